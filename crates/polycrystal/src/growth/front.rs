//! Boundaries that move for a time, in steps as long as their error allows, with events in between.

use cancellation::check_cancelled;
use glam::DVec3;
use voronoi::Tessellation;

use super::Vanished;
use crate::events::reconnection::Reconnections;
use crate::flow::boundary_flow::change_of_step;
use crate::flow::recipe::RelaxedCells;
use crate::flow::relaxation::{Moving, RelaxationStep};
use crate::{GrainId, Network, NetworkError};

/// The first step, and the least, in units of the mean grain size squared. What fails with the least is no matter of time.
const FIRST_STEP: f64 = 1e-3;
const LEAST_STEP: f64 = 1e-9;

/// All boundaries of some grains, in the plane or in space.
pub(super) trait Front {
    /// Where their points are.
    type Points;

    /// Where a step starts. Volumes (in the plane: areas) have the given mean.
    fn start(&mut self, mean: f64) -> Self::Points;

    /// Where a step by curvature leads.
    fn step(&self, start: &Self::Points, time: f64) -> Result<Self::Points, NetworkError>;

    /// Where two steps of half the time and one of the whole time lead together (Richardson): steps are exact to first order.
    fn extrapolated(&self, start: &Self::Points, halves: Self::Points, whole: &Self::Points) -> Self::Points;

    /// The volume of each grain.
    fn volumes(&self, points: &Self::Points) -> Vec<f64>;

    /// Goes where a step leads.
    fn take(&mut self, points: Self::Points);

    /// Lets all events happen that are due, given volumes and their mean.
    fn pass(&mut self, volumes: &[f64], mean: f64) -> Result<Happened, NetworkError>;

    /// The network as it is now, refined as it will be in the end, and its control points.
    fn network(&self) -> Result<(Network, Vec<DVec3>), NetworkError>;

    /// The grains in the end, after so many steps of a time in all.
    fn finish(
        self,
        steps: usize,
        reconnections: Reconnections,
        time: f64,
    ) -> Result<RelaxedCells, NetworkError>;
}

/// What has happened between two steps.
pub(super) struct Happened {
    pub(super) vanished: Vec<GrainId>,
    pub(super) reconnections: Reconnections,
}

/// What has happened in all.
#[derive(Default)]
pub(super) struct History {
    pub(super) steps: usize,
    pub(super) reconnections: Reconnections,
    pub(super) vanished: Vec<Vanished>,
}

/// Lets boundaries move for a time, in units of the mean grain size squared. `largest_error` is that of a grain's volume in a step, in units of the mean.
pub(super) fn advance<F: Front>(
    front: &mut F,
    cells: &Tessellation,
    whole_time: f64,
    largest_error: f64,
    watch: &mut dyn FnMut(RelaxationStep<'_>),
) -> Result<History, NetworkError> {
    let mut history = History::default();
    let domain = cells.domain();
    let mut volumes: Vec<f64> = cells.cell_measures().iter().map(|cell| cell.volume).collect();
    let grain_count = volumes.len();
    let mean_of = |history: &History| domain.measure() / (grain_count - history.vanished.len()) as f64;
    let square = |mean: f64| domain.dimension().cube_edge(mean).powi(2);
    let unit = square(mean_of(&history));
    let mut show = |front: &F, done: usize, left: f64, passed: f64| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "far fewer")]
        let count = done + left.ceil() as usize;
        let now = Moving::Grains(&|| front.network());
        watch(RelaxationStep { done, count, time: passed / unit, now });
    };
    front.start(mean_of(&history));
    show(front, 0, 1.0, 0.0);
    let whole_time = whole_time * unit;
    let (mut passed, mut step_time) = (0.0, FIRST_STEP * unit);
    loop {
        // At first too: points of more than three edges in the plane, and what is too short to move.
        let happened = front.pass(&volumes, mean_of(&history))?;
        let gone = happened.vanished.into_iter().map(|grain| Vanished { grain, time: passed / unit });
        history.vanished.extend(gone);
        history.reconnections.add(happened.reconnections);
        if history.steps > 0 {
            show(front, history.steps, (whole_time - passed) / step_time, passed);
        }
        if passed >= whole_time {
            return Ok(history);
        }
        let mean = mean_of(&history);
        let start = front.start(mean);
        let (time, end) = loop {
            check_cancelled();
            let time = step_time.min(whole_time - passed);
            let tried = front.step(&start, time).and_then(|whole| {
                let halves = front.step(&front.step(&start, 0.5 * time)?, 0.5 * time)?;
                Ok((whole, halves))
            });
            let (error, worst) = match &tried {
                Ok((whole, halves)) => largest_difference(&front.volumes(whole), &front.volumes(halves)),
                Err(_) => (f64::INFINITY, GrainId(0)),
            };
            step_time = time * change_of_step(error / (largest_error * mean));
            match tried {
                Ok((whole, halves)) if error <= largest_error * mean => {
                    break (time, front.extrapolated(&start, halves, &whole));
                }
                Err(error) if time < LEAST_STEP * square(mean) => return Err(error),
                Ok(_) if error.is_nan() || time < LEAST_STEP * square(mean) => {
                    return Err(NetworkError::GrowthNotFollowed { grain: worst, time: passed / unit });
                }
                _ => {}
            }
        };
        passed = if time < whole_time - passed { passed + time } else { whole_time };
        history.steps += 1;
        volumes = front.volumes(&end);
        front.take(end);
    }
}

/// The largest difference between two volumes of a grain, and whose it is.
fn largest_difference(some: &[f64], others: &[f64]) -> (f64, GrainId) {
    let differences = some.iter().zip(others).map(|(one, other)| (one - other).abs());
    let differences = differences.zip((0u32..).map(GrainId));
    differences.max_by(|one, other| one.0.total_cmp(&other.0)).unwrap_or((0.0, GrainId(0)))
}
