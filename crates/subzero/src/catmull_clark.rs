//! Catmull-Clark subdivision (1978) with creases, semi-sharp creases and boundaries.

use rayon::prelude::*;

use crate::ids::{NONE, id};
use crate::mesh_checks::check_size;
use crate::stencil::StencilWriter;
use crate::vertex_stencils::vertex_stencil;
use crate::{EdgeId, FaceId, MeshError, PolygonMesh, Refinement, StencilTable};

/// A count as a number to compute with; no mesh has so many edges that this would round.
#[allow(clippy::cast_precision_loss)]
pub(crate) fn real(count: usize) -> f64 {
    count as f64
}

impl PolygonMesh {
    /// One step of Catmull-Clark subdivision; every refined face has four corners.
    ///
    /// With V vertices, E edges and the half-edge h from a corner of a face to the next: vertex v stays v, edge e gets
    /// the vertex V + e and face f the vertex V + E + f. The face at the corner where h starts is face h, and begins there. The
    /// halves of edge e are 2 e, at its end 0, and 2 e + 1, and the edge 2 E + h joins the edge of h to the face's centre.
    ///
    /// ```
    /// use subzero::{Features, PolygonMesh};
    ///
    /// let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]].map(Vec::from);
    /// let cube = PolygonMesh::new(8, &faces, &Features::default())?;
    /// let finer = cube.catmull_clark_refine()?.mesh;
    /// assert_eq!((finer.vertex_count(), finer.face_count()), (8 + 12 + 6, 24));
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the finer mesh outgrows 32-bit ids.
    pub fn catmull_clark_refine(&self) -> Result<Refinement<Self>, MeshError> {
        let [vertices, edges, half_edges] = [self.vertex_count(), self.edge_count(), self.corners.len()];
        check_size("vertices", vertices + edges + self.face_count())?;
        check_size("half-edges", half_edges.saturating_mul(8))?;
        let sharpness =
            self.sharpness.refine(vertices, |vertex, edge| self.start(self.edges[edge.index()][0]) == vertex);
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
        Ok(Refinement { mesh, stencils: self.catmull_clark_stencils() })
    }

    fn catmull_clark_stencils(&self) -> StencilTable {
        let [vertices, edges] = [self.vertex_count(), self.edge_count()].map(id);
        let count = self.vertex_count() + self.edge_count() + self.face_count();
        StencilTable::from_stencils(count, |i, stencil| {
            if i < vertices {
                let rule = (i, self.vertex_rule(i));
                let other_end = |edge| self.other_end(edge, i);
                let mut add = |point: u32, weight: f64| stencil.add(point, weight);
                vertex_stencil(&self.sharpness, rule, &mut add, other_end, |scale, add| {
                    self.smooth_vertex_stencil(i, scale, add);
                });
                stencil.merge();
            } else if i < vertices + edges {
                self.catmull_clark_edge_stencil(EdgeId(i - vertices), stencil);
            } else {
                self.add_face_point(i - vertices - edges, 1.0, &mut |point, weight| {
                    stencil.add(point, weight)
                });
            }
        })
    }

    fn catmull_clark_edge_stencil(&self, edge: EdgeId, stencil: &mut StencilWriter) {
        let sharp = if self.sharp_edges[edge.index()] { self.sharpness.of_edge(edge).min(1.0) } else { 0.0 };
        let smooth = 1.0 - f64::from(sharp);
        for end in self.edge(edge) {
            stencil.add(end, 0.5 - 0.25 * smooth);
        }
        if smooth > 0.0 {
            for side in self.edges[edge.index()] {
                self.add_face_point(self.faces_of[side as usize], 0.25 * smooth, &mut |point, weight| {
                    stencil.add(point, weight)
                });
            }
            stencil.merge();
        }
    }

    /// (F + 2 R + (n - 3) v)/n, with F the mean of the face points and R that of the midpoints of the n edges.
    fn smooth_vertex_stencil(&self, vertex: u32, scale: f64, add: &mut impl FnMut(u32, f64)) {
        let first = self.outgoing[vertex as usize];
        let n = real(self.ring(first).count());
        add(vertex, scale * (n - 2.0) / n);
        for h in self.ring(first) {
            add(self.end(h), scale / (n * n));
            self.add_face_point(self.faces_of[h as usize], scale / (n * n), add);
        }
    }

    fn add_face_point(&self, face: u32, scale: f64, add: &mut impl FnMut(u32, f64)) {
        let corners = self.face(FaceId(face));
        corners.iter().for_each(|&corner| add(corner, scale / real(corners.len())));
    }
}
