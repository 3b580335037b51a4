//! Connectivity of a triangle mesh.

use crate::ids::{NONE, id, next, prev};
use crate::sharpness::{Sharpness, is_infinite};
use crate::{EdgeId, FaceId, HalfEdgeId, MeshCounts, MeshError, VertexRule};

/// Connectivity of a triangle mesh, possibly with boundary and non-manifold edges; positions live beside it as slices.
///
/// An edge with one triangle, or with three and more, is an infinitely sharp crease. The half-edge h = 3 t + k runs
/// from corner k to corner k + 1 of triangle t. Edges are numbered in the order in which the half-edges first
/// name them; [`MeshCounts`] has the numbering after refinement.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    /// The vertices of each triangle.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Per half-edge: twice its edge, plus 1 if it runs against the edge. Twice an edge plus a direction is also the
    /// id of a half of this edge one level on, namely the half where the half-edge starts.
    pub(crate) directed_edges: Vec<[u32; 3]>,
    /// Per edge: a half-edge that runs along it, and, if there is exactly one other and it runs against it, that one.
    /// Both are [`NONE`]-free on smooth edges; the second is [`NONE`] on boundary and non-manifold edges.
    pub(crate) edges: Vec<[u32; 2]>,
    /// Per vertex: a half-edge that starts there, or [`NONE`] if no triangle uses the vertex.
    pub(crate) outgoing: Vec<u32>,
    /// Per vertex: its rule.
    pub(crate) vertex_rules: Vec<VertexRule>,
    /// Per edge: whether it is sharp.
    pub(crate) sharp_edges: Vec<bool>,
    /// How sharp, and the sharp edges by vertex.
    pub(crate) sharpness: Sharpness,
}

impl TriangleMesh {
    /// Number of vertices, counting those that no triangle uses.
    pub fn vertex_count(&self) -> usize {
        self.vertex_rules.len()
    }

    /// The vertices of each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Number of edges.
    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    /// The numbers of vertices, edges and triangles; they say which child descends from whom.
    pub fn counts(&self) -> MeshCounts {
        MeshCounts {
            vertices: id(self.vertex_count()),
            edges: id(self.edge_count()),
            triangles: id(self.triangles.len()),
        }
    }

    /// The two ends of an edge.
    ///
    /// # Panics
    /// If there is no such edge.
    pub fn edge(&self, edge: EdgeId) -> [u32; 2] {
        let [along, _] = self.edges[edge.index()];
        [self.start(along), self.start(next(along))]
    }

    /// The two ends of each edge.
    pub fn edges(&self) -> impl ExactSizeIterator<Item = [u32; 2]> {
        self.edges.iter().map(|&[along, _]| [self.start(along), self.start(next(along))])
    }

