//! A triangle mesh for editing.

use glam::DVec3;

use crate::edge_table::EdgeTable;
use crate::ids::{NONE, id};
use crate::mesh_checks::check_size;
use crate::triangle_build::check_triangles;
use crate::{FaceId, HalfEdgeId, MeshError, TriangleMesh};

/// What an edit needs to know of a half-edge, in one place in memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HalfEdge {
    /// The vertex where it starts, [`NONE`] in triangles that are gone.
    pub start: u32,
    /// The half-edge on the other side, [`HalfEdgeId::NONE`] on the boundary.
    pub twin: HalfEdgeId,
}

/// A manifold triangle mesh, possibly with boundary, that can be edited; positions live beside it.
///
/// The half-edge h = 3 t + k runs from corner k to corner k + 1 of triangle t. Edits keep the ids of everything they leave
/// in place: a split adds a vertex and triangles at the end, a collapse leaves gaps that [`triangles`](Self::triangles) skips.
#[derive(Clone, Debug, PartialEq)]
pub struct HalfEdgeMesh {
    pub(crate) half_edges: Vec<HalfEdge>,
    /// Per vertex: a half-edge that starts there, on the boundary the one without twin; [`HalfEdgeId::NONE`] at unused vertices.
    pub(crate) outgoing: Vec<HalfEdgeId>,
}

impl HalfEdgeMesh {
    /// Builds the mesh and checks that it is manifold.
    ///
    /// # Errors
    /// [`MeshError`] names the place: a vertex id out of range, a triangle that uses a vertex twice, two triangles with the
    /// same vertices, an edge with three or more triangles or with two that run the same way, a vertex where triangles
    /// touch only in the point, or more elements than 32-bit ids can count.
    pub fn new(vertex_count: usize, triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        check_size("vertices", vertex_count)?;
        check_size("half-edges", triangles.len().saturating_mul(6))?;
        check_triangles(vertex_count, triangles)?;
        let half_edges: Vec<[u32; 2]> =
            triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        let table = EdgeTable::new(&half_edges);
        if let Some(edge) = table.half_edge_counts.iter().position(|&count| count > 2) {
            let ends = half_edges[table.edges[edge][0] as usize];
            return Err(MeshError::NonManifoldEdge { ends, faces: table.half_edge_counts[edge] });
        }
        if let Some(&(_, [first, second])) = table.same_way.first() {
            let ends = half_edges[first as usize];
            return Err(MeshError::Winding { first: FaceId(first / 3), second: FaceId(second / 3), ends });
        }
        let starts = triangles.as_flattened().iter();
        let mut half_edges: Vec<HalfEdge> =
            starts.map(|&start| HalfEdge { start, twin: HalfEdgeId::NONE }).collect();
        for &[along, against] in table.edges.iter().filter(|edge| edge[1] != NONE) {
            half_edges[along as usize].twin = HalfEdgeId(against);
            half_edges[against as usize].twin = HalfEdgeId(along);
        }
        let mut mesh = Self { half_edges, outgoing: vec![HalfEdgeId::NONE; vertex_count] };
        let mut triangles_at = vec![0_usize; vertex_count];
        for h in (0..id(mesh.half_edges.len())).map(HalfEdgeId) {
            let vertex = mesh.start(h) as usize;
            triangles_at[vertex] += 1;
            if mesh.outgoing[vertex] == HalfEdgeId::NONE || mesh.twin(h).is_none() {
                mesh.outgoing[vertex] = h;
            }
        }
        let has_more_fans =
            |&vertex: &u32| mesh.outgoing_half_edges(vertex).count() != triangles_at[vertex as usize];
        match (0..id(vertex_count)).find(has_more_fans) {
            Some(vertex) => Err(MeshError::NonManifoldVertex { vertex }),
            None => Ok(mesh),
        }
    }

    /// The mesh of the triangles of a [`TriangleMesh`], without its features.
    ///
    /// # Errors
    /// [`MeshError`] as of [`new`](Self::new), where the mesh is not manifold.
    pub fn from_triangle_mesh(mesh: &TriangleMesh) -> Result<Self, MeshError> {
        Self::new(mesh.vertex_count(), mesh.triangles())
    }

    /// Number of vertices, counting those that no triangle uses.
    pub fn vertex_count(&self) -> usize {
        self.outgoing.len()
    }

    /// Number of half-edges, counting those that collapses removed.
    pub fn half_edge_count(&self) -> usize {
        self.half_edges.len()
    }

