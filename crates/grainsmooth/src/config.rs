use std::num::NonZeroU32;
use std::ops::RangeInclusive;
use std::path::PathBuf;

use glam::{BVec3, DVec3};
use polycrystal::{FaceMesh, Junctions, Relaxation};
use voronoi::{Dimension, Domain};

use crate::{Error, Lattice, LatticeFit, Names, StlEncoding};

/// Where seeds come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SeedSource {
    /// Uniform random in the box, see [`random_seeds`](crate::random_seeds).
    Random {
        /// Number of seeds, at least 1.
        count: usize,
    },
    /// Random in the box, but apart from each other, see [`poisson_disc_seeds`](crate::poisson_disc_seeds).
    PoissonDisc {
        /// Number of seeds, at least 1.
        count: usize,
    },
    /// A lattice, see [`LatticeFit`].
    Lattice {
        /// Its kind, of the config's dimension.
        lattice: Lattice,
        /// Number of conventional cells along the side of the box that holds the fewest, at least 1.
        cells: u32,
    },
    /// A text file, see [`read_seed_file`](crate::read_seed_file).
    File(PathBuf),
}

/// Everything that decides what a run computes. The same config gives the same bytes on every machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// Where seeds come from.
    pub seeds: SeedSource,
    /// Starts the random generator.
    pub random_seed: u64,
    /// Number of times that every seed moves to the centroid of its cell (Lloyd's algorithm).
    pub lloyd_steps: u32,
    /// Two or three dimensions.
    pub dimension: Dimension,
    /// Side lengths of the box, which has its lower corner in the origin; in 2D the last is ignored.
    pub box_size: DVec3,
    /// Axes along which the box repeats; in 2D the last is ignored.
    pub periodic: BVec3,
    /// Control points on boundaries.
    pub face_mesh: FaceMesh,
    /// How far boundaries relax; time 0 leaves them flat.
    pub relaxation: Relaxation,
    /// Length, in units of the mean grain size, below which edges of cells collapse before relaxation; 0 keeps all.
    pub regularize: f64,
    /// Number of subdivisions.
    pub levels: u32,
    /// How triple lines are smoothed.
    pub junctions: Junctions,
    /// Whether to go on without seeds that have no cell, as their neighbours outweigh them; else that is an error.
    pub drop_empty: bool,
    /// How files are written, apart from their formats.
    pub file: FileOptions,
}

/// How files are written, apart from their formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileOptions {
    /// Whose names and numbers arrays have.
    pub names: Names,
    /// Number of voxels along each axis, for formats of voxels; the third is not used in 2D.
    pub voxels: Option<[NonZeroU32; 3]>,
    /// How STL spells its numbers.
    pub stl: StlEncoding,
    /// Whether VTK files have arrays of what is measured.
    pub arrays: bool,
}

impl Default for FileOptions {
    fn default() -> Self {
        Self { names: Names::default(), voxels: None, stl: StlEncoding::Binary, arrays: false }
    }
}

impl Default for Config {
    fn default() -> Self {
        Self {
            seeds: SeedSource::Random { count: 200 },
            random_seed: 1,
            lloyd_steps: 0,
            dimension: Dimension::Three,
            box_size: DVec3::ONE,
            periodic: BVec3::FALSE,
            face_mesh: FaceMesh::Fan,
            relaxation: Relaxation::default(),
            regularize: Self::REGULARIZE,
            levels: 3,
            junctions: Junctions::Crease,
            drop_empty: false,
            file: FileOptions::default(),
        }
    }
}

impl Config {
    /// Shortest and longest side of a box: products of five lengths, which volumes and their derivatives are, must
    /// stay within the range of doubles.
    pub const SIDE_RANGE: RangeInclusive<f64> = 1e-30..=1e30;

    /// The usual length to regularise by: a tenth of a grain. Shorter edges would shrink to nothing during relaxation.
    pub const REGULARIZE: f64 = 0.1;

    /// The largest: edges as long as half a grain are no small features.
    pub const LARGEST_REGULARIZE: f64 = 0.5;

    /// The lattice that the seeds form, if they do.
    pub fn lattice_fit(&self) -> Option<LatticeFit> {
        match self.seeds {
            SeedSource::Lattice { lattice, cells } => Some(LatticeFit::new(lattice, cells, self.box_size)),
            _ => None,
        }
    }

    /// The box that the grains fill: that of [`LatticeFit::box_size`] for a lattice.
    ///
    /// # Errors
    /// [`Error::BoxSide`] when a side is not positive and finite, or beyond what doubles can compute with.
    pub fn domain(&self) -> Result<Domain, Error> {
        let axes = if self.dimension == Dimension::Two { 2 } else { 3 };
        let sides = ['x', 'y', 'z'].into_iter().zip(self.box_size.to_array());
        if let Some((axis, length)) = sides.take(axes).find(|(_, length)| !Self::SIDE_RANGE.contains(length))
        {
            return Err(Error::BoxSide { axis, length });
        }
        let upper = self.lattice_fit().map_or(self.box_size, |fit| fit.box_size());
        let domain = match self.dimension {
            Dimension::Two => Domain::rectangle(DVec3::ZERO, upper)?,
            Dimension::Three => Domain::cuboid(DVec3::ZERO, upper)?,
        };
        Ok(domain.with_periods(self.periodic))
    }
}
