//! Loop subdivision of points straight from connectivity, without tables.
//!
//! From the third step on, the mesh two levels *up*, with a sixteenth of the triangles, says everything about the neighbours of
//! its descendants: 15 points make 21 new ones inside each of its triangles, and 13 make 6 on each of its edges. So little
//! is read, and in order, to write much.

use rayon::prelude::*;

use crate::base_rings::BaseRings;
use crate::ids::{id, next, prev};
use crate::prefetch::prefetch;
use crate::stencil::sum_stencil;
use crate::{EdgeId, FaceId, LoopWeights, Point, TriangleMesh, VertexParent, VertexRule};

/// Points or parents that one task takes.
const PER_TASK: usize = 1024;

/// How many edges or triangles ahead points are asked for: memory takes some 100 ns to answer, one of them some 15 ns to fill.
const AHEAD: usize = 8;

impl TriangleMesh {
    /// Writes the points one level on: what the stencils of [`loop_refine_with`](Self::loop_refine_with) make of `points`, up to
    /// rounding. `ancestors` are the meshes from which this one was refined, coarsest first, and `rings` the rings of the first of
    /// all these meshes.
    pub(crate) fn loop_points<P: Point>(
        &self,
        ancestors: &[Self],
        rings: &BaseRings,
        points: &[P],
        weights: LoopWeights,
        refined: &mut [P],
    ) {
        assert_eq!(points.len(), self.vertex_count(), "there must be one point per vertex");
        // Sector weights depend on more than ancestors' edges can tell.
        if weights == LoopWeights::BiermannLevinZorin {
            return self.points_by_stencils(points, weights, refined);
        }
        let (moved, placed) = refined.split_at_mut(self.vertex_count());
        match ancestors {
            [] => {
                self.move_oldest(points, rings, weights, moved, |outgoing_edge| self.end(outgoing_edge));
                self.place_on_all_edges(points, weights, placed);
            }
            [parent] => {
                let (oldest, middles) = moved.split_at_mut(parent.vertex_count());
                let middle = |outgoing_edge: u32| id(parent.vertex_count()) + outgoing_edge / 2;
                self.move_oldest(points, rings, weights, oldest, middle);
                self.move_middles(parent, points, weights, middles);
                self.place_on_all_edges(points, weights, placed);
            }
            [.., grandparent, parent] => {
                let (moved, on_edges) = moved.split_at_mut(parent.vertex_count());
                let (oldest, middles) = moved.split_at_mut(grandparent.vertex_count());
                self.move_vertices(ancestors, rings, points, weights, oldest);
                let (on_halves, inside) = placed.split_at_mut(2 * parent.edge_count());
                let (outer, inner) = on_edges.split_at_mut(2 * grandparent.edge_count());
                let (outer_halves, inner_halves) = on_halves.split_at_mut(4 * grandparent.edge_count());
                self.place_on_edges(grandparent, points, weights, (middles, outer, outer_halves));
                grandparent.place_in_triangles(points, (inner, inner_halves, inside));
            }
        }
    }

    /// Any points, each from its own neighbours.
    fn points_by_stencils<P: Point>(&self, points: &[P], weights: LoopWeights, refined: &mut [P]) {
        let (moved, placed) = refined.split_at_mut(self.vertex_count());
        let moved = moved.par_iter_mut().with_min_len(PER_TASK).enumerate();
        moved.for_each(|(v, new)| *new = self.point_by_stencil(id(v), points, weights));
        let placed = placed.par_iter_mut().with_min_len(PER_TASK).enumerate();
        placed.for_each(|(e, new)| *new = self.edge_point_by_stencil(EdgeId(id(e)), points, weights));
    }

