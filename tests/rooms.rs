//! Rooms, the top modules of a crate, know those below alone: no circle of imports among them, nor, in `grainsmooth`, among the modules of
//! a room.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The crates whose rooms stand in an order, and by how many parts of its path a module is named.
const CRATES: [(&str, usize); 10] = [
    ("campaign", 1),
    ("grainsmooth", 1),
    ("grainsmooth", 2),
    ("polycrystal", 1),
    ("polycrystal", 2),
    ("sizes", 1),
    ("subzero", 1),
    ("texture", 1),
    ("voronoi", 1),
    ("voronoi", 2),
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

/// What each module hands on under its own name, and the path of that from the crate's root.
type Exports = BTreeMap<Vec<String>, BTreeMap<String, Vec<String>>>;

/// The imports among the modules of a crate, each named by `depth` parts of its path. What a module hands on counts as imported from where
/// it is defined.
fn imports(source: &Path, depth: usize) -> Imports {
    let files: Vec<(Vec<String>, String)> =
        files(source).iter().map(|path| (module(source, path), code(path))).collect();
    let modules: BTreeSet<&[String]> = files.iter().map(|(module, _)| &module[..]).collect();
    let exports: Exports =
        files.iter().map(|(module, code)| (module.clone(), handed_on(module, code))).collect();
    let named = |module: &[String]| module[..module.len().min(depth)].join("::");
    let mut imports = Imports::new();
    for (own, code) in files.iter().filter(|(own, _)| !own.is_empty()) {
        let from_root = paths(code, "crate::").into_iter();
        let from_here = paths(code, "super::").into_iter().map(|path| from_above(own, &path));
        for path in from_root.chain(from_here) {
            let path = definition(path, &exports);
            let beginnings = (1..=path.len()).rev().map(|length| &path[..length]);
            let of = beginnings.into_iter().find(|beginning| modules.contains(*beginning)).unwrap_or(own);
            if named(of) != named(own) {
                imports.entry(named(own)).or_default().insert(named(of));
            }
        }
    }
    imports
}

/// What a module hands on by `pub use` or `pub(crate) use`.
fn handed_on(module: &[String], code: &str) -> BTreeMap<String, Vec<String>> {
    let uses = ["pub use ", "pub(crate) use "].into_iter().flat_map(|start| code.split(start).skip(1));
    let handed_on = uses.flat_map(|text| leaves(text.split(';').next().unwrap())).map(|path| {
        let whole = match path[0].as_str() {
            "crate" => path[1..].to_vec(),
            "super" => from_above(module, &path[1..]),
            _ => [module, &path[..]].concat(),
        };
        (path[path.len() - 1].clone(), whole)
    });
    handed_on.collect()
}

/// The path from the crate's root of one that a module names behind `super::`.
fn from_above(module: &[String], path: &[String]) -> Vec<String> {
    let up = path.iter().take_while(|part| *part == "super").count();
    [&module[..module.len() - 1 - up], &path[up..]].concat()
}

/// The path to where something is defined, from one by which it is handed on.
fn definition(path: Vec<String>, exports: &Exports) -> Vec<String> {
    for length in 0..path.len() {
        let is_module_on_the_way = length + 1 < path.len() && exports.contains_key(&path[..=length]);
        let handed_on = exports.get(&path[..length]).and_then(|names| names.get(&path[length]));
        match handed_on.filter(|_| !is_module_on_the_way) {
            Some(whole) if *whole != path => {
                return definition([whole, &path[length + 1..]].concat(), exports);
            }
            _ => {}
        }
    }
    path
}

/// The path of the module in a file; nothing for the crate's root.
fn module(source: &Path, path: &Path) -> Vec<String> {
    let path = path.strip_prefix(source).unwrap().with_extension("");
    let parts = path.components().map(|part| part.as_os_str().to_str().unwrap().to_owned());
    parts.filter(|part| !["lib", "main", "mod"].contains(&part.as_str())).collect()
}

/// The modules that import from each other, directly or by way of others, circle by circle.
fn circles(imports: &Imports) -> BTreeSet<BTreeSet<String>> {
    let reached = |from: &String| {
        let (mut reached, mut waiting) = (BTreeSet::new(), vec![from]);
        while let Some(of) = waiting.pop().and_then(|module| imports.get(module)) {
            waiting.extend(of.iter().filter(|module| reached.insert((*module).clone())));
        }
        reached
    };
    let reached: Imports = imports.keys().map(|module| (module.clone(), reached(module))).collect();
    let circle = |module: &String| -> BTreeSet<String> {
        let others = reached[module].iter();
        others.filter(|other| reached.get(*other).is_some_and(|of| of.contains(module))).cloned().collect()
    };
    imports.keys().map(circle).filter(|circle| !circle.is_empty()).collect()
}

#[test]
fn no_room_imports_from_one_above() {
    for (name, depth) in CRATES {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates").join(name).join("src");
        let imports = imports(&source, depth);
        assert!(!imports.is_empty(), "{name} has no imports, or they were not found");
        assert_eq!(circles(&imports), BTreeSet::new(), "{name}");
    }
}

/// The crates whose rooms ARCHITECTURE.md lists one by one.
#[test]
fn each_room_stands_in_the_architecture() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let architecture = fs::read_to_string(root.join("ARCHITECTURE.md")).unwrap();
    for name in ["grainsmooth", "polycrystal", "voronoi"] {
        let source = root.join("crates").join(name).join("src");
        let rooms: BTreeSet<Vec<String>> = files(&source)
            .iter()
            .map(|path| module(&source, path).into_iter().take(1).collect())
            .filter(|room: &Vec<String>| !room.is_empty())
            .collect();
        assert!(rooms.len() > 5, "{name} has few rooms, or they were not found");
        for room in rooms.iter().flatten() {
            assert!(architecture.contains(&format!("`{room}`")), "the room {room} of {name} is missing");
        }
    }
}

#[test]
fn circles_are_found() {
    let of = |rooms: &[&str]| rooms.iter().map(|room| (*room).to_owned()).collect::<BTreeSet<_>>();
    let line = Imports::from([("a".to_owned(), of(&["b", "c"])), ("b".to_owned(), of(&["c"]))]);
    assert_eq!(circles(&line), BTreeSet::new());
    let circle = [line, Imports::from([("c".to_owned(), of(&["b"]))])].into_iter().flatten().collect();
    assert_eq!(circles(&circle), BTreeSet::from([of(&["b", "c"])]));
    assert_eq!(
        paths("use crate::{A, b::{C, d::E,}}; crate::f::G(1)", "crate::"),
        [vec!["A"], vec!["b", "C"], vec!["b", "d", "E"], vec!["f", "G"]]
    );
    // Lists behind a room's name were once passed over.
    assert_eq!(paths("use crate::a::{B, c::D};", "crate::"), [vec!["a", "B"], vec!["a", "c", "D"]]);
    assert_eq!(paths("super::super::A::b()", "super::"), [vec!["super", "A", "b"]]);
}
