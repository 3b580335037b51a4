//! What is asked of the phases: their shares of the volume, and what their grains are like.

use std::fmt;
use std::str::FromStr;

use texture::CrystalSymmetry;
use thiserror::Error;

use super::place::PhasePlace;
use super::sizes::SizeSource;
use super::texture::TextureSource;

/// Least similarity of a mistaken key to the one that is meant, after Jaro and Winkler.
const LEAST_SIMILARITY: f64 = 0.8;

/// What is asked of a phase.
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseOptions {
    /// Its name: letters, digits, `_`, `-` and `.`.
    pub name: String,
    /// Its share of the volume (in the plane: area), above 0.
    pub fraction: f64,
    /// The diameters of its grains; nothing for those of all.
    pub diameters: Option<SizeSource>,
    /// The orientations of its grains; nothing for those of all.
    pub texture: Option<TextureSource>,
    /// The symmetry of its crystals; nothing for that of all.
    pub symmetry: Option<CrystalSymmetry>,
    /// Where its grains are; nothing for anywhere.
    pub place: Option<PhasePlace>,
}

/// What a phase may have, by key, and how it is read.
type Key = (&'static str, fn(&mut PhaseOptions, &str) -> Result<(), String>);

const KEYS: [Key; 4] = [
    ("diameters", |phase, text| {
        phase.diameters = Some(SizeSource::diameters(text).map_err(|error| error.to_string())?);
        Ok(())
    }),
    ("texture", |phase, text| {
        phase.texture = Some(TextureSource::new(text).map_err(|error| error.to_string())?);
        Ok(())
    }),
    ("symmetry", |phase, text| {
        phase.symmetry = Some(text.parse().map_err(|error: texture::SymmetryError| error.to_string())?);
        Ok(())
    }),
    ("place", |phase, text| {
        phase.place = Some(text.parse()?);
        Ok(())
    }),
];

/// What may stand behind a distribution of diameters, and so is no key of a phase.
const OF_DIAMETERS: [&str; 3] = ["from", "to", "by"];

impl FromStr for PhaseOptions {
    type Err = String;

    /// Reads `NAME:FRACTION`, and behind it keys with values: `austenite:0.2,diameters=equal(5),texture=goss(10)`. What has no key
    /// belongs to the value before.
    fn from_str(text: &str) -> Result<Self, String> {
        let (first, rest) = text.split_once(',').unwrap_or((text, ""));
        let example = "write a name and a share of the volume, such as ferrite:0.8";
        let (name, fraction) =
            first.split_once(':').ok_or_else(|| format!("no ':' in '{first}'; {example}"))?;
        let name = name.trim();
        let is_good = |character: char| character.is_ascii_alphanumeric() || "_-.".contains(character);
        if name.is_empty() || !name.chars().all(is_good) {
            return Err(format!("'{name}' is not a name; give letters, digits, _, - or ."));
        }
        let number =
            fraction.trim().parse().ok().filter(|number: &f64| (f64::MIN_POSITIVE..=1.0).contains(number));
        let fraction = number.ok_or_else(|| {
            format!("'{}' is not a share of the volume; give a number above 0, up to 1", fraction.trim())
        })?;
        let mut phase = Self {
            name: name.to_owned(),
            fraction,
            diameters: None,
            texture: None,
            symmetry: None,
            place: None,
        };
        let mut given: Vec<(Key, String)> = Vec::new();
        for piece in pieces(rest) {
            match (key_of(piece)?, given.last_mut()) {
                (Some((key, value)), _) => {
                    if given.iter().any(|(other, _)| other.0 == key.0) {
                        return Err(format!("{} stands twice; leave one out", key.0));
                    }
                    given.push((key, value.to_owned()));
                }
                (None, Some((_, value))) => {
                    value.push(',');
                    value.push_str(piece);
                }
                (None, None) => return Err(format!("'{}' has no key; {}", piece.trim(), known_keys())),
            }
        }
        for ((_, read), value) in given {
            read(&mut phase, value.trim())?;
        }
        Ok(phase)
    }
}

/// Parts between commas outside all brackets.
fn pieces(text: &str) -> Vec<&str> {
    let mut depth = 0_usize;
    let parts = text.split(|character| {
        match character {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        character == ',' && depth == 0
    });
    parts.filter(|part| !part.trim().is_empty()).collect()
}

/// The key of a piece and its value; nothing where it goes on with the value before.
fn key_of(piece: &str) -> Result<Option<(Key, &str)>, String> {
    let Some((word, value)) = piece.split_once('=') else { return Ok(None) };
    let word = word.trim();
    if let Some(key) = KEYS.into_iter().find(|(name, _)| *name == word) {
        return Ok(Some((key, value)));
    }
    let is_word =
        !word.is_empty() && word.chars().all(|character| character.is_ascii_alphabetic() || character == '-');
    if !is_word || OF_DIAMETERS.contains(&word) {
        return Ok(None);
    }
    let alike = KEYS.map(|(name, _)| (strsim::jaro_winkler(word, name), name));
    let nearest = alike.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    Err(match nearest.filter(|(similarity, _)| *similarity > LEAST_SIMILARITY) {
        Some((_, name)) => format!("'{word}' is unknown; did you mean '{name}'?"),
        None => format!("'{word}' is unknown; {}", known_keys()),
    })
}

fn known_keys() -> String {
    format!("a phase may have {}", KEYS.map(|(name, _)| format!("{name}=")).join(", "))
}

/// As it is given: `NAME:FRACTION,key=value`.
impl fmt::Display for PhaseOptions {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}:{:?}", self.name, self.fraction)?;
        let values = [
            ("diameters", self.diameters.as_ref().map(ToString::to_string)),
            ("texture", self.texture.as_ref().map(ToString::to_string)),
            ("symmetry", self.symmetry.as_ref().map(ToString::to_string)),
            ("place", self.place.as_ref().map(ToString::to_string)),
        ];
        for (key, value) in values {
            value.iter().try_for_each(|value| write!(out, ",{key}={value}"))?;
        }
        Ok(())
    }
}