    /// The triangles that are there, with their ids.
    pub fn triangles(&self) -> impl Iterator<Item = (FaceId, [u32; 3])> {
        let (triangles, _) = self.half_edges.as_chunks::<3>();
        triangles
            .iter()
            .enumerate()
            .filter(|(_, half_edges)| half_edges[0].start != NONE)
            .map(|(t, half_edges)| (FaceId(id(t)), half_edges.map(|half_edge| half_edge.start)))
    }

    /// One half-edge of each edge: the only one, or that with the lower id.
    pub fn edges(&self) -> impl Iterator<Item = HalfEdgeId> {
        (0..id(self.half_edges.len()))
            .map(HalfEdgeId)
            .filter(|&h| self.exists(h) && self.twin(h).is_none_or(|twin| h < twin))
    }

    /// Whether a half-edge is there, and not out of range or removed.
    pub fn exists(&self, half_edge: HalfEdgeId) -> bool {
        self.half_edges.get(half_edge.index()).is_some_and(|half_edge| half_edge.start != NONE)
    }

    /// The vertex where a half-edge starts.
    ///
    /// # Panics
    /// If the half-edge is out of range.
    pub fn start(&self, half_edge: HalfEdgeId) -> u32 {
        self.half_edges[half_edge.index()].start
    }

    /// The vertex where a half-edge ends.
    ///
    /// # Panics
    /// If the half-edge is out of range.
    pub fn end(&self, half_edge: HalfEdgeId) -> u32 {
        self.start(half_edge.next())
    }

    /// The half-edge on the other side of the edge, if it is not on the boundary.
    ///
    /// # Panics
    /// If the half-edge is out of range.
    pub fn twin(&self, half_edge: HalfEdgeId) -> Option<HalfEdgeId> {
        self.half_edges[half_edge.index()].twin.some()
    }

    /// The three half-edges around the triangle of a half-edge, from this one on.
    pub fn face_half_edges(&self, half_edge: HalfEdgeId) -> [HalfEdgeId; 3] {
        [half_edge, half_edge.next(), half_edge.prev()]
    }

    /// The half-edges that start at a vertex, counter-clockwise; at the boundary from one side of it to the other.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn outgoing_half_edges(&self, vertex: u32) -> impl Iterator<Item = HalfEdgeId> {
        let first = self.outgoing[vertex as usize];
        std::iter::successors(first.some(), move |&h| self.twin(h.prev()).filter(|&turned| turned != first))
    }

    /// The vertices that share an edge with `vertex`, counter-clockwise; at the boundary from one side of it to the other.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn neighbours(&self, vertex: u32) -> impl Iterator<Item = u32> {
        // The fan of a boundary vertex has an edge more than triangles.
        let first = self.is_boundary_vertex(vertex).then(|| self.end(self.outgoing[vertex as usize]));
        first.into_iter().chain(self.outgoing_half_edges(vertex).map(|h| self.start(h.prev())))
    }

    /// Whether a vertex lies on the boundary.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn is_boundary_vertex(&self, vertex: u32) -> bool {
        let first = self.outgoing[vertex as usize];
        first.some().is_some_and(|first| self.twin(first).is_none())
    }

    /// A half-edge of the edge between two vertices, from `a` to `b` if there is one.
    ///
    /// # Errors
    /// [`MeshError::NoEdge`] if they share no edge.
    pub fn half_edge_between(&self, a: u32, b: u32) -> Result<HalfEdgeId, MeshError> {
        let known = |v: u32| (v as usize) < self.vertex_count();
        let from_to = |a: u32, b: u32| self.outgoing_half_edges(a).find(|&h| self.end(h) == b);
        let found = if known(a) && known(b) { from_to(a, b).or_else(|| from_to(b, a)) } else { None };
        found.ok_or(MeshError::NoEdge { ends: [a, b] })
    }

    /// The unit normal at each vertex: the mean of those of its triangles, weighted by their areas. Nothing at unused vertices, and where
    /// the mean vanishes.
    ///
    /// # Panics
    /// If `points` has fewer points than the mesh has vertices.
    pub fn vertex_normals(&self, points: &[DVec3]) -> Vec<Option<DVec3>> {
        let mut sums = vec![DVec3::ZERO; self.vertex_count()];
        for (_, corners) in self.triangles() {
            let [a, b, c] = corners.map(|v| points[v as usize]);
            let normal = (b - a).cross(c - a);
            corners.into_iter().for_each(|v| sums[v as usize] += normal);
        }
        sums.into_iter().map(DVec3::try_normalize).collect()
    }
}
