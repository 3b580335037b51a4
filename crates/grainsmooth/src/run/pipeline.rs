//! From a config to a smooth, validated network.

use glam::DVec3;
use polycrystal::{
    AngleStatistics, Attempt, Boundary, Certificate, Certified, Collapsed, GrowthRecipe, Junctions, MeshSize,
    Network, NetworkError, NetworkRecipe, RegularCells, Relaxation, RelaxationStep, Relaxed, RelaxedCells,
    Vanished, Volumes, WeightedAngle, angles_between_boundaries, angles_between_cells, grow_cells,
    regular_cells, relax_cells, relax_certified, remove_short_edges,
};
use voronoi::{Dimension, Tessellation};

use super::origin::{Origin, Synthesis};
use super::polycrystal::Polycrystal;
use super::regularization::{Reconnected, Regularization};
use super::stage::{Clock, Progress, Stage};
use super::tessellated::{Tessellated, grain_volumes, tessellate};
use super::topology::Topology;
use crate::error::failure::Growth;
use crate::figures::significant::two_digits_down;
use crate::memory::{ControlMesh, LABEL_BYTES, LevelSize, Motion, available_memory, check_levels};
use crate::seeds::count::seed_count;
use crate::{BoundaryLaw, Config, Error, Failure};

/// Factor by which each time that is tried for grains that grow too long is shorter than the last, and how many are tried.
const SHORTER: f64 = 0.6;
const SHORTER_TIMES: usize = 12;

/// How often the grains of given shapes at which relaxation fails get rounder ones. Of 200 grains of 3:1:1 some take one round, of 54 of 3:2:1
/// whose length is that of a thin box twelve.
const MOST_ROUNDINGS: usize = 20;

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
/// [`LevelsExceedMemory`](crate::memory::MemoryError::LevelsExceedMemory) and [`LevelsExceedIds`](crate::memory::MemoryError::LevelsExceedIds).
pub fn check_expected_size(config: &Config) -> Result<(), Error> {
    let Some(count) = seed_count(config) else { return Ok(()) };
    let size = expected_control_mesh_size(count, config.dimension);
    // Each of two segments.
    let arcs = if bends_to_arcs(config) { size.edges / 2 } else { 0 };
    Ok(check_levels(
        ControlMesh { size, arcs, besides: voxel_bytes(config), motion: motion(config) },
        config.levels,
        available_memory(),
    )?)
}

/// Whether boundaries become arcs with as many segments as look smooth.
fn bends_to_arcs(config: &Config) -> bool {
    config.dimension == Dimension::Two && config.lets_topology_change()
}

/// The control mesh of some cells, without what regularisation takes out.
pub(crate) fn control_mesh(config: &Config, tessellation: &Tessellation) -> ControlMesh {
    let MeshSize { points, edges, triangles } = config.face_mesh.control_mesh_size(tessellation);
    let size = LevelSize { points, edges, triangles };
    let besides = voxel_bytes(config);
    let motion = motion(config);
    if !bends_to_arcs(config) {
        return ControlMesh { size, arcs: 0, besides, motion };
    }
    let sides = tessellation.faces().map(|face| tessellation.face_sides(face));
    let inside = sides.filter(|[_, second]| !matches!(second, voronoi::Side::Wall(_)));
    ControlMesh { size, arcs: inside.count() as u128, besides, motion }
}

/// How far points move.
pub(crate) fn motion(config: &Config) -> Motion {
    match config.effective_relaxation() {
        Relaxation::Equilibrium => Motion::ToRest,
        Relaxation::Time(0.0) => Motion::Still,
        Relaxation::Time(_) => Motion::Timed,
    }
}

/// Bytes that voxels take while they are labelled.
pub(crate) fn voxel_bytes(config: &Config) -> u128 {
    if config.file.voxels.is_some() { LABEL_BYTES } else { 0 }
}