    /// Points at the corners of some triangles, on their edges, and at a vertex, one level on; returns the vertices there, in order.
    pub(crate) fn points_of_triangles<P: Point>(
        &self,
        triangles: &[FaceId],
        vertex: u32,
        points: &[P],
        weights: LoopWeights,
        refined: &mut [P],
    ) -> Vec<u32> {
        let counts = self.counts();
        let of_triangle = |triangle: &FaceId| {
            let on_edges = self.triangle_edges(*triangle).map(|edge| counts.edge_vertex(edge));
            self.triangles[triangle.index()].into_iter().chain(on_edges)
        };
        let mut vertices: Vec<u32> = triangles.iter().flat_map(of_triangle).chain([vertex]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        for vertex in &vertices {
            refined[*vertex as usize] = match counts.vertex_parent(*vertex) {
                VertexParent::Vertex(old) => self.point_by_stencil(old, points, weights),
                VertexParent::Edge(edge) => self.edge_point_by_stencil(edge, points, weights),
            };
        }
        vertices
    }

    fn point_by_stencil<P: Point>(&self, vertex: u32, points: &[P], weights: LoopWeights) -> P {
        sum_stencil(points, |mut add| self.loop_vertex_stencil(vertex, weights, &mut add))
    }

    fn edge_point_by_stencil<P: Point>(&self, edge: EdgeId, points: &[P], weights: LoopWeights) -> P {
        sum_stencil(points, |mut add| self.loop_edge_stencil(edge, weights, &mut add))
    }

    /// Whether a vertex has a rule of its own: its ring is not enough to move it.
    pub(crate) fn is_sharp(&self, vertex: usize) -> bool {
        !matches!(self.vertex_rules[vertex], VertexRule::Smooth | VertexRule::Dart)
    }

    /// Where an outgoing edge leads: the vertex at which it does not start.
    fn end(&self, outgoing_edge: u32) -> u32 {
        let [along, _] = self.edges[(outgoing_edge / 2) as usize];
        self.start(if outgoing_edge.is_multiple_of(2) { next(along) } else { along })
    }

    /// Moves the vertices of the coarsest mesh; `neighbour` is the vertex on an outgoing edge.
    fn move_oldest<P: Point>(
        &self,
        points: &[P],
        rings: &BaseRings,
        weights: LoopWeights,
        oldest: &mut [P],
        neighbour: impl Fn(u32) -> u32 + Sync,
    ) {
        oldest.par_iter_mut().with_min_len(PER_TASK).enumerate().for_each(|(v, new)| {
            *new = if self.is_sharp(v) {
                self.point_by_stencil(id(v), points, weights)
            } else {
                let outgoing_edges = rings.outgoing_edges(v);
                let ring =
                    outgoing_edges.iter().map(|&outgoing_edge| points[neighbour(outgoing_edge) as usize]);
                smooth_point(points[v], ring, outgoing_edges.len(), rings.weight(v))
            };
        });
    }

    /// Moves the vertices that the parent's edges got.
    fn move_middles<P: Point>(&self, parent: &Self, points: &[P], weights: LoopWeights, middles: &mut [P]) {
        let middles = middles.par_iter_mut().zip(&parent.edges).with_min_len(PER_TASK).enumerate();
        middles.for_each(|(e, (new, &[along, against]))| {
            let v = parent.vertex_count() + e;
            *new = if self.is_sharp(v) {
                self.point_by_stencil(id(v), points, weights)
            } else {
                let old = |h: u32| points[parent.start(h) as usize];
                let middle = |h: u32| points[parent.vertex_count() + (parent.directed_edge(h) / 2) as usize];
                let [left, right] = [along, against].map(|h| [middle(next(h)), middle(prev(h))]);
                vertex_point(points[v], [old(along), old(against), left[0], left[1], right[0], right[1]])
            };
        });
    }

    /// Places the vertices on all edges.
    fn place_on_all_edges<P: Point>(&self, points: &[P], weights: LoopWeights, placed: &mut [P]) {
        let edges = self.edges.par_iter().zip(&self.sharp_edges);
        placed.par_iter_mut().zip(edges).with_min_len(PER_TASK).enumerate().for_each(
            |(e, (new, (&[along, against], &sharp)))| {
                *new = if sharp {
                    self.edge_point_by_stencil(EdgeId(id(e)), points, weights)
                } else {
                    let at = |h: u32| points[self.start(h) as usize];
                    edge_point(at(along), at(next(along)), at(prev(along)), at(prev(against)))
                };
            },
        );
    }

    /// On the edges of the grandparent: moves the vertices on their middles and halves, and places those on their quarters.
    fn place_on_edges<P: Point>(
        &self,
        grandparent: &Self,
        points: &[P],
        weights: LoopWeights,
        (middles, on_halves, on_quarters): (&mut [P], &mut [P], &mut [P]),
    ) {
        let counts = grandparent.counts();
        let parent_vertices = counts.vertices + counts.edges;
        let on_old = |v: u32| points[v as usize];
        let on_parent_edge = |e: u32| points[(parent_vertices + e) as usize];
        let old = grandparent.edges.par_iter().zip(&grandparent.sharp_edges);
        let new = on_halves.as_chunks_mut::<2>().0.par_iter_mut().zip(on_quarters.as_chunks_mut::<4>().0);
        middles.par_iter_mut().zip(new).zip(old).with_min_len(PER_TASK).enumerate().for_each(
            |(e, ((moved_middle, (on_halves, on_quarters)), (&[along, against], &sharp)))| {
                grandparent.prefetch_beside(e, points);
                let e = id(e);
                if sharp {
                    *moved_middle = self.point_by_stencil(counts.vertices + e, points, weights);
                    for (vertex, new) in (parent_vertices + 2 * e..).zip(on_halves) {
                        *new = self.point_by_stencil(vertex, points, weights);
                    }
                    for (quarter, new) in (4 * e..).zip(on_quarters) {
                        *new = self.edge_point_by_stencil(EdgeId(quarter), points, weights);
                    }
                    return;
                }
                let middle = on_old(counts.vertices + e);
                let (left_start, left_cut_start, left_cut_end, left_end) = grandparent.beside(along, points);
                let (right_end, right_cut_end, right_cut_start, right_start) =
                    grandparent.beside(against, points);
                let [half, rest] = [on_parent_edge(2 * e), on_parent_edge(2 * e + 1)];
                *moved_middle = vertex_point(
                    middle,
                    [half, rest, left_cut_start, left_cut_end, right_cut_end, right_cut_start],
                );
                let start = on_old(grandparent.start(along));
                on_halves[0] = vertex_point(
                    half,
                    [start, middle, left_start, left_cut_start, right_start, right_cut_start],
                );
                on_quarters[0] = edge_point(half, start, left_start, right_start);
                on_quarters[1] = edge_point(half, middle, left_cut_start, right_cut_start);
                let end = on_old(grandparent.start(against));
                on_halves[1] =
                    vertex_point(rest, [end, middle, left_end, left_cut_end, right_end, right_cut_end]);
                on_quarters[2] = edge_point(rest, middle, left_cut_end, right_cut_end);
                on_quarters[3] = edge_point(rest, end, left_end, right_end);
            },
        );
    }

    /// Inside the triangles of the grandparent, this mesh: moves the vertices on the edges that cut off the corners, and places those on
    /// these edges' halves and inside the parent's triangles.
    fn place_in_triangles<P: Point>(
        &self,
        points: &[P],
        (on_cuts, on_halves, inside): (&mut [P], &mut [P], &mut [P]),
    ) {
        let counts = self.counts();
        let parent_vertices = counts.vertices + counts.edges;
        let on_parent_edge = |e: u32| points[(parent_vertices + e) as usize];
        let (in_corners, in_centres) = inside.split_at_mut(9 * self.triangles.len());
        let new = (on_cuts.as_chunks_mut().0.par_iter_mut().zip(on_halves.as_chunks_mut().0))
            .zip(in_corners.as_chunks_mut().0.par_iter_mut().zip(in_centres.as_chunks_mut().0));
        let old = self.triangles.par_iter().zip(&self.directed_edges);
        new.zip(old).with_min_len(PER_TASK).enumerate().for_each(
            |(t, (((on_cuts, on_halves), (in_corners, in_centre)), (corners, directed)))| {
                self.prefetch_around(t, points);
                let first_cut = 2 * counts.edges + 3 * id(t);
                let cuts = [first_cut, first_cut + 1, first_cut + 2].map(on_parent_edge);
                let middles = directed.map(|directed| points[(counts.vertices + directed / 2) as usize]);
                let mut inside = Inside { on_cuts, on_halves, in_corners, in_centre };
                let corner = |k: usize| points[corners[k] as usize];
                let out = |k: usize| on_parent_edge(directed[k]);
                let back = |k: usize| on_parent_edge(directed[k] ^ 1);
                // Written out, so that the compiler knows every index.
                inside.fill_corner([0, 1, 2], corner(0), [out(0), back(2)], &middles, &cuts);
                inside.fill_corner([1, 2, 0], corner(1), [out(1), back(0)], &middles, &cuts);
                inside.fill_corner([2, 0, 1], corner(2), [out(2), back(1)], &middles, &cuts);
            },
        );
    }

    /// Moves the vertices that this mesh shares with its grandparent. A vertex has the same outgoing edges on every level from its birth
    /// on, and the neighbour on an outgoing edge is the vertex that the parent's edge got: no need to turn around the vertex.
    fn move_vertices<P: Point>(
        &self,
        ancestors: &[Self],
        rings: &BaseRings,
        points: &[P],
        weights: LoopWeights,
        moved: &mut [P],
    ) {
        let parent = &ancestors[ancestors.len() - 1];
        let on_outgoing_edge = |directed: u32, levels: usize| {
            // Half after half at the vertex: twice the id, and plus 1 again if the edge ends there.
            let ones = (directed & 1) * ((1 << levels) - 1);
            id(parent.vertex_count()) + ((directed << levels) + ones) / 2
        };
        let (oldest, mut rest) = moved.split_at_mut(ancestors[0].vertex_count());
        self.move_oldest(points, rings, weights, oldest, |outgoing_edge| {
            on_outgoing_edge(outgoing_edge, ancestors.len() - 1)
        });
        for (level, born_on) in ancestors[..ancestors.len() - 2].iter().enumerate() {
            let (born, younger) = rest.split_at_mut(born_on.edge_count());
            rest = younger;
            let first_inner = 2 * id(born_on.edge_count());
            let levels = ancestors.len() - 2 - level;
            born.par_iter_mut().zip(&born_on.edges).with_min_len(PER_TASK).enumerate().for_each(
                |(e, (new, &[along, against]))| {
                    let v = born_on.vertex_count() + e;
                    if self.is_sharp(v) {
                        *new = self.point_by_stencil(id(v), points, weights);
                        return;
                    }
                    let [first_half, inner] = [4 * id(e), 2 * first_inner];
                    let outgoing_edge = |directed: u32| points[on_outgoing_edge(directed, levels) as usize];
                    let ring = [
                        outgoing_edge(first_half + 1),
                        outgoing_edge(first_half + 2),
                        outgoing_edge(inner + 2 * along),
                        outgoing_edge(inner + 2 * next(along) + 1),
                        outgoing_edge(inner + 2 * against),
                        outgoing_edge(inner + 2 * next(against) + 1),
                    ];
                    *new = vertex_point(points[v], ring);
                },
            );
        }
    }
}

impl TriangleMesh {
    /// Points of the mesh two levels on, in the triangle of a half-edge: on the half of the edge before it at its start, on
    /// the edges that cut off its start and its end, and on the half of the edge after it at its end.
    #[inline(always)]
    fn beside<P: Point>(&self, h: u32, points: &[P]) -> (P, P, P, P) {
        let [after, before] = [next(h), prev(h)];
        let first_cut = 2 * id(self.edge_count());
        let on_child_edge = |e: u32| points[self.vertex_count() + self.edge_count() + e as usize];
        (
            on_child_edge(self.directed_edge(before) ^ 1),
            on_child_edge(first_cut + h),
            on_child_edge(first_cut + after),
            on_child_edge(self.directed_edge(after)),
        )
    }

