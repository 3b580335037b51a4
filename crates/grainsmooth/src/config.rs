//! What a run is asked for, as data.

use std::path::PathBuf;

use glam::{BVec3, DVec3};
use polycrystal::{FaceMesh, Junctions, Relaxation, Volumes};
use voronoi::Dimension;

pub(crate) mod check;
pub(crate) mod files;
pub(crate) mod gradient;
pub(crate) mod inside;
pub(crate) mod lattice;
pub(crate) mod laws;
pub(crate) mod phases;
pub(crate) mod place;
pub(crate) mod settings;
pub(crate) mod shapes;
pub(crate) mod sizes;
pub(crate) mod table_file;
pub(crate) mod texture;

use files::FileOptions;
use inside::{InsideOptions, InsidePattern};
use lattice::Lattice;
use laws::{LawKind, LawOptions};
use phases::PhaseOptions;
use shapes::ShapeSource;
use sizes::{SizeOptions, SizeSource, USUAL_DIAMETERS};
use texture::TextureOptions;

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

/// What the grains fill.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// The box.
    Box,
    /// The ball that touches the box's sides, which are equal.
    Sphere {
        /// Largest distance of its polyhedron from the sphere.
        chord_error: f64,
    },
    /// The cylinder along z that touches the box's sides, of which those along x and y are equal.
    Cylinder {
        /// Largest distance of its polyhedron from the mantle.
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PeriodicCut {
    /// They are whole, and stick out of the box.
    #[default]
    Wrap,
    /// At the walls of the box, which then holds some in several pieces.
    Box,
}

/// Everything that decides what a run computes. The same config gives the same bytes on every machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// Where seeds come from.
    pub seeds: SeedSource,
    /// Starts the random generator.
    pub random_seed: u64,
    /// The sizes of the grains.
    pub sizes: SizeOptions,
    /// The phases of the grains, in the order of their numbers; none where all are alike.
    pub phases: Vec<PhaseOptions>,
    /// What grains are divided by; nothing leaves them whole.
    pub inside: Vec<InsideOptions>,
    /// Number of times that every seed moves to the centroid of its cell (Lloyd's algorithm); given volumes are kept. Where nothing is
    /// said, [`Config::LLOYD_OF_SIZES`] for grains of given sizes whose places are not given, else none.
    pub lloyd_steps: Option<u32>,
    /// Two or three dimensions.
    pub dimension: Dimension,
    /// Side lengths of the box, which has its lower corner in the origin; in 2D the last is ignored.
    pub box_size: DVec3,
    /// What of the box, or instead of it, the grains fill.
    pub shape: Shape,
    /// How long grains are along each axis, in proportion. Everything is computed in a frame in which they are as long along all, and stretched in
    /// the end. For boxes only; in 2D the last is 1.
    pub aspect_ratio: DVec3,
    /// The shape of each grain, in boxes with walls, where some are asked for: grains are then several cells each, and keep their neighbours.
    pub grain_shapes: Option<ShapeSource>,
    /// Axes along which the box repeats; in 2D the last is ignored.
    pub periodic: BVec3,
    /// Where grains of a periodic domain end in what is written.
    pub periodic_cut: PeriodicCut,
    /// Control points on boundaries.
    pub face_mesh: FaceMesh,
    /// How far boundaries relax; time 0 leaves them flat.
    pub relaxation: Relaxation,
    /// Tension of the walls, where that between grains is 1, or in units of the largest between grains.
    pub wall_tension: f64,
    /// The tensions of boundaries between grains; 1 where there is none for them.
    pub tensions: Vec<LawOptions>,
    /// Mobilities of boundaries, in any unit, where grains grow; empty where all are 1.
    pub mobilities: Vec<LawOptions>,
    /// Whether relaxation keeps the grains' volumes.
    pub volumes: Volumes,
    /// Where the topology of the cells is to stay, the length, in units of the mean grain size, below which edges collapse before
    /// relaxation all the same; 0 keeps all. Nothing lets grains come together and part as tension has it, where they can.
    pub regularize: Option<f64>,
    /// Number of subdivisions.
    pub levels: u32,
    /// How triple lines are smoothed.
    pub junctions: Junctions,
    /// Whether to go on without seeds that have no cell, as their neighbours outweigh them; else that is an error.
    pub drop_empty: bool,
    /// Cells below this share of the mean equivalent diameter lose their seeds, the smallest first, until none is left and their
    /// neighbours have grown into their places; 0 keeps all. Below 1.
    pub min_diameter: f64,
    /// The orientations of the grains.
    pub texture: TextureOptions,
    /// How files are written, apart from their formats.
    pub file: FileOptions,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            seeds: SeedSource::Packed { count: 200 },
            random_seed: 1,
            sizes: SizeOptions::default(),
            phases: Vec::new(),
            inside: Vec::new(),
            lloyd_steps: None,
            dimension: Dimension::Three,
            box_size: DVec3::ONE,
            shape: Shape::Box,
            aspect_ratio: DVec3::ONE,
            grain_shapes: None,
            periodic: BVec3::FALSE,
            periodic_cut: PeriodicCut::Wrap,
            face_mesh: FaceMesh::Fan,
            relaxation: Relaxation::default(),
            wall_tension: 0.0,
            tensions: Vec::new(),
            mobilities: Vec::new(),
            volumes: Volumes::Kept,
            regularize: None,
            levels: 3,
            junctions: Junctions::Crease,
            drop_empty: false,
            min_diameter: 0.0,
            texture: TextureOptions::default(),
            file: FileOptions::default(),
        }
    }
}

