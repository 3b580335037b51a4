//! Catmull-Clark subdivision (1978) with creases, semi-sharp creases and boundaries, and its limits.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use rayon::prelude::*;

use crate::ids::{NONE, id};
use crate::mesh_checks::check_size;
use crate::stencil::Rows;
use crate::vertex_rows::vertex_row;
use crate::{MeshError, PolygonMesh, Refinement, StencilTable, VertexRule};

/// Limit positions and tangents of a Catmull-Clark surface at the vertices of a mesh, as averages of its points.
#[derive(Clone, Debug, PartialEq)]
pub struct CatmullClarkLimits {
    /// One row per vertex: its limit position.
    pub positions: StencilTable,
    /// Two rows per vertex, that add up to 0: limit tangents t1 and t2 with the normal along t1 x t2. The rows are empty
    /// at vertices that are not smooth.
    pub tangents: StencilTable,
}

/// A count as a number to compute with; no mesh has so many edges that this would round.
#[allow(clippy::cast_precision_loss)]
fn real(count: usize) -> f64 {
    count as f64
}

impl PolygonMesh {
    /// One step of Catmull-Clark subdivision; every refined face has four corners.
    ///
    /// With V vertices, E edges and the half-edge h from a corner of a face to the next: vertex v stays v, edge e gets
    /// the vertex V + e and face f the vertex V + E + f. The face at the corner where h starts is face h, and begins there. The
    /// halves of edge e are 2 e, at its end 0, and 2 e + 1, and the edge 2 E + h joins the edge of h to the face's centre.
    ///
    /// # Panics
    /// If the finer mesh outgrows 32-bit ids.
    pub fn catmull_clark_refine(&self) -> Refinement<Self> {
        let [vertices, edges, half_edges] = [self.vertex_count(), self.edge_count(), self.corners.len()];
        for (what, count) in
            [("vertices", vertices + edges + self.face_count()), ("half-edges", half_edges.saturating_mul(8))]
        {
            if let Err(error) = check_size(what, count) {
                panic!("the finer mesh does not fit: {error}");
            }
        }
        let sharpness = self
            .sharpness
            .refine(vertices, |vertex, edge| self.start(self.edges[edge as usize][0]) == vertex);
        let edge_vertex = |h: u32| id(vertices) + self.directed_edges[h as usize] / 2;
        let face_vertex = |h: u32| id(vertices + edges) + self.faces_of[h as usize];
        let inner = |h: u32| 2 * (id(2 * edges) + h);
        let quads = (0..id(half_edges)).into_par_iter();
        let corners: Vec<[u32; 4]> = quads
            .clone()
            .map(|h| [self.start(h), edge_vertex(h), face_vertex(h), edge_vertex(self.prev(h))])
            .collect();
        let directed_edges: Vec<[u32; 4]> = quads
            .clone()
            .map(|h| {
                let before = self.prev(h);
                let [out, back] = [h, before].map(|h| self.directed_edges[h as usize]);
                [2 * out + out % 2, inner(h), inner(before) + 1, 2 * (back ^ 1) + back % 2]
            })
            .collect();
        let halves = self.edges.par_iter().flat_map_iter(|&[along, against]| {
            let other = |h: u32| if against == NONE { NONE } else { h };
            let [before, after] = if against == NONE { [0; 2] } else { [self.next(against), against] };
            [[4 * along, other(4 * before + 3)], [4 * self.next(along) + 3, other(4 * after)]]
        });
        let inner_edges = quads.clone().map(|h| [4 * h + 1, 4 * self.next(h) + 2]);
        let outgoing = (self.outgoing.iter().map(|&h| if h == NONE { NONE } else { 4 * h }))
            .chain(self.edges.iter().map(|&[along, _]| 4 * along + 1))
            .chain(self.face_starts[..self.face_count()].iter().map(|&h| 4 * h + 2))
            .collect::<Vec<u32>>();
        let mesh = Self {
            face_starts: (0..=id(half_edges)).map(|h| 4 * h).collect(),
            faces_of: (0..id(4 * half_edges)).map(|h| h / 4).collect(),
            corners: corners.into_flattened(),
            directed_edges: directed_edges.into_flattened(),
            edges: halves.chain(inner_edges).collect(),
            vertex_rules: sharpness.vertex_rules(outgoing.len()),
            sharp_edges: sharpness.sharp_edges(2 * edges + half_edges),
            outgoing,
            sharpness,
        };
        Refinement { mesh, stencils: self.catmull_clark_stencils() }
    }

