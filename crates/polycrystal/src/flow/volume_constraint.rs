//! Grain volumes as linear constraints on the displacement of groups of tied points.

use glam::DVec3;
use rayon::prelude::*;

use crate::solver::conjugate_gradients::{Limits, solve};
use crate::solver::multigrid::Multigrid;
use crate::solver::rows::{CsrRows, NewRow};
use crate::{Freedom, GrainId};

/// Most iterations. Without rounding as many as there are grains are enough; where rigid parts leave a grain no way to
/// change its volume there is no solution, and going on would only blow up what rounding leaves.
const ITERATIONS: usize = 2000;

/// Length of a sum of gradients, as a share of the sum of all lengths at a group, that is rounding.
const CANCELLED: f64 = 1e-13;

/// The same in units of the last place of the points times the root of that sum, which is the size of what moves: where that is small, points
/// are coarse. Sums of some hundred gradients stay below 10.
const COARSE: f64 = 30.0;

/// How little all grains give way to one pressure, as a share of how they do to their own, where walls hold them: rounding leaves less than
/// [`CANCELLED`] of it, a free surface of a thousandth of all boundaries a thousandth.
const HELD: f64 = 1e-9;

/// Grains whose volumes one task sums up.
const GRAINS_PER_TASK: usize = 64;

/// How the volumes of grains change when groups move: a sparse matrix J with a vector for each group and grain.
pub(crate) struct VolumeConstraint {
    /// Of each group, its grains and the gradients of their volumes.
    by_group: CsrRows<DVec3>,
    /// Of each grain, its groups and the gradients of its volume.
    by_grain: CsrRows<DVec3>,
}

impl VolumeConstraint {
    /// That of so many grains, given [`Self::by_group`].
    pub(crate) fn new(by_group: CsrRows<DVec3>, grain_count: usize) -> Self {
        let by_grain = by_group.transposed(grain_count);
        Self { by_group, by_grain }
    }

    /// Of groups with these freedoms the grains and the gradients of their volumes: `fill` adds up those of a group. `rounding` is a last place
    /// of the points.
    pub(crate) fn by_group(
        freedoms: &[Freedom],
        rounding: f64,
        fill: impl Fn(usize, &mut VolumeGradients<'_, '_>) + Sync,
    ) -> CsrRows<DVec3> {
        let row = |group: usize, row: &mut NewRow<'_, DVec3>| {
            let mut volume_gradients = VolumeGradients { row, length: 0.0 };
            fill(group, &mut volume_gradients);
            volume_gradients.finish(rounding, freedoms[group]);
        };
        CsrRows::made_by(freedoms.len(), row)
    }

    /// The change of each grain's volume under displacements, given group by group: `J d`.
    pub(crate) fn volume_change(&self, displacement: impl Fn(usize) -> DVec3 + Sync) -> Vec<f64> {
        let change = |grain: usize| {
            let row = self.by_grain.row(grain).iter();
            row.map(|(group, gradient)| gradient.dot(displacement(*group as usize))).sum()
        };
        (0..self.by_grain.len()).into_par_iter().with_min_len(GRAINS_PER_TASK).map(change).collect()
    }

    /// The force of the grains' pressures on a group: a row of `J^T p`.
    #[inline]
    pub(crate) fn force(&self, pressures: &[f64], group: usize) -> DVec3 {
        let row = self.by_group.row(group).iter();
        row.map(|(grain, gradient)| *gradient * pressures[*grain as usize]).sum()
    }

    /// `J D J^T` for groups that move by D under a force of one.
    pub(crate) fn compliance(&self, mobility: &[f64]) -> Compliance {
        let row = |grain: usize, row: &mut NewRow<'_, f64>| {
            for (group, gradient) in self.by_grain.row(grain) {
                let moved = *gradient * mobility[*group as usize];
                for (other, gradient) in self.by_group.row(*group as usize) {
                    row.add(*other, moved.dot(*gradient));
                }
            }
        };
        Compliance::new(CsrRows::made_by(self.by_grain.len(), row))
    }
}

/// The gradients of the volumes of a group, grain by grain, as they add up.
pub(crate) struct VolumeGradients<'a, 'b> {
    row: &'a mut NewRow<'b, DVec3>,
    /// The sum of all lengths.
    length: f64,
}

impl VolumeGradients<'_, '_> {
    /// Adds to the gradient of a grain's volume.
    #[inline]
    pub(crate) fn add(&mut self, grain: GrainId, gradient: DVec3) {
        self.length += gradient.length();
        self.row.add(grain.0, gradient);
    }

    /// Leaves what counts where the group can move. A grain that moves as a whole keeps its volume: no pressure may push against what
    /// rounding leaves.
    fn finish(self, rounding: f64, freedom: Freedom) {
        let cancelled = CANCELLED * self.length + COARSE * rounding * self.length.sqrt();
        self.row.filter_map(|gradient| (gradient.length() > cancelled).then(|| freedom.project(*gradient)));
    }
}

/// How the volumes of grains answer to pressures: a symmetric matrix over the grains.
pub(crate) struct Compliance {
    grids: Multigrid,
    diagonal: Vec<f64>,
    /// The sum of the diagonal.
    total: f64,
    /// Whether the same pressure everywhere moves nothing, as walls hold the whole outer surface: there is none at pores.
    is_held: bool,
}

impl Compliance {
    /// That of a symmetric, positive semidefinite matrix.
    fn new(matrix: CsrRows<f64>) -> Self {
        let diagonal = matrix.diagonal();
        // Where nothing can move there is nothing to share out.
        let total = diagonal.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let row_sum = |grain: usize| matrix.row(grain).iter().map(|(_, value)| value).sum::<f64>().abs();
        let is_held = (0..matrix.len()).map(row_sum).sum::<f64>() <= HELD * total;
        Self { grids: Multigrid::new(matrix), diagonal, total, is_held }
    }

    /// The pressures that bring about the given changes of volume, up to an error of this share.
    pub(crate) fn pressures(&self, changes: &[f64], tolerance: f64) -> Vec<f64> {
        // A total other than zero, which rounding leaves, has no answer where walls hold and would grow without bound. Grains take it as they
        // give way: one far smaller than the others may be smaller than their rounding.
        let share = if self.is_held { changes.iter().sum::<f64>() / self.total } else { 0.0 };
        let balanced: Vec<f64> =
            changes.iter().zip(&self.diagonal).map(|(change, own)| change - share * own).collect();
        let limits = Limits { tolerance, steps: ITERATIONS.min(2 * changes.len() + 20) };
        let precondition = |residual: &[f64]| self.grids.precondition(residual);
        solve(|vector| self.grids.apply(vector), precondition, &balanced, &limits)
    }
}
