//! Stencils that average old points into new ones.

use rayon::prelude::*;

use crate::Point;
use crate::ids::id;

/// Stencils that one task fills or applies; fixed, so that no result depends on the number of threads.
const STENCILS_PER_TASK: usize = 2048;

/// How new points follow from old ones: stencil i lists the old points that make up new point i, and their weights.
///
/// Stencils of a subdivision scheme sum to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct StencilTable {
    /// Where each stencil starts in `ids`, and after the last stencil their number.
    starts: Vec<usize>,
    /// Old points of all stencils, stencil after stencil.
    ids: Vec<u32>,
    /// Weights of all stencils, stencil after stencil.
    weights: Vec<f64>,
}

/// Stencils while they are being written: old points and their weights.
#[derive(Default)]
pub(crate) struct StencilWriter {
    /// Where each stencil starts, the stencil at hand included.
    starts: Vec<usize>,
    ids: Vec<u32>,
    weights: Vec<f64>,
}

impl StencilWriter {
    /// Adds an old point to the stencil at hand.
    pub(crate) fn add(&mut self, point: u32, weight: f64) {
        self.ids.push(point);
        self.weights.push(weight);
    }

    /// Sorts the stencil at hand, and adds up entries of the same point.
    pub(crate) fn merge(&mut self) {
        let start = self.starts.last().copied().unwrap_or(0);
        let mut stencil: Vec<(u32, f64)> = self.ids.drain(start..).zip(self.weights.drain(start..)).collect();
        merge(&mut stencil);
        stencil.into_iter().for_each(|(point, weight)| self.add(point, weight));
    }
}

/// Sorts a stencil, and adds up entries of the same point.
pub(crate) fn merge(stencil: &mut Vec<(u32, f64)>) {
    // Stable, so that weights of one point are summed in the order in which they were added.
    stencil.sort_by_key(|&(point, _)| point);
    stencil.dedup_by(|entry, kept| {
        let is_same = entry.0 == kept.0;
        if is_same {
            kept.1 += entry.1;
        }
        is_same
    });
}

/// What a stencil that is handed out entry by entry makes of some points.
pub(crate) fn sum_stencil<P: Point>(points: &[P], stencil: impl FnOnce(&mut dyn FnMut(u32, f64))) -> P {
    let mut sum = P::zero();
    stencil(&mut |point, weight| sum = sum.add_scaled(points[point as usize], weight));
    sum
}

impl StencilTable {
    /// Builds `count` stencils in parallel: `write(i, writer)` adds the entries of stencil i.
    pub(crate) fn from_stencils(count: usize, write: impl Fn(u32, &mut StencilWriter) + Sync) -> Self {
        let tasks: Vec<StencilWriter> = (0..count.div_ceil(STENCILS_PER_TASK))
            .into_par_iter()
            .map(|task| {
                let mut writer = StencilWriter::default();
                for stencil in task * STENCILS_PER_TASK..count.min((task + 1) * STENCILS_PER_TASK) {
                    writer.starts.push(writer.ids.len());
                    write(id(stencil), &mut writer);
                }
                writer
            })
            .collect();
        let mut starts = Vec::with_capacity(count + 1);
        let mut end = 0;
        for writer in &tasks {
            starts.extend(writer.starts.iter().map(|start| end + start));
            end += writer.ids.len();
        }
        starts.push(end);
        let (ids, weights): (Vec<&[u32]>, Vec<&[f64]>) =
            tasks.iter().map(|writer| (writer.ids.as_slice(), writer.weights.as_slice())).unzip();
        Self { starts, ids: ids.concat(), weights: weights.concat() }
    }

    /// The table that leaves `count` points as they are.
    pub fn identity(count: usize) -> Self {
        Self::from_stencils(count, |i, writer| writer.add(i, 1.0))
    }

    /// Number of stencils, that is of new points.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether the table makes no point at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Stencil `i`: the old points, and the weight of each.
    ///
    /// # Panics
    /// If there is no stencil `i`.
    pub fn stencil(&self, i: usize) -> (&[u32], &[f64]) {
        let entries = self.starts[i]..self.starts[i + 1];
        (&self.ids[entries.clone()], &self.weights[entries])
    }

    /// The new points, computed in parallel; the result does not depend on the number of threads.
    ///
    /// # Panics
    /// If `points` has fewer points than the mesh that was refined.
    pub fn apply<P: Point>(&self, points: &[P]) -> Vec<P> {
        (0..self.len())
            .into_par_iter()
            .with_min_len(STENCILS_PER_TASK)
            .map(|i| self.point(i, points))
            .collect()
    }

    /// Writes the new points to `out`, in parallel and without allocation.
    ///
    /// # Panics
    /// If `points` has fewer points than the mesh that was refined, or if `out` is not [`len`](Self::len) points long.
    pub fn apply_into<P: Point>(&self, points: &[P], out: &mut [P]) {
        assert_eq!(out.len(), self.len(), "the output must have one point per stencil");
        out.par_iter_mut()
            .with_min_len(STENCILS_PER_TASK)
            .enumerate()
            .for_each(|(i, new)| *new = self.point(i, points));
    }

    fn point<P: Point>(&self, i: usize, points: &[P]) -> P {
        let (ids, weights) = self.stencil(i);
        ids.iter()
            .zip(weights)
            .fold(P::zero(), |sum, (&old, &weight)| sum.add_scaled(points[old as usize], weight))
    }

    /// This table and `next` in one: stencil i of the result averages the points of `self` as stencil i of `next` those of `next`.
    ///
    /// Within a stencil, old points are sorted.
    ///
    /// ```
    /// use glam::DVec2;
    /// use subzero::{CurveMesh, Refinement};
    ///
    /// let line = CurveMesh::new(3, vec![[0, 1], [1, 2]], &[])?;
    /// let Refinement { mesh, stencils } = line.refine()?;
    /// let points = [DVec2::ZERO, DVec2::ONE, DVec2::new(2., 0.)];
    /// let both = stencils.then(&mesh.refine()?.stencils);
    /// assert_eq!(both.apply(&points), mesh.refine()?.stencils.apply(&stencils.apply(&points)));
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Panics
    /// If `next` refers to points that `self` does not make.
    pub fn then(&self, next: &Self) -> Self {
        Self::from_stencils(next.len(), |i, writer| {
            let (middle_ids, middle_weights) = next.stencil(i as usize);
            for (&middle, &outer) in middle_ids.iter().zip(middle_weights) {
                let (ids, weights) = self.stencil(middle as usize);
                ids.iter().zip(weights).for_each(|(&old, &inner)| writer.add(old, outer * inner));
            }
            writer.merge();
        })
    }
}
