//! The Python package offers the program's options as keywords, by types that are written here: `UPDATE=1 cargo test python_keywords`.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

use clap::builder::ValueRange;
use clap::{Arg, ArgAction, Command, CommandFactory};
use grainsmooth::cli::Arguments;

/// Characters of a line of a docstring.
const WIDTH: usize = 120;

/// Options that shape no polycrystal: of these headings, and of files those that Python has functions for.
const LEFT_OUT_HEADINGS: [&str; 2] = ["Pictures", "Run"];
const LEFT_OUT: [&str; 9] = [
    "output",
    "format",
    "grains-dir",
    "grains-format",
    "stats",
    "series",
    "every",
    "cells-json",
    "cells-csv",
];

const HEAD: &str = r#""""The program's options as keywords. Written by the test `python_keywords` from the program's own: change options there."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Literal, TypedDict, Union

#: A number, a text or a path, as the command line has it.
Value = Union[int, float, str, "os.PathLike[str]"]

#: The value of an option that can be given several times: one, or a list; parts with names, as of a phase, are a dictionary.
Repeated = Union[Value, Mapping[str, Value], Sequence[Union[Value, Mapping[str, Value]]]]
"#;

const OPTIONS: &str = r#"

class Options(TypedDict, total=False):
    """What shapes a polycrystal, and how its files are written.

    Names, defaults, ranges and messages are those of the program ``grainsmooth``: ``--rng-seed 7`` is ``rng_seed=7``. An option that is
    ``None`` is not given.
    """
"#;

const MAP_OPTIONS: &str = r#"

class MapOptions(TypedDict, total=False):
    """How a measured map is read: the options of ``grainsmooth smooth``, as :class:`Options` has those of the program."""
"#;

#[test]
fn keywords_are_the_options() {
    let mut command = Arguments::command();
    command.build();
    let smooth = command.find_subcommand("smooth").unwrap();
    let shapes = |argument: &&Arg| {
        let heading = argument.get_help_heading();
        let name = argument.get_long();
        heading.is_some_and(|heading| !LEFT_OUT_HEADINGS.contains(&heading))
            && name.is_some_and(|name| !LEFT_OUT.contains(&name))
    };
    let reads =
        |argument: &&Arg| argument.get_help_heading().is_some_and(|heading| heading.starts_with("Map"));
    let text = [HEAD, &class(OPTIONS, &command, shapes), &class(MAP_OPTIONS, smooth, reads)].concat();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("python/grainsmooth/_options.py");
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let written = std::fs::read_to_string(&path).unwrap();
    assert_eq!(
        declared(&written),
        declared(&text),
        "the options changed: run `UPDATE=1 cargo test python_keywords`"
    );
    assert!(declared(&text).len() > 60);
    for name in LEFT_OUT {
        assert!(
            command.get_arguments().any(|argument| argument.get_long() == Some(name)),
            "{name} is no option"
        );
    }
}

/// The names and types of keywords; their help may be worded anew in the program first.
fn declared(text: &str) -> Vec<&str> {
    let lines: Vec<&str> = text.lines().collect();
    let has_help = |pair: &&[&str]| pair[0].contains(": ") && pair[1].starts_with("    \"\"\"");
    lines.windows(2).filter(has_help).map(|pair| pair[0]).collect()
}

/// A class with a keyword for each option that is chosen.
fn class(head: &str, command: &Command, is_chosen: impl Fn(&&Arg) -> bool) -> String {
    let arguments: Vec<&Arg> = command.get_arguments().filter(is_chosen).collect();
    let names: BTreeSet<&str> = arguments.iter().filter_map(|argument| argument.get_long()).collect();
    let mut text = head.to_owned();
    for argument in arguments {
        let name = keyword(argument.get_long().unwrap());
        let doc = wrapped(&documented(argument, &names));
        write!(text, "\n    {name}: {}\n    \"\"\"{doc}\"\"\"\n", annotation(argument)).unwrap();
    }
    text
}

fn keyword(name: &str) -> String {
    name.replace('-', "_")
}

/// The type of an option's value.
fn annotation(argument: &Arg) -> String {
    let count = argument.get_num_args().unwrap_or(ValueRange::SINGLE);
    if matches!(argument.get_action(), ArgAction::SetTrue) {
        return "bool".to_owned();
    }
    if matches!(argument.get_action(), ArgAction::Append) && count.max_values() == 1 {
        return "Repeated".to_owned();
    }
    let values = argument.get_possible_values();
    if !values.is_empty() {
        let values: Vec<String> = values.iter().map(|value| format!("\"{}\"", value.get_name())).collect();
        return format!("Literal[{}]", values.join(", "));
    }
    let kind = match (count.min_values(), count.max_values()) {
        (_, 1) => "Value",
        (1, _) => "Union[Value, Sequence[Value]]",
        _ => "Sequence[Value]",
    };
    kind.to_owned()
}

/// The help of an option, with the names of others as they are keywords, and its default.
fn documented(argument: &Arg, names: &BTreeSet<&str>) -> String {
    let help = argument.get_long_help().or_else(|| argument.get_help()).unwrap().to_string();
    let mut paragraphs: Vec<String> = Vec::new();
    for paragraph in help.split("\n\n").filter(|paragraph| !paragraph.trim().is_empty()) {
        let paragraph = paragraph.split_whitespace().collect::<Vec<_>>().join(" ").replace('\\', "\\\\");
        paragraphs.push(match paragraph.strip_prefix("Example: ") {
            Some(example) => format!("Example of the command line: ``{example}``"),
            None => with_keywords(&paragraph, names),
        });
    }
    let defaults = argument.get_default_values();
    if !defaults.is_empty() && !matches!(argument.get_action(), ArgAction::SetTrue) {
        let words: Vec<_> = defaults.iter().map(|value| value.to_string_lossy()).collect();
        paragraphs.push(format!("Default: ``{}``", words.join(" ")));
    }
    paragraphs.join("\n\n")
}

/// Text in which ``box`` stands for --box.
fn with_keywords(text: &str, names: &BTreeSet<&str>) -> String {
    let mut parts = text.split("--");
    let mut found = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end =
            part.find(|letter: char| !letter.is_ascii_lowercase() && letter != '-').unwrap_or(part.len());
        match names.contains(&part[..end]) {
            true => write!(found, "``{}``{}", keyword(&part[..end]), &part[end..]).unwrap(),
            false => write!(found, "--{part}").unwrap(),
        }
    }
    found
}

/// Paragraphs as lines within a class.
fn wrapped(text: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    for paragraph in text.split("\n\n") {
        if !lines.is_empty() {
            lines.push(String::new());
        }
        let mut line = String::new();
        for word in paragraph.split(' ') {
            if !line.is_empty() && line.len() + 1 + word.len() > WIDTH {
                lines.push(format!("    {line}"));
                line.clear();
            }
            let gap = if line.is_empty() { "" } else { " " };
            write!(line, "{gap}{word}").unwrap();
        }
        lines.push(format!("    {line}"));
    }
    lines.join("\n").trim_start().to_owned()
}
