//! What tensions and mobilities are asked for, by phases and by disorientation.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use thiserror::Error;

use super::table_file::is_table_file;

/// A law for the boundaries between two phases, or for all that have none of their own.
#[derive(Debug, Clone, PartialEq)]
pub struct LawOptions {
    /// The names of the phases on both sides, in any order; nothing for all boundaries.
    pub phases: Option<[String; 2]>,
    /// What they have.
    pub law: LawSource,
}

/// What boundaries have, in any unit.
#[derive(Debug, Clone, PartialEq)]
pub enum LawSource {
    /// The same whatever the disorientation.
    Number(f64),
    /// A curve over the disorientation.
    Curve {
        /// What it is multiplied by.
        factor: f64,
        /// Which.
        curve: LawCurve,
        /// The angle in degrees from where boundaries count as of high angle.
        angle: f64,
    },
    /// A text file with angles in degrees and what boundaries have there.
    File(PathBuf),
}

/// A curve over the disorientation as a share x of an angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LawCurve {
    /// x (1 - ln x), and 1 from 1 on: tensions after Read and Shockley (1950).
    ReadShockley,
    /// 1 - exp(-5 x^4): mobilities after Humphreys (1997).
    Humphreys,
}

impl LawCurve {
    const ALL: [Self; 2] = [Self::ReadShockley, Self::Humphreys];

    /// Its name on the command line.
    fn name(self) -> &'static str {
        match self {
            Self::ReadShockley => "read-shockley",
            Self::Humphreys => "humphreys",
        }
    }

    /// Its value, from 0 to 1, at a share from 0 on.
    pub(crate) fn at(self, share: f64) -> f64 {
        match self {
            Self::ReadShockley if share >= 1.0 => 1.0,
            Self::ReadShockley if share > 0.0 => share * (1.0 - libm::log(share)),
            Self::ReadShockley => 0.0,
            Self::Humphreys => -libm::expm1(-5.0 * share.powi(4)),
        }
    }
}

/// What laws are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LawKind {
    /// Energy per area.
    Tension,
    /// Velocity per pressure.
    Mobility,
}

impl LawKind {
    /// Its name, as in options and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tension => "tension",
            Self::Mobility => "mobility",
        }
    }
}

impl FromStr for LawOptions {
    type Err = String;

    /// Reads a law, or one of two phases: `ferrite/austenite:0.8*read-shockley(15)`.
    fn from_str(text: &str) -> Result<Self, String> {
        let pair = text.split_once(':').and_then(|(pair, law)| Some((pair.split_once('/')?, law)));
        match pair {
            Some(((first, second), law)) => {
                let phases = [first, second].map(|name| name.trim().to_owned());
                Ok(Self { phases: Some(phases), law: law.parse()? })
            }
            None => Ok(Self { phases: None, law: text.parse()? }),
        }
    }
}

impl FromStr for LawSource {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        if is_table_file(Path::new(text)) {
            return Ok(Self::File(text.into()));
        }
        let mistaken = || {
            format!(
                "'{text}' is not a law; give a number such as 0.8, read-shockley(15), humphreys(15), one of them times a number, or a .csv file"
            )
        };
        let number = |text: &str| {
            let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite() && *number >= 0.0);
            number.ok_or_else(mistaken)
        };
        let (factor, curve) = match text.split_once('*') {
            Some((factor, curve)) => (number(factor)?, curve.trim()),
            None => (1.0, text),
        };
        let Some((name, angle)) = curve.split_once('(') else { return number(text).map(Self::Number) };
        let curve =
            LawCurve::ALL.into_iter().find(|curve| curve.name() == name.trim()).ok_or_else(mistaken)?;
        let angle = angle.trim().strip_suffix(')').ok_or_else(mistaken)?;
        let degrees = number(angle)?;
        if !(degrees > 0.0 && degrees <= 180.0) {
            return Err(format!("the angle {angle} is not above 0, up to 180 degrees"));
        }
        Ok(Self::Curve { factor, curve, angle: degrees })
    }
}

/// As it is given.
impl fmt::Display for LawOptions {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some([first, second]) = &self.phases {
            write!(out, "{first}/{second}:")?;
        }
        match &self.law {
            LawSource::Number(number) => write!(out, "{number:?}"),
            LawSource::Curve { factor, curve, angle } => {
                write!(out, "{factor:?}*{}({angle:?})", curve.name())
            }
            LawSource::File(path) => path.display().fmt(out),
        }
    }
}

/// A law that does not go with the grains that there are.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("--{} {problem}", kind.name())]
pub struct LawError {
    /// What the law is for.
    pub kind: LawKind,
    /// What is wrong with it.
    pub problem: LawProblem,
}

/// What is wrong with a law.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum LawProblem {
    /// A law names a phase that there is not.
    #[error("names the phase '{name}'; the phases are {known}")]
    UnknownPhase {
        /// The name.
        name: String,
        /// Those that there are.
        known: String,
    },
    /// Two laws are for the same boundaries.
    #[error("has two laws for {boundaries}; leave one out")]
    Twice {
        /// Which.
        boundaries: String,
    },
    /// A law of the disorientation, and grains have no orientations.
    #[error("{law} depends on orientations; give the grains some, such as --texture random")]
    NoOrientations {
        /// The law.
        law: String,
    },
    /// A law of the disorientation, and crystals of two symmetries have none.
    #[error(
        "depends on disorientations, and phases {first} and {second} have crystals of different symmetries; give the boundaries between them a number, such as {first}/{second}:1"
    )]
    NoDisorientation {
        /// A phase.
        first: String,
        /// Another.
        second: String,
    },
    /// Orientations that are swapped after boundaries have relaxed by them.
    #[error(
        "{law} needs orientations before boundaries relax, and --misorientations swaps them after; leave one of them out"
    )]
    Swapped {
        /// The law.
        law: String,
    },
    /// No boundary has any.
    #[error("gives every boundary 0; give at least one a positive number")]
    AllVanish,
    /// Mobilities of boundaries whose grains keep their volumes.
    #[error("is for grains that grow; give --free as well")]
    NotFree,
}
