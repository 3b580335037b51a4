use std::fmt;

use voronoi::{Translation, Wall};

/// Number of a grain: that of its seed in the input, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GrainId(pub u32);

impl GrainId {
    /// The id as an index.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Number of a boundary, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BoundaryId(pub u32);

impl BoundaryId {
    /// The id as an index.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// What lies on one side of a boundary.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// A grain.
    Grain(GrainId),
    /// The outside of the domain.
    Exterior,
}

impl Side {
    /// The grain, if it is one.
    pub fn grain(self) -> Option<GrainId> {
        match self {
            Self::Grain(grain) => Some(grain),
            Self::Exterior => None,
        }
    }
}

impl fmt::Display for Side {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Grain(grain) => write!(out, "grain {}", grain.0),
            Self::Exterior => write!(out, "the exterior"),
        }
    }
}

/// The surface (in the plane: the line) between two grains, or between a grain and one wall of the domain.
///
/// Grains of a periodic domain are whole. The boundary between a grain and one that stands a period away so comes twice, once
/// at each of the two grains, with the exterior beyond and the other one as its twin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Boundary {
    /// The two sides: a grain first, then a grain of greater number or the exterior. Normals point from first to second.
    pub sides: [Side; 2],
    /// The wall that the boundary lies on, if its second side is the exterior.
    pub wall: Option<Wall>,
    /// The same boundary at the grain beyond, whole periods away.
    pub twin: Option<Twin>,
}

/// Where a boundary of a periodic network comes a second time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Twin {
    /// The boundary there. The greater number of the two is the copy.
    pub boundary: BoundaryId,
    /// From here to there.
    pub translation: Translation,
}

impl Boundary {
    /// The grains on either side with the sign of the boundary's contribution to their volume.
    pub fn signed_grains(&self) -> impl Iterator<Item = (GrainId, f64)> {
        self.sides.into_iter().zip([1.0, -1.0]).filter_map(|(side, sign)| Some((side.grain()?, sign)))
    }

    /// The grains or the exterior on both sides, with the grain beyond a period in the exterior's place; given all boundaries of
    /// the network.
    ///
    /// # Panics
    /// When the boundary's twin is none of them.
    pub fn sides_across(&self, boundaries: &[Boundary]) -> [Side; 2] {
        let [first, second] = self.sides;
        [first, self.twin.map_or(second, |twin| boundaries[twin.boundary.index()].sides[0])]
    }

    /// The boundary as the law of its tension is asked about it: on both sides the grains that meet there, a period between them or not, the
    /// smaller first, or a grain and then the exterior at a wall; no twin. Given all boundaries of the network.
    ///
    /// # Panics
    /// When the boundary's twin is none of them.
    #[must_use]
    pub fn between_grains(&self, boundaries: &[Boundary]) -> Self {
        let mut sides = self.sides_across(boundaries);
        sides.sort_unstable();
        Self { sides, wall: self.wall, twin: None }
    }

    /// Whether grains lie on both sides, without a period between them.
    pub fn is_interior(&self) -> bool {
        self.sides[1] != Side::Exterior
    }
}
