//! Why the geometry refuses a command.

use std::path::Path;

use hyper::StatusCode;
use serde::de::DeserializeOwned;
use serde_json::error::Category;

use super::answer::Answer;

/// An answer that refuses.
pub(super) struct Refusal(pub(super) Answer);

impl Refusal {
    pub(super) fn new(status: StatusCode, why: &str) -> Self {
        Self(Answer::refused(status, why))
    }

    /// What cannot be done to what is shown.
    pub(super) fn impossible(why: &dyn std::fmt::Display) -> Self {
        Self::new(StatusCode::UNPROCESSABLE_ENTITY, &why.to_string())
    }

    pub(super) fn no_such_command(path: &str) -> Self {
        Self::new(StatusCode::NOT_FOUND, &format!("{path} is no command"))
    }
}

impl From<serde_json::Error> for Refusal {
    fn from(error: serde_json::Error) -> Self {
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, &error.to_string())
    }
}

/// The words of a command.
pub(super) fn words<T: DeserializeOwned>(body: &[u8]) -> Result<T, Refusal> {
    serde_json::from_slice(body).map_err(|error| {
        let status = match error.classify() {
            Category::Data => StatusCode::UNPROCESSABLE_ENTITY,
            _ => StatusCode::BAD_REQUEST,
        };
        Refusal::new(status, &error.to_string())
    })
}

/// The name of a file, for a heading.
pub(super) fn name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