    /// Asks for the points around triangles to come.
    #[inline(always)]
    fn prefetch_around<P: Point>(&self, triangle: usize, points: &[P]) {
        let first_on_edges = self.vertex_count() + self.edge_count();
        for &directed in self.directed_edges.get(triangle + AHEAD).into_iter().flatten() {
            let edge = (directed / 2) as usize;
            prefetch(points, self.vertex_count() + edge);
            prefetch(points, first_on_edges + 2 * edge);
            prefetch(points, first_on_edges + 2 * edge + 1);
        }
    }

    /// Asks for the points [`beside`](Self::beside) edges to come.
    #[inline(always)]
    fn prefetch_beside<P: Point>(&self, edge: usize, points: &[P]) {
        for &h in self.edges.get(edge + 2 * AHEAD).into_iter().flatten() {
            prefetch(&self.directed_edges, (h / 3) as usize);
        }
        let first_cut = 2 * self.edge_count();
        let prefetch_on_child_edge = |e: usize| prefetch(points, self.vertex_count() + self.edge_count() + e);
        for &h in self.edges.get(edge + AHEAD).into_iter().flatten() {
            let Some(directed) = self.directed_edges.get((h / 3) as usize) else { continue };
            prefetch_on_child_edge(first_cut + 3 * (h / 3) as usize);
            prefetch_on_child_edge(first_cut + 3 * (h / 3) as usize + 2);
            for directed in directed {
                prefetch_on_child_edge(*directed as usize);
            }
        }
    }
}

/// The new points inside a triangle of the grandparent.
struct Inside<'a, P> {
    /// On the edges that cut off its corners, moved.
    on_cuts: &'a mut [P; 3],
    /// On these edges' halves.
    on_halves: &'a mut [P; 6],
    /// Inside the parent's triangles at its corners.
    in_corners: &'a mut [P; 9],
    /// Inside the parent's triangle at its centre.
    in_centre: &'a mut [P; 3],
}

