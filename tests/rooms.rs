//! Rooms, the top modules of a crate, know those below alone: no circle of imports among them, nor, in `grainsmooth`, among the modules of
//! a room.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The crates whose rooms stand in an order, and by how many parts of its path a module is named.
const CRATES: [(&str, usize); 8] = [
    ("campaign", 1),
    ("grainsmooth", 1),
    ("grainsmooth", 2),
    ("polycrystal", 1),
    ("sizes", 1),
    ("subzero", 1),
    ("texture", 1),
    ("voronoi", 1),
];

/// Which modules each one imports from.
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

/// The paths behind each `start`, which is no part of a longer path: of all that is imported there, or of one item inside of code.
fn paths(code: &str, start: &str) -> Vec<Vec<String>> {
    let is_of_path = |character: char| character.is_alphanumeric() || "_:".contains(character);
    let found = code.match_indices(start).filter(|(at, _)| !code[..*at].ends_with(is_of_path));
    let found = found.map(|(at, _)| &code[at + start.len()..]);
    found
        .flat_map(|rest| {
            let end = rest.find(|character| !is_of_path(character)).unwrap_or(rest.len());
            match rest[end..].starts_with('{') {
                true => leaves(&rest[..rest.find(';').unwrap()]),
                false => leaves(&rest[..end]),
            }
        })
        .collect()
}

/// The imports among the modules of a crate, each named by `depth` parts of its path; names at its root count as those of the module that they
/// come from.
fn imports(source: &Path, depth: usize) -> Imports {
    let modules: BTreeSet<Vec<String>> = files(source).iter().map(|path| module(source, path)).collect();
    let exported: BTreeMap<String, Vec<String>> = code(&source.join("lib.rs"))
        .split("pub use ")
        .skip(1)
        .flat_map(|text| leaves(text.split(';').next().unwrap()))
        .map(|path| (path[path.len() - 1].clone(), path))
        .collect();
    let named = |module: &[String]| module[..module.len().min(depth)].join("::");
    let mut imports = Imports::new();
    for path in files(source) {
        let own = module(source, &path);
        if own == ["lib"] || own == ["main"] {
            continue;
        }
        let (code, around) = (code(&path), &own[..own.len() - 1]);
        let from_root = paths(&code, "crate::").into_iter().map(|path| match exported.get(&path[0]) {
            Some(whole) => whole.clone(),
            None => path,
        });
        let from_here = paths(&code, "super::").into_iter().map(|path| {
            let up = path.iter().take_while(|part| *part == "super").count();
            [&around[..around.len() - up], &path[up..]].concat()
        });
        for path in from_root.chain(from_here) {
            let beginnings = (1..=path.len()).rev().map(|length| &path[..length]);
            let of = beginnings.into_iter().find(|beginning| modules.contains(*beginning)).unwrap_or(&own);
            if named(of) != named(&own) {
                imports.entry(named(&own)).or_default().insert(named(of));
            }
        }
    }
    imports
}

/// The path of the module in a file.
fn module(source: &Path, path: &Path) -> Vec<String> {
    let path = path.strip_prefix(source).unwrap().with_extension("");
    path.components().map(|part| part.as_os_str().to_str().unwrap().to_owned()).collect()
}

/// The modules that are left when each that imports from none of the rest has gone, again and again.
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
    for (name, depth) in CRATES {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates").join(name).join("src");
        let imports = imports(&source, depth);
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
    // Lists behind a room's name were once passed over.
    assert_eq!(paths("use crate::a::{B, c::D};", "crate::"), [vec!["a", "B"], vec!["a", "c", "D"]]);
    assert_eq!(paths("super::super::A::b()", "super::"), [vec!["super", "A", "b"]]);
}
