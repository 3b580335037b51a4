//! Relaxation to equilibrium, with the changes of topology that it takes.

use glam::DVec3;
use voronoi::{CellComplex, Collapsed, Tessellation};

use super::flow::{Flow, Remedy, Taken};
use super::local_area::{Conditions, boundary};
use super::merged_lines::MergedLines;
use super::plane;
use super::reconnection::{Reconnections, Reconnector, lengths};
use super::shape::{ControlPoints, Shape};
use super::{Relaxation, RelaxationStep, Relaxed, Tuning, relax_levels};
use crate::tension::{checked_tension, in_unit, mean_tension};
use crate::{
    Attempt, Boundary, FaceMesh, Junctions, Network, NetworkError, SpaceMeasures, TripleLineMeasures,
    Volumes, measure_network, validate,
};

/// Length, in units of the feature size, below which triple lines may go; in equilibrium few are that short.
const SHORT: f64 = 0.12;

/// Time of a step while the topology changes, in units of the mean grain size squared. Short lines would shrink to nothing in less: what is
/// left of them is still there, as a step lets none turn over.
const STEP_TIME: f64 = 0.15;

/// Most looks.
const LOOKS: usize = 150;

/// Looks in a row without an event that make an end ...
const QUIET_LOOKS: usize = 5;

/// ... when the area also changes by less than this share of it from one to the next.
const QUIET_CHANGE: f64 = 2e-5;

/// How a network is made of cells.
#[derive(Clone, Copy)]
pub struct NetworkRecipe<'a> {
    /// How triple lines are smoothed.
    pub junctions: Junctions,
    /// Number of subdivisions.
    pub levels: usize,
    /// The tension of each boundary.
    pub tension: &'a dyn Fn(&Boundary) -> f64,
}

/// What relaxation to equilibrium gives.
#[derive(Debug, Clone)]
pub struct Equilibrium {
    /// The network with its topology in the end.
    pub network: Network,
    /// Where its points are.
    pub relaxed: Relaxed,
    /// What changed the topology.
    pub reconnections: Reconnections,
    /// Short triple lines, and boundaries with them, that were drawn together into points of higher order.
    pub merged: Collapsed,
    /// How near to equilibrium it is.
    pub balance: Balance,
    /// What was tried before, and tangled.
    pub attempts: Vec<Attempt>,
}

/// How near to equilibrium a network is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    /// Places that are not at rest: triple lines, shorter than 0.12 of the mean grain size, that no event takes away, lines where more
    /// than three boundaries meet (in the plane, such points), and those whose residual is above [`Balance::LARGEST_RESIDUAL`].
    pub flagged_lines: usize,
    /// The largest residual of Herring's condition, as of [`HerringResidual`](crate::HerringResidual), of any line that is not flagged.
    pub largest_residual: f64,
}

impl Balance {
    /// Residual of a line above which it is not at rest: that of one of three equal boundaries that is off by 14 degrees. Of random
    /// grains at rest, the worst of some 3000 lines has two thirds of it.
    pub const LARGEST_RESIDUAL: f64 = 0.07;

    /// That of lines of which some are flagged anyway, with their residuals.
    pub(super) fn of(lines: impl Iterator<Item = (bool, Option<f64>)>) -> Self {
        let mut balance = Self { flagged_lines: 0, largest_residual: 0.0 };
        for (is_flagged, residual) in lines {
            let residual = residual.unwrap_or(0.0);
            if is_flagged || residual > Self::LARGEST_RESIDUAL {
                balance.flagged_lines += 1;
            } else {
                balance.largest_residual = balance.largest_residual.max(residual);
            }
        }
        balance
    }
}