    /// The edges of a triangle; edge k runs from corner k to corner k + 1.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn triangle_edges(&self, triangle: FaceId) -> [EdgeId; 3] {
        self.directed_edges[triangle.index()].map(|directed| EdgeId(directed / 2))
    }

    /// For each half-edge of each triangle, twice its edge, plus 1 if it runs against the edge. With the numbering of [`MeshCounts`] the
    /// triangles of all refinements follow from these and the triangles alone.
    pub fn directed_edges(&self) -> &[[u32; 3]] {
        &self.directed_edges
    }

    /// A vertex and those that share a triangle with it, in order.
    pub(crate) fn neighbourhood(&self, vertex: u32) -> Vec<u32> {
        let around = self.triangles.iter().filter(|triangle| triangle.contains(&vertex));
        let mut vertices: Vec<u32> = around.flatten().copied().chain([vertex]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }

    /// The triangles at some vertices, which are in order.
    pub(crate) fn triangles_at(&self, vertices: &[u32]) -> Vec<FaceId> {
        let is_there = |corner: &u32| vertices.binary_search(corner).is_ok();
        let triangles = (0..).map(FaceId).zip(&self.triangles);
        triangles.filter(|(_, corners)| corners.iter().any(is_there)).map(|(triangle, _)| triangle).collect()
    }

    /// The two half-edges of an edge, the first of which it runs along; nothing on boundary and non-manifold edges.
    ///
    /// # Panics
    /// If there is no such edge.
    pub fn edge_half_edges(&self, edge: EdgeId) -> Option<[HalfEdgeId; 2]> {
        let [along, against] = self.edges[edge.index()];
        (against != NONE).then_some([along, against].map(HalfEdgeId))
    }

    /// The two triangles of an edge; nothing on boundary and non-manifold edges.
    ///
    /// # Panics
    /// If there is no such edge.
    pub fn edge_triangles(&self, edge: EdgeId) -> Option<[FaceId; 2]> {
        self.edge_half_edges(edge).map(|pair| pair.map(HalfEdgeId::triangle))
    }

    /// The half-edge on the other side, which runs against this one; nothing on boundary and non-manifold edges. The half-edge 3 t + k
    /// runs from corner k to corner k + 1 of triangle t.
    ///
    /// # Panics
    /// If there is no such half-edge.
    pub fn half_edge_beyond(&self, half_edge: HalfEdgeId) -> Option<HalfEdgeId> {
        Some(self.twin(half_edge.0)).filter(|twin| *twin != NONE).map(HalfEdgeId)
    }

    /// Whether an edge is infinitely sharp: marked so, or on the boundary, or with three or more triangles.
    ///
    /// # Panics
    /// If there is no such edge.
    pub fn is_crease(&self, edge: EdgeId) -> bool {
        is_infinite(self.edge_sharpness(edge))
    }

    /// The sharpness of an edge: 0 if smooth, [`INFINITE_SHARPNESS`](crate::INFINITE_SHARPNESS) or more if it stays.
    ///
    /// # Panics
    /// If there is no such edge.
    pub fn edge_sharpness(&self, edge: EdgeId) -> f32 {
        if self.sharp_edges[edge.index()] { self.sharpness.of_edge(edge) } else { 0.0 }
    }

    /// The rule that moves a vertex in the next refinement.
    ///
    /// A vertex that no triangle uses, one where sheets of triangles touch in a point, and one with a number of
    /// non-manifold edges other than 0 and 2 are corners.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn vertex_rule(&self, vertex: u32) -> VertexRule {
        self.vertex_rules[vertex as usize]
    }

    /// The number of triangles of each edge: 1 on the boundary, 2 inside a surface, 3 and more where surfaces meet.
    pub fn edge_triangle_counts(&self) -> Vec<u32> {
        let mut counts = vec![0; self.edge_count()];
        for directed in self.directed_edges.as_flattened() {
            counts[(directed / 2) as usize] += 1;
        }
        counts
    }

    /// Checks that no edge lies on a boundary.
    ///
    /// # Errors
    /// [`MeshError::Open`] names the first edge with one triangle only.
    pub fn check_closed(&self) -> Result<(), MeshError> {
        match self.edge_triangle_counts().iter().position(|&count| count == 1) {
            Some(edge) => Err(MeshError::Open { ends: self.edge(EdgeId(id(edge))) }),
            None => Ok(()),
        }
    }

    /// The vertex where a half-edge starts.
    pub(crate) fn start(&self, h: u32) -> u32 {
        self.triangles[(h / 3) as usize][(h % 3) as usize]
    }

    /// The edge of a half-edge.
    pub(crate) fn edge_of(&self, h: u32) -> EdgeId {
        EdgeId(self.directed_edge(h) / 2)
    }

    /// Twice the edge of a half-edge, plus 1 if the half-edge runs against the edge.
    pub(crate) fn directed_edge(&self, h: u32) -> u32 {
        self.directed_edges[(h / 3) as usize][(h % 3) as usize]
    }

    /// The half-edge on the other side, or [`NONE`] on boundary and non-manifold edges.
    pub(crate) fn twin(&self, h: u32) -> u32 {
        let directed = self.directed_edge(h);
        let [along, against] = self.edges[(directed / 2) as usize];
        match (against, directed % 2) {
            (NONE, _) => NONE,
            (against, 0) => against,
            _ => along,
        }
    }

    /// The end of an edge that is not `vertex`.
    pub(crate) fn other_end(&self, edge: EdgeId, vertex: u32) -> u32 {
        let [start, end] = self.edge(edge);
        if start == vertex { end } else { start }
    }

    /// The half-edges that start where `first` starts, counter-clockwise, until the ring closes or an edge has no
    /// other side. Whether it closes is for the caller to know.
    pub(crate) fn ring(&self, first: u32) -> impl Iterator<Item = u32> {
        std::iter::successors(Some(first), move |&h| {
            let turned = self.twin(prev(h));
            (turned != NONE && turned != first).then_some(turned)
        })
    }

    /// The half-edges of [`ring`](Self::ring) up to the next infinite crease.
    pub(crate) fn sector(&self, first: u32) -> impl Iterator<Item = u32> {
        let beyond = move |&h: &u32| {
            let before = prev(h);
            if self.is_crease(self.edge_of(before)) {
                return None;
            }
            Some(self.twin(before)).filter(|&turned| turned != first)
        };
        std::iter::successors(Some(first), beyond)
    }
}
