//! Points two levels on from a mesh, given those one level on, without the mesh in between.

use rayon::prelude::*;

use crate::ids::{id, next, prev};
use crate::loop_points::{edge_point, smooth_point, vertex_point};
use crate::{EdgeId, FaceId, LoopWeights, MeshCounts, Point, TriangleMesh, VertexRule, large_vec};

/// Parents that one task takes.
const PER_TASK: usize = 1024;

impl TriangleMesh {
    /// Corners of the 16 triangles two levels on in a triangle, as places in [`loop_points_beyond`](Self::loop_points_beyond): four in each of the
    /// triangles one level on.
    pub const TRIANGLES_BEYOND: [[usize; 3]; 16] = {
        let mut triangles = [[0; 3]; 16];
        let mut corner = 0;
        while corner < 3 {
            let before = (corner + 2) % 3;
            let [middle, middle_before] = [3 + corner, 3 + before];
            let [out, back, cut] = [6 + 2 * corner, 7 + 2 * before, 12 + corner];
            triangles[4 * corner] = [corner, out, back];
            triangles[4 * corner + 1] = [middle, cut, out];
            triangles[4 * corner + 2] = [middle_before, back, cut];
            triangles[4 * corner + 3] = [back, out, cut];
            triangles[12 + corner] = [middle_before, cut, 12 + before];
            corner += 1;
        }
        triangles[15] = [14, 12, 13];
        triangles
    };

    /// The points two levels on by Loop's scheme, given those one level on: what [`loop_step`](Self::loop_step) of the refined mesh makes of
    /// them, up to rounding, without that mesh, and several times as fast. In parallel; the result does not depend on the number of threads.
    ///
    /// ```
    /// use glam::DVec3;
    /// use subzero::{Features, TriangleMesh};
    ///
    /// let triangles = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    /// let points = [DVec3::ONE, DVec3::new(-1., 1., -1.), DVec3::new(1., -1., -1.), DVec3::new(-1., -1., 1.)];
    /// let mesh = TriangleMesh::new(4, triangles, &Features::default())?;
    /// let points = mesh.loop_step(&points);
    /// let expected = mesh.refine_connectivity()?.loop_step(&points);
    /// let pairs = mesh.loop_step_beyond(&points).into_iter().zip(expected);
    /// assert!(pairs.into_iter().all(|(point, expected)| point.distance(expected) < 1e-15));
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Panics
    /// If there is not one point per vertex of the refined mesh, or an edge or corner is semi-sharp.
    pub fn loop_step_beyond<P: Point>(&self, points: &[P]) -> Vec<P> {
        let edges = self.edge_count();
        let finer = self.vertex_count() + edges;
        let mut refined = large_vec::zeros(finer + 2 * edges + 3 * self.triangles.len());
        let (moved, placed) = refined.split_at_mut(finer);
        self.move_beyond(points, moved);
        let (halves, inside) = placed.split_at_mut(2 * edges);
        let halves = halves.as_chunks_mut().0.par_iter_mut().zip(&self.edges).with_min_len(PER_TASK);
        halves.for_each(|(halves, &[along, _])| *halves = self.on_halves(along, points));
        let inside = inside.as_chunks_mut().0.par_iter_mut().with_min_len(PER_TASK).enumerate();
        inside.for_each(|(t, inside)| *inside = self.inside(t, points));
        refined
    }

    /// The first of the points of [`loop_step_beyond`](Self::loop_step_beyond): those of the vertices of the refined mesh.
    ///
    /// # Panics
    /// As of [`loop_step_beyond`](Self::loop_step_beyond).
    pub fn loop_moved_beyond<P: Point>(&self, points: &[P]) -> Vec<P> {
        let mut moved = large_vec::zeros(points.len());
        self.move_beyond(points, &mut moved);
        moved
    }

    /// The points of [`loop_step_beyond`](Self::loop_step_beyond) in one triangle, given those one level on, and where
    /// [`loop_moved_beyond`](Self::loop_moved_beyond) puts these: at the corners, on the middles of the edges, on the two halves of each edge,
    /// and on the edges that cut off the corners.
    ///
    /// # Panics
    /// If there is no such triangle, or too few points.
    #[inline(always)]
    pub fn loop_points_beyond<P: Point>(&self, triangle: FaceId, points: &[P], moved: &[P]) -> [P; 15] {
        let t = triangle.index();
        let [a, b, c] = self.triangles[t].map(|corner| moved[corner as usize]);
        let [ab, bc, ca] = [0, 1, 2].map(|k| moved[self.middle(3 * triangle.0 + k) as usize]);
        let [[a_out, b_back], [b_out, c_back], [c_out, a_back]] =
            [0, 1, 2].map(|k| self.on_halves(3 * triangle.0 + k, points));
        let [at_a, at_b, at_c] = self.inside(t, points);
        [a, b, c, ab, bc, ca, a_out, b_back, b_out, c_back, c_out, a_back, at_a, at_b, at_c]
    }

