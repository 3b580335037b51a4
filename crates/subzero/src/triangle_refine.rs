//! Connectivity of the next level by index arithmetic, in parallel.

use rayon::prelude::*;

use crate::ids::{NONE, id, next};
use crate::large_vec;
use crate::{EdgeId, LoopWeights, MeshError, Refinement, TriangleMesh};

/// Parents that one task refines.
const PARENTS_PER_TASK: usize = 2048;

impl TriangleMesh {
    /// One step of Loop subdivision with Loop's weights.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the finer mesh outgrows 32-bit ids; [`MeshCounts::refined`](crate::MeshCounts::refined) tells beforehand.
    pub fn loop_refine(&self) -> Result<Refinement<Self>, MeshError> {
        self.loop_refine_with(LoopWeights::Loop)
    }

    /// One step of Loop subdivision with a choice of weights.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the finer mesh outgrows 32-bit ids; [`MeshCounts::refined`](crate::MeshCounts::refined) tells beforehand.
    pub fn loop_refine_with(&self, weights: LoopWeights) -> Result<Refinement<Self>, MeshError> {
        Ok(Refinement { mesh: self.refine_connectivity()?, stencils: self.loop_stencils(weights) })
    }

    /// Splits each triangle into four, numbered as [`MeshCounts`](crate::MeshCounts) says; points of any scheme that does so follow apart, as by
    /// [`loop_step`](Self::loop_step).
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the finer mesh outgrows 32-bit ids; [`MeshCounts::refined`](crate::MeshCounts::refined) tells beforehand.
    pub fn refine_connectivity(&self) -> Result<Self, MeshError> {
        let refined = self.counts().refined()?;
        let sharpness =
            self.sharpness.refine(self.vertex_count(), |vertex, edge| self.edge(edge)[0] == vertex);
        Ok(Self {
            triangles: self.refined_triangles(),
            directed_edges: self.refined_directed_edges(),
            edges: self.refined_edges(),
            outgoing: self.refined_outgoing(),
            vertex_rules: sharpness.vertex_rules(refined.vertices as usize),
            sharp_edges: sharpness.sharp_edges(refined.edges as usize),
            sharpness,
        })
    }

    /// All triangles of the refined mesh, without that mesh.
    pub(crate) fn refined_triangles(&self) -> Vec<[u32; 3]> {
        let counts = self.counts();
        let parents = self.triangles.len();
        let mut triangles = large_vec::zeros::<[u32; 3]>(4 * parents);
        let (corners, centres) = triangles.split_at_mut(3 * parents);
        let old = self.triangles.par_iter().zip(&self.directed_edges);
        let new = corners.as_chunks_mut::<3>().0.par_iter_mut().zip(centres);
        old.zip(new).with_min_len(PARENTS_PER_TASK).for_each(|((triangle, directed), (corners, centre))| {
            let [first, second, third] = directed.map(|directed| counts.edge_vertex(EdgeId(directed / 2)));
            *corners =
                [[triangle[0], first, third], [triangle[1], second, first], [triangle[2], third, second]];
            *centre = [third, first, second];
        });
        triangles
    }

    fn refined_directed_edges(&self) -> Vec<[u32; 3]> {
        let parents = self.triangles.len();
        let mut directed_edges = large_vec::zeros::<[u32; 3]>(4 * parents);
        let (corners, centres) = directed_edges.split_at_mut(3 * parents);
        let new = corners.as_chunks_mut::<3>().0.par_iter_mut().zip(centres);
        let first_inner = 2 * id(self.edges.len());
        let old = self.directed_edges.par_iter();
        old.zip(new).with_min_len(PARENTS_PER_TASK).enumerate().for_each(
            |(t, (directed, (corners, centre)))| {
                let inner = first_inner + 3 * id(t);
                let [d0, d1, d2] = *directed;
                // The halves of an edge where a half-edge starts and where it ends, in the half-edge's direction.
                let first_half = |d: u32| 2 * d + d % 2;
                let second_half = |d: u32| 2 * (d ^ 1) + d % 2;
                *corners = [
                    [first_half(d0), 2 * inner, second_half(d2)],
                    [first_half(d1), 2 * inner + 2, second_half(d0)],
                    [first_half(d2), 2 * inner + 4, second_half(d1)],
                ];
                *centre = [2 * inner + 1, 2 * inner + 3, 2 * inner + 5];
            },
        );
        directed_edges
    }

    fn refined_edges(&self) -> Vec<[u32; 2]> {
        let half_edges = id(3 * self.triangles.len());
        let mut edges = large_vec::zeros::<[u32; 2]>(2 * self.edges.len() + half_edges as usize);
        let (halves, inner) = edges.split_at_mut(2 * self.edges.len());
        let parents = self.edges.par_iter().with_min_len(PARENTS_PER_TASK);
        parents.zip(halves.par_chunks_exact_mut(2)).for_each(|(&[along, against], halves)| {
            if against == NONE {
                halves[0] = [3 * along, NONE];
                halves[1] = [3 * next(along) + 2, NONE];
            } else {
                halves[0] = [3 * along, 3 * next(against) + 2];
                halves[1] = [3 * next(along) + 2, 3 * against];
            }
        });
        inner
            .par_iter_mut()
            .with_min_len(PARENTS_PER_TASK)
            .enumerate()
            .for_each(|(h, edge)| *edge = [3 * id(h) + 1, 3 * half_edges + id(h)]);
        edges
    }

    fn refined_outgoing(&self) -> Vec<u32> {
        let mut outgoing = large_vec::with_capacity(self.vertex_count() + self.edge_count());
        let old = self.outgoing.par_iter().map(|&h| if h == NONE { NONE } else { 3 * h });
        let new = self.edges.par_iter().map(|&[along, _]| 3 * along + 1);
        old.chain(new).with_min_len(PARENTS_PER_TASK).collect_into_vec(&mut outgoing);
        outgoing
    }
}
