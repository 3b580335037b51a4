use std::num::NonZeroU32;
use std::path::PathBuf;

use glam::{BVec3, DVec3};
use polycrystal::{FaceMesh, Junctions, Relaxation, Volumes};
use voronoi::{Dimension, Domain};

use crate::domain_file::{half_space_domain, surface_domain};
use crate::vtk::VtkEncoding;
use crate::{
    Error, InsideOptions, InsidePattern, Lattice, LatticeFit, LawOptions, Names, PhaseOptions, ShapeSource,
    SizeOptions, StlEncoding, TextureOptions,
};

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
    /// How VTK's XML files hold their numbers.
    pub encoding: VtkEncoding,
}

impl Default for FileOptions {
    fn default() -> Self {
        Self {
            names: Names::default(),
            voxels: None,
            stl: StlEncoding::Binary,
            arrays: false,
            encoding: VtkEncoding::Raw,
        }
    }
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

    /// The lattice that the seeds form, if they do.
    ///
    /// For a domain from a file only its sides tell.
    pub fn lattice_fit(&self) -> Option<LatticeFit> {
        match self.seeds {
            SeedSource::Lattice { .. } if self.shape.is_from_file() => None,
            SeedSource::Lattice { lattice, cells } => Some(LatticeFit::new(lattice, cells, self.box_size)),
            _ => None,
        }
    }

    /// What to say of the lattice that the seeds form, if they do and so many of them lie in the domain.
    pub fn lattice_report(&self, domain: &Domain, seed_count: usize) -> Option<String> {
        let SeedSource::Lattice { lattice, cells } = self.seeds else { return None };
        let (all, said) = match self.lattice_fit() {
            Some(fit) => (fit.seed_count(), fit.to_string()),
            // No --box would make it perfect.
            None => {
                let fit = LatticeFit::new(lattice, cells, domain.size());
                (fit.seed_count(), fit.name())
            }
        };
        Some(match all.saturating_sub(seed_count) {
            0 => said,
            outside => format!("{said}; {outside} of {all} seeds lie outside the domain and are left out"),
        })
    }

    /// The seeds of a lattice that lie in the domain.
    pub(crate) fn lattice_seeds(&self, lattice: Lattice, cells: u32, domain: &Domain) -> Vec<DVec3> {
        let (fit, corner) = match self.lattice_fit() {
            Some(fit) => (fit, DVec3::ZERO),
            None => (LatticeFit::new(lattice, cells, domain.size()), domain.lower()),
        };
        let seeds = fit.seeds().into_iter().map(|seed| corner + seed);
        seeds.filter(|seed| domain.contains(*seed)).collect()
    }

    /// By what coordinates are multiplied in the end: the aspect ratio, with the product 1.
    pub fn stretch(&self) -> DVec3 {
        let stretch = self.aspect_ratio / self.dimension.cube_edge(self.aspect_ratio.element_product());
        if self.dimension == Dimension::Two { stretch.with_z(1.0) } else { stretch }
    }

    /// What the grains fill while they are computed, before [`Self::stretch`]; a box is that of [`LatticeFit::box_size`] for a lattice.
    ///
    /// # Errors
    /// [`Error::BoxSide`] when a side is not positive and finite, or beyond what doubles can compute with;
    /// whatever is wrong with the domain's file.
    pub fn domain(&self) -> Result<Domain, Error> {
        let axes = usize::from(self.dimension.axes());
        let sides = ['x', 'y', 'z'].into_iter().zip(self.box_size.to_array());
        if let Some((axis, length)) = sides.take(axes).find(|(_, length)| !Domain::LENGTHS.contains(length)) {
            return Err(Error::BoxSide { axis, length });
        }
        let center = 0.5 * self.box_size;
        match &self.shape {
            Shape::Box => {}
            Shape::Sphere { chord_error } => return Ok(Domain::ball(center, center.x, *chord_error)?),
            Shape::Cylinder { chord_error } => {
                return Ok(Domain::cylinder(center, center.x, self.box_size.z, *chord_error)?);
            }
            Shape::Disc { chord_error } => return Ok(Domain::disc(center, center.x, *chord_error)?),
            Shape::Surface(path) => return surface_domain(path),
            Shape::HalfSpaces(path) => return half_space_domain(path, self.dimension),
        }
        let upper = self.lattice_fit().map_or(self.box_size / self.stretch(), |fit| fit.box_size());
        let domain = match self.dimension {
            Dimension::Two => Domain::rectangle(DVec3::ZERO, upper)?,
            Dimension::Three => Domain::cuboid(DVec3::ZERO, upper)?,
        };
        Ok(domain.with_periods(self.periodic))
    }
}
