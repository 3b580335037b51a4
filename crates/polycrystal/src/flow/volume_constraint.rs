//! Grain volumes as linear constraints on the displacement of groups of tied points.

use glam::DVec3;
use rayon::prelude::*;
use smallvec::SmallVec;

use crate::mesh::disjoint_sets::DisjointSets;
use crate::solver::conjugate_gradients::{Limits, solve};
use crate::solver::multigrid::Multigrid;
use crate::solver::rows::{CsrRows, NewRow};
use crate::{Freedom, GrainId};

/// Most iterations: where rigid parts leave a grain no way to change its volume there is no solution, and with many grains the usual limit would take
/// minutes.
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
///
/// Its grains are in the order in which groups come to them: groups that follow each other lie side by side, grains need not, and what a grain is asked for
/// would come from all over the memory.
pub(crate) struct VolumeConstraint {
    /// Of each group, its grains and the gradients of their volumes.
    by_group: CsrRows<DVec3>,
    /// Of each grain, its groups and the gradients of its volume.
    by_grain: CsrRows<DVec3>,
    /// The place in this order of each of the network's grains.
    places: Vec<u32>,
}

impl VolumeConstraint {
    /// That of so many grains, given [`Self::by_group`].
    pub(crate) fn new(mut by_group: CsrRows<DVec3>, grain_count: usize) -> Self {
        const NONE: u32 = u32::MAX;
        let mut places = vec![NONE; grain_count];
        let mut next = 0..;
        let mut number = |place: &mut u32| {
            if *place == NONE {
                *place = next.next().expect("ids fit 32 bits");
            }
        };
        by_group.columns().for_each(|grain| number(&mut places[grain as usize]));
        places.iter_mut().for_each(number);
        by_group.renumber_columns(&places);
        let by_grain = by_group.transposed(grain_count);
        Self { by_group, by_grain, places }
    }

    /// What each of the network's grains has, in the order of this matrix.
    pub(crate) fn in_order(&self, of_grains: &[f64]) -> Vec<f64> {
        let mut ordered = vec![0.0; of_grains.len()];
        self.places.iter().zip(of_grains).for_each(|(place, value)| ordered[*place as usize] = *value);
        ordered
    }

    /// What grains in the order of this matrix have, in that of the network.
    pub(crate) fn of_grains(&self, ordered: &[f64]) -> Vec<f64> {
        self.places.iter().map(|place| ordered[*place as usize]).collect()
    }

    /// The place of a grain in the order of this matrix.
    pub(crate) fn place(&self, grain: GrainId) -> usize {
        self.places[grain.index()] as usize
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

    /// The change of each grain's volume, in the order of this matrix, under displacements, given group by group: `J d`.
    pub(crate) fn volume_change(&self, displacement: impl Fn(usize) -> DVec3 + Sync) -> Vec<f64> {
        let change = |grain: usize| {
            let row = self.by_grain.row(grain).iter();
            row.map(|(group, gradient)| gradient.dot(displacement(*group as usize))).sum()
        };
        (0..self.by_grain.len()).into_par_iter().with_min_len(GRAINS_PER_TASK).map(change).collect()
    }

    /// The force of the grains' pressures, in the order of this matrix, on a group: a row of `J^T p`.
    #[inline]
    pub(crate) fn force(&self, pressures: &[f64], group: usize) -> DVec3 {
        let row = self.by_group.row(group).iter();
        row.map(|(grain, gradient)| *gradient * pressures[*grain as usize]).sum()
    }

    /// `J D J^T` for groups that move by D under a force of one.
    pub(crate) fn compliance(&self, mobility: &[f64]) -> Compliance {
        let row = |grain: usize, row: &mut NewRow<'_, f64>| {
            // All products before any sum: groups come from all over the memory, and to look for a column waits for each of them.
            let mut products: SmallVec<[_; 256]> = SmallVec::new();
            for (group, gradient) in self.by_grain.row(grain) {
                let moved = *gradient * mobility[*group as usize];
                let others = self.by_group.row(*group as usize).iter();
                products.extend(others.map(|(other, gradient)| (*other, moved.dot(*gradient))));
            }
            products.into_iter().for_each(|(other, product)| row.add(other, product));
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

/// How the volumes of grains answer to pressures: a symmetric matrix over the grains, in the order of their [`VolumeConstraint`].
pub(crate) struct Compliance {
    grids: Multigrid,
    diagonal: Vec<f64>,
    /// Of each grain, the number of its part.
    parts: Vec<u32>,
    /// Of each part, the sum of its diagonal; none where the same pressure in all of it moves something: pores do, walls hold the whole outer
    /// surface.
    held: Vec<Option<f64>>,
}

impl Compliance {
    /// That of a symmetric, positive semidefinite matrix.
    fn new(matrix: CsrRows<f64>) -> Self {
        let diagonal = matrix.diagonal();
        let mut parts = DisjointSets::new(matrix.len());
        for (grain, row) in (0u32..).zip((0..matrix.len()).map(|grain| matrix.row(grain))) {
            row.iter().for_each(|(other, _)| parts.join(grain, *other));
        }
        let (parts, count) = parts.numbers();
        // Of each part, the sums of the diagonal and of what one pressure leaves.
        let mut sums = vec![[0.0; 2]; count as usize];
        for (grain, (part, own)) in parts.iter().zip(&diagonal).enumerate() {
            let left: f64 = matrix.row(grain).iter().map(|(_, value)| value).sum();
            let [total, all] = &mut sums[*part as usize];
            *total += own;
            *all += left.abs();
        }
        let held = sums.into_iter().map(|[total, all]| (all <= HELD * total).then_some(total)).collect();
        Self { grids: Multigrid::new(matrix), diagonal, parts, held }
    }

    /// Whether the grain at a place gives way to any pressure: one that moves as a whole keeps its volume.
    pub(crate) fn gives_way(&self, place: usize) -> bool {
        self.diagonal[place] > 0.0
    }

    /// The pressures that bring about the given changes of volume, up to an error of this share.
    pub(crate) fn pressures(&self, changes: &[f64], tolerance: f64) -> Vec<f64> {
        let balanced = self.balanced(changes);
        let limits = Limits::of(changes.len(), tolerance);
        let limits = Limits { steps: limits.steps.min(ITERATIONS), ..limits };
        let precondition = |residual: &[f64]| self.grids.precondition(residual);
        solve(|vector| self.grids.apply(vector), precondition, &balanced, &limits)
    }

    /// The changes of volume that pressures can bring about, nearest to the given ones.
    ///
    /// A part that is held keeps its whole volume, and so does a grain that moves as a whole: pressures that were to change it would grow without
    /// bound. What rounding leaves of a part's total, grains take as they give way: one far smaller than the others may be smaller than their
    /// rounding.
    fn balanced(&self, changes: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.held.len()];
        self.parts.iter().zip(changes).for_each(|(part, change)| sums[*part as usize] += change);
        let balanced = |((change, own), part): ((&f64, &f64), &u32)| match self.held[*part as usize] {
            _ if *own == 0.0 => 0.0,
            Some(total) => change - sums[*part as usize] / total * own,
            None => *change,
        };
        changes.iter().zip(&self.diagonal).zip(&self.parts).map(balanced).collect()
    }
}
