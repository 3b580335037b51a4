//! Loop subdivision of points without a table: for points that are refined once.

use rayon::prelude::*;

use crate::ids::{id, next, prev};
use crate::large_vec;
use crate::{LoopWeights, Point, TriangleMesh, VertexRule};

/// Points that one task computes.
const POINTS_PER_TASK: usize = 2048;

/// Valences up to which the neighbours' weight is computed once.
const COMMON_VALENCES: usize = 32;

impl TriangleMesh {
    /// The mesh refined `levels` times by Loop's scheme, and its points; without stencil tables, so faster and smaller
    /// than [`loop_refine_with`](Self::loop_refine_with) if the points will not change.
    ///
    /// # Panics
    /// If `points` has fewer points than the mesh has vertices, or if the finest mesh outgrows 32-bit ids;
    /// [`MeshCounts::refined`](crate::MeshCounts::refined) tells beforehand.
    pub fn loop_subdivide<P: Point>(
        &self,
        points: &[P],
        levels: usize,
        weights: LoopWeights,
    ) -> (Self, Vec<P>) {
        let mut mesh = self.clone();
        let mut points = points.to_vec();
        for _ in 0..levels {
            points = mesh.loop_points(&points, weights);
            mesh = mesh.refine_connectivity();
        }
        (mesh, points)
    }

    /// The points one level on: what the rows of [`loop_stencils`](Self::loop_stencils) make of `points`, up to rounding.
    pub(crate) fn loop_points<P: Point>(&self, points: &[P], weights: LoopWeights) -> Vec<P> {
        let common: Vec<f64> =
            (0..COMMON_VALENCES).map(|valence| weights.neighbour(valence.max(1))).collect();
        let vertices = (0..self.counts().vertices).into_par_iter().map(|v| match self.vertex_rule(v) {
            VertexRule::Smooth | VertexRule::Dart => self.smooth_point(v, points, |valence| {
                common.get(valence).copied().unwrap_or_else(|| weights.neighbour(valence))
            }),
            _ => sum_row(points, |mut add| self.loop_vertex_row(v, weights, &mut add)),
        });
        let edges = self.edges.par_iter().zip(&self.sharp_edges).enumerate();
        let edges = edges.map(|(e, (&[along, against], &sharp))| {
            if sharp || weights == LoopWeights::BiermannLevinZorin {
                return sum_row(points, |mut add| self.loop_edge_row(id(e), weights, &mut add));
            }
            let at = |h: u32| points[self.start(h) as usize];
            P::zero()
                .add_scaled(at(along), 0.375)
                .add_scaled(at(next(along)), 0.375)
                .add_scaled(at(prev(along)), 0.125)
                .add_scaled(at(prev(against)), 0.125)
        });
        let mut refined = large_vec::with_capacity(self.vertex_count() + self.edge_count());
        vertices.chain(edges).with_min_len(POINTS_PER_TASK).collect_into_vec(&mut refined);
        refined
    }

    fn smooth_point<P: Point>(&self, vertex: u32, points: &[P], weight: impl Fn(usize) -> f64) -> P {
        let mut valence = 0;
        let mut sum = P::zero();
        for h in self.ring(self.outgoing[vertex as usize]) {
            sum = sum.add_scaled(points[self.start(next(h)) as usize], 1.0);
            valence += 1;
        }
        let neighbour = weight(valence);
        #[allow(clippy::cast_precision_loss)]
        let own = 1.0 - valence as f64 * neighbour;
        P::zero().add_scaled(points[vertex as usize], own).add_scaled(sum, neighbour)
    }
}

fn sum_row<P: Point>(points: &[P], row: impl FnOnce(&mut dyn FnMut(u32, f64))) -> P {
    let mut sum = P::zero();
    row(&mut |point, weight| sum = sum.add_scaled(points[point as usize], weight));
    sum
}