    fn catmull_clark_stencils(&self) -> StencilTable {
        let [vertices, edges] = [self.vertex_count(), self.edge_count()].map(id);
        let count = self.vertex_count() + self.edge_count() + self.face_count();
        StencilTable::from_rows(count, |i, rows| {
            if i < vertices {
                let rule = (i, self.vertex_rule(i));
                let other_end = |edge| self.other_end(edge, i);
                let mut add = |point: u32, weight: f64| rows.add(point, weight);
                vertex_row(&self.sharpness, rule, &mut add, other_end, |share, add| {
                    self.smooth_vertex_row(i, share, add);
                });
                rows.merge();
            } else if i < vertices + edges {
                self.catmull_clark_edge_row(i - vertices, rows);
            } else {
                self.add_face_point(i - vertices - edges, 1.0, &mut |point, weight| rows.add(point, weight));
            }
        })
    }

    fn catmull_clark_edge_row(&self, edge: u32, rows: &mut Rows) {
        let sharp = if self.sharp_edges[edge as usize] { self.sharpness.of_edge(edge).min(1.0) } else { 0.0 };
        let smooth = 1.0 - f64::from(sharp);
        for end in self.edge(edge) {
            rows.add(end, 0.5 - 0.25 * smooth);
        }
        if smooth > 0.0 {
            for side in self.edges[edge as usize] {
                self.add_face_point(self.faces_of[side as usize], 0.25 * smooth, &mut |point, weight| {
                    rows.add(point, weight)
                });
            }
            rows.merge();
        }
    }

    /// (F + 2 R + (n - 3) v)/n, with F the mean of the face points and R that of the midpoints of the n edges.
    fn smooth_vertex_row(&self, vertex: u32, share: f64, add: &mut impl FnMut(u32, f64)) {
        let first = self.outgoing[vertex as usize];
        let n = real(self.ring(first).count());
        add(vertex, share * (n - 2.0) / n);
        for h in self.ring(first) {
            add(self.end(h), share / (n * n));
            self.add_face_point(self.faces_of[h as usize], share / (n * n), add);
        }
    }

    fn add_face_point(&self, face: u32, share: f64, add: &mut impl FnMut(u32, f64)) {
        let corners = self.face(face);
        corners.iter().for_each(|&corner| add(corner, share / real(corners.len())));
    }

    /// Limit positions of all vertices, and limit tangents of the smooth ones.
    ///
    /// # Errors
    /// [`MeshError::SemiSharp`] names a vertex with a sharpness that will run out: refine until it has.
    pub fn catmull_clark_limits(&self) -> Result<CatmullClarkLimits, MeshError> {
        self.sharpness.check_settled()?;
        // The masks are known where all faces have four corners, as they do one level on.
        let Refinement { mesh: quads, stencils } = self.catmull_clark_refine();
        let positions = StencilTable::from_rows(self.vertex_count(), |v, rows| quads.limit_position(v, rows));
        let tangents = StencilTable::from_rows(2 * self.vertex_count(), |row, rows| {
            if quads.vertex_rule(row / 2) == VertexRule::Smooth {
                quads.limit_tangent(row / 2, row % 2 == 0, rows);
            }
        });
        Ok(CatmullClarkLimits { positions: stencils.then(&positions), tangents: stencils.then(&tangents) })
    }