impl Config {
    /// The length to regularise by where grains cannot come together and part, in mean grain sizes: the shortest that leaves triangles as
    /// good as longer ones do. Of random grains, 0.15 made three times as many points of more than four grains; docs/relaxation.md has
    /// the figures.
    pub const REGULARIZE: f64 = 0.05;

    /// The same where grains are of several cells: edges of their boundaries close that are shorter than this part of the smallest grain there.
    pub const REGULARIZE_OF_SHAPES: f64 = 0.25;

    /// The usual relaxation of grains of given shapes, which it rounds: 200 of 2:1:1 with a ratio of 2.08 have 1.97 at 0.02, 1.82 at 0.1 and 1.70
    /// at 0.3, with angles that spread by 11.9, 12.7 and 13.9 degrees.
    pub const RELAXATION_OF_SHAPES: Relaxation = Relaxation::Time(0.05);

    /// Centroid steps of grains with given sizes: with 10 they have 13.7 faces and a sphericity of 0.855, as those of measured metals.
    pub const LLOYD_OF_SIZES: u32 = 10;

    /// The largest: edges as long as half a grain are no small features.
    pub const LARGEST_REGULARIZE: f64 = 0.5;

    /// How far boundaries relax unless something else is asked for. In the plane to equilibrium, which is quick and exact there, in
    /// space for a time: longer where all that stands beside it lets grains switch neighbours. Not at all where grains are divided into
    /// lamellae, which would bend and come apart.
    pub fn usual_relaxation(&self) -> Relaxation {
        if self.inside.iter().any(|inside| matches!(inside.pattern, InsidePattern::Lamellae { .. })) {
            return Relaxation::Time(0.0);
        }
        if self.has_grains_of_several_cells() {
            return Self::RELAXATION_OF_SHAPES;
        }
        let usual = match self.dimension {
            Dimension::Two => Relaxation::Equilibrium,
            Dimension::Three => Relaxation::USUAL,
        };
        let lets_change = Self { relaxation: usual, ..self.clone() }.lets_topology_change();
        if lets_change { usual } else { Relaxation::default() }
    }

    /// How far boundaries relax where the topology stays: where it should have changed, for no longer than is usual then.
    pub(crate) fn relaxation_of_kept_topology(&self) -> Relaxation {
        match (self.relaxation, Relaxation::default()) {
            (Relaxation::Time(time), Relaxation::Time(usual)) if self.lets_topology_change() => {
                Relaxation::Time(time.min(usual))
            }
            _ => self.relaxation,
        }
    }

    /// The length to regularise by, where the topology is to stay or cannot change: none without relaxation.
    pub(crate) fn effective_regularize(&self) -> f64 {
        if self.relaxation == Relaxation::Time(0.0) {
            0.0
        } else {
            let usual = if self.has_grains_of_several_cells() {
                Self::REGULARIZE_OF_SHAPES
            } else {
                Self::REGULARIZE
            };
            self.regularize.unwrap_or(usual)
        }
    }

    /// Whether grains may switch neighbours: at kept volumes, unless the cells' own are asked for. In the plane they do so on the way to
    /// equilibrium only.
    pub(crate) fn lets_topology_change(&self) -> bool {
        let is_on_the_way = match self.dimension {
            // Arcs of circles are divided as they curve.
            Dimension::Two => {
                self.relaxation == Relaxation::Equilibrium
                    && !matches!(self.face_mesh, FaceMesh::Refined { .. })
            }
            Dimension::Three => self.relaxation != Relaxation::Time(0.0),
        };
        is_on_the_way
            && !self.has_grains_of_several_cells()
            && self.regularize.is_none()
            && self.volumes == Volumes::Kept
    }