    /// One of the points of [`loop_step_beyond`](Self::loop_step_beyond) by itself: puts the points one level on that make it up in place of
    /// `entries`, each with its weight.
    ///
    /// # Panics
    /// If there is no such point, or what is sharp there is semi-sharp.
    pub fn loop_stencil_beyond(&self, vertex: u32, entries: &mut Vec<(u32, f64)>) {
        let MeshCounts { vertices, edges, .. } = self.counts();
        entries.clear();
        let mut add =
            |points: &[u32], weight: f64| entries.extend(points.iter().map(|point| (*point, weight)));
        if vertex < vertices {
            match self.vertex_rules[vertex as usize] {
                VertexRule::Corner => add(&[vertex], 1.0),
                VertexRule::Crease => {
                    add(&[vertex], 0.75);
                    add(&self.along_crease(vertex), 0.125);
                }
                VertexRule::Smooth | VertexRule::Dart => {
                    let ring = self.ring(self.outgoing[vertex as usize]);
                    let ring: Vec<u32> = ring.map(|h| self.middle(h)).collect();
                    let weight = LoopWeights::Loop.neighbour(ring.len());
                    #[allow(clippy::cast_precision_loss)]
                    add(&[vertex], 1.0 - ring.len() as f64 * weight);
                    add(&ring, weight);
                }
            }
            return;
        }
        let edge = vertex - vertices;
        if edge < edges {
            if self.sharp_edges[edge as usize] {
                add(&[vertex], 0.75);
                add(&self.edge(EdgeId(edge)), 0.125);
            } else {
                add(&[vertex], 0.625);
                add(&self.around_middle(edge), 0.0625);
            }
            return;
        }
        let half = edge - edges;
        match half.checked_sub(2 * edges) {
            None => {
                let (edge, end) = (half / 2, (half % 2) as usize);
                let ends = [self.edge(EdgeId(edge))[end], vertices + edge];
                if self.sharp_edges[edge as usize] {
                    add(&ends, 0.5);
                } else {
                    let [along, _] = self.edges[edge as usize];
                    add(&ends, 0.375);
                    add(&self.beside_halves(along)[end], 0.125);
                }
            }
            Some(h) => {
                add(&[h, prev(h)].map(|h| self.middle(h)), 0.375);
                add(&[self.start(h), self.middle(next(h))], 0.125);
            }
        }
    }

    fn move_beyond<P: Point>(&self, points: &[P], moved: &mut [P]) {
        let vertices = self.vertex_count();
        assert_eq!(points.len(), vertices + self.edge_count(), "there must be one point per finer vertex");
        assert_eq!(self.sharpness.check_settled(), Ok(()), "what is sharp must stay so");
        let (oldest, middles) = moved.split_at_mut(vertices);
        let oldest = oldest.par_iter_mut().with_min_len(PER_TASK).enumerate();
        oldest.for_each(|(v, new)| *new = self.moved_vertex(v, points));
        let middles = middles.par_iter_mut().with_min_len(PER_TASK).enumerate();
        middles.for_each(|(e, new)| {
            let own = points[vertices + e];
            let at = |point: u32| points[point as usize];
            *new = if self.sharp_edges[e] {
                on_crease(own, self.edge(EdgeId(id(e))).map(at))
            } else {
                vertex_point(own, self.around_middle(id(e)).map(at))
            };
        });
    }

    /// Where a vertex goes, given the points one level on.
    fn moved_vertex<P: Point>(&self, vertex: usize, points: &[P]) -> P {
        let own = points[vertex];
        match self.vertex_rules[vertex] {
            VertexRule::Corner => own,
            VertexRule::Crease => {
                on_crease(own, self.along_crease(id(vertex)).map(|neighbour| points[neighbour as usize]))
            }
            VertexRule::Smooth | VertexRule::Dart => {
                let ring = || self.ring(self.outgoing[vertex]);
                let valence = ring().count();
                let middles = ring().map(|h| points[self.middle(h) as usize]);
                smooth_point(own, middles, valence, LoopWeights::Loop.neighbour(valence))
            }
        }
    }

    /// The vertex on the edge of a half-edge, one level on.
    #[inline(always)]
    fn middle(&self, h: u32) -> u32 {
        self.counts().edge_vertex(self.edge_of(h))
    }

