//! From a config to a smooth, validated network.

use std::time::{Duration, Instant};

use glam::DVec3;
use polycrystal::{
    AngleStatistics, Balance, Boundary, Certificate, Equilibrium, MeshSize, Network, NetworkError,
};
use polycrystal::{NetworkRecipe, Reconnections, RelaxationStep, Relaxed, Volumes, WeightedAngle};
use polycrystal::{
    angles_between_boundaries, dihedral_angles, equilibrate, regular_cells, relax_watched, validate,
};
use voronoi::{Collapsed, Dimension, Side, Tessellation};

use crate::memory::{ControlMesh, LevelSize, available_memory, check_levels};
use crate::{Config, Error, PeriodicCut, SeedSource, Tessellated, Topology, tessellate};

/// A part of a run, in the order in which they follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Drawing or reading seeds.
    Seeds,
    /// Cutting the Voronoi cells.
    Cells,
    /// Building the network and the connectivity of all its levels.
    Network,
    /// Moving control points toward equilibrium.
    Relaxation,
    /// Placing the points of the finest level.
    Subdivision,
    /// Checking the result and measuring it.
    Validation,
    /// Writing the file.
    Writing,
}

impl Stage {
    /// Every stage, in the order in which they follow each other.
    pub const ALL: [Self; 7] = [
        Self::Seeds,
        Self::Cells,
        Self::Network,
        Self::Relaxation,
        Self::Subdivision,
        Self::Validation,
        Self::Writing,
    ];

    /// The stage's place among all, from 1.
    pub fn number(self) -> usize {
        1 + Self::ALL.iter().take_while(|other| **other != self).count()
    }

    /// The stage in one word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Seeds => "seeds",
            Self::Cells => "cells",
            Self::Network => "network",
            Self::Relaxation => "relaxation",
            Self::Subdivision => "subdivision",
            Self::Validation => "validation",
            Self::Writing => "writing",
        }
    }
}

/// Told how far a run is: the stage, the steps of it that are done, and their number.
pub type Progress<'a> = &'a (dyn Fn(Stage, usize, usize) + Sync);

/// A finished polycrystal: a valid network with the points of its finest level.
#[derive(Debug, Clone)]
pub struct Polycrystal {
    /// What was asked for.
    pub config: Config,
    /// The flat cells that the grains come from.
    pub cells: Tessellated,
    /// Connectivity of all levels.
    pub network: Network,
    /// Points of the finest level.
    pub points: Vec<DVec3>,
    /// What relaxation gave, before the last subdivisions: points to move by hand, of whole grains.
    pub relaxed: Relaxed,
    /// How far the cells were regularised.
    pub regularization: Regularization,
    /// How many faces grains have and how many meet, before a periodic box is cut.
    pub topology: Topology,
    /// What regularisation took out, or in equilibrium was drawn together.
    pub collapsed: Collapsed,
    /// How relaxation to equilibrium changed the topology and how near it came; nothing where it kept the topology.
    pub equilibrium: Option<(Reconnections, Balance)>,
    /// Angles between boundaries of the flat network, before relaxation.
    pub flat_angles: Vec<WeightedAngle>,
    /// Their statistics, if boundaries meet inside the domain.
    pub angles_before: Option<AngleStatistics>,
    /// What validation found: the angles of the finished network, volumes and how true they are.
    pub validation: Certificate,
    /// Time that each stage took.
    pub times: Vec<(Stage, Duration)>,
}