    /// Control points on the boundaries of regularised cells: in a fan, whose triangles at short lines are thin, those stay whole.
    pub(crate) fn regular_face_mesh(&self) -> FaceMesh {
        if self.face_mesh == FaceMesh::Fan { FaceMesh::SparseFan } else { self.face_mesh }
    }

    /// Number of voxels that are asked for.
    pub(crate) fn voxel_count(&self) -> u128 {
        let axes = usize::from(self.dimension.axes());
        let counts = self.file.voxels.iter().flat_map(|counts| &counts[..axes]);
        counts.map(|count| u128::from(count.get())).reduce(|all, count| all * count).unwrap_or(0)
    }

    /// Bytes of a voxel in VTK's ImageData: its grain, its phase where there are some, and three colours where grains have orientations.
    pub(crate) fn bytes_of_voxel(&self) -> u32 {
        let phase = if self.phases.is_empty() { 0 } else { 4 };
        4 + phase + if self.has_texture() { 3 * 3 } else { 0 }
    }

    /// By what coordinates are multiplied in the end: the aspect ratio, with the product 1.
    pub fn stretch(&self) -> DVec3 {
        let stretch = self.aspect_ratio / self.dimension.cube_edge(self.aspect_ratio.element_product());
        if self.dimension == Dimension::Two { stretch.with_z(1.0) } else { stretch }
    }

    /// Whether phases are put into the grains of others, which then are of several cells.
    pub(crate) fn has_inclusions(&self) -> bool {
        self.phases.iter().filter_map(|phase| phase.place).any(|place| place.of_inclusions().is_some())
    }

    /// Whether grains are of several cells, and need not be convex.
    pub fn has_grains_of_several_cells(&self) -> bool {
        self.grain_shapes.is_some() || self.has_inclusions()
    }

    /// Whether grains have given volumes: phases have exact shares, so their grains do.
    pub fn is_sized(&self) -> bool {
        self.sizes.source.is_some()
            || matches!(self.seeds, SeedSource::Packed { .. })
            || !self.phases.is_empty()
            || self.grain_shapes.is_some()
    }

    /// Whether sizes are asked for that say how many grains there are.
    pub fn has_sizes(&self) -> bool {
        self.sizes.source.is_some() || self.phases_have_diameters()
    }

    /// Number of times that every seed moves to the centroid of its cell.
    pub fn centroid_steps(&self) -> u32 {
        let has_places = matches!(self.seeds, SeedSource::File(_));
        let usual = if self.is_sized() && !has_places { Self::LLOYD_OF_SIZES } else { 0 };
        self.lloyd_steps.unwrap_or(usual)
    }

    /// What is asked for in words.
    pub(crate) fn asked_sizes(&self) -> String {
        match &self.sizes.source {
            None => USUAL_DIAMETERS.to_owned(),
            Some(SizeSource::VolumeFile(path)) => format!("volumes of {}", path.display()),
            Some(source) => source.setting().1,
        }
    }

    /// What is asked for in a phase, in words.
    pub(crate) fn asked_sizes_of_phase(&self, phase: usize) -> String {
        match &self.phases[phase].diameters {
            Some(source) => source.setting().1,
            None => self.asked_sizes(),
        }
    }

    /// The share of the volume that each phase is to have; they add up to 1. None without phases.
    pub(crate) fn phase_fractions(&self) -> Vec<f64> {
        let sum: f64 = self.phases.iter().map(|phase| phase.fraction).sum();
        self.phases.iter().map(|phase| phase.fraction / sum).collect()
    }

    /// Whether phases have diameters of their own.
    pub(crate) fn phases_have_diameters(&self) -> bool {
        self.phases.iter().any(|phase| phase.diameters.is_some())
    }

    /// Whether grains have orientations that are asked for.
    pub fn has_texture(&self) -> bool {
        self.texture.source.is_some() || self.phases.iter().any(|phase| phase.texture.is_some())
    }

    /// What divides the grains of a phase, by its index; of phase 0 without phases.
    pub(crate) fn pattern_inside(&self, phase: usize) -> Option<usize> {
        let name = self.phases.get(phase).map(|phase| &phase.name);
        self.inside.iter().position(|options| options.phase.is_none() || options.phase.as_ref() == name)
    }

    /// The laws of a kind that are asked for.
    pub fn laws(&self, kind: LawKind) -> &[LawOptions] {
        match kind {
            LawKind::Tension => &self.tensions,
            LawKind::Mobility => &self.mobilities,
        }
    }
}
