//! Relaxation toward the equilibrium of grain-boundary tension at fixed grain volumes.
//!
//! The energy is the area of all boundaries between grains; its gradient flow is motion by mean curvature. A semi-implicit
//! step of time dt solves `(M + dt K) d = -dt g + J^T p`, `J d = v` for the displacement d of the moved points x, with
//! M the area that each stands for, K the cotangent stiffness of the mesh that they make up (Dziuk 1991), g the gradient of
//! the area of the next finer level, J the gradient of the grains' volumes, v what these
//! lack, and p the pressures that make up for it.
//!
//! First the control points move, then those of level 1, which start where subdivision puts them.

mod assembly;
mod balance;
mod cells;
mod clusters;
pub(crate) mod conjugate_gradients;
mod event;
mod fan_flow;
mod fans;
mod flow;
mod local_area;
mod local_size;
mod merged_lines;
mod multigrid;
mod patch;
mod patches;
mod plane;
mod reconnection;
mod rows;
mod settling;
mod shape;
mod system;
mod tangential;
mod thin_triangles;
mod tuning;
mod volume_constraint;
mod wedges;

use glam::DVec3;
use voronoi::Tessellation;

use crate::{Attempt, GrainId, Mesh, Network, NetworkError};
use flow::{End, Flow, Stage};

pub use balance::Balance;
pub use cells::{NetworkRecipe, RelaxedCells, relax_cells, relax_cells_tuned};
pub use reconnection::Reconnections;
pub use tuning::Tuning;

/// Steps of grains that grow in the plane: with fewer, rates are off by more than a hundredth.
const GROWTH_STEPS: usize = 60;

/// Most steps of grains that grow: long before that, one has vanished, or all are at rest.
const MOST_GROWTH_STEPS: usize = 2000;

/// The usual relaxation time, in units of the mean grain size squared.
const USUAL_TIME: f64 = 0.3;

/// Time of the flow toward equilibrium on each coarser level, in units of the mean grain size squared.
const LONG_STEP: f64 = 0.3;

/// Time of one step on the finest level that moves, in the same unit; in the plane it is the time above.
const REST_STEP: f64 = 0.1;

/// Most such steps.
const REST_STEPS: usize = 200;

/// Volume of a grain as a share of the mean below which it has shrunk to nothing.
const LEAST_GRAIN: f64 = 1e-3;

/// How to relax.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Relaxation {
    /// For a time under curvature flow with unit mobility, in units of the mean grain size squared; 0 leaves boundaries flat.
    Time(f64),
    /// Until a step of time 0.1 (in the plane: 0.3) lessens the area by no more than [`Relaxation::LEAST_GAIN`] of it, or the residual of
    /// Herring's condition has not fallen, by three hundredths, for three steps. The step at which it was least is the result.
    ///
    /// [`relax`] lets no boundary vanish on the way and no neighbours switch, so this is the least area of this topology: where
    /// grains would rather switch neighbours, triple lines stay out of balance. [`relax_cells`] lets them.
    Equilibrium,
}

impl Relaxation {
    /// Change of area with a step, as a share of the area, that counts as equilibrium.
    pub const LEAST_GAIN: f64 = 3e-6;

    /// The usual time where the topology may change: eight steps with a look at what is short after each. The angles of random Voronoi
    /// grains spread by 5 degrees instead of 24, and one point in two hundred joins more than four.
    pub const USUAL: Self = Self::Time(1.2);

    fn check(self) -> Result<(), NetworkError> {
        match self {
            Self::Time(time) if !(time.is_finite() && time >= 0.0) => {
                Err(NetworkError::BadRelaxationTime(time))
            }
            Self::Time(_) | Self::Equilibrium => Ok(()),
        }
    }
}

impl Default for Relaxation {
    /// Time 0.3, the usual where the topology stays: the angles of random Voronoi grains spread by 7 degrees instead of 24.
    fn default() -> Self {
        Self::Time(USUAL_TIME)
    }
}

/// Whether grains keep their volumes (in the plane: areas).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Volumes {
    /// Each grain has the volume of its cell on the finest level.
    #[default]
    Kept,
    /// Grains grow and shrink as curvature has them: grain growth, as long as no boundary vanishes.
    Free,
}

/// Where a relaxation is after one of its steps.
#[derive(Clone, Copy)]
pub struct RelaxationStep<'a> {
    /// Steps done.
    pub done: usize,
    /// Steps in all.
    pub count: usize,
    /// Time passed under curvature flow with unit mobility, in units of the mean grain size squared. Levels follow each other:
    /// each finer one takes the whole time once more.
    pub time: f64,
    /// What moves now, and where it is.
    pub now: Moving<'a>,
}

