//! Options by their long names, with values from a file or another program, as words of the command line.

use std::ffi::OsString;

use clap::error::ErrorKind;
use clap::{Arg, ArgAction, Command};

use crate::error::usage::in_one_line;
use crate::spelling::nearest;

/// Options that cannot be given so: they would name another file, or do something else than a run.
const NOT_GIVEN_BY_NAME: [&str; 3] = ["config", "help", "version"];

/// What the command line has before other keys, of an option that is a table.
const NAME: &str = "name";
const FRACTION: &str = "fraction";

/// The value of an option.
#[derive(Debug, Clone, PartialEq)]
pub enum OptionValue {
    /// Of an option that is given or not.
    Flag(bool),
    /// A number or a text, as the command line spells it.
    Word(OsString),
    /// Several: of one option, or of an option that comes several times.
    List(Vec<OptionValue>),
    /// Named parts of one value, such as of a phase, in their order.
    Parts(Vec<(String, OptionValue)>),
}

/// The words of all options, each with its own.
///
/// # Errors
/// What is wrong with one, in one line.
pub(super) fn all_words(
    options: &[(String, OptionValue)],
    command: &Command,
) -> Result<Vec<Vec<OsString>>, String> {
    options.iter().map(|(name, value)| Ok(option(name, value, command)?.1)).collect()
}

/// The option of a long name with its value: as words, which are found good by themselves.
///
/// # Errors
/// What is wrong with it, in one line.
pub(super) fn option<'a>(
    name: &str,
    value: &OptionValue,
    command: &'a Command,
) -> Result<(&'a Arg, Vec<OsString>), String> {
    let argument = find(name, command)?;
    let words = words(name, value, argument)?;
    let alone = [command.get_name().into()].into_iter().chain(words.iter().cloned());
    match command.clone().try_get_matches_from(alone) {
        Err(error) if error.kind() != ErrorKind::MissingRequiredArgument => Err(in_one_line(&error)),
        _ => Ok((argument, words)),
    }
}

/// The option of this long name.
fn find<'a>(name: &str, command: &'a Command) -> Result<&'a Arg, String> {
    let named = || {
        let named = command.get_arguments().filter_map(|argument| Some((argument.get_long()?, argument)));
        named.filter(|(name, _)| !NOT_GIVEN_BY_NAME.contains(name))
    };
    if let Some((_, argument)) = named().find(|(known, _)| *known == name) {
        return Ok(argument);
    }
    Err(match nearest(name, named().map(|(name, _)| name)) {
        Some(meant) => format!("unknown key '{name}'; did you mean '{meant}'?"),
        None => format!("unknown key '{name}'; keys are the long names of the options that --help lists"),
    })
}

/// The option as words of a command line.
fn words(name: &str, value: &OptionValue, argument: &Arg) -> Result<Vec<OsString>, String> {
    let option = OsString::from(format!("--{name}"));
    let is_flag = matches!(argument.get_action(), ArgAction::SetTrue);
    match (value, is_flag) {
        (OptionValue::Flag(true), true) => Ok(vec![option]),
        (OptionValue::Flag(false), true) => Ok(Vec::new()),
        (_, true) => Err(format!("'{name}' is true or false")),
        // An option that may come several times: once for each value.
        (OptionValue::List(values), _) if is_repeated(argument) => {
            values.iter().map(|value| single(&option, name, value)).collect()
        }
        (OptionValue::List(values), _) => {
            let values = values.iter().map(|value| word(name, value));
            std::iter::once(Ok(option)).chain(values).collect()
        }
        _ => Ok(vec![single(&option, name, value)?]),
    }
}

/// An option and its only value as one word, in which the value may begin as an option does.
fn single(option: &OsString, name: &str, value: &OptionValue) -> Result<OsString, String> {
    let value = match value {
        OptionValue::Parts(parts) => named_parts(name, parts)?,
        value => word(name, value)?,
    };
    let mut single = option.clone();
    single.push("=");
    single.push(value);
    Ok(single)
}

/// Whether the option takes one value each time that it comes.
fn is_repeated(argument: &Arg) -> bool {
    let is_single = argument.get_num_args().is_some_and(|count| count.max_values() == 1);
    matches!(argument.get_action(), ArgAction::Append) && is_single
}

/// Parts such as of `[[phase]]` as the command line spells them: `NAME:FRACTION,key=value`, with a value for each other key.
fn named_parts(name: &str, parts: &[(String, OptionValue)]) -> Result<OsString, String> {
    let part = |key: &str| {
        let part = parts.iter().find(|(known, _)| known == key);
        let (_, value) = part.ok_or_else(|| format!("a table '{name}' needs a {key}"))?;
        word(key, value)
    };
    let (mut text, fraction) = (part(NAME)?, part(FRACTION)?);
    text.push(":");
    text.push(fraction);
    for (key, value) in parts.iter().filter(|(key, _)| ![NAME, FRACTION].contains(&key.as_str())) {
        text.push(format!(",{key}="));
        text.push(word(key, value)?);
    }
    Ok(text)
}

fn word(name: &str, value: &OptionValue) -> Result<OsString, String> {
    match value {
        OptionValue::Word(text) => Ok(text.clone()),
        _ => Err(not_a_value(name)),
    }
}

/// What is said of a value of no kind that options have.
pub(super) fn not_a_value(name: &str) -> String {
    format!("'{name}' is a decimal number, a text, or a list of them")
}
