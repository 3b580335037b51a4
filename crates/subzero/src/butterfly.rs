//! Interpolating schemes: butterfly, modified butterfly and midpoints. Old vertices stay where they are.

use std::f64::consts::TAU;

use crate::ids::{NONE, next, prev};
use crate::stencil::StencilWriter;
use crate::{EdgeId, MeshError, Refinement, StencilTable, TriangleMesh, VertexRule};

impl TriangleMesh {
    /// One step of the butterfly scheme (Dyn, Gregory and Levin 1990, w = 1/16): the 8-point rule on every edge.
    ///
    /// Creases (boundaries and non-manifold edges among them) get the 4-point rule along their own curve; across them the
    /// 8-point rule reflects the points that it lacks. Semi-sharp creases count as smooth.
    ///
    /// ```
    /// use glam::DVec3;
    /// use subzero::{Features, TriangleMesh};
    ///
    /// let triangles = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    /// let points = [DVec3::ONE, DVec3::new(-1., 1., -1.), DVec3::new(1., -1., -1.), DVec3::new(-1., -1., 1.)];
    /// let mesh = TriangleMesh::new(4, triangles, &Features::default())?;
    /// let finer = mesh.butterfly_refine()?.stencils.apply(&points);
    /// assert_eq!(finer[..4], points, "the old points stay");
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the finer mesh outgrows 32-bit ids; [`MeshCounts::refined`](crate::MeshCounts::refined) tells beforehand.
    pub fn butterfly_refine(&self) -> Result<Refinement<Self>, MeshError> {
        self.interpolating_refine(|along, stencil| self.eight_point(along, 1.0, stencil))
    }

    /// One step of the modified butterfly scheme (Zorin, Schroeder and Sweldens 1996), smooth at irregular vertices too.
    ///
    /// Creases are treated as in [`butterfly_refine`](Self::butterfly_refine), and vertices on them count as regular.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the finer mesh outgrows 32-bit ids; [`MeshCounts::refined`](crate::MeshCounts::refined) tells beforehand.
    pub fn modified_butterfly_refine(&self) -> Result<Refinement<Self>, MeshError> {
        self.interpolating_refine(|along, stencil| {
            match (self.is_irregular(along), self.is_irregular(self.twin(along))) {
                (false, false) => self.eight_point(along, 1.0, stencil),
                (true, false) => self.irregular(along, 1.0, stencil),
                (false, true) => self.irregular(self.twin(along), 1.0, stencil),
                (true, true) => {
                    self.irregular(along, 0.5, stencil);
                    self.irregular(self.twin(along), 0.5, stencil);
                }
            }
        })
    }

    /// Splits each triangle into four at the midpoints of its edges, without moving the surface.
    ///
    /// ```
    /// use glam::DVec3;
    /// use subzero::{Features, TriangleMesh};
    ///
    /// let triangles = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    /// let points = [DVec3::ONE, DVec3::new(-1., 1., -1.), DVec3::new(1., -1., -1.), DVec3::new(-1., -1., 1.)];
    /// let mesh = TriangleMesh::new(4, triangles, &Features::default())?;
    /// let finer = mesh.midpoint_refine()?.stencils.apply(&points);
    /// assert!(finer[4..].iter().all(|middle| middle.length() == 1.0), "the middles of the edges are an octahedron");
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the finer mesh outgrows 32-bit ids; [`MeshCounts::refined`](crate::MeshCounts::refined) tells beforehand.
    pub fn midpoint_refine(&self) -> Result<Refinement<Self>, MeshError> {
        let vertices = self.counts().vertices;
        let stencils = StencilTable::from_stencils(self.vertex_count() + self.edge_count(), |i, stencil| {
            if i < vertices {
                stencil.add(i, 1.0);
            } else {
                self.edge(EdgeId(i - vertices)).into_iter().for_each(|end| stencil.add(end, 0.5));
            }
        });
        Ok(Refinement { mesh: self.refine_connectivity()?, stencils })
    }

