//! The flow of flat fans on which grains come together and part.

use glam::DVec3;
use voronoi::{CellComplex, Tessellation};

use super::flow::{Flow, Remedy, Taken};
use super::local_area::Conditions;
use super::local_size::LocalSize;
use super::reconnection::{Reconnections, Reconnector, lengths};
use super::shape::{ControlPoints, Shape};
use super::{NetworkRecipe, Relaxation, RelaxationStep, Tuning};
use crate::{Boundary, FaceMesh, Network, NetworkError, Volumes};

/// Length, in units of the feature size, below which triple lines may go; in equilibrium few are that short.
pub(super) const SHORT: f64 = 0.12;

/// Longest time of a step, in units of the mean grain size squared. Short lines would shrink to nothing in less: what is
/// left of them is still there, as a step lets none turn over.
const STEP_TIME: f64 = 0.15;

/// Most steps: long before that all is at rest.
const STEPS: usize = 150;

/// Steps in a row without an event that make an end ...
const QUIET_STEPS: usize = 5;

/// ... when the area also changes by less than this share of it from one to the next.
const QUIET_CHANGE: f64 = 2e-5;

/// Cells whose topology has followed their boundaries.
pub(super) struct Settled {
    pub(super) complex: CellComplex,
    /// How lines and boundaries bulge.
    pub(super) shape: Shape,
    /// What changed the topology.
    pub(super) reconnections: Reconnections,
    pub(super) steps: usize,
    /// Time passed, in units of the mean grain size squared.
    pub(super) time: f64,
}

/// Lets control points flow, and grains come together and part, for a time or until all is at rest.
///
/// After each step all short lines, and small boundaries with three sides, are looked at.
pub(super) fn settle(
    tessellation: &Tessellation,
    recipe: &NetworkRecipe<'_>,
    volumes: &[f64],
    relaxation: &Relaxation,
    tuning: &Tuning,
    watch: &mut impl FnMut(RelaxationStep<'_>),
) -> Result<Settled, NetworkError> {
    // All of a wall has the same area unless it folds, so that tension does nothing but unfold it.
    let tension =
        |boundary: &Boundary| (recipe.tension)(boundary) + if boundary.wall.is_some() { 1.0 } else { 0.0 };
    let network_of = |control_points: &ControlPoints| {
        let (network, flat) =
            Network::with_face_mesh(&control_points.cells, FaceMesh::Fan, recipe.junctions, 0)?;
        Ok::<_, NetworkError>((network.with_cell_volumes(volumes.to_vec()).with_tensions(tension)?, flat))
    };
    let (count, step_time) = match *relaxation {
        Relaxation::Time(time) => equal_steps(time),
        Relaxation::Equilibrium => (STEPS, STEP_TIME),
    };
    let mut complex = CellComplex::from(tessellation);
    let mut control_points = ControlPoints::new(&complex);
    let (mut network, mut points) = network_of(&control_points)?;
    let mut reconnector = Reconnector::new(SHORT * network.feature_size(), LocalSize::new(&network, tuning.small_grain));
    let time_unit = network.mean_grain_size().powi(2);
    let mut reconnections = Reconnections::default();
    let (mut quiet, mut last_energy) = (0, f64::INFINITY);
    let mut steps = 0;
    let mut show = |done: usize, cells: &Tessellation, points: &[DVec3]| {
        let time = done as f64 * step_time;
        watch(RelaxationStep { done, count, time, level: 0, points, cells: Some(cells) });
    };
    show(0, &control_points.cells, &points);
    loop {
        let free = Tuning { rigid_length: 0.0, ..*tuning };
        let mut flow = Flow::new(&network, 0, Volumes::Kept, 1.0, free).until_rest(Remedy::Join);
        // As long as the topology stays, so does the flow.
        let shape = loop {
            let before = lengths(&complex);
            let Taken { energy, pressures, .. } = flow.step(&mut points, step_time * time_unit)?;
            steps += 1;
            show(steps, &control_points.cells, &points);
            control_points.place_vertices(&mut complex, &points);
            let shape = control_points.shape(&complex, &points);
            let conditions =
                Conditions { shape: &shape, tension: recipe.tension, volumes, pressures: &pressures };
            let mut excess = network.grain_volumes(network.control_mesh(), &points);
            excess.iter_mut().zip(volumes).for_each(|(volume, wanted)| *volume -= wanted);
            let events = reconnector.pass(&mut complex, &conditions, &before, &mut excess);
            reconnections.add(events);
            quiet = if events.count() > 0 { 0 } else { quiet + 1 };
            let is_at_rest = quiet > QUIET_STEPS && (last_energy - energy).abs() < QUIET_CHANGE * energy;
            if is_at_rest || steps == count {
                let time = steps as f64 * step_time;
                return Ok(Settled { complex, shape, reconnections, steps, time });
            }
            last_energy = energy;
            if events.count() > 0 {
                break shape;
            }
            points = control_points.points(&complex, &network, &shape);
            flow.part_joined();
        };
        control_points = ControlPoints::new(&complex);
        network = network_of(&control_points)?.0;
        points = control_points.points(&complex, &network, &shape);
    }
}

/// A time in as few equal steps as may be, and the time of each. After the most steps all is at rest.
fn equal_steps(time: f64) -> (usize, f64) {
    let count = (1..=STEPS).find(|count| time <= STEP_TIME * *count as f64);
    count.map_or((STEPS, STEP_TIME), |count| (count, time / count as f64))
}
