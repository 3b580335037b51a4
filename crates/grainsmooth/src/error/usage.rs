//! Mistaken options.

/// A mistake in options.
///
/// Its text is one line; the error of `clap` within also tells the usage, and how a program ends.
#[derive(Debug, thiserror::Error)]
#[error("{}", in_one_line(.0))]
pub struct UsageError(Box<clap::Error>);

impl UsageError {
    /// The error that the command line's parser gave.
    pub fn into_inner(self) -> clap::Error {
        *self.0
    }
}

impl From<clap::Error> for UsageError {
    fn from(error: clap::Error) -> Self {
        Self(Box::new(error))
    }
}

/// The message and its tips, without the usage and where to find help.
pub(crate) fn in_one_line(error: &clap::Error) -> String {
    let message = error.to_string();
    let told = message.lines().filter(|line| line.starts_with("error: ") || line.contains("tip: "));
    let told: Vec<&str> = told.map(|line| line.trim().trim_start_matches("error: ")).collect();
    told.join("; ")
}
