//! Grain growth in the plane, whatever vanishes on the way.
//!
//! Between events boundaries move by their curvature, in steps as long as their error allows. After each step grains that are nearly gone
//! vanish (T2), and edges that are nearly gone make neighbours switch (T1).

mod curves;
mod events;
mod step;
pub(crate) mod tuning;

use cancellation::check_cancelled;
use voronoi::{Dimension, Tessellation};

use crate::events::reconnection::Reconnections;
use crate::flow::relaxation::{Moving, Relaxation, RelaxationStep, Relaxed};
use crate::{Boundary, Certificate, GrainId, Network, NetworkError, validate};
use curves::{Curves, MovingCurves};
use tuning::GrowthTuning;

/// How a network is made of grains that grow.
#[derive(Clone, Copy)]
pub struct GrowthRecipe<'a> {
    /// Number of subdivisions.
    pub levels: usize,
    /// The tension of each boundary, in any unit.
    pub tension: &'a (dyn Fn(&Boundary) -> f64 + Sync),
    /// The mobility of each boundary, in any unit.
    pub mobility: &'a (dyn Fn(&Boundary) -> f64 + Sync),
}

/// A grain that has shrunk to nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vanished {
    /// The grain.
    pub grain: GrainId,
    /// When, in units of the mean grain size squared at the start.
    pub time: f64,
}

/// What growth gives.
#[derive(Debug, Clone)]
pub struct GrownCells {
    /// The network of the grains that are left. Grains keep their numbers; those that have vanished have no boundaries, and the volume 0.
    pub network: Network,
    /// Where its points are.
    pub relaxed: Relaxed,
    /// How neighbours switched.
    pub reconnections: Reconnections,
    /// The grains that vanished, the first one first.
    pub vanished: Vec<Vanished>,
    /// What validation found.
    pub validation: Certificate,
}

/// The first step, and the least, in units of the mean area. What fails with the least is no matter of time.
const FIRST_STEP: f64 = 1e-3;
const LEAST_STEP: f64 = 1e-9;

/// Share of the largest error that the next step is to have, and the most that it is shorter or longer than the one before.
const SAFETY: f64 = 0.8;
const LEAST_CHANGE: f64 = 0.3;
const LARGEST_CHANGE: f64 = 2.0;