/// Phases that contradict each other or other options.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PhasesError {
    /// Their fractions do not add up to 1.
    #[error("the phases' fractions add up to {sum}, not to 1; give {remedy}, for example")]
    Sum {
        /// The sum.
        sum: String,
        /// Fractions in the same proportion.
        remedy: String,
    },
    /// Two have one name.
    #[error("two phases are called {name}; give each a name of its own")]
    NameTwice {
        /// The name.
        name: String,
    },
    /// One has diameters of its own and another has none.
    #[error(
        "phase {with} has diameters and phase {without} has none; give it some, or --diameters for all that have none"
    )]
    NoDiameters {
        /// One with diameters.
        with: String,
        /// One without.
        without: String,
    },
    /// An option for the phases without something of their own, where all have that.
    #[error("--{option} is for phases without {key}= of their own, and all have it; leave one of them out")]
    NotUsed {
        /// The option.
        option: &'static str,
        /// The key of the phases.
        key: &'static str,
    },
    /// Each grain has a volume of its own, and phases take what they need.
    #[error("volumes given for each grain contradict fractions of phases; leave one of them out")]
    Volumes,
    /// All phases are to be put into others.
    #[error(
        "every phase has place=, such as {place}, and none makes the grains around them; leave place= out of one"
    )]
    NoMatrix {
        /// The place of the first.
        place: PhasePlace,
    },
    /// A place that there is in three dimensions only.
    #[error(
        "place={place} needs three dimensions; with --dim 2 give triple-lines, for the points where three grains meet"
    )]
    PlaceInPlane {
        /// The place.
        place: PhasePlace,
    },
    /// An option that a place does not go with.
    #[error("place={place} of phase {name} does not go with {option}; leave one of them out")]
    PlaceAnd {
        /// The place.
        place: PhasePlace,
        /// The phase that has it.
        name: String,
        /// The option.
        option: &'static str,
    },
    /// Fewer grains than phases.
    #[error("{grains} grains cannot be of {phases} phases; give {phases} seeds or more")]
    FewGrains {
        /// Number of grains.
        grains: usize,
        /// Number of phases.
        phases: usize,
    },
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;

    #[test]
    fn what_stands_behind_a_distribution_belongs_to_it() {
        let text = "b-2:0.25,diameters=0.5*lognormal(mean=20,cv=0.3)+0.5*equal(60), from=5,by=volume,texture=euler(30 45 60, 10),symmetry=622";
        let phase: PhaseOptions = text.parse().unwrap();
        assert_eq!((phase.name.as_str(), phase.fraction), ("b-2", 0.25));
        assert_eq!(
            phase.diameters.as_ref().unwrap().to_string(),
            "0.5*lognormal(mean=20,cv=0.3)+0.5*equal(60), from=5,by=volume"
        );
        assert_eq!(phase.texture, Some(TextureSource::Words("euler(30 45 60, 10)".to_owned())));
        assert_eq!(phase.symmetry, Some(CrystalSymmetry::Hexagonal));
        assert_eq!(phase.to_string().parse(), Ok(phase), "its own text");
    }
}
