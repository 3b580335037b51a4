//! Loop subdivision of points straight from connectivity, without tables.
//!
//! From the third step on, the mesh two levels *up*, with a sixteenth of the triangles, says everything about the neighbours of
//! its descendants: 15 points make 21 new ones inside each of its triangles, and 13 make 6 on each of its edges. So little
//! is read, and in order, to write much.

use rayon::prelude::*;

use crate::ids::{id, next, prev};
use crate::{LoopWeights, Point, TriangleMesh, VertexRule};

/// Points or parents that one task takes.
const PER_TASK: usize = 1024;

impl TriangleMesh {
    /// Writes the points one level on: what the rows of [`loop_refine_with`](Self::loop_refine_with) make of `points`, up to
    /// rounding. `ancestors` are the meshes from which this one was refined, coarsest first.
    pub(crate) fn loop_points<P: Point>(
        &self,
        ancestors: &[Self],
        points: &[P],
        weights: LoopWeights,
        refined: &mut [P],
    ) {
        assert_eq!(points.len(), self.vertex_count(), "there must be one point per vertex");
        match ancestors {
            // Sector weights depend on more than ancestors' edges can tell.
            [.., grandparent, parent] if weights != LoopWeights::BiermannLevinZorin => {
                let (moved, rest) = refined.split_at_mut(parent.vertex_count());
                self.move_vertices(ancestors, points, weights, moved);
                let (on_edges, rest) = rest.split_at_mut(parent.edge_count());
                let (on_halves, inside) = rest.split_at_mut(2 * parent.edge_count());
                let (outer, inner) = on_edges.split_at_mut(2 * grandparent.edge_count());
                let (outer_halves, inner_halves) = on_halves.split_at_mut(4 * grandparent.edge_count());
                self.place_on_edges(grandparent, points, weights, (outer, outer_halves));
                grandparent.place_in_triangles(points, (inner, inner_halves, inside));
            }
            _ => self.points_by_rows(points, weights, refined),
        }
    }

    /// Any points, each from its own neighbours.
    fn points_by_rows<P: Point>(&self, points: &[P], weights: LoopWeights, refined: &mut [P]) {
        let (moved, placed) = refined.split_at_mut(self.vertex_count());
        moved.par_iter_mut().zip(&self.vertex_rules).with_min_len(PER_TASK).enumerate().for_each(
            |(v, (new, rule))| {
                *new = if matches!(rule, VertexRule::Smooth | VertexRule::Dart) {
                    let ring = self.ring(self.outgoing[v]).map(|h| points[self.start(next(h)) as usize]);
                    smooth_point(points[v], ring, weights)
                } else {
                    sum_row(points, |mut add| self.loop_vertex_row(id(v), weights, &mut add))
                };
            },
        );
        let edges = self.edges.par_iter().zip(&self.sharp_edges);
        placed.par_iter_mut().zip(edges).with_min_len(PER_TASK).enumerate().for_each(
            |(e, (new, (&[along, against], &sharp)))| {
                *new = if sharp || weights == LoopWeights::BiermannLevinZorin {
                    sum_row(points, |mut add| self.loop_edge_row(id(e), weights, &mut add))
                } else {
                    let at = |h: u32| points[self.start(h) as usize];
                    edge_point(at(along), at(next(along)), at(prev(along)), at(prev(against)))
                };
            },
        );
    }