    /// The vertices on the two sharp edges of a vertex, one level on.
    fn along_crease(&self, vertex: u32) -> [u32; 2] {
        let sharp = self.sharpness.outgoing_edges(vertex);
        [0, 1].map(|place: usize| self.counts().edge_vertex(sharp[place].edge))
    }

    /// The vertices around the one on a smooth edge, one level on.
    #[inline(always)]
    fn around_middle(&self, edge: u32) -> [u32; 6] {
        let [along, against] = self.edges[edge as usize];
        let [a, b] = [along, against].map(|h| self.start(h));
        let [[c, d], [e, f]] = [along, against].map(|h| [next(h), prev(h)].map(|h| self.middle(h)));
        [a, b, c, d, e, f]
    }

    /// The vertices across from the two halves of a smooth half-edge, one level on.
    #[inline(always)]
    fn beside_halves(&self, h: u32) -> [[u32; 2]; 2] {
        let twin = self.twin(h);
        [[self.middle(prev(h)), self.middle(next(twin))], [self.middle(next(h)), self.middle(prev(twin))]]
    }

    /// The points on the two halves of a half-edge, given those one level on.
    #[inline(always)]
    fn on_halves<P: Point>(&self, h: u32, points: &[P]) -> [P; 2] {
        let EdgeId(edge) = self.edge_of(h);
        let middle = points[self.vertex_count() + edge as usize];
        let [start, end] = [h, next(h)].map(|h| points[self.start(h) as usize]);
        if self.sharp_edges[edge as usize] {
            return [start, end].map(|end| end.add_scaled(middle, 1.0).scaled(0.5));
        }
        let [[a, b], [c, d]] = self.beside_halves(h);
        let [a, b, c, d] = [points[a as usize], points[b as usize], points[c as usize], points[d as usize]];
        [edge_point(start, middle, a, b), edge_point(end, middle, c, d)]
    }

    /// The points on the edges that cut off the corners of a triangle, given those one level on.
    #[inline(always)]
    fn inside<P: Point>(&self, t: usize, points: &[P]) -> [P; 3] {
        let corners = self.triangles[t].map(|corner| points[corner as usize]);
        let middles =
            self.directed_edges[t].map(|directed| points[self.vertex_count() + (directed / 2) as usize]);
        [0, 1, 2].map(|k| edge_point(middles[k], middles[(k + 2) % 3], corners[k], middles[(k + 1) % 3]))
    }
}

/// The new place of a vertex on a crease with these neighbours.
fn on_crease<P: Point>(vertex: P, [a, b]: [P; 2]) -> P {
    vertex.scaled(0.75).add_scaled(a.add_scaled(b, 1.0), 0.125)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::loop_step::tests::example;
    use crate::{Crease, FaceId, Features, TriangleMesh};

    /// The octahedron has a crease, which begins at a smooth vertex and ends at a corner.
    #[test]
    fn points_beyond_are_those_of_the_refined_mesh() {
        let (triangles, mut points) = example();
        let creases = [Crease::infinite([2, 3]), Crease::infinite([3, 4])];
        let features = Features { creases: &creases, corners: &[4], ..Features::default() };
        let mut mesh = TriangleMesh::new(28, triangles, &features).unwrap();
        for _ in 0..3 {
            let finer = mesh.refine_connectivity().unwrap();
            let given = mesh.loop_step(&points);
            let (beyond, expected) = (mesh.loop_step_beyond(&given), finer.loop_step(&given));
            let far = |(a, b): (&DVec3, &DVec3)| a.distance(*b) > 1e-14;
            assert_eq!(beyond.iter().zip(&expected).position(far), None);
            let mut entries = Vec::new();
            for (vertex, point) in (0u32..).zip(&beyond) {
                mesh.loop_stencil_beyond(vertex, &mut entries);
                let made: DVec3 = entries.iter().map(|(p, weight)| given[*p as usize] * *weight).sum();
                assert!(made.distance(*point) < 1e-14, "vertex {vertex}");
            }
            // Triangle by triangle they are the same, at the corners of the same triangles.
            let moved = mesh.loop_moved_beyond(&given);
            let finest = finer.refined_triangles();
            for triangle in (0..mesh.counts().triangles).map(FaceId) {
                let own = mesh.loop_points_beyond(triangle, &given, &moved);
                let triangles = TriangleMesh::TRIANGLES_BEYOND.map(|corners| corners.map(|c| own[c]));
                let children = mesh.counts().triangle_children(triangle).into_iter();
                let children = children.flat_map(|child| finer.counts().triangle_children(child));
                let expected: Vec<[DVec3; 3]> = children
                    .map(|child| finest[child.index()].map(|corner| beyond[corner as usize]))
                    .collect();
                assert_eq!(triangles.as_slice(), expected);
            }
            (mesh, points) = (finer, given);
        }
    }
}