impl Polycrystal {
    /// The grains of a periodic box cut at its walls, as [`PeriodicCut::Box`](crate::PeriodicCut::Box) asks; others as they are.
    ///
    /// # Errors
    /// As of [`Network::cut_at_box`].
    pub fn cut_if_asked(mut self) -> Result<Self, Error> {
        if self.config.periodic_cut == PeriodicCut::Wrap || !self.network.domain().is_periodic() {
            return Ok(self);
        }
        let volumes = self.network.cell_volumes().to_vec();
        let start = Instant::now();
        let cut = self.network.cut_at_box(&self.points).map_err(Error::from);
        let (network, points) = cut.map_err(|error| error.with_grain(&self.cells))?;
        (self.network, self.points) = (network.with_cell_volumes(volumes), points);
        self.add_time(Stage::Subdivision, start.elapsed());
        let start = Instant::now();
        self.validation = validate(&self.network, &self.points).map_err(NetworkError::Invalid)?;
        self.add_time(Stage::Validation, start.elapsed());
        Ok(self)
    }
}

/// Computes a polycrystal: its cells, then all that [`smooth`] does.
///
/// # Errors
/// Whatever is wrong with the input, or the first fault that makes the result invalid.
pub fn make_polycrystal(config: &Config, progress: Progress) -> Result<Polycrystal, Error> {
    check_expected_size(config)?;
    smooth(config, tessellate(config, progress)?, progress)
}

/// Checks that the network of as many seeds as the config asks for will fit, before the first cell is cut: a count beyond all
/// means must not eat the memory first. The count of a seed file is known only when it is read.
///
/// # Errors
/// [`Error::LevelsExceedMemory`] and [`Error::LevelsExceedIds`].
pub fn check_expected_size(config: &Config) -> Result<(), Error> {
    let Some(count) = seed_count(config) else { return Ok(()) };
    let size = expected_control_mesh_size(count, config.dimension);
    // Each of two segments.
    let arcs = if bends_to_arcs(config) { size.edges / 2 } else { 0 };
    check_levels(ControlMesh { size, arcs }, config.levels, available_memory())
}

/// Whether boundaries become arcs with as many segments as look smooth.
fn bends_to_arcs(config: &Config) -> bool {
    config.dimension == Dimension::Two && config.lets_topology_change()
}

/// The control mesh of some cells, without what regularisation takes out.
pub(crate) fn control_mesh(config: &Config, tessellation: &Tessellation) -> ControlMesh {
    let MeshSize { points, edges, triangles } = config.face_mesh.control_mesh_size(tessellation);
    let size = LevelSize { points, edges, triangles };
    if !bends_to_arcs(config) {
        return size.into();
    }
    let sides = tessellation.faces().map(|face| tessellation.face_sides(face));
    let inside = sides.filter(|[_, second]| !matches!(second, Side::Wall(_)));
    ControlMesh { size, arcs: inside.count() as u128 }
}

pub(crate) fn seed_count(config: &Config) -> Option<usize> {
    match &config.seeds {
        SeedSource::File(_) => None,
        SeedSource::Random { count } | SeedSource::PoissonDisc { count } => Some(*count),
        SeedSource::Lattice { .. } => config.lattice_fit().map(|fit| fit.seed_count()),
    }
}

/// Relaxes, subdivides and validates the network of some cells.
///
/// # Errors
/// [`Error::LevelsExceedMemory`] and [`Error::LevelsExceedIds`]; [`Error::Network`] when the network cannot be relaxed, or
/// is invalid.
pub fn smooth(config: &Config, cells: Tessellated, progress: Progress) -> Result<Polycrystal, Error> {
    smooth_watched(config, cells, progress, |_| ())
}