/// Relaxes, subdivides and validates the network of some cells.
///
/// # Errors
/// [`LevelsExceedMemory`](crate::memory::MemoryError::LevelsExceedMemory) and [`LevelsExceedIds`](crate::memory::MemoryError::LevelsExceedIds); [`Error::Network`] when the network cannot be relaxed, or
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
    let mut clock = Clock { progress, times: cells.times.clone() };
    let mut attempts = Vec::new();
    let as_they_were = (config.volumes == Volumes::Free).then(|| cells.clone());
    let Rounded { cells, resolved, regularization, result } =
        smooth_rounded(config, cells, &mut attempts, &mut clock, &mut watch)?;
    let tessellation = resolved.as_ref().unwrap_or(&cells.tessellation);
    let smoothed = match result {
        Ok(smoothed) => smoothed,
        Err(error) => {
            let mut failure = Failure::new(error, attempts, &cells);
            if config.regularize == Some(0.0) && failure.cause.is_tangle() {
                let shorter = Config { regularize: None, ..config.clone() };
                let (attempts, watch) = (&mut Vec::new(), &mut |_: RelaxationStep<'_>| ());
                let (_, smoothed) = smooth_cells(&shorter, &cells, tessellation, attempts, &mut clock, watch);
                failure.works_without_short_lines = smoothed.is_ok();
            }
            return Err(match as_they_were {
                Some(cells) if failure.cause.is_of_time() => {
                    let works = time_that_works(config, &cells, &failure.cause);
                    failure.with_growth(works.map_or(Growth::Never, Growth::Until))
                }
                _ => failure,
            }
            .into());
        }
    };
    attempts.extend(smoothed.relaxed.given_up.clone());
    let (network, points, validation) = (smoothed.network, smoothed.points, smoothed.validation);
    let topology = Topology::new(Some(&cells.face_counts(tessellation)), &network);
    let synthesis = Synthesis {
        config: config.clone(),
        cells,
        relaxed: smoothed.relaxed,
        regularization,
        collapsed: smoothed.collapsed,
        reconnected: smoothed.reconnected,
        vanished: smoothed.vanished,
        flat_angles: smoothed.flat_angles,
        angles_before: smoothed.angles_before,
    };
    let origin = Origin::Synthetic(Box::new(synthesis));
    let mut polycrystal =
        clock.time(Stage::Validation, || Polycrystal::new(origin, topology, network, points, validation));
    (polycrystal.attempts, polycrystal.times) = (attempts, clock.times);
    polycrystal.fit_misorientations();
    if let Some(Synthesis { cells, .. }) = polycrystal.synthesis() {
        let tensions = cells.law.tensions_reached(&polycrystal.network, || polycrystal.measures());
        let mobilities = cells.law.mobilities_reached(&polycrystal.network);
        (polycrystal.tensions, polycrystal.mobilities) = (tensions, mobilities);
    }
    Ok(polycrystal)
}

/// The network of some cells, or of rounder ones.
struct Rounded {
    cells: Tessellated,
    /// The cells with faces that are resolved, if some were not.
    resolved: Option<Tessellation>,
    /// The last way.
    regularization: Regularization,
    result: Result<Smoothed, NetworkError>,
}

