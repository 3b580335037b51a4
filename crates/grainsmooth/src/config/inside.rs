//! What is asked of the inside of grains: a second tessellation in each.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;
use sizes::Spec;
use thiserror::Error;

/// The coefficient of variation of the diameters of inner grains, as of usual ones.
const USUAL_VARIATION: f64 = 0.35;

/// What the grains of a phase, or all, are divided by.
#[derive(Debug, Clone, PartialEq)]
pub struct InsideOptions {
    /// The name of the phase; nothing for all grains.
    pub phase: Option<String>,
    /// What divides each of its grains.
    pub pattern: InsidePattern,
}

/// What divides a grain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InsidePattern {
    /// Parallel layers.
    Lamellae {
        /// Thickness of each, in the unit of the box; what is left over goes to both ends.
        width: f64,
        /// The direction across them, in the sample, of any length; nothing for a random one in each grain.
        normal: Option<DVec3>,
    },
    /// Cells like the usual ones.
    Voronoi {
        /// Mean equivalent diameter, in the unit of the box.
        diameter: f64,
        /// Coefficient of variation of the diameters, which are lognormal.
        cv: f64,
    },
}

impl FromStr for InsideOptions {
    type Err = String;

    /// Reads `lamellae(width=2)` or `voronoi(diameter=5)`, with `PHASE:` before it for the grains of one phase.
    fn from_str(text: &str) -> Result<Self, String> {
        let (phase, pattern) = match text.split_once(':') {
            Some((phase, pattern)) => (Some(phase.trim().to_owned()), pattern),
            None => (None, text),
        };
        Ok(Self { phase, pattern: pattern.parse()? })
    }
}

impl FromStr for InsidePattern {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let known = "write lamellae(width=2) or voronoi(diameter=5), with PHASE: before it for one phase";
        let inner =
            text.split_once('(').and_then(|(name, rest)| Some((name.trim(), rest.strip_suffix(')')?)));
        let (name, inner) = inner.ok_or_else(|| format!("'{text}' divides nothing; {known}"))?;
        let keys: &[&str] = match name {
            "lamellae" => &["width", "normal"],
            "voronoi" => &["diameter", "cv"],
            _ => return Err(format!("'{name}' divides nothing; {known}")),
        };
        let mut values = [None, None];
        for pair in inner.split(',').filter(|pair| !pair.trim().is_empty()) {
            let needs = || format!("{name} takes {}; '{}' is none of them", keys_in_words(keys), pair.trim());
            let (key, value) = pair.split_once('=').ok_or_else(needs)?;
            let place = keys.iter().position(|known| *known == key.trim()).ok_or_else(needs)?;
            if values[place].replace(value.trim()).is_some() {
                return Err(format!("{} stands twice; leave one out", keys[place]));
            }
        }
        let [first, second] = values;
        let length = first.ok_or_else(|| format!("{name} needs {}=; {known}", keys[0]))?;
        let length = number(length).filter(|length| *length >= f64::MIN_POSITIVE);
        let length = length.ok_or_else(|| format!("{}= is not a length; give a number above 0", keys[0]))?;
        Ok(match (name, second) {
            ("lamellae", normal) => {
                Self::Lamellae { width: length, normal: normal.map(direction).transpose()?.flatten() }
            }
            (_, None) => Self::Voronoi { diameter: length, cv: USUAL_VARIATION },
            (_, Some(text)) => {
                let cv = number(text).filter(|cv| (0.0..=1.0).contains(cv));
                let cv = cv.ok_or_else(|| format!("cv={text} is none; give a number from 0 to 1"))?;
                Self::Voronoi { diameter: length, cv }
            }
        })
    }
}

fn keys_in_words(keys: &[&str]) -> String {
    keys.iter().map(|key| format!("{key}=")).collect::<Vec<_>>().join(" and ")
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

/// A direction of the sample: nothing for `random`.
fn direction(text: &str) -> Result<Option<DVec3>, String> {
    let axis = match text {
        "random" => return Ok(None),
        "x" => Some(DVec3::X),
        "y" => Some(DVec3::Y),
        "z" => Some(DVec3::Z),
        _ => None,
    };
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(number).collect();
    let of_numbers = numbers.and_then(|numbers| match numbers[..] {
        [x, y] => Some(DVec3::new(x, y, 0.0)),
        [x, y, z] => Some(DVec3::new(x, y, z)),
        _ => None,
    });
    let found = axis.or(of_numbers).filter(|normal| normal.try_normalize().is_some());
    found.map(Some).ok_or_else(|| {
        format!("normal={text} is not a direction; give x, y, z, random, or coordinates such as normal=1 1 0")
    })
}

/// As it is given.
impl fmt::Display for InsideOptions {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(phase) = &self.phase {
            write!(out, "{phase}:")?;
        }
        self.pattern.fmt(out)
    }
}