/// What a step of a relaxation moves, where it is then.
#[derive(Clone, Copy)]
pub enum Moving<'a> {
    /// The points of one level of the network.
    Points {
        /// The level.
        level: usize,
        /// Where its points are.
        points: &'a [DVec3],
    },
    /// Cells while their topology changes. What this makes on demand are the cells, and where the control points of their network with
    /// [`FaceMesh::Fan`](crate::FaceMesh::Fan) are.
    Cells(&'a dyn Fn() -> (Tessellation, Vec<DVec3>)),
}

/// Where the control points are before a relaxation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Start {
    /// On the flat cells: coarse levels go first.
    Flat,
    /// Nearly where the control mesh has them at rest: a given time passes on the finest level that moves alone.
    Relaxed,
}

/// What relaxation gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxed {
    /// The finest level whose points were moved by themselves; those of finer ones follow by subdivision.
    pub level: usize,
    /// The points of that level.
    pub points: Vec<DVec3>,
    /// Steps taken.
    pub steps: usize,
    /// Time passed, as of [`RelaxationStep::time`].
    pub time: f64,
    /// Why the points of the level after that one did not move too, where they should have: then these are the last that were good.
    pub given_up: Vec<Attempt>,
    /// Whether no point moved: boundaries are as flat as the cells, and finer points lie midway between coarser ones.
    pub is_flat: bool,
}

impl Relaxed {
    /// The points of the network's finest level.
    ///
    /// # Panics
    /// When the network is not the one that was relaxed.
    pub fn finest_points(&self, network: &Network) -> Vec<DVec3> {
        if self.is_flat {
            return network.divide(&self.points);
        }
        network.subdivide_between(self.level, network.levels().len() - 1, &self.points)
    }
}

/// Relaxes a network from the given control points; on the finest level every grain keeps the volume of its cell.
///
/// `progress` is called after each step with the number of steps done and their total.
///
/// # Errors
/// [`NetworkError::BadRelaxationTime`]; [`NetworkError::Folded`] or [`NetworkError::VolumeNotRestored`] when the
/// network cannot be relaxed for so long without a change of its topology.
pub fn relax(
    network: &Network,
    control_points: &[DVec3],
    relaxation: &Relaxation,
    progress: impl Fn(usize, usize),
) -> Result<Relaxed, NetworkError> {
    relax_watched(network, control_points, relaxation, Volumes::Kept, |step| progress(step.done, step.count))
}

