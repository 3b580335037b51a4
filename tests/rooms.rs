//! Rooms, the top modules of a crate, know those below alone: no circle of imports among them.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The crates whose rooms stand in an order.
const CRATES: [&str; 6] = ["campaign", "polycrystal", "sizes", "subzero", "texture", "voronoi"];

/// Which rooms each one imports from.
type Imports = BTreeMap<String, BTreeSet<String>>;

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// The code of a file before its tests, without comments and blanks.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let before_tests = text.split("#[cfg(test)]\nmod tests").next().unwrap();
    let lines = before_tests.lines().map(|line| line.split("//").next().unwrap());
    lines.flat_map(|line| line.split_whitespace().collect::<Vec<_>>()).collect::<Vec<_>>().join(" ")
}

/// The paths, in parts, that a tree such as `a::{b, c::{d, e}}` stands for.
fn leaves(tree: &str) -> Vec<Vec<String>> {
    let tree = tree.trim();
    if let Some(inner) = tree.strip_prefix('{') {
        let (mut depth, mut from, mut found) = (0, 0, Vec::new());
        let inner = inner.trim_end().strip_suffix('}').unwrap();
        for (at, character) in inner.char_indices().chain([(inner.len(), ',')]) {
            match character {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    found.extend(leaves(&inner[from..at]));
                    from = at + 1;
                }
                _ => {}
            }
        }
        return found;
    }
    match tree.split_once("::") {
        Some((first, rest)) => {
            leaves(rest).into_iter().map(|rest| [vec![first.trim().to_owned()], rest].concat()).collect()
        }
        // Behind the last comma.
        None if tree.is_empty() => Vec::new(),
        None => vec![vec![tree.split(" as ").next().unwrap().to_owned()]],
    }
}

/// What stands behind each `start` up to a `;` or, inside of code, up to the end of a path.
fn paths(code: &str, start: &str) -> Vec<Vec<String>> {
    let is_of_path = |character: char| character.is_alphanumeric() || "_:".contains(character);
    let found = code.match_indices(start).map(|(at, _)| &code[at + start.len()..]);
    found
        .flat_map(|rest| match rest.starts_with('{') {
            true => leaves(&rest[..rest.find(';').unwrap()]),
            false => leaves(&rest[..rest.find(|character| !is_of_path(character)).unwrap_or(rest.len())]),
        })
        .collect()
}

/// The imports among the rooms of a crate; names at its root count as those of the room that they come from.
fn imports(source: &Path) -> Imports {
    let root = code(&source.join("lib.rs"));
    let rooms: BTreeSet<String> = files(source).iter().map(|path| room(source, path)).collect();
    let exported: BTreeMap<String, String> = root
        .split("pub use ")
        .skip(1)
        .flat_map(|text| leaves(text.split(';').next().unwrap()))
        .map(|path| (path[path.len() - 1].clone(), path[0].clone()))
        .collect();
    let mut imports = Imports::new();
    for path in files(source) {
        let own = room(source, &path);
        if own == "lib" || own == "main" {
            continue;
        }
        let code = code(&path);
        for parts in paths(&code, "crate::") {
            let first = &parts[0];
            let of = if rooms.contains(first) { first } else { exported.get(first).unwrap_or(&own) };
            if *of != own {
                imports.entry(own.clone()).or_default().insert(of.clone());
            }
        }
    }
    imports
}

/// The top module that a file belongs to.
fn room(source: &Path, path: &Path) -> String {
    let first = path.strip_prefix(source).unwrap().components().next().unwrap();
    Path::new(first.as_os_str()).file_stem().unwrap().to_str().unwrap().to_owned()
}

/// The rooms that are left when each that imports from none of the rest has gone, again and again.
fn in_circles(mut imports: Imports) -> Imports {
    loop {
        let left: BTreeSet<String> = imports.keys().cloned().collect();
        for of in imports.values_mut() {
            of.retain(|room| left.contains(room));
        }
        let count = imports.len();
        imports.retain(|_, of| !of.is_empty());
        if imports.len() == count {
            return imports;
        }
    }
}

#[test]
fn no_room_imports_from_one_above() {
    for name in CRATES {
        let imports = imports(&Path::new(env!("CARGO_MANIFEST_DIR")).join("crates").join(name).join("src"));
        assert!(!imports.is_empty(), "{name} has no imports, or they were not found");
        assert_eq!(in_circles(imports), Imports::new(), "{name}");
    }
}

#[test]
fn circles_are_found() {
    let of = |rooms: &[&str]| rooms.iter().map(|room| (*room).to_owned()).collect::<BTreeSet<_>>();
    let line = Imports::from([("a".to_owned(), of(&["b", "c"])), ("b".to_owned(), of(&["c"]))]);
    assert_eq!(in_circles(line.clone()), Imports::new());
    let circle = [line, Imports::from([("c".to_owned(), of(&["b"]))])].into_iter().flatten().collect();
    assert_eq!(in_circles(circle).keys().collect::<Vec<_>>(), ["a", "b", "c"]);
    assert_eq!(
        paths("use crate::{A, b::{C, d::E,}}; crate::f::G(1)", "crate::"),
        [vec!["A"], vec!["b", "C"], vec!["b", "d", "E"], vec!["f", "G"]]
    );
}