    /// A refinement that keeps old vertices, with `inner` as the rule of edges that are no creases.
    fn interpolating_refine(
        &self,
        inner: impl Fn(u32, &mut StencilWriter) + Sync,
    ) -> Result<Refinement<Self>, MeshError> {
        let vertices = self.counts().vertices;
        let stencils = StencilTable::from_stencils(self.vertex_count() + self.edge_count(), |i, stencil| {
            if i < vertices {
                stencil.add(i, 1.0);
            } else if self.is_crease(EdgeId(i - vertices)) {
                self.four_point(EdgeId(i - vertices), stencil);
            } else {
                inner(self.edges[(i - vertices) as usize][0], stencil);
            }
        });
        Ok(Refinement { mesh: self.refine_connectivity()?, stencils })
    }

    /// 9/16 of the ends and -1/16 of the next points of the crease, reflected where the crease does not go on.
    fn four_point(&self, edge: EdgeId, stencil: &mut StencilWriter) {
        let [a, b] = self.edge(edge);
        for (end, other) in [(a, b), (b, a)] {
            stencil.add(end, 9.0 / 16.0);
            let goes_on = self.vertex_rule(end) == VertexRule::Crease;
            let outgoing_edge = self
                .sharpness
                .outgoing_edges(end)
                .iter()
                .find(|outgoing_edge| goes_on && outgoing_edge.edge != edge);
            if let Some(outgoing_edge) = outgoing_edge {
                stencil.add(self.other_end(outgoing_edge.edge, end), -1.0 / 16.0);
            } else {
                stencil.add(end, -2.0 / 16.0);
                stencil.add(other, 1.0 / 16.0);
            }
        }
    }

    /// 1/2 of the ends, 1/8 of the apexes and -1/16 of the wings.
    fn eight_point(&self, along: u32, scale: f64, stencil: &mut StencilWriter) {
        for h in [along, self.twin(along)] {
            stencil.add(self.start(h), 0.5 * scale);
            stencil.add(self.start(prev(h)), 0.125 * scale);
            for wing in [next(h), prev(h)] {
                let beyond = if self.is_crease(self.edge_of(wing)) { NONE } else { self.twin(wing) };
                if beyond == NONE {
                    // The triangle's mirror image: the ends of the wing's edge less the third corner.
                    stencil.add(self.start(wing), -scale / 16.0);
                    stencil.add(self.start(next(wing)), -scale / 16.0);
                    stencil.add(self.start(prev(wing)), scale / 16.0);
                } else {
                    stencil.add(self.start(prev(beyond)), -scale / 16.0);
                }
            }
        }
    }

    /// The rule of an edge that starts at an irregular vertex, `h` running away from it.
    fn irregular(&self, h: u32, scale: f64, stencil: &mut StencilWriter) {
        let valence = self.ring(h).count();
        #[allow(clippy::cast_precision_loss)]
        let n = valence as f64;
        stencil.add(self.start(h), 0.75 * scale);
        let mut angle = 0.0;
        for (j, outgoing_edge) in self.ring(h).enumerate() {
            let weight = match (valence, j) {
                (3, 0) => 5.0 / 12.0,
                (3, _) => -1.0 / 12.0,
                (4, 0) => 3.0 / 8.0,
                (4, 2) => -1.0 / 8.0,
                (4, _) => 0.0,
                _ => (0.25 + f64::cos(angle) + 0.5 * f64::cos(2.0 * angle)) / n,
            };
            if weight != 0.0 {
                stencil.add(self.start(next(outgoing_edge)), scale * weight);
            }
            angle += TAU / n;
        }
    }

    /// Whether the half-edge starts at a smooth vertex with a valence other than 6.
    fn is_irregular(&self, h: u32) -> bool {
        self.vertex_rule(self.start(h)) == VertexRule::Smooth && self.ring(h).count() != 6
    }
}
