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
use voronoi::{CellId, Collapsed, Dimension, Side, Tessellation, VoronoiError};

use crate::memory::{ControlMesh, LevelSize, available_memory, check_cells, check_levels};
use crate::{
    Config, EquivalentDiameters, Error, FileSeed, PeriodicCut, SeedPlace, SeedSource, Topology,
    poisson_disc_seeds, random_seeds, read_seed_file,
};

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

/// The cells of a config's seeds.
#[derive(Debug, Clone, PartialEq)]
pub struct Tessellated {
    /// All cells; none is empty.
    pub tessellation: Tessellation,
    /// Power weight of each seed: 0 where there are no radii.
    pub weights: Vec<f64>,
    /// The number of each cell's seed, in the order in which all were given, from 0: what `SeedId` holds. It is the cell's own
    /// unless seeds were dropped or merged.
    pub seed_ids: Vec<u32>,
    /// The numbers of seeds that are left out because their neighbours outweigh them.
    pub dropped_seeds: Vec<u32>,
    /// The numbers of seeds that are left out because their cells were below [`Config::min_diameter`].
    pub merged_seeds: Vec<u32>,
    /// Time that each stage took.
    pub times: Vec<(Stage, Duration)>,
}

impl Tessellated {
    /// The numbers of the cells' seeds, for formats that tell them only where they are not those of the cells, as seeds were left
    /// out; else nothing.
    pub(crate) fn renumbered(&self) -> &[u32] {
        let is_renumbered = !self.dropped_seeds.is_empty() || !self.merged_seeds.is_empty();
        if is_renumbered { &self.seed_ids } else { &[] }
    }
}

/// Computes the cells alone.
///
/// # Errors
/// Whatever is wrong with the seeds; [`Error::EmptyGrains`] unless the config drops them.
pub fn tessellate(config: &Config, progress: Progress) -> Result<Tessellated, Error> {
    let mut clock = Clock { progress, times: Vec::new() };
    let domain = config.domain()?;
    let mut seeds = NumberedSeeds::new(clock.time(Stage::Seeds, || seeds(config, &domain))?);
    let (mut dropped_seeds, mut merged_seeds) = (Vec::new(), Vec::new());
    let (tessellation, weights) = clock.time(Stage::Cells, || {
        let mut all = cells_of(config, &domain, &seeds.seeds)?;
        for step in 1..=config.lloyd_steps {
            let centroids = all.0.centroids();
            seeds.seeds.iter_mut().zip(centroids).for_each(|(seed, centroid)| seed.position = centroid);
            all = cells_of(config, &domain, &seeds.seeds)?;
            progress(Stage::Cells, step as usize, config.lloyd_steps as usize);
        }
        let empty = all.0.empty_cells();
        if !empty.is_empty() {
            if !config.drop_empty {
                return Err(Error::EmptyGrains { grains: empty.iter().map(|cell| cell.0).collect() });
            }
            dropped_seeds = seeds.without(&empty);
            all = cells_of(config, &domain, &seeds.seeds)?;
        }
        loop {
            let small = small_cells(&all.0, config.min_diameter);
            if small.is_empty() {
                break;
            }
            merged_seeds.extend(seeds.without(&small));
            all = cells_of(config, &domain, &seeds.seeds)?;
        }
        merged_seeds.sort_unstable();
        Ok::<_, Error>(all)
    })?;
    let times = clock.times;
    Ok(Tessellated { tessellation, weights, seed_ids: seeds.ids, dropped_seeds, merged_seeds, times })
}

/// Seeds with the numbers that they had among all.
struct NumberedSeeds {
    seeds: Vec<FileSeed>,
    ids: Vec<u32>,
}

impl NumberedSeeds {
    fn new(seeds: Vec<FileSeed>) -> Self {
        Self { ids: (0u32..).take(seeds.len()).collect(), seeds }
    }

