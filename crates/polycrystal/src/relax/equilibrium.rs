//! Relaxation to equilibrium, with the changes of topology that it takes.

use glam::DVec3;
use voronoi::{CellComplex, Collapsed, Tessellation};

use super::flow::{Flow, RIGID_LENGTH, Remedy, Taken};
use super::local_area::Conditions;
use super::merged_lines::MergedLines;
use super::plane;
use super::reconnection::{Reconnections, Reconnector, lengths};
use super::shape::{ControlPoints, Shape};
use super::{FINEST_BALANCED, Relaxation, RelaxationStep, Relaxed, relax_levels};
use crate::{
    Boundary, FaceMesh, Junctions, Network, NetworkError, SpaceMeasures, TripleLineMeasures, Volumes,
    dihedral_angles, measure_network, validate,
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

/// Length, in units of the mean grain size, below which lines that are left are drawn together.
const MERGED: f64 = 0.12;

/// Standard deviation of the angles at triple lines, in degrees, above which some place is off: random grains end at 1.2 to 1.8 on
/// all levels that move.
const LARGEST_SPREAD: f64 = 2.0;

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
}

/// How near to equilibrium a network is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    /// Places that are out of balance: triple lines, shorter than 0.12 of the mean grain size, that no event takes away, and
    /// lines where more than three boundaries meet; in the plane, such points.
    pub flagged_lines: usize,
    /// The largest difference to 120 degrees of an angle between boundaries, as a mean over its triple line, in degrees; flagged
    /// lines, and those that end where one is, left out. In the plane, of an angle between segments at a triple point.
    pub largest_deviation: f64,
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
    mut watch: impl FnMut(RelaxationStep<'_>),
) -> Result<Equilibrium, NetworkError> {
    if tessellation.domain().dimension() == voronoi::Dimension::Two {
        return plane::equilibrate(tessellation, recipe, &mut watch);
    }
    let mut attempt = |remedy| balanced(tessellation, recipe, remedy, &mut watch);
    // Each gets through places where the other does not.
    let Ok(first) = attempt(Remedy::Join) else { return attempt(Remedy::Brake) };
    let first_spread = spread(&first);
    if first.relaxed.fell_back || (recipe.levels >= FINEST_BALANCED && first_spread > LARGEST_SPREAD) {
        let second = attempt(Remedy::Brake).ok().filter(|second| spread(second) < first_spread);
        return Ok(second.unwrap_or(first));
    }
    Ok(first)
}

/// The standard deviation of the angles at triple lines.
fn spread(Equilibrium { network, relaxed, .. }: &Equilibrium) -> f64 {
    let angles = dihedral_angles(network, network.finest(), &relaxed.finest_points(network));
    angles.map_or(0.0, |angles| angles.standard_deviation)
}

/// As [`equilibrate`], with one remedy for what folds while the topology changes.
fn balanced(
    tessellation: &Tessellation,
    recipe: &NetworkRecipe<'_>,
    remedy: Remedy,
    watch: &mut impl FnMut(RelaxationStep<'_>),
) -> Result<Equilibrium, NetworkError> {
    let mut complex = CellComplex::from(tessellation);
    let volumes: Vec<f64> = tessellation.cell_measures().iter().map(|cell| cell.volume).collect();
    let (shape, reconnections) = settle(&mut complex, recipe, &volumes, remedy)?;
    let mut smooth = |merged_length: f64, rigid_length: f64| {
        let MergedLines { cells, middles, collapsed } = MergedLines::new(&complex, &shape, merged_length);
        let (network, points) = Network::of_curved_lines(&cells, &middles, recipe.junctions, recipe.levels)?;
        let network = network.with_cell_volumes(volumes.clone()).with_tensions(recipe.tension)?;
        let relaxation = Relaxation::Equilibrium;
        let relaxed = relax_levels(&network, &points, &relaxation, Volumes::Kept, rigid_length, watch)?;
        let points = relaxed.finest_points(&network);
        validate(&network, &points).map_err(NetworkError::Invalid)?;
        let balance = balance(&network, &points);
        Ok(Equilibrium { network, relaxed, reconnections, merged: collapsed, balance })
    };
    // What folds where all may deform need not where the shortest edges keep their lengths, or where all lines are left.
    smooth(MERGED, 0.0).or_else(|_: NetworkError| smooth(MERGED, RIGID_LENGTH)).or_else(|_| smooth(0.0, 0.0))
}

/// Lets the control points flow and the topology change until both are at rest; the complex is then as they are.
fn settle(
    complex: &mut CellComplex,
    recipe: &NetworkRecipe<'_>,
    volumes: &[f64],
    remedy: Remedy,
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
        let mut flow = Flow::new(&network, 0, Volumes::Kept).with_rigid_length(0.0).until_rest(remedy);
        // As long as the topology stays, so does the flow.
        let shape = loop {
            let before = lengths(complex);
            let Taken { energy, pressures } = flow.step(&mut points, step_time)?;
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
    let ends = |points: &[u32]| [points[0], points[points.len() - 1]];
    let is_short = |line: &TripleLineMeasures| !line.is_closed && line.length < short;
    let flagged = || triple_lines.iter().filter(|line| is_short(line) || line.boundaries.len() > 3);
    let mut flagged_ends: Vec<u32> = flagged().flat_map(|line| ends(&line.points)).collect();
    flagged_ends.sort_unstable();
    let is_apart = |point: &u32| flagged_ends.binary_search(point).is_err();
    let others = triple_lines.iter().filter(|line| {
        let is_inside = line.sides.len() == 3 && !line.sides.contains(&crate::Side::Exterior);
        is_inside && ends(&line.points).iter().all(is_apart)
    });
    let deviations = others.flat_map(|line| &line.mean_angles).map(|angle| (angle - 120.0).abs());
    Balance { flagged_lines: flagged().count(), largest_deviation: deviations.fold(0.0, f64::max) }
}
