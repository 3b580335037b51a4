//! Loop's scheme by edits of a half-edge mesh: split every edge, then flip. Slower than index arithmetic, and a check of it.

use crate::ids::id;
use crate::{HalfEdgeId, HalfEdgeMesh, LoopWeights, MeshError, Point};

impl HalfEdgeMesh {
    /// One step of Loop subdivision by edge splits and flips; boundaries are creases, and there are no other features.
    ///
    /// The vertex on edge e, the e-th that [`edges`](Self::edges) names, is vertex V + e of the finer mesh, where V is the number of
    /// vertices before. `points` becomes the points of the finer mesh.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the mesh outgrows 32-bit ids.
    ///
    /// # Panics
    /// If `points` does not have one point per vertex.
    pub fn loop_by_split_and_flip<P: Point>(&mut self, points: &mut Vec<P>) -> Result<(), MeshError> {
        assert_eq!(points.len(), self.vertex_count(), "there must be one point per vertex");
        let vertices = id(self.vertex_count());
        let edges: Vec<HalfEdgeId> = self.edges().collect();
        let ends: Vec<[u32; 2]> = edges.iter().map(|&h| [self.start(h), self.end(h)]).collect();
        let mut new_points: Vec<P> = (0..vertices).map(|v| self.loop_vertex_point(v, points)).collect();
        new_points.extend(edges.iter().map(|&h| self.loop_edge_point(h, points)));
        *points = new_points;

        for &[a, b] in &ends {
            self.split(self.half_edge_between(a, b)?)?;
        }
        // What joins an old vertex to a new one and is no half of an old edge crosses an old triangle: turned, it cuts
        // off the corner.
        let crosses = |&h: &HalfEdgeId| {
            let [low, high] = [self.start(h).min(self.end(h)), self.start(h).max(self.end(h))];
            low < vertices && high >= vertices && !ends[(high - vertices) as usize].contains(&low)
        };
        let crossing: Vec<HalfEdgeId> = self.edges().filter(crosses).collect();
        crossing.into_iter().try_for_each(|h| self.flip(h))
    }

    fn loop_vertex_point<P: Point>(&self, v: u32, points: &[P]) -> P {
        let point = points[v as usize];
        let neighbours: Vec<u32> = self.neighbours(v).collect();
        let (own, each, among): (f64, f64, &[u32]) = match neighbours[..] {
            [] => (1.0, 0.0, &[]),
            [first, .., last] if self.is_boundary_vertex(v) => (0.75, 0.125, &[first, last]),
            _ => {
                let weight = LoopWeights::Loop.neighbour(neighbours.len());
                #[allow(clippy::cast_precision_loss)]
                (1.0 - neighbours.len() as f64 * weight, weight, &neighbours)
            }
        };
        let start = P::zero().add_scaled(point, own);
        among.iter().fold(start, |sum, &neighbour| sum.add_scaled(points[neighbour as usize], each))
    }

    fn loop_edge_point<P: Point>(&self, h: HalfEdgeId, points: &[P]) -> P {
        let at = |v: u32| points[v as usize];
        let [a, b] = [at(self.start(h)), at(self.end(h))];
        match self.twin(h) {
            None => P::zero().add_scaled(a, 0.5).add_scaled(b, 0.5),
            Some(twin) => {
                let [c, d] = [h, twin].map(|h| at(self.start(h.prev())));
                P::zero().add_scaled(a, 0.375).add_scaled(b, 0.375).add_scaled(c, 0.125).add_scaled(d, 0.125)
            }
        }
    }
}
