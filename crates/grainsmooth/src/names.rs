//! What arrays are called in files, and how grains are numbered there.

use clap::ValueEnum;
use polycrystal::{Boundary, GrainId, Side};
use serde::Serialize;
use voronoi::{Domain, Wall};

/// The point array that tells how many grains meet: four at a quadruple point, unless edges collapsed there.
pub(crate) const NUMBER_OF_GRAINS: &str = "NumberOfGrains";

/// The array of the tensions of boundaries.
pub(crate) const TENSION: &str = "Tension";

/// The array of boundaries' mobilities.
pub(crate) const MOBILITY: &str = "Mobility";

/// The array of the numbers of grains' seeds.
pub(crate) const SEED_ID: &str = "SeedId";

/// The array of the grains that others are parts of.
pub(crate) const PARENT: &str = "Parent";

/// The array of the phases of grains.
pub(crate) const PHASE: &str = "Phase";

/// The array of the numbers of voxels, pixels or points of grains.
pub(crate) const VOXEL_COUNT: &str = "VoxelCount";

/// The array of the grain orientation spreads.
pub(crate) const SPREAD: &str = "GOS";

/// The array of the numbers of boundaries.
pub(crate) const BOUNDARY_ID: &str = "BoundaryId";

/// The array of the levels at which points were born.
pub(crate) const GENERATION: &str = "Generation";

/// The volumes (in the plane: areas) of all grains.
pub(crate) const VOLUMES: &str = "Volumes";

/// The names of the phases, and the symmetry of the crystals of each.
pub(crate) const PHASE_NAMES: &str = "PhaseNames";
pub(crate) const CRYSTAL_SYMMETRIES: &str = "CrystalSymmetries";

/// The periods along the axes of a network that repeats; 0 along the others.
pub(crate) const PERIODS: &str = "Periods";

/// The entry with the settings of a run, as TOML.
pub(crate) const CONFIG: &str = "Config";

/// The entry with Bunge's angles of each grain, in degrees.
pub(crate) const EULER_ANGLES: &str = "EulerAngles";

/// What files say of themselves and of all grains beside who made them and how, and whether it is text.
pub(crate) const FIELD_NAMES: [(&str, bool); 11] = [
    (CONFIG, true),
    ("RandomSeed", false),
    (PHASE_NAMES, true),
    (CRYSTAL_SYMMETRIES, true),
    (PERIODS, false),
    (VOLUMES, false),
    (SEED_ID, false),
    (PARENT, false),
    (PHASE, false),
    (EULER_ANGLES, false),
    ("Quaternion", false),
];

/// Cell arrays that hold the two sides, in the order in which they are looked for: DREAM.3D's and this program's, then
/// pyvista's and VTK's.
pub(crate) const LABEL_ARRAYS: [&str; 3] = ["FaceLabels", "boundary_labels", "BoundaryLabels"];

/// The axes, as sides of a box are named after them.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// The name of a side of a box, as Neper has it: `x0`, `x1` and so on. Nothing for walls of other domains.
pub(crate) fn side_of_box(domain: &Domain, wall: Wall) -> Option<String> {
    let (axis, coordinate) = domain.across_axis(wall).filter(|_| domain.is_box())?;
    Some(format!("{}{}", AXES[axis], u8::from(coordinate == domain.upper()[axis])))
}

/// Whose names and numbers arrays have, for users of other tools. Points and cells stay the same, but for what is said here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Names {
    /// `FaceLabels`, `GrainId`, `material`: grains from 0, the exterior is -1 and comes second.
    #[default]
    Grainsmooth,
    /// DREAM.3D: `FaceLabels`, `FeatureIds`: grains from 1; the exterior is -1 and comes first, so its triangles wind the
    /// other way.
    Dream3d,
    /// pyvista: `boundary_labels`, `GrainId`: grains from 1, the exterior is 0 and comes second.
    Pyvista,
    /// VirMat: `FaceLabels`, `GrainID`: grains from 1, the exterior is 0 and comes second.
    Virmat,
    /// Neper: `FaceLabels`, `Id`, `MaterialId`: grains from 1, the exterior is 0 and comes second.
    Neper,
}

impl Names {
    /// The array of the two sides of a boundary.
    pub(crate) fn sides(self) -> &'static str {
        if self == Self::Pyvista { "boundary_labels" } else { "FaceLabels" }
    }

    /// The array of the grain on a grain's surface.
    pub(crate) fn grain(self) -> &'static str {
        match self {
            Self::Grainsmooth | Self::Pyvista => "GrainId",
            Self::Dream3d => "FeatureIds",
            Self::Virmat => "GrainID",
            Self::Neper => "Id",
        }
    }

    /// The array of the grain of a voxel.
    pub(crate) fn voxel(self) -> &'static str {
        match self {
            Self::Grainsmooth => "material",
            Self::Neper => "MaterialId",
            _ => self.grain(),
        }
    }

    /// The arrays of the inverse pole figure colours of the sample's axes.
    pub(crate) fn inverse_pole_figures(self) -> [&'static str; 3] {
        match self {
            Self::Virmat => ["IPF-RD", "IPF-TD", "IPF-ND"],
            _ => ["IPFColorX", "IPFColorY", "IPFColorZ"],
        }
    }

    /// The number of a grain.
    pub(crate) fn number(self, grain: GrainId) -> i32 {
        // Grains are far fewer than 2^31, for each has many triangles and those have 32-bit ids.
        let number = i32::try_from(grain.0).expect("fewer grains than 2^31");
        if self == Self::Grainsmooth { number } else { number + 1 }
    }

    /// The number of a side.
    pub(crate) fn side_number(self, side: Side) -> i32 {
        match side {
            Side::Grain(grain) => self.number(grain),
            Side::Exterior if matches!(self, Self::Grainsmooth | Self::Dream3d) => -1,
            Side::Exterior => 0,
        }
    }

    /// The number of a voxel: 0 outside of all grains, or -1 where that is a grain.
    pub(crate) fn voxel_number(self, side: Side) -> i32 {
        match side {
            Side::Grain(grain) => self.number(grain),
            Side::Exterior if self == Self::Grainsmooth => -1,
            Side::Exterior => 0,
        }
    }

    /// Whether a boundary's sides stand, and its triangles wind, the other way than elsewhere.
    pub(crate) fn reverses(self, boundary: &Boundary) -> bool {
        self == Self::Dream3d && !boundary.is_interior()
    }

    /// The numbers of the sides of a boundary, in the scheme's order. Where a grain stands a period beyond, the second of
    /// ours is -2 - b with the number b of the boundary there.
    pub fn labels(self, boundary: &Boundary) -> [i32; 2] {
        let [first, mut second] = boundary.sides.map(|side| self.side_number(side));
        if let (Self::Grainsmooth, Some(twin)) = (self, boundary.twin) {
            second = -2 - twin.boundary.0.cast_signed();
        }
        if self.reverses(boundary) { [second, first] } else { [first, second] }
    }
}
