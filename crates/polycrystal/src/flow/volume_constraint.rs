//! Grain volumes as linear constraints on the displacement of groups of tied points.

use glam::DVec3;
use rayon::prelude::*;

use crate::GrainId;
use crate::flow::mobility::Mobility;
use crate::solver::conjugate_gradients::{Limits, solve};
use crate::solver::multigrid::Multigrid;
use crate::solver::rows::CsrRows;

/// Most iterations. Without rounding as many as there are grains are enough; where rigid parts leave a grain no way to
/// change its volume there is no solution, and going on would only blow up what rounding leaves.
const ITERATIONS: usize = 2000;

/// Length of a sum of gradients, as a share of the sum of all lengths at a group, that is rounding.
const CANCELLED: f64 = 1e-13;

/// The same in units of the last place of the points times the root of that sum, which is the size of what moves: where that is small, points
/// are coarse. Sums of some hundred gradients stay below 10.
const COARSE: f64 = 30.0;

/// How the volumes of grains change when groups move: a sparse matrix J with a vector for each group and grain.
pub(crate) struct VolumeConstraint {
    /// Of each group, its grains and the gradients of their volumes.
    by_group: CsrRows<DVec3>,
    /// Of each grain, its groups and the gradients of its volume.
    by_grain: CsrRows<DVec3>,
}

impl VolumeConstraint {
    /// That of so many groups and grains: `fill` adds up the gradients of a group. `rounding` is a last place of the points.
    pub(crate) fn new(
        group_count: usize,
        grain_count: usize,
        rounding: f64,
        fill: impl Fn(usize, &mut VolumeGradients<'_>) + Sync,
    ) -> Self {
        let row = |group: usize, entries: &mut Vec<(u32, DVec3)>| {
            let mut volume_gradients = VolumeGradients { start: entries.len(), entries, length: 0.0 };
            fill(group, &mut volume_gradients);
            volume_gradients.drop_rounding(rounding);
        };
        let by_group = CsrRows::made_by(group_count, row);
        let by_grain = by_group.transposed(grain_count);
        Self { by_group, by_grain }
    }

    /// The change of each grain's volume under a displacement: `J d`.
    pub(crate) fn volume_change(&self, displacement: &[DVec3]) -> Vec<f64> {
        let change = |grain: usize| {
            let row = self.by_grain.row(grain).iter();
            row.map(|(group, gradient)| gradient.dot(displacement[*group as usize])).sum()
        };
        (0..self.by_grain.len()).into_par_iter().map(change).collect()
    }

    /// The force of the grains' pressures on a group: a row of `J^T p`.
    pub(crate) fn force(&self, pressures: &[f64], group: usize) -> DVec3 {
        let row = self.by_group.row(group).iter();
        row.map(|(grain, gradient)| *gradient * pressures[*grain as usize]).sum()
    }

    /// `J D J^T` for the mobility D of the groups.
    pub(crate) fn compliance(&self, mobility: &[Mobility]) -> Compliance {
        let row = |grain: usize, entries: &mut Vec<(u32, f64)>| {
            let start = entries.len();
            for (group, gradient) in self.by_grain.row(grain) {
                let moved = mobility[*group as usize].of(*gradient);
                for (other, gradient) in self.by_group.row(*group as usize) {
                    let change = moved.dot(*gradient);
                    match entries[start..].iter_mut().find(|(known, _)| known == other) {
                        Some((_, sum)) => *sum += change,
                        None => entries.push((*other, change)),
                    }
                }
            }
        };
        Compliance::new(CsrRows::made_by(self.by_grain.len(), row))
    }
}

/// The gradients of the volumes of a group, grain by grain, as they add up.
pub(crate) struct VolumeGradients<'a> {
    entries: &'a mut Vec<(u32, DVec3)>,
    start: usize,
    /// The sum of all lengths.
    length: f64,
}

impl VolumeGradients<'_> {
    /// Adds to the gradient of a grain's volume.
    pub(crate) fn add(&mut self, grain: GrainId, gradient: DVec3) {
        self.length += gradient.length();
        match self.entries[self.start..].iter_mut().find(|(known, _)| *known == grain.0) {
            Some((_, sum)) => *sum += gradient,
            None => self.entries.push((grain.0, gradient)),
        }
    }

    /// A grain that moves as a whole keeps its volume: no pressure may push against what rounding leaves.
    fn drop_rounding(self, rounding: f64) {
        let cancelled = CANCELLED * self.length + COARSE * rounding * self.length.sqrt();
        for at in (self.start..self.entries.len()).rev() {
            if self.entries[at].1.length() <= cancelled {
                self.entries.remove(at);
            }
        }
    }
}

/// How the volumes of grains answer to pressures: a symmetric matrix over the grains.
pub(crate) struct Compliance {
    grids: Multigrid,
    diagonal: Vec<f64>,
    /// The sum of the diagonal.
    total: f64,
}

impl Compliance {
    /// That of a symmetric, positive semidefinite matrix.
    fn new(matrix: CsrRows<f64>) -> Self {
        let diagonal = matrix.diagonal();
        // Where nothing can move there is nothing to share out.
        let total = diagonal.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        Self { grids: Multigrid::new(matrix), diagonal, total }
    }

    /// The pressures that bring about the given changes of volume, up to an error of this share.
    pub(crate) fn pressures(&self, changes: &[f64], tolerance: f64) -> Vec<f64> {
        // The same pressure everywhere moves nothing, as the walls hold: a total other than zero, which rounding leaves,
        // has no answer and would grow without bound. Grains take it as they give way: one far smaller than the others may be
        // smaller than their rounding.
        let share = changes.iter().sum::<f64>() / self.total;
        let balanced: Vec<f64> =
            changes.iter().zip(&self.diagonal).map(|(change, own)| change - share * own).collect();
        let limits = Limits { tolerance, steps: ITERATIONS.min(2 * changes.len() + 20) };
        let precondition = |residual: &[f64]| self.grids.precondition(residual);
        solve(|vector| self.grids.apply(vector), precondition, &balanced, &limits)
    }
}