/// The network of some cells. Where that of grains with given shapes tangles, they get rounder ones.
fn smooth_rounded(
    config: &Config,
    mut cells: Tessellated,
    attempts: &mut Vec<Attempt>,
    clock: &mut Clock<'_>,
    watch: &mut impl FnMut(RelaxationStep<'_>),
) -> Result<Rounded, Error> {
    let mut resolved = cells.tessellation.resolved();
    let mut roundings = 0..MOST_ROUNDINGS;
    loop {
        let tessellation = resolved.as_ref().unwrap_or(&cells.tessellation);
        check_levels(control_mesh(config, tessellation), config.levels, available_memory())?;
        let (regularization, result) = smooth_cells(config, &cells, tessellation, attempts, clock, watch);
        let rounder = match &result {
            Err(error) if error.is_tangle() && roundings.next().is_some() => {
                clock.time(Stage::Cells, || cells.with_rounder(&error.grains().unwrap_or_default()))?
            }
            _ => None,
        };
        match (result, rounder) {
            (Err(error), Some(rounder)) => {
                error.give_up(regularization.in_words(), attempts);
                resolved = rounder.tessellation.resolved();
                cells = rounder;
            }
            (result, _) => return Ok(Rounded { cells, resolved, regularization, result }),
        }
    }
}

/// The network of some cells, by the first way that leads to one, with the last way.
fn smooth_cells(
    config: &Config,
    cells: &Tessellated,
    tessellation: &Tessellation,
    attempts: &mut Vec<Attempt>,
    clock: &mut Clock<'_>,
    watch: &mut impl FnMut(RelaxationStep<'_>),
) -> (Regularization, Result<Smoothed, NetworkError>) {
    let mut tries = Regularization::tries(config).iter();
    loop {
        let regularization = *tries.next().expect("there is one, and the last is the result");
        match smooth_regularized(config, cells, tessellation, regularization, attempts, clock, watch) {
            Err(error) if error.is_tangle() && tries.len() > 0 => {
                error.give_up(regularization.in_words(), attempts);
            }
            result => return (regularization, result),
        }
    }
}

/// A time for which grains can grow freely, where for the config's own they cannot: it is tried.
fn time_that_works(config: &Config, cells: &Tessellated, cause: &NetworkError) -> Option<f64> {
    let Relaxation::Time(asked) = config.effective_relaxation() else { return None };
    let mut time = match cause {
        NetworkError::GrainVanished { time, .. } | NetworkError::GrowthNotFollowed { time, .. }
            if *time > 0.0 =>
        {
            0.9 * time
        }
        _ => SHORTER * asked,
    };
    let mut clock = Clock { progress: &|_, _, _| (), times: Vec::new() };
    for _ in 0..SHORTER_TIMES {
        time = two_digits_down(time);
        let shorter = Config { relaxation: Some(Relaxation::Time(time)), ..config.clone() };
        let (cells, attempts) = (cells.clone(), &mut Vec::new());
        let smoothed = smooth_rounded(&shorter, cells, attempts, &mut clock, &mut |_| ());
        if smoothed.is_ok_and(|rounded| rounded.result.is_ok()) {
            return Some(time);
        }
        time *= SHORTER;
    }
    None
}

/// A valid network and how it came about, as [`Polycrystal`] has it.
struct Smoothed {
    network: Network,
    points: Vec<DVec3>,
    relaxed: Relaxed,
    collapsed: Collapsed,
    reconnected: Option<Reconnected>,
    vanished: Vec<Vanished>,
    flat_angles: Vec<WeightedAngle>,
    angles_before: Option<AngleStatistics>,
    validation: Certificate,
}

/// The network of cells regularised in one way.
fn smooth_regularized(
    config: &Config,
    cells: &Tessellated,
    tessellation: &Tessellation,
    regularization: Regularization,
    attempts: &mut Vec<Attempt>,
    clock: &mut Clock<'_>,
    watch: &mut impl FnMut(RelaxationStep<'_>),
) -> Result<Smoothed, NetworkError> {
    let progress = clock.progress;
    let mut watch = |step: RelaxationStep<'_>| {
        progress(Stage::Relaxation, step.done, step.count);
        watch(step);
    };
    if regularization == Regularization::ByEnergy {
        return smooth_by_energy(config, &cells.law, tessellation, attempts, clock, &mut watch);
    }
    let (mut network, flat, collapsed) =
        clock.time(Stage::Network, || network(config, cells, tessellation, regularization, attempts))?;
    let (flat_angles, angles_before) = flat_angles(&network, &flat);
    let relaxation = config.relaxation_of_kept_topology();
    let (relaxed, certified) = clock
        .time(Stage::Relaxation, || relax_certified(&network, &flat, &relaxation, config.volumes, watch))?;
    let Certified { points, validation, validated_in } = certified;
    clock.move_time(validated_in, Stage::Relaxation, Stage::Validation);
    if config.volumes == Volumes::Free {
        let volumes = network.grain_volumes(network.finest(), &points);
        network = network.with_cell_volumes(volumes);
    }
    let (reconnected, vanished) = (None, Vec::new());
    Ok(Smoothed {
        network,
        points,
        relaxed,
        collapsed,
        reconnected,
        vanished,
        flat_angles,
        angles_before,
        validation,
    })
}

/// As of [`flat_angles`], of cells whose flat network is not needed for anything else.
fn angles_of_cells(
    tessellation: &Tessellation,
    junctions: Junctions,
) -> Result<(Vec<WeightedAngle>, Option<AngleStatistics>), NetworkError> {
    match tessellation.domain().dimension() {
        Dimension::Three => {
            let angles = angles_between_cells(tessellation);
            let statistics = AngleStatistics::of(angles.iter().copied());
            Ok((angles, statistics))
        }
        Dimension::Two => {
            let (of_cells, flat) = Network::new(tessellation, junctions, 0)?;
            Ok(flat_angles(&of_cells, &flat))
        }
    }
}

/// Angles between boundaries of flat cells, and their statistics.
fn flat_angles(of_cells: &Network, flat: &[DVec3]) -> (Vec<WeightedAngle>, Option<AngleStatistics>) {
    let mesh = of_cells.control_mesh();
    let angles = angles_between_boundaries(of_cells, mesh, flat);
    let statistics = AngleStatistics::of(angles.iter().copied());
    (angles, statistics)
}

/// The network of cells that come together and part as tension has it, or grow and vanish.
fn smooth_by_energy(
    config: &Config,
    law: &BoundaryLaw,
    tessellation: &Tessellation,
    attempts: &mut Vec<Attempt>,
    clock: &mut Clock<'_>,
    watch: &mut impl FnMut(RelaxationStep<'_>),
) -> Result<Smoothed, NetworkError> {
    let Config { face_mesh, junctions, levels, .. } = *config;
    let tension = |boundary: &Boundary| law.tension(boundary);
    let recipe = NetworkRecipe { face_mesh, junctions, levels: levels as usize, tension: &tension };
    let mobility = |boundary: &Boundary| law.mobility(boundary);
    let (flat_angles, angles_before) = angles_of_cells(tessellation, junctions)?;
    let relaxed_cells = clock.time(Stage::Relaxation, || match config.effective_relaxation() {
        Relaxation::Time(time) if config.lets_grains_vanish() => {
            let recipe = GrowthRecipe { network: recipe, mobility: &mobility };
            grow_cells(tessellation, &recipe, time, watch).map(|grown| (grown.cells, grown.vanished))
        }
        relaxation => relax_cells(tessellation, &recipe, &relaxation, watch).map(|cells| (cells, Vec::new())),
    });
    let (relaxed_cells, vanished) = relaxed_cells?;
    let RelaxedCells {
        network,
        relaxed,
        points,
        reconnections,
        merged,
        balance,
        validation,
        validated_in,
        attempts: tried,
    } = relaxed_cells;
    attempts.extend(tried);
    clock.move_time(validated_in, Stage::Relaxation, Stage::Validation);
    let reconnected = Some(Reconnected { reconnections, balance });
    Ok(Smoothed {
        network,
        points,
        relaxed,
        collapsed: merged,
        reconnected,
        vanished,
        flat_angles,
        angles_before,
        validation,
    })
}

/// The network of regularised cells, whose grains are to have the volumes of the cells as they were.
fn network(
    config: &Config,
    cells: &Tessellated,
    tessellation: &Tessellation,
    regularization: Regularization,
    attempts: &mut Vec<Attempt>,
) -> Result<(Network, Vec<DVec3>, Collapsed), NetworkError> {
    let Config { face_mesh, junctions, levels, .. } = *config;
    let length = config.effective_regularize();
    let network_of = |tessellation: &Tessellation, face_mesh, coarsening| {
        let (network, flat) =
            cells.network(tessellation, face_mesh, junctions, coarsening, levels as usize)?;
        Ok::<_, NetworkError>((cells.law.apply(network)?, flat))
    };
    let (regular, collapsed) = match regularization {
        Regularization::Plain | Regularization::Shorter(_) if cells.grain_cells.is_some() => {
            let halvings = if let Regularization::Shorter(halvings) = regularization { halvings } else { 0 };
            let (network, flat) = network_of(tessellation, face_mesh, 0.5f64.powi(halvings.into()) * length)?;
            return Ok((network, flat, Collapsed::default()));
        }
        Regularization::Predicted => {
            let RegularCells { cells, collapsed, given_up } = regular_cells(tessellation, length)?;
            attempts.extend(given_up);
            (cells, collapsed)
        }
        Regularization::Plain => remove_short_edges(tessellation, length),
        Regularization::Shorter(halvings) => {
            remove_short_edges(tessellation, 0.5f64.powi(halvings.into()) * length)
        }
        Regularization::None | Regularization::ByEnergy => {
            let (network, flat) = network_of(tessellation, face_mesh, 0.0)?;
            return Ok((network, flat, Collapsed::default()));
        }
    };
    let volumes = grain_volumes(tessellation, cells.grain_cells.as_ref());
    let (network, flat) = network_of(&regular, config.regular_face_mesh(), 0.0)?;
    Ok((network.with_cell_volumes(volumes), flat, collapsed))
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