    /// On the edges of the grandparent: moves the vertices on their halves, and places those on their quarters.
    fn place_on_edges<P: Point>(
        &self,
        grandparent: &Self,
        points: &[P],
        weights: LoopWeights,
        (on_halves, on_quarters): (&mut [P], &mut [P]),
    ) {
        let counts = grandparent.counts();
        let parent_vertices = counts.vertices + counts.edges;
        let on_old = |v: u32| points[v as usize];
        let on_parent_edge = |e: u32| points[(parent_vertices + e) as usize];
        let old = grandparent.edges.par_iter().zip(&grandparent.sharp_edges);
        let new = on_halves.par_chunks_exact_mut(2).zip(on_quarters.par_chunks_exact_mut(4));
        new.zip(old).with_min_len(PER_TASK).enumerate().for_each(
            |(e, ((on_halves, on_quarters), (&[along, against], &sharp)))| {
                let e = id(e);
                if sharp {
                    for (half, new) in (0..).zip(on_halves) {
                        let vertex = parent_vertices + 2 * e + half;
                        *new = sum_row(points, |mut add| self.loop_vertex_row(vertex, weights, &mut add));
                    }
                    for (quarter, new) in (0..).zip(on_quarters) {
                        *new =
                            sum_row(points, |mut add| self.loop_edge_row(4 * e + quarter, weights, &mut add));
                    }
                    return;
                }
                let middle = on_old(counts.vertices + e);
                let (left_start, left_cut_start, left_cut_end, left_end) = grandparent.beside(along, points);
                let (right_end, right_cut_end, right_cut_start, right_start) =
                    grandparent.beside(against, points);
                let start = on_old(grandparent.start(along));
                let [half, rest] = [on_parent_edge(2 * e), on_parent_edge(2 * e + 1)];
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
        let new = (on_cuts.par_chunks_exact_mut(3).zip(on_halves.par_chunks_exact_mut(6)))
            .zip(in_corners.par_chunks_exact_mut(9).zip(in_centres.par_chunks_exact_mut(3)));
        let old = self.triangles.par_iter().zip(&self.directed_edges);
        new.zip(old).with_min_len(PER_TASK).enumerate().for_each(
            |(t, (((on_cuts, on_halves), (in_corners, in_centre)), (corners, directed)))| {
                let first_cut = 2 * counts.edges + 3 * id(t);
                let cuts =
                    [on_parent_edge(first_cut), on_parent_edge(first_cut + 1), on_parent_edge(first_cut + 2)];
                let middle = |k: usize| points[(counts.vertices + directed[k] / 2) as usize];
                let middles = [middle(0), middle(1), middle(2)];
                for (k, after, before) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
                    // The triangle at corner k: the corner, the middles of the edges after and before it, and what
                    // lies between the three.
                    let corner = points[corners[k] as usize];
                    let [out, back] = [on_parent_edge(directed[k]), on_parent_edge(directed[before] ^ 1)];
                    let [ahead, behind, cut] = [middles[k], middles[before], cuts[k]];
                    on_cuts[k] = vertex_point(cut, [ahead, behind, out, back, cuts[after], cuts[before]]);
                    on_halves[2 * k] = edge_point(cut, ahead, out, cuts[after]);
                    on_halves[2 * k + 1] = edge_point(cut, behind, back, cuts[before]);
                    in_corners[3 * k] = edge_point(out, back, corner, cut);
                    in_corners[3 * k + 1] = edge_point(cut, out, ahead, back);
                    in_corners[3 * k + 2] = edge_point(back, cut, behind, out);
                    in_centre[k] = edge_point(cut, cuts[before], behind, cuts[after]);
                }
            },
        );
    }

    /// Moves the vertices that this mesh shares with its parent. A vertex has the same spokes on every level from its birth
    /// on, and the neighbour on a spoke is the vertex that the parent's edge got: no need to turn around the vertex.
    fn move_vertices<P: Point>(
        &self,
        ancestors: &[Self],
        points: &[P],
        weights: LoopWeights,
        moved: &mut [P],
    ) {
        let parent = &ancestors[ancestors.len() - 1];
        let on_spoke = |directed: u32, levels: usize| {
            // Half after half at the vertex: twice the id, and plus 1 again if the edge ends there.
            let ones = (directed & 1) * ((1 << levels) - 1);
            points[parent.vertex_count() + (((directed << levels) + ones) / 2) as usize]
        };
        let is_sharp = |v: usize| !matches!(self.vertex_rules[v], VertexRule::Smooth | VertexRule::Dart);
        let sharp = |v: usize| sum_row(points, |mut add| self.loop_vertex_row(id(v), weights, &mut add));

        let (oldest, mut rest) = moved.split_at_mut(ancestors[0].vertex_count());
        oldest.par_iter_mut().with_min_len(PER_TASK).enumerate().for_each(|(v, new)| {
            if is_sharp(v) {
                *new = sharp(v);
                return;
            }
            let base = &ancestors[0];
            let spokes =
                base.ring(base.outgoing[v]).map(|h| on_spoke(base.directed_edge(h), ancestors.len() - 1));
            *new = smooth_point(points[v], spokes, weights);
        });
        for (level, born_on) in ancestors[..ancestors.len() - 1].iter().enumerate() {
            let (born, younger) = rest.split_at_mut(born_on.edge_count());
            rest = younger;
            let first_inner = 2 * id(born_on.edge_count());
            let levels = ancestors.len() - 2 - level;
            born.par_iter_mut().zip(&born_on.edges).with_min_len(PER_TASK).enumerate().for_each(
                |(e, (new, &[along, against]))| {
                    let v = born_on.vertex_count() + e;
                    if is_sharp(v) {
                        *new = sharp(v);
                        return;
                    }
                    let [first_half, inner] = [4 * id(e), 2 * first_inner];
                    let spoke = |directed: u32| on_spoke(directed, levels);
                    let ring = [
                        spoke(first_half + 1),
                        spoke(first_half + 2),
                        spoke(inner + 2 * along),
                        spoke(inner + 2 * next(along) + 1),
                        spoke(inner + 2 * against),
                        spoke(inner + 2 * next(against) + 1),
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
}

/// The new place of a smooth vertex.
fn smooth_point<P: Point>(vertex: P, ring: impl Iterator<Item = P>, weights: LoopWeights) -> P {
    let (valence, sum) = ring.fold((0, P::zero()), |(valence, sum), p| (valence + 1, sum.add_scaled(p, 1.0)));
    let neighbour = weights.neighbour(valence);
    #[allow(clippy::cast_precision_loss)]
    let own = 1.0 - valence as f64 * neighbour;
    P::zero().add_scaled(vertex, own).add_scaled(sum, neighbour)
}

/// The new place of a smooth vertex with six neighbours, the same for Loop's and Warren's weights.
#[inline(always)]
fn vertex_point<P: Point>(vertex: P, ring: [P; 6]) -> P {
    let [a, b, c, d, e, f] = ring;
    let ring = a
        .add_scaled(b, 1.0)
        .add_scaled(c, 1.0)
        .add_scaled(d, 1.0)
        .add_scaled(e, 1.0)
        .add_scaled(f, 1.0)
        .add_scaled(vertex, 10.0);
    P::zero().add_scaled(ring, 0.0625)
}

/// The point on a smooth edge from its ends and the apexes of its triangles.
#[inline(always)]
fn edge_point<P: Point>(a: P, b: P, c: P, d: P) -> P {
    let ends = a.add_scaled(b, 1.0);
    let apexes = c.add_scaled(d, 1.0);
    P::zero().add_scaled(apexes.add_scaled(ends, 3.0), 0.125)
}

fn sum_row<P: Point>(points: &[P], row: impl FnOnce(&mut dyn FnMut(u32, f64))) -> P {
    let mut sum = P::zero();
    row(&mut |point, weight| sum = sum.add_scaled(points[point as usize], weight));
    sum
}
