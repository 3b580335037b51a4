//! Options from a file: `--config run.toml`, or a file that an earlier run wrote.
//!
//! A key of the file is the long name of an option and its value what follows that on the command line, so every option can
//! stand there and is checked in the same way. What stands on the command line as well overrides the file.

use std::borrow::Cow;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::parser::ValueSource;
use clap::{Arg, Command};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::option_value::{OptionValue, not_a_value, option};
use crate::embedded_config;

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
pub(super) fn parse<'a>(text: &str, command: &'a Command) -> Result<Vec<(&'a Arg, Vec<OsString>)>, String> {
    let line = |at: usize| format!("line {}", 1 + text[..at].matches('\n').count());
    let table = DeTable::parse(text).map_err(|error| {
        let place = error.span().map_or("is no TOML".to_owned(), |span| line(span.start));
        format!("{place}: {}", error.message().replace('\n', "; "))
    })?;
    let mut settings: Vec<_> = table.get_ref().iter().collect();
    settings.sort_by_key(|(key, _)| key.span().start);
    let located = |key: &Spanned<Cow<'_, str>>, problem| format!("{}: {problem}", line(key.span().start));
    let read_option = |(key, value): (&Spanned<Cow<'_, str>>, &Spanned<DeValue<'_>>)| {
        let option = option_value(key.get_ref(), value.get_ref())
            .and_then(|value| option(key.get_ref(), &value, command));
        option.map_err(|problem| located(key, problem))
    };
    settings.into_iter().map(read_option).collect()
}

/// A value as options take it.
fn option_value(key: &str, value: &DeValue<'_>) -> Result<OptionValue, String> {
    let word = |text: &str| Ok(OptionValue::Word(text.into()));
    match value {
        DeValue::Boolean(is_set) => Ok(OptionValue::Flag(*is_set)),
        DeValue::String(text) => word(text),
        DeValue::Float(number) => word(number.as_str()),
        DeValue::Integer(number) if number.radix() == 10 => word(number.as_str()),
        DeValue::Array(values) => {
            let values = values.iter().map(|item| option_value(key, item.get_ref()));
            Ok(OptionValue::List(values.collect::<Result<_, _>>()?))
        }
        DeValue::Table(table) => {
            let mut parts: Vec<_> = table.iter().collect();
            parts.sort_by_key(|(name, _)| name.span().start);
            let part = |(name, part): (&Spanned<Cow<'_, str>>, &Spanned<DeValue<'_>>)| {
                Ok((name.get_ref().to_string(), option_value(name.get_ref(), part.get_ref())?))
            };
            Ok(OptionValue::Parts(parts.into_iter().map(part).collect::<Result<_, String>>()?))
        }
        _ => Err(not_a_value(key)),
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
