//! What a page asks to change.

use serde::Deserialize;
use subzero::INFINITE_SHARPNESS;

use crate::mesh::EdgeChoice;

/// A change of what is edited. Points, edges and faces go by their numbers of the moment.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum Command {
    /// Turns an edge within its quadrilateral.
    Flip { edge: [u32; 2] },
    /// Puts a point on the middle of an edge.
    Split { edge: [u32; 2] },
    /// Draws the first end of an edge into the second.
    Collapse { edge: [u32; 2] },
    /// Puts a point at a place, as the page draws places.
    Move { point: u32, to: [f64; 3] },
    /// Makes an edge a crease of a sharpness, or none of it.
    Crease { edge: [u32; 2], sharpness: Option<Sharpness> },
    /// Makes a point a corner of a sharpness, or none of it.
    Corner { point: u32, sharpness: Option<Sharpness> },
    /// Splits many edges.
    SplitMany(Many),
    /// Flips many edges, where that can be done.
    FlipMany(Many),
    /// Turns every face round.
    Reverse,
    /// Makes winding agree, and normals of closed parts point outward.
    Orient,
    /// Cuts polygons into triangles.
    Triangulate,
}

/// How many steps of subdivision something stays sharp for.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Sharpness {
    Infinite,
    #[serde(untagged)]
    Steps(f32),
}

impl Sharpness {
    pub(super) fn steps(self) -> f32 {
        match self {
            Self::Infinite => INFINITE_SHARPNESS,
            Self::Steps(steps) => steps,
        }
    }
}

/// Edges chosen together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Many {
    All,
    Longest,
    Flat,
}

impl Command {
    /// Whether all is changed: what was before is kept then, so that undoing need not do everything again.
    pub(super) fn is_global(&self) -> bool {
        matches!(
            self,
            Self::SplitMany(_) | Self::FlipMany(_) | Self::Reverse | Self::Orient | Self::Triangulate
        )
    }
}

impl Many {
    pub(super) fn edges(self) -> EdgeChoice {
        match self {
            Self::All => EdgeChoice::All,
            Self::Longest => EdgeChoice::Longest,
            Self::Flat => EdgeChoice::Flat,
        }
    }
}
