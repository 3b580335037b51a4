//! The best step of a flow to rest, and when no better one is worth waiting for.

use glam::DVec3;

/// Share of the residual by which it has to fall to count as progress: a step costs more than what less would gain.
const PROGRESS: f64 = 0.03;

/// Steps without progress that make an end. Where a place folds and unfolds, all gets worse for a step or two.
const PATIENCE: usize = 3;

/// How far a step is from rest: one without folds comes before all with some, then the residual of
/// Herring's condition counts.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub(crate) struct Defects {
    pub(crate) has_folds: bool,
    pub(crate) residual: f64,
}

/// The best step so far.
#[derive(Debug)]
pub(crate) struct Best {
    defects: Defects,
    /// Where the points were; none before the first step.
    points: Option<Vec<DVec3>>,
    /// The defects when progress was last made.
    milestone: Defects,
    steps_since: usize,
}

impl Best {
    pub(crate) fn new() -> Self {
        let worst = Defects { has_folds: true, residual: f64::INFINITY };
        Self { defects: worst, points: None, milestone: worst, steps_since: 0 }
    }

    /// Takes a further step into account.
    pub(crate) fn offer(&mut self, defects: Defects, points: &[DVec3]) {
        if defects < self.defects {
            self.defects = defects;
            self.points = Some(points.to_vec());
        }
        let enough = Defects { residual: (1.0 - PROGRESS) * self.milestone.residual, ..self.milestone };
        if defects < enough {
            self.milestone = defects;
            self.steps_since = 0;
        } else {
            self.steps_since += 1;
        }
    }

    /// Whether there has been no progress for so long that there will be none.
    pub(crate) fn is_final(&self) -> bool {
        self.steps_since >= PATIENCE
    }

    pub(crate) fn into_points(self) -> Option<Vec<DVec3>> {
        self.points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of steps taken until the end, and which one of them is the best.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "steps are few")]
    fn end(steps: &[(bool, f64)]) -> (usize, usize) {
        let mut best = Best::new();
        let mut taken = 0;
        for (step, (has_folds, residual)) in steps.iter().enumerate() {
            best.offer(Defects { has_folds: *has_folds, residual: *residual }, &[DVec3::splat(step as f64)]);
            taken = step + 1;
            if best.is_final() {
                break;
            }
        }
        (taken, best.into_points().expect("a step was taken")[0].x as usize)
    }

    #[test]
    fn slow_gains_make_an_end_and_are_kept() {
        assert_eq!(
            end(&[(false, 2.0), (false, 1.9), (false, 1.899), (false, 1.898), (false, 1.897), (false, 1.0)]),
            (5, 4)
        );
    }

    #[test]
    fn gains_that_add_up_are_progress() {
        let residuals: Vec<(bool, f64)> = (0..20).map(|k| (false, 2.0 * 0.988f64.powi(k))).collect();
        assert_eq!(end(&residuals), (20, 19));
    }

    #[test]
    fn a_step_without_folds_is_better_than_a_smaller_residual() {
        assert_eq!(end(&[(true, 1.0), (false, 3.0), (true, 0.5), (false, 3.1), (false, 3.2)]), (5, 1));
    }
}
