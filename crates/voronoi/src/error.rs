use glam::DVec3;

use crate::exact::generator::Generator;

/// Why a tessellation could not be made. Seeds are named by their position in the input, counted from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VoronoiError {
    /// There is nothing to tessellate.
    #[error("no seeds: give at least one")]
    NoSeeds,
    /// More seeds than 32-bit ids can name.
    #[error("{count} seeds are more than the {} that ids can name; use fewer", Generator::MAX_SITES)]
    TooManySeeds {
        /// Number of seeds, with their periodic images if it is these that are too many.
        count: usize,
    },
    /// A side of the domain is no length, or one whose powers leave the range of numbers.
    #[error("the domain's side along {axis} is {length:?}; every side must be between 1e-30 and 1e30")]
    BadDomain {
        /// `x`, `y` or `z`.
        axis: char,
        /// The offending length.
        length: f64,
    },
    /// A half-space has a number that is not finite, no normal, or in the plane one that leaves it.
    #[error(
        "half-space {wall} has no direction; its normal must be finite and not 0, in the plane without a part along z"
    )]
    BadHalfSpace {
        /// Position of the half-space in the input.
        wall: usize,
    },
    /// A half-space is farther away than a length may be.
    #[error("half-space {wall} is {distance:e} from the origin; move it within 1e30, or leave it out")]
    FarHalfSpace {
        /// Position of the half-space in the input.
        wall: usize,
        /// How far away it is; infinite where that is no number.
        distance: f64,
    },
    /// Half-spaces have no point in common.
    #[error(
        "half-space {wall} has nothing in common with those before it; turn its normal outward or move it"
    )]
    EmptyDomain {
        /// Position of the half-space in the input.
        wall: usize,
    },
    /// Half-spaces bound nothing in some direction.
    #[error("the half-spaces are unbounded in the direction {}; add one with a normal that points there", Point(*.direction))]
    UnboundedDomain {
        /// A unit vector.
        direction: DVec3,
    },
    /// Half-spaces have a point, a line or a polygon in common, but no volume (in the plane: area).
    #[error("the domain between {} and {} is flat; move its half-spaces apart", Point(*.lower), Point(*.upper))]
    FlatDomain {
        /// Corner of its bounding box.
        lower: DVec3,
        /// The opposite corner.
        upper: DVec3,
    },
    /// A domain has more walls than can be told apart.
    #[error(
        "more than the {most} walls that a domain can have; use fewer half-spaces or a larger chord error"
    )]
    TooManyWalls {
        /// The largest number.
        most: u16,
    },
    /// A length of a curved domain is not positive and finite.
    #[error("the domain's {what} is {length}; it must be positive and finite")]
    BadLength {
        /// Which length.
        what: &'static str,
        /// The offending length.
        length: f64,
    },
    /// A surface has a border, or winds both ways.
    #[error(
        "face {face} has no neighbour across its edge from vertex {} to vertex {}, or one that winds the other way; close the surface",
        .ends[0], .ends[1]
    )]
    OpenSurface {
        /// Position of the face in the input.
        face: usize,
        /// Positions of the edge's ends.
        ends: [u32; 2],
    },
    /// A surface is not that of a convex body.
    #[error("vertex {vertex} lies outside face {face}: the surface is not convex, which a domain must be")]
    NotConvex {
        /// Position of the face in the input.
        face: usize,
        /// Position of the vertex.
        vertex: usize,
    },
    /// A seed has a coordinate that is NaN or infinite.
    #[error("seed {seed} at {} has a coordinate that is not a finite number; correct it or remove the seed", Point(*.position))]
    NotFinite {
        /// Position of the seed in the input.
        seed: usize,
        /// Its coordinates.
        position: DVec3,
    },
    /// A seed lies outside the domain.
    #[error("seed {seed} at {} lies outside the domain {domain}; move it inside or enlarge the domain", Point(*.position))]
    OutsideDomain {
        /// Position of the seed in the input.
        seed: usize,
        /// Its coordinates.
        position: DVec3,
        /// The domain in words, such as `[0, 1] x [0, 1] x [0, 1]`.
        domain: String,
    },
    /// A power weight is NaN or infinite.
    #[error(
        "seed {seed} has the weight {weight}, which is not a finite number; correct it or remove the seed"
    )]
    BadWeight {
        /// Position of the seed in the input.
        seed: usize,
        /// Its weight.
        weight: f64,
    },
    /// Two seeds share all coordinates, so neither has a cell of its own.
    #[error("seeds {first} and {second} have the same position {}; remove one of them", Point(*.position))]
    DuplicateSeeds {
        /// The earlier of the two in the input.
        first: usize,
        /// The later of the two.
        second: usize,
        /// Their common coordinates.
        position: DVec3,
    },
}

/// Writes a point as `(x, y, z)` with as many digits as its doubles need.
struct Point(DVec3);

impl std::fmt::Display for Point {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y, z] = self.0.to_array().map(Number);
        write!(formatter, "({x}, {y}, {z})")
    }
}

/// Writes a number with all its digits, and an exponent where there would be many zeros beside them.
struct Number(f64);

impl std::fmt::Display for Number {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self(number) = self;
        let has_many_zeros = *number != 0.0 && !(1e-5..1e16).contains(&number.abs());
        if has_many_zeros { write!(formatter, "{number:e}") } else { write!(formatter, "{number}") }
    }
}
