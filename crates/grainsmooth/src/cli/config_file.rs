//! Options from a file: `--config run.toml`, or a file that an earlier run wrote.
//!
//! A key of the file is the long name of an option and its value what follows that on the command line, so every option can
//! stand there and is checked in the same way. What stands on the command line as well overrides the file.

use std::borrow::Cow;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, Command};
use grainsmooth::embedded_config;
use grainsmooth::spelling::nearest;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Options that a file cannot give: they would name another file, or do something else than a run.
const NOT_IN_FILES: [&str; 3] = ["config", "help", "version"];

/// What the command line has before other keys, of an option that is a table in a file.
const NAME: &str = "name";
const FRACTION: &str = "fraction";

/// The program's arguments with those of the file named by `--config`, if there is one, before them.
///
/// # Errors
/// What is wrong with the file, in one line.
pub fn with_config_file(arguments: Vec<OsString>, command: &Command) -> Result<Vec<OsString>, String> {
    let mut command = command.clone();
    command.build();
    // What is mistaken here is said when all is parsed.
    let given = command.clone().ignore_errors(true).try_get_matches_from(&arguments);
    let Ok(given) = given else { return Ok(arguments) };
    let Ok(Some(path)) = given.try_get_one::<PathBuf>("config") else { return Ok(arguments) };
    let is_given =
        |argument: &Arg| given.value_source(argument.get_id().as_str()) == Some(ValueSource::CommandLine);
    let is_overridden = |argument: &Arg| {
        let excludes =
            |a, b: &Arg| command.get_arg_conflicts_with(a).iter().any(|c| c.get_id() == b.get_id());
        let mut all = command.get_arguments().filter(|other| is_given(other));
        is_given(argument) || all.any(|other| excludes(other, argument) || excludes(argument, other))
    };
    let text = read(path).map_err(|problem| format!("{}: {problem}", path.display()))?;
    let mut options = Vec::new();
    for (argument, words) in
        parse(&text, &command).map_err(|problem| format!("{} {problem}", path.display()))?
    {
        if !is_overridden(argument) {
            options.extend(words);
        }
    }
    let (program, rest) = arguments.split_at(1);
    Ok([program, &options, rest].concat())
}

/// The TOML text of a file.
fn read(path: &Path) -> Result<String, String> {
    let unreadable = |cause| format!("cannot be read: {cause}; give the path of a readable file");
    let is_toml = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    if is_toml {
        let bytes = std::fs::read(path).map_err(unreadable)?;
        return String::from_utf8(bytes).map_err(|_| "is not UTF-8 text; save it as UTF-8".to_owned());
    }
    embedded_config(path).map_err(unreadable)?.ok_or_else(|| {
        let is_stl = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("stl"));
        let reason = if is_stl { ", for which STL has little room" } else { "" };
        format!("holds no configuration{reason}; give a .toml file, or a .vtp or other file that grainsmooth wrote")
    })
}

/// The options of a text, each with its words of a command line.
fn parse<'a>(text: &str, command: &'a Command) -> Result<Vec<(&'a Arg, Vec<OsString>)>, String> {
    let line = |at: usize| format!("line {}", 1 + text[..at].matches('\n').count());
    let table = DeTable::parse(text).map_err(|error| {
        let place = error.span().map_or("is no TOML".to_owned(), |span| line(span.start));
        format!("{place}: {}", error.message().replace('\n', "; "))
    })?;
    let mut settings: Vec<_> = table.get_ref().iter().collect();
    settings.sort_by_key(|(key, _)| key.span().start);
    let located = |key: &Spanned<Cow<'_, str>>, problem| format!("{}: {problem}", line(key.span().start));
    let option = |(key, value): (&Spanned<Cow<'_, str>>, &Spanned<DeValue<'_>>)| {
        option(key.get_ref(), value.get_ref(), command).map_err(|problem| located(key, problem))
    };
    settings.into_iter().map(option).collect()
}

/// The option of a setting.
fn option<'a>(
    key: &str,
    value: &DeValue<'_>,
    command: &'a Command,
) -> Result<(&'a Arg, Vec<OsString>), String> {
    let argument = find(key, command)?;
    let words = words(key, value, argument)?;
    let alone = [command.get_name().into()].into_iter().chain(words.iter().cloned());
    match command.clone().try_get_matches_from(alone) {
        Err(error) if error.kind() != ErrorKind::MissingRequiredArgument => {
            let message = error.to_string();
            // Below the message stand the usage and where to find help; a tip is about the value.
            let message =
                message.lines().filter(|line| line.starts_with("error: ") || line.contains("tip: "));
            let message: Vec<&str> = message.map(|line| line.trim().trim_start_matches("error: ")).collect();
            Err(message.join("; "))
        }
        _ => Ok((argument, words)),
    }
}

