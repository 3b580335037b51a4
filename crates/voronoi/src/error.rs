use glam::DVec3;

/// Why a tessellation could not be made. Seeds are named by their position in the input, counted from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VoronoiError {
    /// There is nothing to tessellate.
    #[error("no seeds: give at least one")]
    NoSeeds,
    /// More seeds than 32-bit ids can name.
    #[error("{count} seeds are more than the {} that ids can name", u32::MAX - 8)]
    TooManySeeds {
        /// Number of seeds given.
        count: usize,
    },
    /// A side of the domain is not a positive, finite length.
    #[error("the domain's side along {axis} is {length}; every side must be positive and finite")]
    BadDomain {
        /// `x`, `y` or `z`.
        axis: char,
        /// The offending length.
        length: f64,
    },
    /// A seed has a coordinate that is NaN or infinite.
    #[error("seed {seed} at {} has a coordinate that is not a finite number", Point(*.position))]
    NotFinite {
        /// Position of the seed in the input.
        seed: usize,
        /// Its coordinates.
        position: DVec3,
    },
    /// A seed lies outside the domain.
    #[error("seed {seed} at {} lies outside the domain {domain}; move it inside or enlarge the box", Point(*.position))]
    OutsideDomain {
        /// Position of the seed in the input.
        seed: usize,
        /// Its coordinates.
        position: DVec3,
        /// The domain in words, such as `[0, 1] x [0, 1] x [0, 1]`.
        domain: String,
    },
    /// A power weight is NaN or infinite.
    #[error("seed {seed} has the weight {weight}, which is not a finite number")]
    BadWeight {
        /// Position of the seed in the input.
        seed: usize,
        /// Its weight.
        weight: f64,
    },
    /// Two seeds share all coordinates, so neither has a cell of its own.
    #[error("seeds {first} and {second} stand at the same place {}; remove one of them", Point(*.position))]
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
        write!(formatter, "({}, {}, {})", self.0.x, self.0.y, self.0.z)
    }
}
