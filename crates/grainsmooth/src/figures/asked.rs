//! What was asked for, beside what came of it.

use serde::Serialize;

/// A figure that was asked for, and its value in the end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AskedAndReached {
    /// What it is.
    pub what: String,
    /// What was asked for; 0 of differences and errors.
    pub asked: f64,
    /// What was reached.
    pub reached: f64,
}