    /// Takes the seeds of some cells out, and returns their numbers.
    fn without(&mut self, cells: &[CellId]) -> Vec<u32> {
        let mut is_kept = vec![true; self.seeds.len()];
        cells.iter().for_each(|cell| is_kept[cell.index()] = false);
        let numbers = cells.iter().map(|cell| self.ids[cell.index()]).collect();
        let mut kept = is_kept.iter();
        self.seeds.retain(|_| *kept.next().unwrap_or(&true));
        let mut kept = is_kept.iter();
        self.ids.retain(|_| *kept.next().unwrap_or(&true));
        numbers
    }
}

/// The cells to take out next: those below a share of the mean equivalent diameter, of neighbours the smallest.
///
/// When these are gone the others are as they were, or have grown. So in the end the same cells are left as if the smallest of all
/// had gone each time.
fn small_cells(cells: &Tessellation, share: f64) -> Vec<CellId> {
    if share == 0.0 {
        return Vec::new();
    }
    let dimension = cells.domain().dimension();
    let diameters: Vec<f64> =
        cells.cell_measures().iter().map(|cell| dimension.ball_diameter(cell.volume)).collect();
    let limit = share * EquivalentDiameters::new(dimension, &diameters).mean;
    let is_smaller =
        |a: CellId, b: CellId| diameters[a.index()].total_cmp(&diameters[b.index()]).then(a.cmp(&b)).is_lt();
    let is_smallest = |cell: &CellId| {
        diameters[cell.index()] < limit
            && cells.neighbors(*cell).into_iter().all(|side| match side {
                Side::Cell(other) | Side::Image(other, _) => !is_smaller(other, *cell),
                Side::Wall(_) => true,
            })
    };
    (0u32..).map(CellId).take(diameters.len()).filter(is_smallest).collect()
}

/// The cells of some seeds, and the seeds' weights.
fn cells_of(
    config: &Config,
    domain: &voronoi::Domain,
    seeds: &[FileSeed],
) -> Result<(Tessellation, Vec<f64>), Error> {
    let positions: Vec<DVec3> = seeds.iter().map(|seed| seed.position).collect();
    let weights: Vec<f64> = seeds.iter().map(|seed| seed.weight.unwrap_or(0.0)).collect();
    let tessellation = if seeds.iter().any(|seed| seed.weight.is_some()) {
        Tessellation::power(domain, &positions, &weights)
    } else {
        Tessellation::new(domain, &positions)
    };
    Ok((tessellation.map_err(|error| located(error, config, seeds))?, weights))
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

fn seed_count(config: &Config) -> Option<usize> {
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
struct Clock<'a> {
    progress: Progress<'a>,
    times: Vec<(Stage, Duration)>,
}

impl Clock<'_> {
    fn time<T>(&mut self, stage: Stage, work: impl FnOnce() -> T) -> T {
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

fn seeds(config: &Config, domain: &voronoi::Domain) -> Result<Vec<FileSeed>, Error> {
    if let Some(count) = seed_count(config) {
        check_cells(count, available_memory())?;
    }
    let positions = match &config.seeds {
        SeedSource::File(path) => return read_seed_file(path, config.dimension),
        SeedSource::Random { count } => random_seeds(*count, domain, config.random_seed),
        SeedSource::PoissonDisc { count } => poisson_disc_seeds(*count, domain, config.random_seed),
        SeedSource::Lattice { lattice, cells } => config.lattice_seeds(*lattice, *cells, domain),
    };
    let numbered = (1..).map(SeedPlace::Entry).zip(positions);
    Ok(numbered.map(|(place, position)| FileSeed { position, weight: None, place }).collect())
}

/// The error with the line of the seed file that it comes from.
fn located(error: VoronoiError, config: &Config, seeds: &[FileSeed]) -> Error {
    let SeedSource::File(path) = &config.seeds else { return error.into() };
    let seed = match &error {
        VoronoiError::NotFinite { seed, .. }
        | VoronoiError::OutsideDomain { seed, .. }
        | VoronoiError::BadWeight { seed, .. } => *seed,
        VoronoiError::DuplicateSeeds { first, second, position } => {
            let places = [seeds[*first].place, seeds[*second].place];
            return Error::DuplicateSeedsInFile { path: path.clone(), places, position: *position };
        }
        _ => return error.into(),
    };
    Error::SeedInFile { path: path.clone(), place: seeds[seed].place, cause: error }
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