impl fmt::Display for InsidePattern {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lamellae { width, normal: None } => write!(out, "lamellae(width={width:?})"),
            Self::Lamellae { width, normal: Some(DVec3 { x, y, z }) } => {
                write!(out, "lamellae(width={width:?},normal={x:?} {y:?} {z:?})")
            }
            Self::Voronoi { diameter, cv } => write!(out, "voronoi(diameter={diameter:?},cv={cv:?})"),
        }
    }
}

impl InsidePattern {
    /// The diameters of cells that divide a grain, as a distribution; nothing for lamellae.
    pub(crate) fn diameters(&self) -> Option<Spec> {
        let Self::Voronoi { diameter, cv } = self else { return None };
        let words = match cv {
            0.0 => format!("equal({diameter:?})"),
            _ => format!("lognormal(mean={diameter:?}, cv={cv:?})"),
        };
        Some(words.parse().expect("a good distribution"))
    }
}

/// Patterns that do not go with each other or with other options.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum InsideError {
    /// One names a phase that there is not.
    #[error("--inside names the phase '{name}'; {known}")]
    UnknownPhase {
        /// The name.
        name: String,
        /// What there is.
        known: String,
    },
    /// Two are for the same grains.
    #[error("--inside divides {grains} twice; leave one of them out")]
    Twice {
        /// Which.
        grains: String,
    },
    /// A direction that leaves the plane.
    #[error("--inside {pattern}: in 2D the normal lies in the plane; give x, y, random, or two coordinates")]
    OutOfPlane {
        /// The pattern.
        pattern: String,
    },
    /// Grains are too small to be divided.
    #[error("--inside {pattern} divides no grain because all are too small; give at most {remedy}")]
    NothingDivided {
        /// The pattern.
        pattern: String,
        /// What divides one.
        remedy: String,
    },
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;

    #[test]
    fn patterns_are_read_back_from_their_own_text() {
        for text in [
            "lamellae(width=2.0)",
            "a.b:lamellae(width=0.5,normal=0.0 0.0 1.0)",
            "voronoi(diameter=5.0,cv=0.35)",
            "beta:voronoi(diameter=5.0,cv=0.0)",
        ] {
            assert_eq!(text.parse::<InsideOptions>().unwrap().to_string(), text);
        }
        assert_eq!("voronoi( diameter = 5 )".parse::<InsidePattern>(), "voronoi(diameter=5,cv=0.35)".parse());
        let tilted: InsidePattern = "lamellae(width=1, normal=1 1 0)".parse().unwrap();
        // As it was given: a unit vector that is read again and normalised may not be the same.
        let normal = Some(DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(tilted, InsidePattern::Lamellae { width: 1.0, normal });
        assert_eq!(tilted.to_string().parse(), Ok(tilted));
    }

    #[test]
    fn mistakes_are_told() {
        for (text, said) in [
            ("layers(2)", "'layers' divides nothing"),
            ("lamellae", "'lamellae' divides nothing"),
            ("lamellae()", "lamellae needs width="),
            ("lamellae(width=0)", "width= is not a length"),
            ("lamellae(width=nan)", "width= is not a length"),
            ("lamellae(width=1,width=2)", "width stands twice"),
            ("lamellae(2)", "lamellae takes width= and normal=; '2' is none of them"),
            ("lamellae(width=1,normal=0 0 0)", "normal=0 0 0 is not a direction"),
            ("voronoi(diameter=1,cv=2)", "cv=2 is none"),
            ("voronoi(width=1)", "voronoi takes diameter= and cv="),
        ] {
            let error = text.parse::<InsideOptions>().unwrap_err();
            assert!(error.contains(said), "{text}: {error}");
        }
    }
}