/// As [`smooth`], with the start and every step of the relaxation shown to `watch`.
///
/// # Errors
/// As of [`smooth`].
pub fn smooth_watched(
    config: &Config,
    cells: Tessellated,
    progress: Progress,
    mut watch: impl FnMut(RelaxationStep<'_>),
) -> Result<Polycrystal, Error> {
    let tessellation = &cells.tessellation;
    let mut clock = Clock { progress, times: cells.times.clone() };
    check_levels(control_mesh(config, tessellation), config.levels, available_memory())?;
    let mut tries = Regularization::tries(config).iter();
    let (regularization, smoothed) = loop {
        let regularization = *tries.next().expect("there is one, and the last is the result");
        let smoothed = smooth_regularized(config, tessellation, regularization, &mut clock, &mut watch);
        let is_tangled =
            smoothed.as_ref().is_err_and(|error| matches!(error, Error::Network(cause) if is_tangle(cause)));
        if !is_tangled || tries.len() == 0 {
            break (regularization, smoothed.map_err(|error| error.with_grain(&cells))?);
        }
    };
    let Smoothed { network, points, relaxed, collapsed, equilibrium, flat_angles, angles_before, validation } =
        smoothed;
    let times = clock.times;
    let topology = Topology::new(tessellation, &network);
    let config = config.clone();
    Ok(Polycrystal {
        config,
        cells,
        network,
        points,
        relaxed,
        regularization,
        topology,
        collapsed,
        equilibrium,
        flat_angles,
        angles_before,
        validation,
        times,
    })
}

/// What is taken out of the cells before relaxation. Cells that may change their neighbours are relaxed as they are instead.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regularization {
    /// What is short, and what relaxation would make so: the best triangles.
    Foreseeing,
    /// What is short.
    Plain,
    /// Nothing.
    None,
}

impl Regularization {
    /// A name for programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Foreseeing => "full",
            Self::Plain => "short_edges",
            Self::None => "none",
        }
    }

    /// Whether less was taken out than is usual where regularisation is asked for.
    pub(crate) fn fell_back(self, config: &Config) -> bool {
        Self::tries(config)[0] != self
    }

    /// What to try, one after the other: where much is taken out, in rare places relaxation makes boundaries fold or cross.
    fn tries(config: &Config) -> &'static [Self] {
        match config.effective_regularize() {
            0.0 => &[Self::None],
            _ => &[Self::Foreseeing, Self::Plain, Self::None],
        }
    }
}

/// Whether a network could not be relaxed as it is, but might be with less taken out.
fn is_tangle(error: &NetworkError) -> bool {
    matches!(
        error,
        NetworkError::Invalid(_) | NetworkError::Folded { .. } | NetworkError::VolumeNotRestored { .. }
    )
}

/// A valid network and how it came about, as [`Polycrystal`] has it.
struct Smoothed {
    network: Network,
    points: Vec<DVec3>,
    relaxed: Relaxed,
    collapsed: Collapsed,
    equilibrium: Option<(Reconnections, Balance)>,
    flat_angles: Vec<WeightedAngle>,
    angles_before: Option<AngleStatistics>,
    validation: Certificate,
}

/// The network of cells regularised in one way.
fn smooth_regularized(
    config: &Config,
    tessellation: &Tessellation,
    regularization: Regularization,
    clock: &mut Clock<'_>,
    watch: &mut impl FnMut(RelaxationStep<'_>),
) -> Result<Smoothed, Error> {
    let (mut network, flat, mut collapsed) =
        clock.time(Stage::Network, || network(config, tessellation, regularization))?;
    let angles_before = dihedral_angles(&network, network.control_mesh(), &flat);
    let flat_angles = angles_between_boundaries(&network, network.control_mesh(), &flat);
    let mut equilibrium = None;
    let progress = clock.progress;
    let relaxed = clock.time(Stage::Relaxation, || {
        let mut watch = |step: RelaxationStep<'_>| {
            progress(Stage::Relaxation, step.done, step.count);
            watch(step);
        };
        // Cells that may change their neighbours are not regularised: one try tells all.
        if let Regularization::Foreseeing = regularization
            && let Some((balanced, relaxed, merged, report)) = balanced(config, tessellation, &mut watch)
        {
            network = balanced;
            equilibrium = Some(report);
            collapsed = merged;
            return Ok(relaxed);
        }
        relax_watched(&network, &flat, &config.relaxation, config.volumes, watch)
    })?;
    let points = clock.time(Stage::Subdivision, || relaxed.finest_points(&network));
    if config.volumes == Volumes::Free {
        let volumes = network.grain_volumes(network.finest(), &points);
        network = network.with_cell_volumes(volumes);
    }
    let validation =
        clock.time(Stage::Validation, || validate(&network, &points).map_err(NetworkError::Invalid))?;
    Ok(Smoothed { network, points, relaxed, collapsed, equilibrium, flat_angles, angles_before, validation })
}

