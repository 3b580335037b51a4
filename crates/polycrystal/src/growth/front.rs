//! Boundaries that move for a time, in steps as long as their error allows, with events in between.

use glam::DVec3;
use voronoi::Tessellation;

use super::Vanished;
use crate::events::reconnection::Reconnections;
use crate::flow::adaptive_steps::{AdaptiveSteps, Evolution};
use crate::flow::recipe::RelaxedCells;
use crate::flow::relaxation::{Moving, RelaxationStep};
use crate::{GrainId, Network, NetworkError};

/// The least step, in units of the mean grain size squared. What fails with it is no matter of time.
const LEAST_STEP: f64 = 1e-9;

/// All boundaries of some grains, in the plane or in space.
pub(super) trait Front: Evolution {
    /// Where a step starts. Volumes (in the plane: areas) have the given mean.
    fn start(&mut self, mean: f64) -> Self::Points;

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
    let size = domain.dimension().cube_edge(mean_of(&history));
    let mut steps = AdaptiveSteps::new(whole_time, size);
    let mut show = |front: &F, steps: &AdaptiveSteps| {
        let now = Moving::Grains(&|| front.network());
        watch(RelaxationStep { done: steps.taken(), count: steps.count(), time: steps.time(), now });
    };
    front.start(mean_of(&history));
    show(front, &steps);
    loop {
        // At first too: points of more than three edges in the plane, and what is too short to move.
        let happened = front.pass(&volumes, mean_of(&history))?;
        let gone = happened.vanished.into_iter().map(|grain| Vanished { grain, time: steps.time() });
        history.vanished.extend(gone);
        history.reconnections.add(happened.reconnections);
        if steps.taken() > 0 {
            show(front, &steps);
        }
        if steps.are_over() {
            history.steps = steps.taken();
            return Ok(history);
        }
        let mean = mean_of(&history);
        let start = front.start(mean);
        let end = steps.take(front, &start, |_| largest_error * mean, LEAST_STEP * size.powi(2))?;
        volumes = front.volumes(&end);
        front.take(end);
    }
}
