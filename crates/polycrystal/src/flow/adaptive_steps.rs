//! Steps as long as the error of volumes allows.

use cancellation::check_cancelled;
use glam::DVec3;

use crate::{GrainId, NetworkError};

/// The first step, in units of the mean grain size squared.
const FIRST_STEP: f64 = 1e-3;

/// Share of the largest error that the next step is to have, and the most that it is longer or shorter than the one before (Hairer, Norsett and
/// Wanner 1993, section II.4).
const SAFETY: f64 = 0.8;
const LARGEST_CHANGE: f64 = 2.0;
const LEAST_CHANGE: f64 = 0.3;

/// Boundaries that move in steps exact to first order.
pub(crate) trait Evolution: Sync {
    /// Where their points are.
    type Points: Send + Sync;

    /// Where a step leads.
    fn step(&self, start: &Self::Points, time: f64) -> Result<Self::Points, NetworkError>;

    /// Where two steps of half the time and one of the whole time lead together (Richardson).
    fn extrapolated(&self, start: &Self::Points, halves: Self::Points, whole: &Self::Points) -> Self::Points;

    /// The volume of each grain, in the plane its area.
    fn volumes(&self, points: &Self::Points) -> Vec<f64>;
}

/// Where points go that two steps of half the time and one of the whole time have led to.
pub(crate) fn extrapolated(halves: &[DVec3], whole: &[DVec3]) -> Vec<DVec3> {
    halves.iter().zip(whole).map(|(halves, whole)| *halves + (*halves - *whole)).collect()
}

/// Steps through a time.
pub(crate) struct AdaptiveSteps {
    /// The square of the mean grain size.
    unit: f64,
    whole_time: f64,
    passed: f64,
    /// The next step, as far as the last one tells.
    next: f64,
    taken: usize,
}

impl AdaptiveSteps {
    /// Steps through a time in units of the mean grain size squared.
    pub(crate) fn new(time: f64, mean_grain_size: f64) -> Self {
        let unit = mean_grain_size.powi(2);
        Self { unit, whole_time: time * unit, passed: 0.0, next: FIRST_STEP * unit, taken: 0 }
    }

    pub(crate) fn are_over(&self) -> bool {
        self.passed >= self.whole_time
    }

    /// The time that has passed, in units of the mean grain size squared.
    pub(crate) fn time(&self) -> f64 {
        self.passed / self.unit
    }

    /// Steps taken.
    pub(crate) fn taken(&self) -> usize {
        self.taken
    }

    /// Steps taken and those that are left, as far as the last one tells.
    pub(crate) fn count(&self) -> usize {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "far fewer")]
        let left = ((self.whole_time - self.passed) / self.next).ceil() as usize;
        self.taken + left
    }

    /// Where the longest step leads after which the volume of each grain differs from that after two of half its time by no more than the largest
    /// error of a grain of that volume.
    ///
    /// # Errors
    /// Of the step that would have to be shorter than the least time; [`NetworkError::GrowthNotFollowed`] where its error is too large.
    pub(crate) fn take<M: Evolution>(
        &mut self,
        motion: &M,
        start: &M::Points,
        largest_error: impl Fn(f64) -> f64,
        least_time: f64,
    ) -> Result<M::Points, NetworkError> {
        loop {
            check_cancelled();
            let left = self.whole_time - self.passed;
            let time = self.next.min(left);
            // Growth takes many steps of few grains: inside one of them threads have little to share.
            let (whole, halves) = rayon::join(
                || motion.step(start, time),
                || motion.step(&motion.step(start, 0.5 * time)?, 0.5 * time),
            );
            let tried = whole.and_then(|whole| Ok((whole, halves?)));
            let (error, worst) = match &tried {
                Ok((whole, halves)) => {
                    largest_share(&motion.volumes(whole), &motion.volumes(halves), &largest_error)
                }
                Err(_) => (f64::INFINITY, GrainId(0)),
            };
            self.next = time * (SAFETY / error).sqrt().clamp(LEAST_CHANGE, LARGEST_CHANGE);
            let is_least = self.next < least_time;
            match tried {
                Ok((whole, halves)) if error <= 1.0 => {
                    self.passed = if time < left { self.passed + time } else { self.whole_time };
                    self.taken += 1;
                    return Ok(motion.extrapolated(start, halves, &whole));
                }
                Err(error) if is_least => return Err(error),
                Ok(_) if error.is_nan() || is_least => {
                    return Err(NetworkError::GrowthNotFollowed { grain: worst, time: self.time() });
                }
                _ => {}
            }
        }
    }
}

/// The largest difference between two volumes of a grain, as a share of the largest error, and whose it is.
fn largest_share(whole: &[f64], halves: &[f64], largest_error: impl Fn(f64) -> f64) -> (f64, GrainId) {
    let share = |(whole, halves): (&f64, &f64)| {
        // Grains that have vanished stay as they are.
        if whole == halves { 0.0 } else { (whole - halves).abs() / largest_error(*halves) }
    };
    let shares = whole.iter().zip(halves).map(share).zip((0u32..).map(GrainId));
    shares.max_by(|one, other| one.0.total_cmp(&other.0)).unwrap_or((0.0, GrainId(0)))
}
