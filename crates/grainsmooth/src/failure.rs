//! A run that failed after its cells were made.

use std::fmt;

use polycrystal::{Attempt, NetworkError};

use crate::{Error, FailedGrain, Tessellated};

/// Why no network could be made of some cells. In words it is one line: what went wrong last, with whom, and what helps.
#[derive(Debug)]
pub struct Failure {
    /// What went wrong on the last way that was tried.
    pub cause: NetworkError,
    /// The grain that it failed at, if it is about grains.
    pub grain: Option<FailedGrain>,
    /// What helps where grains cannot grow freely for so long.
    pub growth: Option<Growth>,
    /// What was tried before, and what each attempt said.
    pub attempts: Vec<Attempt>,
}

/// What is known of grains that cannot grow freely for as long as asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Growth {
    /// They can for this time.
    Until(f64),
    /// They cannot for any time that was tried.
    Never,
}

impl Failure {
    /// A failure that some cells led to.
    pub(crate) fn new(error: NetworkError, mut attempts: Vec<Attempt>, cells: &Tessellated) -> Self {
        let (more, cause) = error.into_attempts();
        attempts.extend(more);
        let grain = FailedGrain::of(&cause, cells);
        Self { cause, grain, growth: None, attempts }
    }

    /// The same, with what helps where grains grow.
    pub(crate) fn with_growth(self, growth: Growth) -> Self {
        Self { growth: Some(growth), ..self }
    }
}

impl From<Failure> for Error {
    fn from(failure: Failure) -> Self {
        Self::Failed(Box::new(failure))
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}", self.cause)?;
        if let Some(grain) = &self.grain {
            write!(out, "; {grain}")?;
        }
        match (self.growth, self.grain.and_then(|grain| grain.least_diameter())) {
            (Some(Growth::Until(time)), _) => write!(out, "; --relax {time} works"),
            (Some(Growth::Never), _) => write!(
                out,
                "; no shorter time that was tried works: merge the smallest cells, such as with --min-diameter 0.5"
            ),
            (None, Some(diameter)) => write!(out, "; merge such cells with --min-diameter {diameter}"),
            (None, None) => Ok(()),
        }
    }
}