/// Relaxes the grains of a tessellation to [`Relaxation::Equilibrium`]. Every grain keeps the volume of its cell.
///
/// Triple lines that shrink to nothing become boundaries, and boundaries triple lines, where that lessens the area; each
/// grain stays a closed ball. The network is valid. Control points are in fans. `watch` is shown the steps after the last change of topology.
///
/// In the plane, boundaries become arcs of circles, in segments that turn by a quarter of a degree at most, and
/// meet at triple points. Steps are Newton's there, and count as time 1 each.
///
/// # Errors
/// As of [`relax`](crate::relax), and [`NetworkError::Invalid`], where no way leads to a valid network.
pub fn equilibrate(
    tessellation: &Tessellation,
    recipe: &NetworkRecipe<'_>,
    watch: impl FnMut(RelaxationStep<'_>),
) -> Result<Equilibrium, NetworkError> {
    equilibrate_tuned(tessellation, recipe, &Tuning::default(), watch)
}

/// As [`equilibrate`], with other numbers than the tuned ones.
///
/// # Errors
/// As of [`equilibrate`].
#[doc(hidden)]
pub fn equilibrate_tuned(
    tessellation: &Tessellation,
    recipe: &NetworkRecipe<'_>,
    tuning: &Tuning,
    mut watch: impl FnMut(RelaxationStep<'_>),
) -> Result<Equilibrium, NetworkError> {
    let mut given = Vec::new();
    for face in tessellation.faces() {
        let boundary = boundary(tessellation.face_sides(face));
        given.push((boundary, checked_tension(&boundary, (recipe.tension)(&boundary))?));
    }
    let unit = mean_tension(given.iter().map(|(boundary, tension)| (boundary, *tension)));
    let tension = |boundary: &Boundary| in_unit((recipe.tension)(boundary), unit);
    let in_units = NetworkRecipe { tension: &tension, ..*recipe };
    let mut equilibrium = equilibrate_by_mean_tension(tessellation, &in_units, tuning, &mut watch)?;
    equilibrium.network = equilibrium.network.with_tensions(recipe.tension)?;
    Ok(equilibrium)
}

/// As [`equilibrate`], with tensions whose mean is 1 at first.
fn equilibrate_by_mean_tension(
    tessellation: &Tessellation,
    recipe: &NetworkRecipe<'_>,
    tuning: &Tuning,
    watch: &mut impl FnMut(RelaxationStep<'_>),
) -> Result<Equilibrium, NetworkError> {
    if tessellation.domain().dimension() == voronoi::Dimension::Two {
        return plane::equilibrate(tessellation, recipe, watch);
    }
    let mut attempts = Vec::new();
    let mut complex = CellComplex::from(tessellation);
    let volumes: Vec<f64> = tessellation.cell_measures().iter().map(|cell| cell.volume).collect();
    let (shape, reconnections) = settle(&mut complex, recipe, &volumes, tuning)?;
    let mut smooth = |merged_length: f64, rigid_length: f64| {
        let MergedLines { cells, middles, collapsed } = MergedLines::new(&complex, &shape, merged_length);
        let (network, points) = Network::of_curved_lines(&cells, &middles, recipe.junctions, recipe.levels)?;
        let network = network.with_cell_volumes(volumes.clone()).with_tensions(recipe.tension)?;
        let relaxation = Relaxation::Equilibrium;
        let tuning = Tuning { rigid_length, ..*tuning };
        let relaxed = relax_levels(&network, &points, &relaxation, Volumes::Kept, &tuning, 1.0, watch)?;
        let points = relaxed.finest_points(&network);
        validate(&network, &points).map_err(NetworkError::Invalid)?;
        let balance = balance(&network, &points);
        let (merged, attempts) = (collapsed, Vec::new());
        Ok::<_, NetworkError>(Equilibrium { network, relaxed, reconnections, merged, balance, attempts })
    };
    // What folds where all may deform need not where the shortest edges keep their lengths, or where all lines are left.
    let ways = [
        ("equilibrium without short lines", tuning.merged_length, 0.0),
        ("the same with the shortest edges rigid", tuning.merged_length, tuning.rigid_length),
    ];
    let mut first = None;
    for (tried, merged_length, rigid_length) in ways {
        match smooth(merged_length, rigid_length) {
            Err(error) if error.is_tangle() => error.give_up(tried, &mut attempts),
            result => {
                first = Some(result);
                break;
            }
        }
    }
    match first.unwrap_or_else(|| smooth(0.0, 0.0)) {
        Ok(equilibrium) => Ok(Equilibrium { attempts, ..equilibrium }),
        Err(error) => Err(error.after(attempts)),
    }
}

/// Lets the control points flow and the topology change until both are at rest; the complex is then as they are.
fn settle(
    complex: &mut CellComplex,
    recipe: &NetworkRecipe<'_>,
    volumes: &[f64],
    tuning: &Tuning,
) -> Result<(Shape, Reconnections), NetworkError> {
    // All of a wall has the same area unless it folds, so that tension does nothing but unfold it.
    let tension =
        |boundary: &Boundary| (recipe.tension)(boundary) + if boundary.wall.is_some() { 1.0 } else { 0.0 };
    let network_of = |control_points: &ControlPoints| {
        let (network, flat) =
            Network::with_face_mesh(&control_points.cells, FaceMesh::Fan, recipe.junctions, 0)?;
        Ok::<_, NetworkError>((network.with_cell_volumes(volumes.to_vec()).with_tensions(tension)?, flat))
    };
    let mut control_points = ControlPoints::new(complex);
    let (mut network, mut points) = network_of(&control_points)?;
    let mut reconnector = Reconnector::new(SHORT * network.feature_size());
    let step_time = STEP_TIME * network.mean_grain_size().powi(2);
    let mut all = Reconnections::default();
    let (mut quiet, mut last_energy) = (0, f64::INFINITY);
    let mut looks = 0;
    loop {
        let free = Tuning { rigid_length: 0.0, ..*tuning };
        let mut flow = Flow::new(&network, 0, Volumes::Kept, 1.0, free).until_rest(Remedy::Join);
        // As long as the topology stays, so does the flow.
        let shape = loop {
            let before = lengths(complex);
            let Taken { energy, pressures, .. } = flow.step(&mut points, step_time)?;
            control_points.place_vertices(complex, &points);
            let shape = control_points.shape(complex, &points);
            let conditions =
                Conditions { shape: &shape, tension: recipe.tension, volumes, pressures: &pressures };
            let events = reconnector.pass(complex, &conditions, &before);
            all.add(events);
            looks += 1;
            quiet = if events.count() > 0 { 0 } else { quiet + 1 };
            let is_at_rest = quiet > QUIET_LOOKS && (last_energy - energy).abs() < QUIET_CHANGE * energy;
            if is_at_rest || looks == LOOKS {
                return Ok((shape, all));
            }
            last_energy = energy;
            if events.count() > 0 {
                break shape;
            }
            points = control_points.points(complex, &network, &shape);
            flow.part_joined();
        };
        control_points = ControlPoints::new(complex);
        network = network_of(&control_points)?.0;
        points = control_points.points(complex, &network, &shape);
    }
}

/// How near to equilibrium a network in space is.
fn balance(network: &Network, points: &[DVec3]) -> Balance {
    let short = SHORT * network.feature_size();
    let measures = measure_network(network, points).in_space();
    let SpaceMeasures { triple_lines, .. } = measures.expect("a network in space");
    let is_short = |line: &TripleLineMeasures| !line.is_closed && line.length < short;
    let lines = triple_lines.iter();
    Balance::of(lines.map(|line| (is_short(line) || line.boundaries.len() > 3, line.residual)))
}
