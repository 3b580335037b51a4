//! Connectivity of the next level by index arithmetic, in parallel.

use rayon::prelude::*;

use crate::ids::{NONE, id, next};
use crate::{LoopWeights, MeshCounts, Refinement, TriangleMesh};

/// Parents that one task refines.
const PARENTS_PER_TASK: usize = 2048;

impl TriangleMesh {
    /// One step of Loop subdivision with Loop's weights.
    ///
    /// # Panics
    /// If the finer mesh outgrows 32-bit ids; [`MeshCounts::refined`] tells beforehand.
    pub fn loop_refine(&self) -> Refinement<Self> {
        self.loop_refine_with(LoopWeights::Loop)
    }

    /// One step of Loop subdivision with a choice of weights.
    ///
    /// # Panics
    /// If the finer mesh outgrows 32-bit ids; [`MeshCounts::refined`] tells beforehand.
    pub fn loop_refine_with(&self, weights: LoopWeights) -> Refinement<Self> {
        Refinement { mesh: self.refine_connectivity(), stencils: self.loop_stencils(weights) }
    }

    /// Splits each triangle into four, numbered as [`MeshCounts`] says.
    pub(crate) fn refine_connectivity(&self) -> Self {
        let counts = self.counts();
        let refined = match counts.refined() {
            Ok(refined) => refined,
            Err(error) => panic!("the finer mesh does not fit: {error}"),
        };
        let sharpness =
            self.sharpness.refine(self.vertex_count(), |vertex, edge| self.edge(edge)[0] == vertex);
        let (triangles, directed_edges) = self.refined_triangles(counts);
        Self {
            triangles,
            directed_edges,
            edges: self.refined_edges(),
            outgoing: self.refined_outgoing(),
            vertex_rules: sharpness.vertex_rules(refined.vertices as usize),
            sharp_edges: sharpness.sharp_edges(refined.edges as usize),
            sharpness,
        }
    }

    fn refined_triangles(&self, counts: MeshCounts) -> (Vec<[u32; 3]>, Vec<[u32; 3]>) {
        let mut triangles = vec![[0; 3]; 4 * self.triangles.len()];
        let mut directed_edges = triangles.clone();
        let (corners, centres) = triangles.split_at_mut(3 * self.triangles.len());
        let (corner_edges, centre_edges) = directed_edges.split_at_mut(3 * self.triangles.len());
        let parents = self.triangles.par_iter().zip(&self.directed_edges).with_min_len(PARENTS_PER_TASK);
        let corners = corners.par_chunks_exact_mut(3).zip(corner_edges.par_chunks_exact_mut(3));
        let centres = centres.par_iter_mut().zip(centre_edges);
        parents.zip(corners).zip(centres).enumerate().for_each(
            |(t, (((triangle, directed), (corners, corner_edges)), (centre, centre_edges)))| {
                let inner = 2 * counts.edges + 3 * id(t);
                let on_edge = directed.map(|d| counts.edge_vertex(d / 2));
                for (k, before) in [(0, 2), (1, 0), (2, 1)] {
                    let inner = inner + id(k);
                    corners[k] = [triangle[k], on_edge[k], on_edge[before]];
                    corner_edges[k] = [
                        2 * directed[k] + directed[k] % 2,
                        2 * inner,
                        2 * (directed[before] ^ 1) + directed[before] % 2,
                    ];
                    centre[k] = on_edge[before];
                    centre_edges[k] = 2 * inner + 1;
                }
            },
        );
        (triangles, directed_edges)
    }

    fn refined_edges(&self) -> Vec<[u32; 2]> {
        let half_edges = id(3 * self.triangles.len());
        let halves = |&[along, against]: &[u32; 2]| {
            if against == NONE {
                [[3 * along, NONE], [3 * next(along) + 2, NONE]]
            } else {
                [[3 * along, 3 * next(against) + 2], [3 * next(along) + 2, 3 * against]]
            }
        };
        let mut edges = vec![[0; 2]; 2 * self.edges.len() + 3 * self.triangles.len()];
        let (outer, inner) = edges.split_at_mut(2 * self.edges.len());
        outer
            .par_chunks_exact_mut(2)
            .with_min_len(PARENTS_PER_TASK)
            .zip(&self.edges)
            .for_each(|(children, edge)| children.copy_from_slice(&halves(edge)));
        inner
            .par_iter_mut()
            .with_min_len(PARENTS_PER_TASK)
            .enumerate()
            .for_each(|(h, edge)| *edge = [3 * id(h) + 1, 3 * half_edges + id(h)]);
        edges
    }

    fn refined_outgoing(&self) -> Vec<u32> {
        let old = self.outgoing.par_iter().map(|&h| if h == NONE { NONE } else { 3 * h });
        let new = self.edges.par_iter().map(|&[along, _]| 3 * along + 1);
        let mut outgoing = vec![0; self.outgoing.len() + self.edges.len()];
        let (old_out, new_out) = outgoing.split_at_mut(self.outgoing.len());
        old.with_min_len(PARENTS_PER_TASK).zip(old_out).for_each(|(h, out)| *out = h);
        new.with_min_len(PARENTS_PER_TASK).zip(new_out).for_each(|(h, out)| *out = h);
        outgoing
    }
}
