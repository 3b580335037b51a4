//! Loop subdivision of points straight from connectivity, without tables.
//!
//! From the second step on, the mesh one level *up* says everything about its children's neighbours: around the vertex on an
//! edge lie the ends of the edge and the vertices on the other edges of its two triangles. Seven points make three
//! new ones there, and six make three inside each triangle, so little is read to write much.

use rayon::prelude::*;

use crate::ids::{id, next, prev};
use crate::{LoopWeights, Point, TriangleMesh, VertexRule};

/// Points or parents that one task takes.
const PER_TASK: usize = 1024;

/// Valences up to which the neighbours' weight is computed once.
const COMMON_VALENCES: usize = 32;

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
        match ancestors.last() {
            // Sector weights depend on more than ancestors' edges can tell.
            Some(parent) if weights != LoopWeights::BiermannLevinZorin => {
                let (moved, rest) = refined.split_at_mut(parent.vertex_count());
                self.move_vertices(ancestors, points, weights, moved);
                self.place_vertices(parent, points, weights, rest);
            }
            _ => {
                let vertices = self.counts().vertices;
                refined.par_iter_mut().with_min_len(PER_TASK).enumerate().for_each(|(i, new)| {
                    let i = id(i);
                    *new = if i < vertices {
                        sum_row(points, |mut add| self.loop_vertex_row(i, weights, &mut add))
                    } else {
                        sum_row(points, |mut add| self.loop_edge_row(i - vertices, weights, &mut add))
                    };
                });
            }
        }
    }

    /// Moves the vertices on the parent's edges, and places those on this mesh's.
    fn place_vertices<P: Point>(&self, parent: &Self, points: &[P], weights: LoopWeights, refined: &mut [P]) {
        let [vertices, edges] = [parent.vertex_count(), parent.edge_count()];
        let (on_edges, rest) = refined.split_at_mut(edges);
        let (on_halves, inside) = rest.split_at_mut(2 * edges);
        let on_edge = |h: u32| points[vertices + (parent.directed_edge(h) / 2) as usize];
        let neighbour = weights.neighbour(6);
        let centre = 1.0 - 6.0 * neighbour;
        let halves = on_halves.par_chunks_exact_mut(2);
        let old = parent.edges.par_iter().zip(&parent.sharp_edges);
        on_edges.par_iter_mut().zip(halves).zip(old).with_min_len(PER_TASK).enumerate().for_each(
            |(e, ((new, halves), (&[along, against], &sharp)))| {
                let middle = vertices + e;
                if sharp {
                    *new = sum_row(points, |mut add| self.loop_vertex_row(id(middle), weights, &mut add));
                    for (half, new) in halves.iter_mut().enumerate() {
                        *new = sum_row(points, |mut add| {
                            self.loop_edge_row(id(2 * e + half), weights, &mut add)
                        });
                    }
                    return;
                }
                let middle = points[middle];
                let ends = [along, next(along)].map(|h| points[parent.start(h) as usize]);
                // The vertices beside the halves at the start and at the end of the edge.
                let [at_start, at_end] = [
                    [on_edge(prev(along)), on_edge(next(against))],
                    [on_edge(next(along)), on_edge(prev(against))],
                ];
                let ring = [ends, at_start, at_end]
                    .as_flattened()
                    .iter()
                    .fold(P::zero(), |sum, &p| sum.add_scaled(p, 1.0));
                *new = P::zero().add_scaled(middle, centre).add_scaled(ring, neighbour);
                for (new, (end, [c, d])) in halves.iter_mut().zip([(ends[0], at_start), (ends[1], at_end)]) {
                    *new = edge_point(middle, end, c, d);
                }
            },
        );
        let old = parent.triangles.par_iter().zip(&parent.directed_edges);
        inside.par_chunks_exact_mut(3).zip(old).with_min_len(PER_TASK).for_each(
            |(new, (corners, directed))| {
                let corner = corners.map(|v| points[v as usize]);
                let on_edge = directed.map(|d| points[vertices + (d / 2) as usize]);
                // Across corner k, between the vertices on the edges before and after it.
                new[0] = edge_point(on_edge[0], on_edge[2], corner[0], on_edge[1]);
                new[1] = edge_point(on_edge[1], on_edge[0], corner[1], on_edge[2]);
                new[2] = edge_point(on_edge[2], on_edge[1], corner[2], on_edge[0]);
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
        let common: Vec<f64> =
            (0..COMMON_VALENCES).map(|valence| weights.neighbour(valence.max(1))).collect();
        let on_spoke = |directed: u32, levels: usize| {
            // Half after half at the vertex: twice the id, and plus 1 again if the edge ends there.
            let ones = (directed & 1) * ((1 << levels) - 1);
            points[parent.vertex_count() + (((directed << levels) + ones) / 2) as usize]
        };
        let smooth = |v: usize, valence: usize, ring: P| {
            let neighbour = common.get(valence).copied().unwrap_or_else(|| weights.neighbour(valence));
            #[allow(clippy::cast_precision_loss)]
            let own = 1.0 - valence as f64 * neighbour;
            P::zero().add_scaled(points[v], own).add_scaled(ring, neighbour)
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
            let (valence, ring) = spokes
                .fold((0, P::zero()), |(valence, sum), point| (valence + 1, sum.add_scaled(point, 1.0)));
            *new = smooth(v, valence, ring);
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
                    let spokes = [
                        first_half + 1,
                        first_half + 2,
                        inner + 2 * along,
                        inner + 2 * next(along) + 1,
                        inner + 2 * against,
                        inner + 2 * next(against) + 1,
                    ];
                    let ring =
                        spokes.into_iter().fold(P::zero(), |sum, d| sum.add_scaled(on_spoke(d, levels), 1.0));
                    *new = smooth(v, 6, ring);
                },
            );
        }
    }
}

/// The point on a smooth edge from its ends and the apexes of its triangles.
fn edge_point<P: Point>(a: P, b: P, c: P, d: P) -> P {
    P::zero().add_scaled(a, 0.375).add_scaled(b, 0.375).add_scaled(c, 0.125).add_scaled(d, 0.125)
}

fn sum_row<P: Point>(points: &[P], row: impl FnOnce(&mut dyn FnMut(u32, f64))) -> P {
    let mut sum = P::zero();
    row(&mut |point, weight| sum = sum.add_scaled(points[point as usize], weight));
    sum
}