    /// The limit position of a vertex among four-sided faces.
    fn limit_position(&self, vertex: u32, rows: &mut Rows) {
        let first = self.outgoing[vertex as usize];
        match self.vertex_rule(vertex) {
            VertexRule::Corner => rows.add(vertex, 1.0),
            VertexRule::Crease => {
                rows.add(vertex, 4.0 / 6.0);
                for spoke in self.sharpness.spokes(vertex) {
                    rows.add(self.other_end(spoke.edge, vertex), 1.0 / 6.0);
                }
            }
            VertexRule::Smooth => {
                let n = real(self.ring(first).count());
                rows.add(vertex, n / (n + 5.0));
                for h in self.ring(first) {
                    rows.add(self.end(h), 4.0 / (n * (n + 5.0)));
                    rows.add(self.start(self.prev(self.prev(h))), 1.0 / (n * (n + 5.0)));
                }
            }
            VertexRule::Dart => {
                let is_sharp = |&h: &u32| self.is_crease(self.directed_edges[h as usize] / 2);
                let start = self.ring(first).find(is_sharp).unwrap_or(first);
                let weights = dart_limit(self.ring(start).count());
                rows.add(vertex, weights[0]);
                for (h, pair) in self.ring(start).zip(weights[1..].chunks_exact(2)) {
                    rows.add(self.end(h), pair[0]);
                    rows.add(self.start(self.prev(self.prev(h))), pair[1]);
                }
            }
        }
    }

    /// A limit tangent of a smooth vertex among four-sided faces: the one that points along the first edge of its ring, or
    /// the one a quarter turn on.
    fn limit_tangent(&self, vertex: u32, along: bool, rows: &mut Rows) {
        let first = self.outgoing[vertex as usize];
        let n = real(self.ring(first).count());
        let edge_weight = 1.0 + (TAU / n).cos() + (PI / n).cos() * (2.0 * (9.0 + (TAU / n).cos())).sqrt();
        let wave = |angle: f64| if along { angle.cos() } else { angle.sin() };
        for (i, h) in self.ring(first).enumerate() {
            let [here, next] = [real(i), real(i + 1)].map(|i| wave(TAU * i / n));
            rows.add(self.end(h), edge_weight * here);
            rows.add(self.start(self.prev(self.prev(h))), here + next);
        }
    }
}

/// Steps of the iteration for a dart's limit; each shrinks the error by a third at least, rounding stops it earlier.
const DART_ITERATIONS: usize = 200;

/// Limit weights of a dart of four-sided faces: of the centre, then of each edge's end and the face corner after it, from the
/// sharp edge on. They are the left eigenvector of the rules for the eigenvalue 1, found by iteration.
fn dart_limit(valence: usize) -> Vec<f64> {
    let n = real(valence);
    let mut weights = vec![1.0 / (2.0 * n + 1.0); 2 * valence + 1];
    for _ in 0..DART_ITERATIONS {
        let mut next = vec![0.0; weights.len()];
        // The new centre has a face point and an edge in each direction.
        next[0] += weights[0] * (1.0 - 7.0 / (4.0 * n));
        for i in 0..valence {
            let [edge, face] = [1 + 2 * i, 2 + 2 * i];
            let [edge_after, face_before] =
                [1 + 2 * ((i + 1) % valence), 2 + 2 * ((i + valence - 1) % valence)];
            next[edge] += weights[0] * 3.0 / (2.0 * n * n);
            next[face] += weights[0] / (4.0 * n * n);
            // The new face points.
            for corner in [0, edge, face, edge_after] {
                next[corner] += weights[face] / 4.0;
            }
            // The new edge points; edge 0 is sharp.
            if i == 0 {
                next[0] += weights[edge] / 2.0;
                next[edge] += weights[edge] / 2.0;
            } else {
                next[0] += weights[edge] * 3.0 / 8.0;
                next[edge] += weights[edge] * 3.0 / 8.0;
                let edge_before = 1 + 2 * (i - 1);
                for corner in [face, face_before, edge_before, edge_after] {
                    next[corner] += weights[edge] / 16.0;
                }
            }
        }
        let change = next.iter().zip(&weights).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        weights = next;
        if change < f64::EPSILON / 16.0 {
            break;
        }
    }
    weights
}

impl CatmullClarkLimits {
    /// The unit normal at each smooth vertex; nothing elsewhere, and where the points are degenerate.
    ///
    /// # Panics
    /// If `points` has fewer points than the mesh has vertices.
    pub fn normals(&self, points: &[DVec3]) -> Vec<Option<DVec3>> {
        let tangents = self.tangents.apply(points);
        tangents.par_chunks_exact(2).map(|t| t[0].cross(t[1]).try_normalize()).collect()
    }
}