/// The network in equilibrium with all changes of topology that this takes, and what these were.
///
/// Nothing where topology is to stay as it is, or where no valid network comes out: then equilibrium is that of the topology
/// that regularisation leaves.
fn balanced(
    config: &Config,
    tessellation: &Tessellation,
    watch: &mut impl FnMut(RelaxationStep<'_>),
) -> Option<(Network, Relaxed, Collapsed, (Reconnections, Balance))> {
    if !config.lets_topology_change() {
        return None;
    }
    let Config { junctions, levels, .. } = *config;
    let tension = |boundary: &Boundary| config.tension(boundary);
    let recipe = NetworkRecipe { junctions, levels: levels as usize, tension: &tension };
    let Equilibrium { network, relaxed, reconnections, merged, balance } =
        equilibrate(tessellation, &recipe, watch).ok()?;
    Some((network, relaxed, merged, (reconnections, balance)))
}

/// The network of regularised cells, whose grains are to have the volumes of the cells as they were.
fn network(
    config: &Config,
    tessellation: &Tessellation,
    regularization: Regularization,
) -> Result<(Network, Vec<DVec3>, Collapsed), NetworkError> {
    let Config { face_mesh, junctions, levels, regularize, .. } = *config;
    let network_of = |cells, face_mesh| {
        let (network, flat) = Network::with_face_mesh(cells, face_mesh, junctions, levels as usize)?;
        Ok::<_, NetworkError>((network.with_tensions(|boundary| config.tension(boundary))?, flat))
    };
    let (regular, collapsed) = match regularization {
        Regularization::Foreseeing => regular_cells(tessellation, regularize),
        Regularization::Plain => tessellation.regularized(regularize),
        Regularization::None => {
            let (network, flat) = network_of(tessellation, face_mesh)?;
            return Ok((network, flat, Collapsed::default()));
        }
    };
    let volumes = tessellation.cell_measures().iter().map(|cell| cell.volume).collect();
    let (network, flat) = network_of(&regular, config.regular_face_mesh())?;
    Ok((network.with_cell_volumes(volumes), flat, collapsed))
}

/// Runs stages one after the other and remembers how long each took.
pub(crate) struct Clock<'a> {
    pub(crate) progress: Progress<'a>,
    pub(crate) times: Vec<(Stage, Duration)>,
}

impl Clock<'_> {
    pub(crate) fn time<T>(&mut self, stage: Stage, work: impl FnOnce() -> T) -> T {
        (self.progress)(stage, 0, 1);
        let start = Instant::now();
        let result = work();
        let taken = start.elapsed();
        match self.times.iter_mut().find(|(known, _)| *known == stage) {
            Some((_, time)) => *time += taken,
            None => self.times.push((stage, taken)),
        }
        result
    }
}

/// The size for so many random seeds, from the means of Poisson-Voronoi cells (walls not counted): in space 15.54 faces,
/// 27.07 vertices and 40.61 edges a cell, 5.23 edges a face; in the plane 6 edges and 6 vertices.
fn expected_control_mesh_size(seed_count: usize, dimension: Dimension) -> LevelSize {
    let count = seed_count as u128;
    match dimension {
        Dimension::Two => LevelSize { points: 5 * count, edges: 6 * count, triangles: 0 },
        // Each face belongs to two cells, each line to three, each vertex to four: 6.77 + 13.54 + 7.77 points.
        Dimension::Three => LevelSize { points: 28 * count, edges: 108 * count, triangles: 81 * count },
    }
}