/// The option of this long name.
fn find<'a>(key: &str, command: &'a Command) -> Result<&'a Arg, String> {
    let named = || {
        let named = command.get_arguments().filter_map(|argument| Some((argument.get_long()?, argument)));
        named.filter(|(name, _)| !NOT_IN_FILES.contains(name))
    };
    if let Some((_, argument)) = named().find(|(name, _)| *name == key) {
        return Ok(argument);
    }
    Err(match nearest(key, named().map(|(name, _)| name)) {
        Some(name) => format!("unknown key '{key}'; did you mean '{name}'?"),
        None => format!("unknown key '{key}'; keys are the long names of the options that --help lists"),
    })
}

/// The option as words of a command line.
fn words(key: &str, value: &DeValue<'_>, argument: &Arg) -> Result<Vec<OsString>, String> {
    let option = OsString::from(format!("--{key}"));
    let is_flag = matches!(argument.get_action(), ArgAction::SetTrue);
    match (value, is_flag) {
        (DeValue::Boolean(true), true) => Ok(vec![option]),
        (DeValue::Boolean(false), true) => Ok(Vec::new()),
        (_, true) => Err(format!("'{key}' is true or false")),
        // An option that may come several times: once for each value.
        (DeValue::Array(values), _) if is_repeated(argument) => {
            let options = values.iter().map(|value| {
                let word = match value.get_ref() {
                    DeValue::Table(table) => named_parts(key, table)?,
                    value => word(key, value)?,
                };
                Ok([option.clone(), word])
            });
            Ok(options.collect::<Result<Vec<_>, String>>()?.concat())
        }
        (DeValue::Array(values), _) => {
            let values = values.iter().map(|value| word(key, value.get_ref()));
            std::iter::once(Ok(option)).chain(values).collect()
        }
        _ => Ok(vec![option, word(key, value)?]),
    }
}

/// Whether the option takes one value each time that it comes.
fn is_repeated(argument: &Arg) -> bool {
    let is_single = argument.get_num_args().is_some_and(|count| count.max_values() == 1);
    matches!(argument.get_action(), ArgAction::Append) && is_single
}

/// A table such as `[[phase]]` as the command line spells it: `NAME:FRACTION,key=value`, with a value for each other key.
fn named_parts(key: &str, table: &DeTable<'_>) -> Result<OsString, String> {
    let part = |part: &str| {
        let value = table.get(part).ok_or_else(|| format!("a table '{key}' needs a {part}"))?;
        word(part, value.get_ref())
    };
    let (mut text, fraction) = (part(NAME)?, part(FRACTION)?);
    text.push(":");
    text.push(fraction);
    let mut others: Vec<_> = table.iter().collect();
    others.retain(|(name, _)| ![NAME, FRACTION].contains(&name.get_ref().as_ref()));
    others.sort_by_key(|(name, _)| name.span().start);
    for (name, value) in others {
        text.push(format!(",{}=", name.get_ref()));
        text.push(word(name.get_ref(), value.get_ref())?);
    }
    Ok(text)
}

fn word(key: &str, value: &DeValue<'_>) -> Result<OsString, String> {
    match value {
        DeValue::String(text) => Ok(text.as_ref().into()),
        DeValue::Float(number) => Ok(number.as_str().into()),
        DeValue::Integer(number) if number.radix() == 10 => Ok(number.as_str().into()),
        _ => Err(format!("'{key}' is a decimal number, a text, or a list of them")),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use clap::CommandFactory;
    use proptest::prelude::*;
    use proptest::sample::Index;

    use super::*;
    use crate::cli::Arguments;

    const GOOD: &str = "# a plate\nseeds = 7\nbox = [3, 1, 0.5]\nperiodic = \"x,y\"\nrelax = 1e-1\nlevels = 1\n\
                        drop-empty = false\nquiet = true\ncells-csv = 'plate.csv'\nlattice = ['bcc', 2]\n";

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]

        #[test]
        fn corrupt_settings_are_refused_in_one_line_or_read(
            changes in prop::collection::vec((any::<Index>(), "[ -~\n]"), 0..4),
            cut in any::<Index>(),
        ) {
            let mut text = GOOD.to_owned();
            for (place, character) in changes {
                let at = place.index(text.len());
                text.replace_range(at..=at, &character);
            }
            text.truncate(text.len() - cut.index(text.len()));
            let mut command = Arguments::command();
            command.build();
            if let Err(message) = parse(&text, &command) {
                prop_assert!(!message.contains('\n'), "{message}");
                prop_assert!(message.starts_with("line ") || message.starts_with("is no TOML"), "{message}");
            }
        }
    }

    #[test]
    fn good_settings_are_read() {
        let mut command = Arguments::command();
        command.build();
        assert_eq!(parse(GOOD, &command).unwrap().len(), 9);
    }
}
