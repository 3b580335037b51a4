//! What a run is asked for, as data.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use glam::{BVec3, DVec3};
use polycrystal::{FaceMesh, Junctions, Relaxation, Volumes};
use serde::Serialize;
use voronoi::Dimension;

pub(crate) mod check;
mod defaults;
pub(crate) mod elements;
pub(crate) mod files;
pub(crate) mod gradient;
pub(crate) mod inside;
pub(crate) mod lattice;
pub(crate) mod laws;
pub(crate) mod phases;
pub(crate) mod place;
pub(crate) mod provenance;
pub(crate) mod settings;
pub(crate) mod shapes;
pub(crate) mod sizes;
pub mod spelling;
pub(crate) mod table_file;
pub(crate) mod texture;
pub(crate) mod volume_mesh;

use elements::ElementOptions;
use files::FileOptions;
use inside::InsideOptions;
use lattice::Lattice;
use laws::LawOptions;
use phases::PhaseOptions;
use settings::{
    JUNCTIONS, as_axes, as_axis_names, as_lengths, as_rule, as_time, by_option, is_equiaxed, parse_relaxation,
};
use shapes::ShapeSource;
use sizes::SizeOptions;
use spelling::{as_number, as_text_if_given, as_texts, as_true, is_usual, number, one_of, whole_number};
use texture::TextureOptions;

/// The largest length of `--regularize`: edges as long as half a grain are no small features.
const LARGEST_REGULARIZE: f64 = 0.5;

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
    /// The centres of spheres that do not overlap, as large as the grains are to be, see [`place_spheres`](voronoi::volumes::place_spheres).
    Packed {
        /// Number of seeds, at least 1.
        count: usize,
    },
    /// A lattice, see [`LatticeFit`](crate::LatticeFit).
    Lattice {
        /// Its kind, of the config's dimension.
        lattice: Lattice,
        /// Number of conventional cells along the side of the box that holds the fewest, at least 1.
        cells: u32,
    },
    /// A text file, see [`read_seed_file`](crate::read_seed_file).
    File(PathBuf),
}

/// The domain that grains fill.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Shape {
    /// The box.
    #[default]
    Box,
    /// The ball that touches the box's sides, which are equal.
    Sphere {
        /// Largest distance of its polyhedron from the sphere.
        chord_error: f64,
    },
    /// The cylinder along z that touches the box's sides, of which those along x and y are equal.
    Cylinder {
        /// Largest distance of its polyhedron from the lateral surface.
        chord_error: f64,
    },
    /// In 2D, the disc that touches the rectangle's sides, which are equal.
    Disc {
        /// Largest distance of its polygon from the circle.
        chord_error: f64,
    },
    /// The body in a closed convex surface, see [`read_mesh`](crate::mesh::file::read_mesh). The box has no meaning.
    Surface(PathBuf),
    /// What the half-spaces in a text file have in common. The box has no meaning.
    HalfSpaces(PathBuf),
}

impl Default for SeedSource {
    fn default() -> Self {
        Self::Packed { count: 200 }
    }
}

impl Shape {
    /// The usual chord error in units of the radius: some 500 faces on a sphere, so that it looks
    /// round while the grains at its surface have a handful of flat parts each.
    pub const CHORD_ERROR: f64 = 0.005;

    /// Whether a file tells where the domain is.
    pub fn is_from_file(&self) -> bool {
        matches!(self, Self::Surface(_) | Self::HalfSpaces(_))
    }
}

/// Where grains of a periodic domain end in what is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PeriodicCut {
    /// They are whole, and stick out of the box.
    #[default]
    Wrap,
    /// At the walls of the box, which then holds some in several pieces.
    Box,
}