/// As [`relax`], with a choice about volumes, and the start and every step shown to `watch`.
///
/// # Errors
/// As of [`relax`].
pub fn relax_watched(
    network: &Network,
    control_points: &[DVec3],
    relaxation: &Relaxation,
    volumes: Volumes,
    watch: impl FnMut(RelaxationStep<'_>),
) -> Result<Relaxed, NetworkError> {
    relax_tuned(network, control_points, relaxation, volumes, &Tuning::default(), watch)
}

/// As [`relax_watched`], with other numbers than the tuned ones.
///
/// # Errors
/// As of [`relax`].
#[doc(hidden)]
pub fn relax_tuned(
    network: &Network,
    control_points: &[DVec3],
    relaxation: &Relaxation,
    volumes: Volumes,
    tuning: &Tuning,
    mut watch: impl FnMut(RelaxationStep<'_>),
) -> Result<Relaxed, NetworkError> {
    let tension_unit = network.mean_tension();
    let plan = Plan { relaxation: *relaxation, start: Start::Flat, volumes, tuning, tension_unit };
    relax_levels(network, control_points, &plan, &mut watch)
}

/// How to relax a network.
#[derive(Clone, Copy)]
struct Plan<'a> {
    relaxation: Relaxation,
    start: Start,
    volumes: Volumes,
    tuning: &'a Tuning,
    tension_unit: f64,
}

/// As [`relax_tuned`], by a plan.
fn relax_levels(
    network: &Network,
    control_points: &[DVec3],
    plan: &Plan<'_>,
    watch: &mut impl FnMut(RelaxationStep<'_>),
) -> Result<Relaxed, NetworkError> {
    let Plan { relaxation, start, volumes, tuning, tension_unit } = *plan;
    let is_in_space = matches!(network.control_mesh().mesh, Mesh::Triangles(_));
    let flow = |level: usize| {
        let flow = Flow::new(network, level, volumes, tension_unit, *tuning);
        match relaxation {
            // In the plane nothing holds a flow up: steps may be long.
            Relaxation::Equilibrium if is_in_space => flow.until_rest(),
            _ => flow,
        }
    };
    relaxation.check()?;
    let (time, finest) = match relaxation {
        Relaxation::Time(time) => (time, tuning.finest_moved),
        Relaxation::Equilibrium => (LONG_STEP, tuning.finest_balanced),
    };
    let has_tension = network.tensions().iter().any(|tension| *tension > 0.0);
    let mut points = control_points.to_vec();
    if time == 0.0 || !has_tension {
        // Cells that were regularised have lost the volumes that their grains are to have.
        if volumes == Volumes::Kept {
            flow(0).restore_lost_volumes(&mut points)?;
        }
        let is_flat = points == control_points;
        return Ok(Relaxed { level: 0, points, steps: 0, time: 0.0, given_up: Vec::new(), is_flat });
    }
    let last = (network.levels().len() - 1).min(finest);
    let whole_time = time * network.mean_grain_size().powi(2);
    let (first, first_steps) = match (volumes, start, relaxation) {
        (Volumes::Kept, Start::Relaxed, Relaxation::Time(_)) => (last, tuning.fine_steps),
        (Volumes::Kept, ..) => (0, tuning.coarse_steps),
        // Grains that grow do so for the time that was asked for, not once more on each level.
        (Volumes::Free, ..) => {
            let fewest = if is_in_space { tuning.coarse_steps } else { GROWTH_STEPS };
            let longest = USUAL_TIME / fewest as f64;
            let steps = (fewest..MOST_GROWTH_STEPS).find(|steps| time <= longest * *steps as f64);
            (last, steps.unwrap_or(MOST_GROWTH_STEPS))
        }
    };
    let steps = first_steps + (last - first) * tuning.fine_steps;
    watch(RelaxationStep {
        done: 0,
        count: steps,
        time: 0.0,
        now: Moving::Points { level: 0, points: control_points },
    });
    let mut done_before = 0;
    let mut passed = 0.0;
    // The level that the points are of, and whether they are good enough as they are.
    let (mut at, mut is_good) = (0, start == Start::Relaxed);
    for level in first..=last {
        let count = if level == first { first_steps } else { tuning.fine_steps };
        let end = if level == last { End::Finished } else { End::Open };
        let stage = match relaxation {
            Relaxation::Equilibrium if level == last => {
                let step_time = if is_in_space { REST_STEP / LONG_STEP * whole_time } else { whole_time };
                Stage { step_time, steps: REST_STEPS, least_gain: Relaxation::LEAST_GAIN, end }
            }
            _ => Stage { step_time: whole_time / count as f64, steps: count, least_gain: 0.0, end },
        };
        let begin = network.subdivide_between(at, level, &points);
        let before = passed;
        let mut show = |done: usize, points: &[DVec3]| {
            let time = before + done as f64 * time * (stage.step_time / whole_time);
            passed = time;
            watch(RelaxationStep {
                done: done_before + done,
                count: steps,
                time,
                now: Moving::Points { level, points },
            });
        };
        let run = flow(level).run(&begin, &stage, &mut show);
        done_before += count;
        match run {
            Ok(moved) => (points, at, is_good) = (moved, level, true),
            Err(error) if level == at || !is_good || !error.is_tangle() => return Err(error),
            Err(error) => {
                // Finer points fold where coarser ones do not: these will have to do.
                let end = Stage { step_time: 0.0, steps: 0, least_gain: 0.0, end: End::Finished };
                let mut attempts = Vec::new();
                error.give_up(format!("moving the points of level {level}"), &mut attempts);
                let run = flow(at).run(&points, &end, &mut |_, _| ());
                points = match run {
                    Ok(points) => points,
                    Err(error) => return Err(error.after(attempts)),
                };
                let steps = done_before - count;
                return Ok(Relaxed {
                    level: at,
                    points,
                    steps,
                    time: before,
                    given_up: attempts,
                    is_flat: false,
                });
            }
        }
    }
    if volumes == Volumes::Free {
        let volumes = network.grain_volumes(&network.levels()[last], &points);
        check_grains_are_left(network, &volumes, whole_time)?;
    }
    Ok(Relaxed { level: last, points, steps, time: passed, given_up: Vec::new(), is_flat: false })
}

/// Checks that no grain has shrunk to nothing by a time: it would have to vanish, and its neighbours to meet, for others to grow on as
/// they do.
fn check_grains_are_left(network: &Network, volumes: &[f64], time: f64) -> Result<(), NetworkError> {
    let least = LEAST_GRAIN * network.domain().measure() / volumes.len() as f64;
    match (0u32..).zip(volumes).find(|(_, volume)| volume.is_nan() || **volume < least) {
        Some((grain, _)) => {
            let time = time / network.mean_grain_size().powi(2);
            Err(NetworkError::GrainVanished { grain: GrainId(grain), time })
        }
        None => Ok(()),
    }
}

/// Where the points of a control mesh in space go in the usual time, as a forecast: volumes are right, triangles may be thin.
pub(crate) fn foreseen_points(
    network: &Network,
    control_points: &[DVec3],
    tuning: &Tuning,
) -> Result<Vec<DVec3>, NetworkError> {
    let steps = tuning.forecast_steps;
    let step_time = USUAL_TIME * network.mean_grain_size().powi(2) / steps as f64;
    let stage = Stage { step_time, steps, least_gain: 0.0, end: End::Volumes };
    let mut flow = Flow::new(network, 0, Volumes::Kept, network.mean_tension(), *tuning);
    flow.run(control_points, &stage, &mut |_, _| ())
}
