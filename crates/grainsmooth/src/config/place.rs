//! Where the grains of a phase are.

use std::fmt;
use std::str::FromStr;

use serde::Serialize;
use voronoi::volumes::InclusionPlace;

/// Where the grains of a phase are, among those of the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PhasePlace {
    /// Each inside another grain.
    Interior,
    /// Each on the boundary between two.
    Boundaries,
    /// Each on a line where three meet (in the plane: a point).
    TripleLines,
    /// Each at a point where four meet.
    QuadruplePoints,
    /// Side by side.
    Clustered,
    /// Apart from each other.
    Dispersed,
}

impl PhasePlace {
    /// All of them with their names in options and files.
    pub const ALL: [(Self, &'static str); 6] = [
        (Self::Interior, "interior"),
        (Self::Boundaries, "boundaries"),
        (Self::TripleLines, "triple-lines"),
        (Self::QuadruplePoints, "quadruple-points"),
        (Self::Clustered, "clustered"),
        (Self::Dispersed, "dispersed"),
    ];

    /// Its name in options and files.
    pub fn name(self) -> &'static str {
        Self::ALL.into_iter().find(|(one, _)| *one == self).map_or("", |(_, name)| name)
    }

    /// Where grains are put into others; nothing where they are cells like these.
    pub fn of_inclusions(self) -> Option<InclusionPlace> {
        match self {
            Self::Interior => Some(InclusionPlace::Interior),
            Self::Boundaries => Some(InclusionPlace::Boundaries),
            Self::TripleLines => Some(InclusionPlace::TripleLines),
            Self::QuadruplePoints => Some(InclusionPlace::QuadruplePoints),
            Self::Clustered | Self::Dispersed => None,
        }
    }

    /// Whether grains are to have neighbours of their own phase; nothing where that is not asked.
    pub(crate) fn is_clustered(self) -> Option<bool> {
        match self {
            Self::Clustered => Some(true),
            Self::Dispersed => Some(false),
            _ => None,
        }
    }
}

impl fmt::Display for PhasePlace {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}

impl FromStr for PhasePlace {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let named = Self::ALL.into_iter().find(|(_, name)| *name == text).map(|(place, _)| place);
        let known = || Self::ALL.map(|(_, name)| name).join(", ");
        named.ok_or_else(|| format!("'{text}' is not a place; give {}", known()))
    }
}