/// Lets the grains of cells of the plane grow for a time under curvature flow, in units of the mean grain size squared at the start; means of
/// tension and mobility at the start are 1.
///
/// Grains vanish and switch neighbours on the way, and keep their numbers. The network is valid.
///
/// ```
/// use glam::DVec3;
/// use polycrystal::{GrowthRecipe, grow_cells};
/// use voronoi::{Domain, Tessellation};
///
/// let seeds: Vec<DVec3> = (0..30).map(|k| DVec3::new(f64::from(k * 7 % 30) + 0.5, f64::from(k) + 0.5, 0.0) / 30.0).collect();
/// let cells = Tessellation::new(&Domain::unit_square(), &seeds)?;
/// let recipe = GrowthRecipe { levels: 1, tension: &|_| 1.0, mobility: &|_| 1.0 };
/// let grown = grow_cells(&cells, &recipe, 3.0, |_| ())?;
/// assert_eq!(grown.network.grains_left() + grown.vanished.len(), 30);
/// assert!(grown.network.grains_left() < 20);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`NetworkError::BadRelaxationTime`], [`NetworkError::BadTension`], [`NetworkError::BadMobility`]; [`NetworkError::GrowthNotFollowed`];
/// [`NetworkError::Invalid`].
///
/// # Panics
/// When the cells are not of the plane.
pub fn grow_cells(
    cells: &Tessellation,
    recipe: &GrowthRecipe<'_>,
    time: f64,
    watch: impl FnMut(RelaxationStep<'_>),
) -> Result<GrownCells, NetworkError> {
    grow_cells_tuned(cells, recipe, time, &GrowthTuning::default(), watch)
}

/// As [`grow_cells`], with other numbers than the tuned ones.
///
/// # Errors
/// As of [`grow_cells`].
///
/// # Panics
/// As [`grow_cells`].
#[doc(hidden)]
pub fn grow_cells_tuned(
    cells: &Tessellation,
    recipe: &GrowthRecipe<'_>,
    time: f64,
    tuning: &GrowthTuning,
    mut watch: impl FnMut(RelaxationStep<'_>),
) -> Result<GrownCells, NetworkError> {
    let domain = cells.domain();
    assert_eq!(domain.dimension(), Dimension::Two, "cells of the plane");
    Relaxation::Time(time).check()?;
    let mean_area = |vanished: &[Vanished]| domain.measure() / (cells.cell_count() - vanished.len()) as f64;
    let (mut reconnections, mut vanished) = (Reconnections::default(), Vec::new());
    let unit = mean_area(&vanished);
    let whole_time = time * unit;
    let mut curves = Curves::new(cells, tuning.spacing * unit.sqrt());
    let (at_first, _) = curves.lay(recipe, 0)?;
    let (tension_unit, mobility_unit) = (at_first.mean_tension(), at_first.mean_mobility());
    let tension = |boundary: &Boundary| (recipe.tension)(boundary) / tension_unit;
    let mobility = |boundary: &Boundary| (recipe.mobility)(boundary) / mobility_unit;
    let in_units = GrowthRecipe { tension: &tension, mobility: &mobility, ..*recipe };
    let mut show = |curves: &Curves, done: usize, left: f64, passed: f64| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "far fewer")]
        let count = done + left.ceil() as usize;
        let now = Moving::Grains(&|| curves.lay(recipe, recipe.levels));
        watch(RelaxationStep { done, count, time: passed / unit, now });
    };
    show(&curves, 0, 1.0, 0.0);
    let (mut passed, mut steps, mut step_time) = (0.0, 0, FIRST_STEP * unit);
    let moves = at_first.boundaries().iter().zip(at_first.tensions());
    let moves = moves.into_iter().any(|(boundary, tension)| boundary.wall.is_none() && *tension > 0.0);
    let whole_time = if moves { whole_time } else { 0.0 };
    if whole_time > 0.0 {
        // Points of more than three edges, and edges too short to move.
        let areas: Vec<f64> = cells.cell_measures().iter().map(|cell| cell.volume).collect();
        reconnections.add(curves.pass(&areas, unit, &in_units, tuning).reconnections);
        curves.resample(tuning.spacing * unit.sqrt());
    }
    while passed < whole_time {
        let mean = mean_area(&vanished);
        let MovingCurves { faces, network, places } = curves.moving(&in_units, tuning.spacing * mean.sqrt());
        let (time, end, areas) = loop {
            check_cancelled();
            let time = step_time.min(whole_time - passed);
            let whole = network.step(&places, time);
            let halves = network.step(&network.step(&places, 0.5 * time), 0.5 * time);
            let end = halves.extrapolated(&whole);
            let areas = curves.areas(&faces, &end);
            let pairs = curves.areas(&faces, &whole).into_iter().zip(curves.areas(&faces, &halves));
            let errors = (0u32..).zip(pairs.map(|(whole, halves)| (whole - halves).abs() / mean));
            let worst = errors.max_by(|one, other| one.1.total_cmp(&other.1));
            let (worst, error) = worst.map_or((GrainId(0), 0.0), |(grain, error)| (GrainId(grain), error));
            let change = (SAFETY * tuning.largest_error / error).sqrt();
            step_time = time * change.clamp(LEAST_CHANGE, LARGEST_CHANGE);
            if error <= tuning.largest_error {
                break (time, end, areas);
            }
            if error.is_nan() || time < LEAST_STEP * mean {
                return Err(NetworkError::GrowthNotFollowed { grain: worst, time: passed / unit });
            }
        };
        passed = if time < whole_time - passed { passed + time } else { whole_time };
        steps += 1;
        curves.take(&faces, end);
        let happened = curves.pass(&areas, mean, &in_units, tuning);
        vanished.extend(happened.vanished.into_iter().map(|grain| Vanished { grain, time: passed / unit }));
        reconnections.add(happened.reconnections);
        curves.resample(tuning.spacing * mean_area(&vanished).sqrt());
        show(&curves, steps, (whole_time - passed) / step_time, passed);
    }
    let (network, points) = curves.lay(recipe, recipe.levels)?;
    let is_flat = whole_time == 0.0;
    let relaxed = Relaxed { level: 0, points, steps, time: passed / unit, given_up: Vec::new(), is_flat };
    let finest = relaxed.finest_points(&network);
    let volumes = network.grain_volumes(network.finest(), &finest);
    let network = network.with_cell_volumes(volumes);
    let validation = validate(&network, &finest).map_err(NetworkError::Invalid)?;
    Ok(GrownCells { network, relaxed, reconnections, vanished, validation })
}
