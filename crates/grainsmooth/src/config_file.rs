//! Options from a file: `--config run.toml`, or a file that an earlier run wrote.
//!
//! A key of the file is the long name of an option, so every option can stand there. What stands on the command line too
//! comes after, and so overrides it.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{anyhow, bail};
use clap::{Arg, ArgAction, Command};
use grainsmooth::vtk::field_text;
use toml::{Table, Value};

/// The field entry of a VTK file that holds the run's options.
const FIELD: &str = "Config";

/// Options that a file cannot give: they would name another file, or do something else than a run.
const NOT_IN_FILES: [&str; 3] = ["config", "help", "version"];

/// Names farther than this from any option's are not taken for misspelled: Jaro-Winkler similarity, as clap has it.
const LEAST_SIMILARITY: f64 = 0.7;

/// The program's arguments with those of the file named by `--config`, if there is one, before them.
pub fn with_config_file(arguments: Vec<OsString>, command: &Command) -> anyhow::Result<Vec<OsString>> {
    let Some(path) = config_path(&arguments) else { return Ok(arguments) };
    let options = read(&path, command).map_err(|error| anyhow!("{}: {error}", path.display()))?;
    let (program, rest) = arguments.split_at(1);
    Ok([program, &options, rest].concat())
}

/// What follows the last `--config`.
fn config_path(arguments: &[OsString]) -> Option<PathBuf> {
    let mut path = None;
    let mut words = arguments.iter().skip(1);
    while let Some(word) = words.next() {
        let text = word.to_string_lossy();
        if text == "--" {
            break;
        } else if text == "--config" {
            path = words.next().map(PathBuf::from);
        } else if let Some(value) = text.strip_prefix("--config=") {
            path = Some(PathBuf::from(value));
        }
    }
    path
}

fn read(path: &Path, command: &Command) -> anyhow::Result<Vec<OsString>> {
    let bytes = std::fs::read(path).map_err(|cause| anyhow!("cannot be read: {cause}"))?;
    let is_toml = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    let text = match is_toml {
        true => String::from_utf8(bytes).map_err(|_| anyhow!("is not UTF-8 text; save it as UTF-8"))?,
        false => field_text(&bytes, FIELD).ok_or_else(|| {
            anyhow!("holds no options; give a .toml file, or a .vtp, .vtu or .vti file of an earlier run")
        })?,
    };
    let table: Table = text.parse().map_err(|error: toml::de::Error| {
        let line = error.span().map_or(0, |span| text[..span.start].lines().count().max(1));
        anyhow!("line {line}: {}", error.message())
    })?;
    let mut options = Vec::new();
    for (key, value) in &table {
        let argument = find(key, command)?;
        options.extend(words(key, value, argument)?);
    }
    Ok(options)
}

/// The option of this long name.
fn find<'a>(key: &str, command: &'a Command) -> anyhow::Result<&'a Arg> {
    let named = || command.get_arguments().filter_map(|argument| Some((argument.get_long()?, argument)));
    let named = || named().filter(|(name, _)| !NOT_IN_FILES.contains(name));
    if let Some((_, argument)) = named().find(|(name, _)| *name == key) {
        return Ok(argument);
    }
    let similarity = |name: &str| strsim::jaro_winkler(key, name);
    let nearest = named().map(|(name, _)| name).max_by(|a, b| similarity(a).total_cmp(&similarity(b)));
    match nearest.filter(|name| similarity(name) > LEAST_SIMILARITY) {
        Some(name) => bail!("unknown key '{key}'; a similar one exists: '{name}'"),
        None => bail!("unknown key '{key}'; keys are the long names of options, as --help lists them"),
    }
}

/// The option as words of a command line.
fn words(key: &str, value: &Value, argument: &Arg) -> anyhow::Result<Vec<OsString>> {
    let option = OsString::from(format!("--{key}"));
    let is_flag = matches!(argument.get_action(), ArgAction::SetTrue);
    match (value, is_flag) {
        (Value::Boolean(true), true) => Ok(vec![option]),
        (Value::Boolean(false), true) => Ok(Vec::new()),
        (_, true) => bail!("key '{key}' is true or false"),
        (Value::Array(values), _) => {
            let values: Vec<OsString> = values.iter().map(|value| word(key, value)).collect::<Result<_, _>>()?;
            Ok([vec![option], values].concat())
        }
        _ => Ok(vec![option, word(key, value)?]),
    }
}

fn word(key: &str, value: &Value) -> anyhow::Result<OsString> {
    match value {
        Value::String(text) => Ok(text.into()),
        Value::Integer(number) => Ok(number.to_string().into()),
        Value::Float(number) => Ok(number.to_string().into()),
        _ => bail!("key '{key}' holds a {}; give a number, a text, or a list of them", value.type_str()),
    }
}
