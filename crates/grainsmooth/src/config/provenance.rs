//! What files tell of how they were made.

use std::borrow::Cow;
use std::io::{self, Write};

use toml::Table;

use super::Config;
use super::settings::PREFIXES;

/// How a network was made.
#[derive(Debug, Clone, Copy)]
pub enum Provenance<'a> {
    /// By these settings, which any file of it carries.
    Config(&'a Config),
    /// By this command, of files that it names.
    Command(&'a str),
}

impl Provenance<'_> {
    /// The command line that makes the same again.
    pub fn command_line(&self) -> Cow<'_, str> {
        match self {
            Self::Config(config) => config.command_line().into(),
            Self::Command(line) => (*line).into(),
        }
    }

    /// Every setting by the long name of its option; none where the command line tells them.
    pub fn settings(&self) -> Table {
        match self {
            Self::Config(config) => config.settings(),
            Self::Command(_) => Table::new(),
        }
    }

    /// What random numbers start from, where some are drawn.
    pub fn random_seed(&self) -> Option<u64> {
        match self {
            Self::Config(config) => Some(config.random_seed),
            Self::Command(_) => None,
        }
    }

    /// The text that files carry: settings as TOML, which [`embedded_config`](crate::embedded_config()) finds, or the command line.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Config(config) => config.to_toml(),
            Self::Command(line) => format!("{line}\n"),
        }
    }

    /// Writes [`text`](Self::text) with a format's sign for comments before each line.
    pub(crate) fn write_comments(&self, sign: &str, out: &mut dyn Write) -> io::Result<()> {
        debug_assert!(PREFIXES.contains(&sign), "embedded_config knows the sign");
        self.text().lines().try_for_each(|line| writeln!(out, "{sign}{line}"))
    }

    /// The settings that are not the default ones, in one line; nothing where there are none.
    pub(crate) fn differences(&self) -> Option<String> {
        match self {
            Self::Config(config) => Some(config.differences()),
            Self::Command(_) => None,
        }
    }
}