impl<P: Point> Inside<'_, P> {
    /// What lies next to corner `k`, from the corner, the middles of the halves there of the edges after and before it, the middles of all
    /// edges, and those of the edges that cut off the corners.
    #[inline(always)]
    fn fill_corner(
        &mut self,
        [k, after, before]: [usize; 3],
        corner: P,
        [out, back]: [P; 2],
        middles: &[P; 3],
        cuts: &[P; 3],
    ) {
        let [ahead, behind, cut] = [middles[k], middles[before], cuts[k]];
        self.on_cuts[k] = vertex_point(cut, [ahead, back, behind, out, cuts[after], cuts[before]]);
        self.on_halves[2 * k] = edge_point(cut, ahead, out, cuts[after]);
        self.on_halves[2 * k + 1] = edge_point(cut, behind, back, cuts[before]);
        self.in_corners[3 * k] = edge_point(out, back, corner, cut);
        self.in_corners[3 * k + 1] = edge_point(cut, out, ahead, back);
        self.in_corners[3 * k + 2] = edge_point(back, cut, behind, out);
        self.in_centre[k] = edge_point(cut, cuts[before], behind, cuts[after]);
    }
}

/// The new place of a smooth vertex, of which each neighbour has this weight.
pub(crate) fn smooth_point<P: Point>(
    vertex: P,
    ring: impl Iterator<Item = P>,
    valence: usize,
    neighbour: f64,
) -> P {
    #[allow(clippy::cast_precision_loss)]
    let own = 1.0 - valence as f64 * neighbour;
    let sum = ring.fold(P::zero(), |sum, p| sum.add_scaled(p, 1.0));
    vertex.scaled(own).add_scaled(sum, neighbour)
}

/// The new place of a smooth vertex with six neighbours, the same for Loop's and Warren's weights.
#[inline(always)]
pub(crate) fn vertex_point<P: Point>(vertex: P, ring: [P; 6]) -> P {
    let [a, b, c, d, e, f] = ring;
    let pairs = [a.add_scaled(b, 1.0), c.add_scaled(d, 1.0), e.add_scaled(f, 1.0)];
    let ring = pairs[0].add_scaled(pairs[1], 1.0).add_scaled(pairs[2], 1.0);
    vertex.scaled(0.625).add_scaled(ring, 0.0625)
}

/// The point on a smooth edge from its ends and the apexes of its triangles.
#[inline(always)]
pub(crate) fn edge_point<P: Point>(a: P, b: P, c: P, d: P) -> P {
    let ends = a.add_scaled(b, 1.0);
    let apexes = c.add_scaled(d, 1.0);
    ends.scaled(0.375).add_scaled(apexes, 0.125)
}
