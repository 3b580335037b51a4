//! One step of Loop's scheme without a table of its stencils.

use rayon::prelude::*;

use crate::ids::{id, next, prev};
use crate::{EdgeId, LoopWeights, Point, TriangleMesh, large_vec};

/// Points that one task makes.
const PER_TASK: usize = 1024;

/// Neighbours of a vertex that are kept in order while they are counted; few vertices have more.
const RING: usize = 16;

impl TriangleMesh {
    /// The points one level on: bit for bit what the table of [`loop_refine`](Self::loop_refine) makes of `points`, without the memory
    /// that the table takes. In parallel; the result does not depend on the number of threads.
    ///
    /// # Panics
    /// If there is not one point per vertex.
    pub fn loop_step<P: Point>(&self, points: &[P]) -> Vec<P> {
        assert_eq!(points.len(), self.vertex_count(), "there must be one point per vertex");
        let mut refined = large_vec::zeros(self.vertex_count() + self.edge_count());
        let (moved, placed) = refined.split_at_mut(self.vertex_count());
        let moved = moved.par_iter_mut().with_min_len(PER_TASK).enumerate();
        moved.for_each_init(Vec::new, |entries, (vertex, new)| {
            *new = if self.is_sharp(vertex) {
                self.loop_stencil(id(vertex), entries);
                sum(points, entries.iter().copied())
            } else {
                self.moved_smoothly(id(vertex), points)
            };
        });
        let edges = self.edges.par_iter().zip(&self.sharp_edges);
        placed.par_iter_mut().zip(edges).with_min_len(PER_TASK).enumerate().for_each(
            |(edge, (new, (&[along, against], &is_sharp)))| {
                *new = if is_sharp {
                    let mut point = P::zero();
                    self.loop_edge_stencil(EdgeId(id(edge)), LoopWeights::Loop, &mut |old, weight| {
                        point = point.add_scaled(points[old as usize], weight);
                    });
                    point
                } else {
                    let ends = [along, next(along)].map(|h| (self.start(h), 0.375));
                    let apexes = [along, against].map(|h| (self.start(prev(h)), 0.125));
                    sum(points, ends.into_iter().chain(apexes))
                };
            },
        );
        refined
    }

    /// A vertex that its ring moves.
    fn moved_smoothly<P: Point>(&self, vertex: u32, points: &[P]) -> P {
        let mut ring = [0; RING];
        let mut valence = 0;
        let neighbours = || self.ring(self.outgoing[vertex as usize]).map(|h| self.start(next(h)));
        for neighbour in neighbours() {
            if let Some(place) = ring.get_mut(valence) {
                *place = neighbour;
            }
            valence += 1;
        }
        let weight = LoopWeights::Loop.neighbour(valence);
        #[allow(clippy::cast_precision_loss)]
        let own = (vertex, 1.0 - valence as f64 * weight);
        if valence <= RING {
            sum(points, std::iter::once(own).chain(ring[..valence].iter().map(|&point| (point, weight))))
        } else {
            sum(points, std::iter::once(own).chain(neighbours().map(|point| (point, weight))))
        }
    }
}

/// The sum of some points by weights, in their order.
fn sum<P: Point>(points: &[P], entries: impl Iterator<Item = (u32, f64)>) -> P {
    entries.fold(P::zero(), |sum, (point, weight)| sum.add_scaled(points[point as usize], weight))
}

#[cfg(test)]
pub(crate) mod tests {
    use glam::DVec3;

    use crate::{Crease, Features, TriangleMesh};

    /// The triangles and 28 points of an octahedron with a third triangle on an edge, and of a fan of twenty.
    pub(crate) fn example() -> (Vec<[u32; 3]>, Vec<DVec3>) {
        let mut triangles: Vec<[u32; 3]> = vec![
            [0, 1, 2],
            [0, 2, 3],
            [0, 3, 4],
            [0, 4, 1],
            [5, 2, 1],
            [5, 3, 2],
            [5, 4, 3],
            [5, 1, 4],
            [0, 1, 6],
        ];
        triangles.extend((0..20).map(|k| [7, 8 + k, 8 + (k + 1) % 20]));
        let points = (0..28)
            .map(|k| DVec3::new(f64::from(k).sin(), (1.3 * f64::from(k)).cos(), 0.1 * f64::from(k)))
            .collect();
        (triangles, points)
    }

    /// Of the octahedron, one crease ends, and one is half sharp.
    #[test]
    fn a_step_is_what_the_table_makes_bit_for_bit() {
        let (triangles, mut points) = example();
        let crease = |ends, sharpness| Crease { ends, sharpness };
        let features =
            Features { creases: &[crease([2, 3], 0.7), crease([3, 4], 5.0)], ..Features::default() };
        let mut mesh = TriangleMesh::new(28, triangles, &features).unwrap();
        for _ in 0..3 {
            let refinement = mesh.loop_refine().unwrap();
            let refined = refinement.stencils.apply(&points);
            assert_eq!(mesh.loop_step(&points), refined);
            (mesh, points) = (refinement.mesh, refined);
        }
    }
}