/// Everything that decides what a run computes. The same config gives the same bytes on every machine.
///
/// Each option stands here once: what `--help` says of it, its name on the command line and in settings, its range and its default. What more
/// than one option tells is put together by `cli`.
#[derive(Debug, Clone, PartialEq, Args, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Config {
    /// Where seeds come from.
    #[arg(skip)]
    #[serde(flatten)]
    pub seeds: SeedSource,

    /// Seed of the random number generator: the same number gives the same grains on every machine
    ///
    /// Example: --rng-seed 7
    #[arg(long = "rng-seed", help_heading = "Seeds", value_name = "S", default_value_t = Self::default().random_seed, value_parser = whole_number(0..=u64::MAX), allow_negative_numbers = true)]
    #[serde(rename = "rng-seed", serialize_with = "as_number")]
    pub random_seed: u64,

    /// The sizes of the grains.
    #[command(flatten)]
    #[serde(flatten)]
    pub sizes: SizeOptions,

    /// Add a phase with an exact share of the volume (of the area in 2D); repeat for each phase
    ///
    /// Shares add up to 1. Each phase can have its own diameters=, texture= and symmetry=, with the values of --diameters,
    /// --texture and --crystal-symmetry. place= says where its grains lie among the others: interior, boundaries,
    /// triple-lines, quadruple-points, clustered or dispersed.
    ///
    /// Example: --phase ferrite:0.8 --phase 'austenite:0.2,texture=goss(10)'
    #[arg(long = "phase", help_heading = "Phases", value_name = "NAME:SHARE[,KEY=VALUE]", num_args = 1, conflicts_with_all = ["volumes", "lattice", "misorientations"])]
    #[serde(rename = "phase", skip_serializing_if = "Vec::is_empty", serialize_with = "as_texts")]
    pub phases: Vec<PhaseOptions>,

    /// Subdivide the grains, or those of one phase, into lamellae of a given width or Voronoi cells of a given mean
    /// diameter, in the unit of --box; repeat for other phases
    ///
    /// Each part becomes a grain with its own orientation, and the array Parent names the grain that it belongs to. Those
    /// grains keep their volumes. Lamellae lie in a random direction in each grain, or across normal=; cells have lognormal
    /// diameters with a coefficient of variation of cv= (0.35).
    ///
    /// Example: --inside 'lamellae(width=0.05)'; --inside 'beta:voronoi(diameter=0.1)' for one phase
    #[arg(long, help_heading = "Phases", value_name = "[PHASE:]PATTERN(LENGTH)", num_args = 1)]
    #[serde(skip_serializing_if = "Vec::is_empty", serialize_with = "as_texts")]
    pub inside: Vec<InsideOptions>,

    /// Drop seeds without a cell, because their neighbours outweigh them; without this option they are an error
    ///
    /// Example: --seeds-file spheres.csv --drop-empty
    #[arg(long, help_heading = "Seeds", requires = "seeds_file")]
    #[serde(skip_serializing_if = "is_usual")]
    pub drop_empty: bool,

    /// Merge cells smaller than F mean equivalent diameters into their surroundings; 0 keeps all
    ///
    /// The smallest such cell loses its seed and all cells are computed again, so that its neighbours fill its space, until
    /// no cell is too small. The grains have the volumes of these last cells. SeedId maps their numbers back to the seeds.
    ///
    /// Example: --min-diameter 0.2
    #[arg(long, help_heading = "Seeds", value_name = "F", default_value_t = 0.0, value_parser = number(0.0..1.0, "give a share of the mean diameter, from 0 (off) to below 1"), allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "is_usual")]
    pub min_diameter: f64,

    /// Make the grains more regular: move every seed to the centroid of its cell, N times; exact sizes are kept [default: 10
    /// where grains have given volumes, as packed ones do, unless --seeds-file says where they are; otherwise 0]
    ///
    /// Example: --lloyd 10
    #[arg(long = "lloyd", help_heading = "Seeds", value_name = "N", value_parser = whole_number(0..=100_000_u32), allow_negative_numbers = true)]
    #[serde(rename = "lloyd", skip_serializing_if = "Option::is_none")]
    pub lloyd_steps: Option<u32>,

    /// Two or three dimensions.
    #[arg(skip = Dimension::Three)]
    #[serde(rename = "dim", serialize_with = "as_axes")]
    pub dimension: Dimension,

    /// Side lengths of the box, which has its lower corner in the origin; in 2D the last is ignored.
    #[arg(skip = DVec3::ONE)]
    #[serde(rename = "box", serialize_with = "as_lengths")]
    pub box_size: DVec3,

    /// How long grains are along each axis, in proportion. Everything is computed in a frame in which they are as long along all, and stretched in
    /// the end. For boxes only; in 2D the last is 1.
    #[arg(skip = DVec3::ONE)]
    #[serde(skip_serializing_if = "is_equiaxed", serialize_with = "as_lengths")]
    pub aspect_ratio: DVec3,

    /// Give each grain a shape: an ellipsoid (an ellipse in 2D) of the given axis ratios, in a random direction or aligned
    /// with x, y and z
    ///
    /// Each grain then consists of several cells, which make it as elongated as space allows. Volumes stay exact, and the
    /// summary reports the ratio that was reached. A file (.csv, .txt) has one line for each grain: lengths a, b, c and
    /// Bunge's Euler angles phi1, Phi, phi2 in degrees (a, b and phi1 in 2D). Relaxation makes grains rounder; --relax sets
    /// for how long it acts.
    ///
    /// Example: --grain-shapes '3:1:1 aligned'
    #[arg(long, help_heading = "Sizes", value_name = "SPEC|FILE", value_parser = ShapeSource::parse, conflicts_with_all = ["lattice", "domain", "half_spaces", "series", "aspect_ratio", "inside", "cells_json", "cells_csv", "no_mesh"])]
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "as_text_if_given")]
    pub grain_shapes: Option<ShapeSource>,

    /// What of the box, or instead of it, the grains fill.
    #[arg(skip)]
    #[serde(flatten)]
    pub shape: Shape,

    /// Axes along which the box repeats; in 2D the last is ignored.
    #[arg(skip)]
    #[serde(serialize_with = "as_axis_names")]
    pub periodic: BVec3,

    /// Keep the grains of a periodic box whole, sticking out where they cross its walls (wrap), or cut them at the walls
    /// (box)
    ///
    /// All grains move by the same distance before the cut where elements of a size are asked for, and where boundaries nearly lie in
    /// the walls; the summary says how far.
    ///
    /// Example: --periodic x,y,z --periodic-cut box
    #[arg(long, help_heading = "Domain", value_name = "RULE", value_enum, default_value_t)]
    #[serde(skip_serializing_if = "is_usual")]
    pub periodic_cut: PeriodicCut,

    /// Control points on boundaries.
    #[arg(skip)]
    #[serde(flatten, serialize_with = "by_option")]
    pub face_mesh: FaceMesh,

    /// Relaxation time, in units of the mean grain size squared, or `equilibrium`; 0 keeps boundaries flat [default: 1.2, in
    /// 2D equilibrium; 0 with lamellae, 0.05 for grains of several cells, 0.3 with --free or --regularize, in 2D with --edge-length too]
    ///
    /// Example: --relax 0.1
    #[arg(long = "relax", help_heading = "Smoothing", value_name = "T", value_parser = parse_relaxation, allow_negative_numbers = true)]
    #[serde(rename = "relax", skip_serializing_if = "Option::is_none", serialize_with = "as_time")]
    pub relaxation: Option<Relaxation>,

    /// Tension of the walls, relative to that between grains, or with --tension to the largest of these; with 0, boundaries
    /// meet the walls at right angles
    ///
    /// Example: --wall-tension 0.5
    #[arg(long, help_heading = "Smoothing", value_name = "G", default_value_t = 0.0, value_parser = number(0.0..=f64::MAX, "a tension is 0 or a positive, finite number"), allow_negative_numbers = true)]
    pub wall_tension: f64,

    /// Tension (energy per area) of boundaries between grains, in any unit: a number; read-shockley(15), a function of the
    /// disorientation, or a multiple of it; or a table of angles and tensions. PHASE/PHASE: in front makes it the tension
    /// between these phases [default: 1]
    ///
    /// Example: --texture 'goss(10)' --tension 'read-shockley(15)'
    #[arg(long = "tension", help_heading = "Smoothing", value_name = "[A/B:]LAW", num_args = 1)]
    #[serde(rename = "tension", skip_serializing_if = "Vec::is_empty", serialize_with = "as_texts")]
    pub tensions: Vec<LawOptions>,

    /// Mobility of the boundaries between growing grains, in any unit: a law as for --tension, such as humphreys(15)
    /// [default: 1]
    ///
    /// Example: --relax 0.02 --free --texture 'goss(10)' --mobility 'humphreys(15)'
    #[arg(long = "mobility", help_heading = "Smoothing", value_name = "[A/B:]LAW", num_args = 1)]
    #[serde(rename = "mobility", skip_serializing_if = "Vec::is_empty", serialize_with = "as_texts")]
    pub mobilities: Vec<LawOptions>,

    /// Whether relaxation keeps the grains' volumes.
    #[arg(skip)]
    #[serde(rename = "free", skip_serializing_if = "is_usual", serialize_with = "as_true")]
    pub volumes: Volumes,

    /// Do not let grains switch neighbours; only edges shorter than L mean grain sizes become points. 0 keeps every edge
    ///
    /// Example: --regularize 0.05
    #[arg(long, help_heading = "Smoothing", value_name = "L", value_parser = number(0.0..=LARGEST_REGULARIZE, "give a length from 0 (off) to 0.5"), allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub regularize: Option<f64>,

    /// Number of subdivisions; each divides every triangle into four (in 2D every segment into two)
    ///
    /// Example: -n 2
    #[arg(short = 'n', long, help_heading = "Smoothing", value_name = "LEVELS", default_value_t = Self::default().levels, value_parser = whole_number(0..=99_u32), allow_negative_numbers = true)]
    pub levels: u32,

    /// Smooth the triple lines (crease), or leave them as polylines through their control points (corner)
    ///
    /// Example: --junctions corner
    #[arg(long, help_heading = "Smoothing", value_name = "RULE", default_value = "crease", value_parser = one_of(&JUNCTIONS))]
    #[serde(serialize_with = "as_rule")]
    pub junctions: Junctions,

    /// The triangles on boundaries.
    #[command(flatten)]
    #[serde(flatten)]
    pub elements: ElementOptions,

    /// The orientations of the grains.
    #[command(flatten)]
    #[serde(flatten)]
    pub texture: TextureOptions,

    /// How files are written, apart from their formats.
    #[arg(skip)]
    #[serde(flatten)]
    pub file: FileOptions,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            seeds: SeedSource::default(),
            random_seed: 1,
            sizes: SizeOptions::default(),
            phases: Vec::new(),
            inside: Vec::new(),
            lloyd_steps: None,
            dimension: Dimension::Three,
            box_size: DVec3::ONE,
            shape: Shape::default(),
            aspect_ratio: DVec3::ONE,
            grain_shapes: None,
            periodic: BVec3::FALSE,
            periodic_cut: PeriodicCut::default(),
            face_mesh: FaceMesh::default(),
            relaxation: None,
            wall_tension: 0.0,
            tensions: Vec::new(),
            mobilities: Vec::new(),
            volumes: Volumes::default(),
            regularize: None,
            levels: 3,
            junctions: Junctions::default(),
            drop_empty: false,
            min_diameter: 0.0,
            elements: ElementOptions::default(),
            texture: TextureOptions::default(),
            file: FileOptions::default(),
        }
    }
}
