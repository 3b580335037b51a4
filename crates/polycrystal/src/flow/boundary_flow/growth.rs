//! Grains that grow.

use glam::DVec3;

use super::{End, Flow};
use crate::flow::adaptive_steps::{AdaptiveSteps, Evolution, extrapolated};
use crate::{GrainId, NetworkError};

/// Largest difference between the volumes of a grain after a step and after two of half its time, as a share. What the two of them extrapolate
/// to is better by far: the rate of a ball that shrinks is off by 0.9 % for its 162 points, and 1.6 % with 2e-2.
const LARGEST_ERROR: f64 = 5e-3;

/// Volume of a grain, in units of the mean, below which it has shrunk to nothing: with three sides it would last in the plane for a third of that,
/// in units of time. With 1e-3, growth of 374 grains in space to 167 takes 1.4 times as long, and where none can vanish, what is held of one that is folded may
/// be larger.
pub(crate) const LEAST_GRAIN: f64 = 2e-3;

/// The least step, in units of the square of the smallest grain's radius: where it fails, a grain or a boundary is about to vanish.
const LEAST_STEP: f64 = 1e-4;

impl Flow<'_> {
    /// Lets grains grow for a time, in units of the mean grain size squared.
    ///
    /// `progress` is told the steps and where the points are, before the first one too.
    ///
    /// # Errors
    /// [`NetworkError::GrainVanished`]; [`NetworkError::GrowthNotFollowed`]; [`NetworkError::Folded`] in the end.
    pub(crate) fn grow(
        &self,
        start: &[DVec3],
        time: f64,
        progress: &mut dyn FnMut(&AdaptiveSteps, &[DVec3]),
    ) -> Result<Vec<DVec3>, NetworkError> {
        let domain = self.network.domain();
        let mean = domain.measure() / self.network.grains_left() as f64;
        let mut points = start.to_vec();
        let mut steps = AdaptiveSteps::new(time, self.network.mean_grain_size());
        progress(&steps, &points);
        let (mut grain, mut least) = self.smallest(&points);
        while !steps.are_over() {
            let least_time = LEAST_STEP * (0.5 * domain.dimension().ball_diameter(least)).powi(2);
            points = match steps.take(self, &points, |volume| LARGEST_ERROR * volume.abs(), least_time) {
                Err(NetworkError::Folded { .. }) => {
                    return Err(NetworkError::GrowthNotFollowed { grain, time: steps.time() });
                }
                taken => taken?,
            };
            (grain, least) = self.smallest(&points);
            // Its neighbours would have to meet for others to grow on as they do.
            if least < LEAST_GRAIN * mean {
                return Err(NetworkError::GrainVanished { grain, time: steps.time() });
            }
            progress(&steps, &points);
        }
        self.finished(points, start, End::Finished, &self.finest_sectors())
    }

    /// The smallest of the grains that have not vanished before, and its volume.
    fn smallest(&self, points: &Vec<DVec3>) -> (GrainId, f64) {
        let volumes = (0u32..).map(GrainId).zip(self.volumes(points));
        let left = volumes.filter(|(grain, _)| self.network.cell_volumes()[grain.index()] > 0.0);
        left.min_by(|one, other| one.1.total_cmp(&other.1)).expect("a grain is left")
    }
}

impl Evolution for Flow<'_> {
    type Points = Vec<DVec3>;

    fn step(&self, start: &Vec<DVec3>, time: f64) -> Result<Vec<DVec3>, NetworkError> {
        let mut points = start.clone();
        self.take_step(&mut points, &mut self.refined(start), time)?;
        Ok(points)
    }

    fn extrapolated(&self, start: &Vec<DVec3>, halves: Vec<DVec3>, whole: &Vec<DVec3>) -> Vec<DVec3> {
        let end = extrapolated(&halves, whole);
        let [before, after] = [start, &end].map(|points| self.refined(points));
        if self.broken_elements(&before, &after).is_empty() { end } else { halves }
    }

    fn volumes(&self, points: &Vec<DVec3>) -> Vec<f64> {
        self.network.grain_volumes(self.surface(), &self.refined(points))
    }
}
