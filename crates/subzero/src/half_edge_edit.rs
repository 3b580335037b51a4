//! Edge flip, edge split and edge collapse.

use smallvec::SmallVec;

use crate::half_edge_mesh::HalfEdge;
use crate::ids::{NONE, id};
use crate::mesh_checks::check_size;
use crate::{HalfEdgeId, HalfEdgeMesh, MeshError, Point};

impl HalfEdgeMesh {
    /// Turns an edge within the quadrilateral of its two triangles, so that it joins their far corners instead.
    ///
    /// The half-edge and its twin keep their ids and run between the far corners afterwards.
    ///
    /// ```
    /// use subzero::HalfEdgeMesh;
    ///
    /// let mut square = HalfEdgeMesh::new(4, &[[0, 1, 2], [0, 2, 3]])?;
    /// let diagonal = square.half_edge_between(0, 2)?;
    /// square.flip(diagonal)?;
    /// assert!(square.half_edge_between(0, 2).is_err());
    /// assert!(square.half_edge_between(1, 3).is_ok());
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::NoHalfEdge`], or [`MeshError::Edit`] if the edge is on the boundary or the far corners share an edge
    /// already. The mesh is unchanged then.
    pub fn flip(&mut self, half_edge: HalfEdgeId) -> Result<(), MeshError> {
        self.check_exists(half_edge)?;
        let ends = [self.start(half_edge), self.end(half_edge)];
        let refuse = |why| Err(MeshError::Edit { edit: "flipped", ends, why });
        let [h, other] = [half_edge, self.half_edges[half_edge.index()].twin];
        if other == HalfEdgeId::NONE {
            return refuse("it lies on the boundary");
        }
        // Around h: a b c; around its twin: b a d.
        let [b_c, c_a, a_d, d_b] = [h.next(), h.prev(), other.next(), other.prev()];
        let [a, b, c, d] = [self.start(h), self.start(b_c), self.start(c_a), self.start(d_b)];
        if self.leads_to(c_a, d) {
            return refuse("its far corners share an edge already");
        }
        let [beyond_bc, beyond_ca, beyond_ad, beyond_db] =
            [b_c, c_a, a_d, d_b].map(|h| self.half_edges[h.index()].twin);
        // The triangles become d c a and c d b.
        for (h, start, twin) in [
            (h, d, other),
            (b_c, c, beyond_ca),
            (c_a, a, beyond_ad),
            (other, c, h),
            (a_d, d, beyond_db),
            (d_b, b, beyond_bc),
        ] {
            self.half_edges[h.index()].start = start;
            self.link(h, twin);
        }
        for (vertex, left, now) in
            [(a, [h, a_d], c_a), (b, [other, b_c], d_b), (c, [c_a; 2], b_c), (d, [d_b; 2], a_d)]
        {
            if left.contains(&self.outgoing[vertex as usize]) {
                self.outgoing[vertex as usize] = now;
            }
        }
        Ok(())
    }

    /// Puts a vertex on an edge and joins it to the far corners of the edge's triangles; returns its id.
    ///
    /// The half-edge keeps its id and its start, and ends at the new vertex afterwards.
    ///
    /// ```
    /// use subzero::HalfEdgeMesh;
    ///
    /// let mut square = HalfEdgeMesh::new(4, &[[0, 1, 2], [0, 2, 3]])?;
    /// let diagonal = square.half_edge_between(0, 2)?;
    /// let middle = square.split(diagonal)?;
    /// assert_eq!(middle, 4);
    /// assert_eq!(square.triangles().count(), 4);
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::NoHalfEdge`], or [`MeshError::TooLarge`] if the mesh outgrows 32-bit ids.
    pub fn split(&mut self, half_edge: HalfEdgeId) -> Result<u32, MeshError> {
        self.check_exists(half_edge)?;
        check_size("vertices", self.vertex_count() + 1)?;
        check_size("half-edges", self.half_edges.len() + 6)?;
        let [h, other] = [half_edge, self.half_edges[half_edge.index()].twin];
        let middle = id(self.vertex_count());
        let far_half = self.split_triangle(h, middle);
        self.outgoing.push(far_half);
        if other != HalfEdgeId::NONE {
            let near_half = self.split_triangle(other, middle);
            self.link(h, near_half);
            self.link(other, far_half);
        }
        Ok(middle)
    }

    /// Cuts the triangle of `h` at a vertex on `h`: `h` keeps the first half. Returns the second half, without twin.
    fn split_triangle(&mut self, h: HalfEdgeId, middle: u32) -> HalfEdgeId {
        let [b_c, c_a] = [h.next(), h.prev()];
        let [b, c] = [self.start(b_c), self.start(c_a)];
        let far_half = HalfEdgeId(id(self.half_edges.len()));
        let [after, before] = [far_half.next(), far_half.prev()];
        let beyond_bc = self.half_edges[b_c.index()].twin;
        self.half_edges.extend([middle, b, c].map(|start| HalfEdge { start, twin: HalfEdgeId::NONE }));
        self.link(after, beyond_bc);
        self.half_edges[b_c.index()].start = middle;
        self.link(b_c, before);
        if self.outgoing[b as usize] == b_c {
            self.outgoing[b as usize] = after;
        }
        far_half
    }

    /// Splits each of these edges, given by their ends, in this order and at its midpoint; appends the midpoints to `points`.
    ///
    /// Splitting what would be cut one way or another makes subdivision keep a symmetry: a cube whose faces are cut
    /// along one diagonal each loses its symmetry under Loop's scheme, one whose diagonals are split first does not.
    ///
    /// # Errors
    /// [`MeshError::NoEdge`] if two ends share no edge, or [`MeshError::TooLarge`]; the edges before are split then.
    ///
    /// # Panics
    /// If `points` does not have one point per vertex.
    pub fn split_edges<P: Point>(
        &mut self,
        edges: &[[u32; 2]],
        points: &mut Vec<P>,
    ) -> Result<(), MeshError> {
        assert_eq!(points.len(), self.vertex_count(), "there must be one point per vertex");
        for &[a, b] in edges {
            let half_edge = self.half_edge_between(a, b)?;
            self.split(half_edge)?;
            let midpoint = P::zero().add_scaled(points[a as usize], 0.5).add_scaled(points[b as usize], 0.5);
            points.push(midpoint);
        }
        Ok(())
    }

    /// Draws the start of a half-edge into its end, which removes the start, the edge, and its triangles.
    ///
    /// ```
    /// use subzero::HalfEdgeMesh;
    ///
    /// // A fan around the vertex 4.
    /// let mut fan = HalfEdgeMesh::new(5, &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])?;
    /// let edge = fan.outgoing_half_edges(4).next().expect("it has edges");
    /// fan.collapse(edge)?;
    /// assert_eq!(fan.triangles().count(), 2);
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::NoHalfEdge`], or [`MeshError::Edit`] if the link condition does not hold: the mesh would be no manifold
    /// or change its topology. The mesh is unchanged then.
    pub fn collapse(&mut self, half_edge: HalfEdgeId) -> Result<(), MeshError> {
        self.check_exists(half_edge)?;
        let [h, other] = [half_edge, self.half_edges[half_edge.index()].twin];
        let [a, b] = [self.start(h), self.end(h)];
        if let Some(why) = self.breaks_link_condition(h) {
            return Err(MeshError::Edit { edit: "collapsed", ends: [a, b], why });
        }
        // The fan of b takes in that of a. On the boundary it starts where that of the boundary vertex does.
        let a_leads = other != HalfEdgeId::NONE && self.is_boundary_vertex(a);
        let mut first = self.outgoing[if a_leads { a } else { b } as usize];
        let mut turning = self.outgoing[a as usize];
        loop {
            self.half_edges[turning.index()].start = b;
            turning = self.half_edges[turning.prev().index()].twin;
            if turning == HalfEdgeId::NONE || turning == self.outgoing[a as usize] {
                break;
            }
        }
        for side in [h, other].into_iter().filter(|&side| side != HalfEdgeId::NONE) {
            // The triangle's other two edges become one.
            let [after, before] = [side.next(), side.prev()];
            let [beyond_after, beyond_before] = [after, before].map(|h| self.half_edges[h.index()].twin);
            for (h, twin) in [(beyond_after, beyond_before), (beyond_before, beyond_after)] {
                if h != HalfEdgeId::NONE {
                    self.half_edges[h.index()].twin = twin;
                }
            }
            let apex = self.start(before) as usize;
            if self.outgoing[apex] == before {
                self.outgoing[apex] = beyond_after;
            }
            if first == after || (side == h && first == other) {
                first = beyond_before;
            }
            for removed in [side, after, before] {
                self.half_edges[removed.index()] = HalfEdge { start: NONE, twin: HalfEdgeId::NONE };
            }
        }
        self.outgoing[b as usize] = first;
        self.outgoing[a as usize] = HalfEdgeId::NONE;
        Ok(())
    }

    /// Draws vertex `from` into its neighbour `into`, which removes `from`, their edge, and its triangles.
    ///
    /// # Errors
    /// [`MeshError::NoEdge`], or [`MeshError::Edit`] as of [`collapse`](Self::collapse). The mesh is unchanged then.
    pub fn collapse_into(&mut self, from: u32, into: u32) -> Result<(), MeshError> {
        let half_edge = self.half_edge_between(from, into)?;
        if self.start(half_edge) == from {
            return self.collapse(half_edge);
        }
        // On the boundary the only half-edge may run the other way: then the vertex that is left takes the other's id.
        self.collapse(half_edge)?;
        let around: Vec<HalfEdgeId> = self.outgoing_half_edges(from).collect();
        for h in around {
            self.half_edges[h.index()].start = into;
        }
        self.outgoing[into as usize] = std::mem::replace(&mut self.outgoing[from as usize], HalfEdgeId::NONE);
        Ok(())
    }

    /// Whether an edge joins the start of `h` to `vertex`, which is no corner of the triangle of `h`.
    fn leads_to(&self, h: HalfEdgeId, vertex: u32) -> bool {
        // Both ways round until they meet: what is read depends on what was read before, so two short chains are faster than a long
        // one.
        let [mut left, mut right] = [Some(h); 2];
        while left.is_some() || right.is_some() {
            left = left.and_then(|h| self.twin(h.prev()));
            if left.is_some_and(|h| self.start(h.prev()) == vertex) {
                return true;
            }
            if left == right {
                return false;
            }
            right = right.and_then(|h| self.twin(h)).map(HalfEdgeId::next);
            if right.is_some_and(|h| self.end(h) == vertex) {
                return true;
            }
            if left == right {
                return false;
            }
        }
        false
    }

    /// What would go wrong if an edge collapsed.
    fn breaks_link_condition(&self, h: HalfEdgeId) -> Option<&'static str> {
        let [a, b] = [self.start(h), self.end(h)];
        let around_b: SmallVec<[u32; 16]> = self.neighbours(b).collect();
        let (valence_of_a, shared) = self.neighbours(a).fold((0, 0), |(valence, shared), neighbour| {
            // Counted to the end: where a search would stop cannot be predicted.
            (valence + 1, shared + around_b.iter().filter(|&&other| other == neighbour).count())
        });
        if self.twin(h).is_none() {
            let alone = self.twin(h.next()).is_none() && self.twin(h.prev()).is_none();
            return match (shared, alone) {
                (1, false) => None,
                (1, true) => Some("nothing else holds its triangle"),
                _ => Some("its ends share a neighbour beyond its triangle"),
            };
        }
        let boundary_ends = [a, b].map(|v| self.is_boundary_vertex(v));
        match boundary_ends {
            [true, true] => Some("it joins two boundary vertices across the inside"),
            _ if shared != 2 => Some("its ends share a neighbour beyond its triangles"),
            [false, false] if valence_of_a == 3 && around_b.len() == 3 => {
                Some("a tetrahedron would fall flat")
            }
            _ => None,
        }
    }

    fn link(&mut self, h: HalfEdgeId, twin: HalfEdgeId) {
        self.half_edges[h.index()].twin = twin;
        if twin != HalfEdgeId::NONE {
            self.half_edges[twin.index()].twin = h;
        }
    }

    fn check_exists(&self, half_edge: HalfEdgeId) -> Result<(), MeshError> {
        if self.exists(half_edge) { Ok(()) } else { Err(MeshError::NoHalfEdge { half_edge }) }
    }
}
