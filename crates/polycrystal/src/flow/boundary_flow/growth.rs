//! Grains that grow, in steps as long as their error allows.

use glam::DVec3;

use super::{End, Flow};
use crate::flow::relaxation::{TIME_OF_KEPT_TOPOLOGY, check_grains_are_left};
use crate::{GrainId, NetworkError};

/// Largest difference between the volumes of a grain after a step and after two of half its time, as a share. What the two of them extrapolate
/// to is better by far: the rate of a ball that shrinks is then right to half a hundredth.
const LARGEST_ERROR: f64 = 5e-3;

/// Share of the largest error that the next step is to have, and the most that it is longer or shorter than the one before (Hairer, Norsett and
/// Wanner 1993, section II.4).
const SAFETY: f64 = 0.8;
const LARGEST_CHANGE: f64 = 2.0;
const LEAST_CHANGE: f64 = 0.3;

/// The first step, in units of the square of the smallest grain's radius.
const FIRST_STEP: f64 = 0.02;

/// The least step in the same unit: where it fails, a grain or a boundary is about to vanish.
const LEAST_STEP: f64 = 1e-4;

/// The factor by which the next step is longer, given the error of a step in units of the largest: steps are exact to first order.
pub(crate) fn change_of_step(error: f64) -> f64 {
    (SAFETY / error).sqrt().clamp(LEAST_CHANGE, LARGEST_CHANGE)
}

/// Where points are after a step, and the volumes of grains there.
struct Trial {
    points: Vec<DVec3>,
    volumes: Vec<f64>,
    /// As [`LARGEST_ERROR`] has it.
    error: f64,
    /// The grain that has it.
    worst: GrainId,
}

/// How far growth has come.
pub(crate) struct Grown<'a> {
    pub(crate) steps: usize,
    /// Steps that are left, as far as the last one tells.
    pub(crate) left: usize,
    pub(crate) passed: f64,
    pub(crate) points: &'a [DVec3],
}

impl Flow<'_> {
    /// Lets grains grow for a time. Each step is taken at once and in halves, and extrapolated (Richardson), as steps are exact to first order.
    ///
    /// # Errors
    /// [`NetworkError::GrainVanished`]; [`NetworkError::GrowthNotFollowed`]; [`NetworkError::Folded`].
    pub(crate) fn grow(
        &self,
        start: &[DVec3],
        whole_time: f64,
        progress: &mut dyn FnMut(Grown<'_>),
    ) -> Result<Vec<DVec3>, NetworkError> {
        let longest =
            TIME_OF_KEPT_TOPOLOGY / self.tuning.coarse_steps as f64 * self.network.mean_grain_size().powi(2);
        let mut points = start.to_vec();
        let mut square = self.least_square(&self.volumes_at(&points));
        let mut step_time = FIRST_STEP * square;
        let (mut passed, mut steps) = (0.0, 0);
        while passed < whole_time {
            let left = whole_time - passed;
            let is_last = step_time.min(longest) >= left;
            let time = if is_last { left } else { step_time.min(longest) };
            let trial = self.try_step(&points, time);
            let error = trial.as_ref().map_or(f64::INFINITY, |trial| trial.error);
            step_time = time * change_of_step(error / LARGEST_ERROR);
            match trial {
                Ok(trial) if error <= LARGEST_ERROR => {
                    passed = if is_last { whole_time } else { passed + time };
                    check_grains_are_left(self.network, &trial.volumes, passed)?;
                    square = self.least_square(&trial.volumes);
                    points = trial.points;
                    steps += 1;
                    let left = ((whole_time - passed) / step_time.min(longest)).ceil();
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "far fewer")]
                    progress(Grown { steps, left: left as usize, passed, points: &points });
                }
                _ if step_time >= LEAST_STEP * square => {}
                Ok(Trial { worst, .. }) => {
                    let time = passed / self.network.mean_grain_size().powi(2);
                    let error = NetworkError::GrowthNotFollowed { grain: worst, time };
                    return Err(self.vanishing(&points, passed, longest).unwrap_or(error));
                }
                Err(error) => return Err(self.vanishing(&points, passed, longest).unwrap_or(error)),
            }
        }
        self.finished(points, start, End::Finished, &self.finest_sectors())
    }

    /// A step at once and in halves, and where both lead together.
    fn try_step(&self, points: &[DVec3], time: f64) -> Result<Trial, NetworkError> {
        let mut at_once = points.to_vec();
        self.step(&mut at_once, &mut self.refined(points), time)?;
        let mut halves = points.to_vec();
        let mut surface = self.refined(points);
        self.step(&mut halves, &mut surface, 0.5 * time)?;
        self.step(&mut halves, &mut surface, 0.5 * time)?;
        let volumes = self.volumes_at(&halves);
        let differences = self.volumes_at(&at_once).into_iter().zip(&volumes).map(|(whole, halves)| {
            let error = (whole / halves - 1.0).abs();
            // A volume of nothing is no number to compare with.
            if error.is_nan() { f64::INFINITY } else { error }
        });
        let worst = (0u32..).zip(differences).max_by(|one, other| one.1.total_cmp(&other.1));
        let (worst, error) = worst.map_or((GrainId(0), 0.0), |(grain, error)| (GrainId(grain), error));
        let extrapolated: Vec<DVec3> =
            halves.iter().zip(&at_once).map(|(halves, once)| *halves + (*halves - *once)).collect();
        let [before, after] = [points, &extrapolated].map(|points| self.refined(points));
        let is_broken = !self.broken_elements(&before, &after).is_empty();
        if is_broken {
            return Ok(Trial { points: halves, volumes, error, worst });
        }
        let volumes = self.volumes_at(&extrapolated);
        Ok(Trial { points: extrapolated, volumes, error, worst })
    }

    /// The square of the smallest grain's radius.
    fn least_square(&self, volumes: &[f64]) -> f64 {
        let least = volumes.iter().copied().fold(f64::INFINITY, f64::min).max(0.0);
        (0.5 * self.network.domain().dimension().ball_diameter(least)).powi(2)
    }
}
