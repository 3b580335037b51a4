//! Connectivity of a polygon mesh.

use glam::DVec3;
use rayon::prelude::*;

use crate::edge_table::EdgeTable;
use crate::features::INFINITE_SHARPNESS;
use crate::ids::{NONE, id};
use crate::mesh_checks::{check_corners, check_faces, check_size};
use crate::sharpness::{Sharpness, is_infinite};
use crate::triangulate::doubled_area_vector;
use crate::{BoundaryRule, EdgeId, FaceId, Features, MeshError, VertexRule};

/// Connectivity of a mesh of polygons with three or more corners; positions live beside it as slices.
///
/// The mesh is manifold: at most two faces meet in an edge, and the faces around a vertex form one fan. The half-edges are
/// numbered face after face; half-edge h runs from its corner to the next of its face. Edges are numbered in the order
/// in which the half-edges first name them.
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonMesh {
    /// Where the corners of each face start, and after the last face their number.
    pub(crate) face_starts: Vec<u32>,
    /// Per half-edge: the vertex where it starts.
    pub(crate) corners: Vec<u32>,
    /// Per half-edge: its face.
    pub(crate) faces_of: Vec<u32>,
    /// Per half-edge: twice its edge, plus 1 if it runs against the edge; this is also the half of the edge at its start.
    pub(crate) directed_edges: Vec<u32>,
    /// Per edge: the half-edge along it, and the one against it or [`NONE`].
    pub(crate) edges: Vec<[u32; 2]>,
    /// Per vertex: a half-edge that starts there, or [`NONE`] if no face uses the vertex.
    pub(crate) outgoing: Vec<u32>,
    pub(crate) vertex_rules: Vec<VertexRule>,
    pub(crate) sharp_edges: Vec<bool>,
    pub(crate) sharpness: Sharpness,
}

impl PolygonMesh {
    /// Connectivity of `faces` over `vertex_count` vertices, with its creases and corners.
    ///
    /// ```
    /// use subzero::{Features, PolygonMesh};
    ///
    /// let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]].map(Vec::from);
    /// let cube = PolygonMesh::new(8, &faces, &Features::default())?;
    /// assert_eq!((cube.vertex_count(), cube.edge_count(), cube.face_count()), (8, 12, 6));
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError`] names the place: a vertex id out of range, a face with fewer than three corners or with one vertex
    /// twice, two faces with the same vertices, an edge with three or more faces, two faces that run the same way
    /// along an edge, a vertex where faces touch only in the point, a crease that is no edge, a negative or NaN
    /// sharpness, or more elements than 32-bit ids can count.
    pub fn new(vertex_count: usize, faces: &[Vec<u32>], features: &Features) -> Result<Self, MeshError> {
        check_size("vertices", vertex_count)?;
        check_size("half-edges", faces.iter().map(Vec::len).sum::<usize>().saturating_mul(2))?;
        check_faces(vertex_count, faces)?;
        let mut mesh = Self {
            face_starts: vec![0],
            corners: Vec::new(),
            faces_of: Vec::new(),
            directed_edges: Vec::new(),
            edges: Vec::new(),
            outgoing: vec![NONE; vertex_count],
            vertex_rules: Vec::new(),
            sharp_edges: Vec::new(),
            sharpness: Sharpness::default(),
        };
        for (f, face) in faces.iter().enumerate() {
            mesh.corners.extend(face);
            mesh.faces_of.resize(mesh.corners.len(), id(f));
            mesh.face_starts.push(id(mesh.corners.len()));
        }
        for (h, &vertex) in mesh.corners.iter().enumerate().rev() {
            mesh.outgoing[vertex as usize] = id(h);
        }
        let half_edges: Vec<[u32; 2]> =
            (0..id(mesh.corners.len())).map(|h| [mesh.start(h), mesh.end(h)]).collect();
        let table = EdgeTable::new(&half_edges);
        let mut sharpness = table.crease_sharpness(vertex_count, features.creases)?;
        if let Some(edge) = table.half_edge_counts.iter().position(|&count| count > 2) {
            let ends = half_edges[table.edges[edge][0] as usize];
            return Err(MeshError::NonManifoldEdge { ends, faces: table.half_edge_counts[edge] });
        }
        if let Some(&(_, [first, second])) = table.same_way.first() {
            let [face, other] = [first, second].map(|h| FaceId(mesh.faces_of[h as usize]));
            return Err(MeshError::Winding { first: face, second: other, ends: half_edges[first as usize] });
        }
        mesh.directed_edges = table.directed_edges;
        mesh.edges = table.edges;
        sharpen_boundary(&mut sharpness, &mesh.edges);
        mesh.sharpness = Sharpness::new(&sharpness, |edge| mesh.edge(edge));
        let mut corners = check_corners(vertex_count, features)?;
        for vertex in mesh.fixed_vertices(features.boundary)? {
            corners.push((vertex, INFINITE_SHARPNESS));
        }
        mesh.sharpness.set_corners(corners);
        mesh.vertex_rules = mesh.sharpness.vertex_rules(vertex_count);
        mesh.sharp_edges = mesh.sharpness.sharp_edges(mesh.edges.len());
        Ok(mesh)
    }

    /// A mesh whose only creases are its boundary, of arrays that agree; a half-edge h starts at vertex h.
    pub(crate) fn with_open_boundary(
        face_starts: Vec<u32>,
        corners: Vec<u32>,
        directed_edges: Vec<u32>,
        edges: Vec<[u32; 2]>,
        vertex_count: u32,
    ) -> Self {
        let mut edge_sharpness = vec![0.0; edges.len()];
        sharpen_boundary(&mut edge_sharpness, &edges);
        let faces_of = (0..id(face_starts.len() - 1)).into_par_iter().flat_map_iter(|face| {
            let starts = [face, face + 1].map(|face| face_starts[face as usize]);
            std::iter::repeat_n(face, (starts[1] - starts[0]) as usize)
        });
        let mut mesh = Self {
            faces_of: faces_of.collect(),
            face_starts,
            corners,
            directed_edges,
            sharp_edges: Vec::new(),
            edges,
            outgoing: (0..vertex_count).collect(),
            vertex_rules: Vec::new(),
            sharpness: Sharpness::default(),
        };
        mesh.sharpness = Sharpness::new(&edge_sharpness, |edge| mesh.edge(edge));
        mesh.vertex_rules = mesh.sharpness.vertex_rules(mesh.vertex_count());
        mesh.sharp_edges = mesh.sharpness.sharp_edges(mesh.edge_count());
        mesh
    }

    /// Number of vertices, counting those that no face uses.
    pub fn vertex_count(&self) -> usize {
        self.outgoing.len()
    }

    /// Number of edges.
    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    /// Number of faces.
    pub fn face_count(&self) -> usize {
        self.face_starts.len() - 1
    }

    /// The vertices of a face.
    ///
    /// # Panics
    /// If there is no such face.
    pub fn face(&self, face: FaceId) -> &[u32] {
        let face = face.index();
        &self.corners[self.face_starts[face] as usize..self.face_starts[face + 1] as usize]
    }

    /// The vertices of each face, face after face.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        (0..id(self.face_count())).map(|face| self.face(FaceId(face)))
    }

    /// The two ends of an edge.
    ///
    /// # Panics
    /// If there is no such edge.
    pub fn edge(&self, edge: EdgeId) -> [u32; 2] {
        let [along, _] = self.edges[edge.index()];
        [self.start(along), self.end(along)]
    }

    /// The two ends of each edge.
    pub fn edges(&self) -> impl ExactSizeIterator<Item = [u32; 2]> {
        self.edges.iter().map(|&[along, _]| [self.start(along), self.end(along)])
    }

    /// The edges of a face; edge k runs from corner k to corner k + 1.
    ///
    /// # Panics
    /// If there is no such face.
    pub fn face_edges(&self, face: FaceId) -> impl Iterator<Item = EdgeId> {
        let face = face.index();
        let half_edges = self.face_starts[face]..self.face_starts[face + 1];
        half_edges.map(|h| EdgeId(self.directed_edges[h as usize] / 2))
    }

    /// Whether an edge is infinitely sharp: marked so, or on the boundary.
    ///
    /// # Panics
    /// If there is no such edge.
    pub fn is_crease(&self, edge: EdgeId) -> bool {
        self.sharp_edges[edge.index()] && is_infinite(self.sharpness.of_edge(edge))
    }

    /// Whether an edge has one face only.
    ///
    /// # Panics
    /// If there is no such edge.
    pub fn is_boundary(&self, edge: EdgeId) -> bool {
        self.edges[edge.index()][1] == NONE
    }

    /// The rule that moves a vertex in the next Catmull-Clark refinement; an unused vertex is a corner.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn vertex_rule(&self, vertex: u32) -> VertexRule {
        self.vertex_rules[vertex as usize]
    }

    /// The unit normal at each vertex: the mean of those of its faces, weighted by their areas. Nothing at unused vertices, and where
    /// the mean vanishes.
    ///
    /// # Panics
    /// If `points` has fewer points than the mesh has vertices.
    pub fn vertex_normals(&self, points: &[DVec3]) -> Vec<Option<DVec3>> {
        let mut sums = vec![DVec3::ZERO; self.vertex_count()];
        let mut corners = Vec::new();
        for face in self.faces() {
            corners.clear();
            corners.extend(face.iter().map(|&v| points[v as usize]));
            let normal = doubled_area_vector(&corners);
            face.iter().for_each(|&v| sums[v as usize] += normal);
        }
        sums.into_iter().map(DVec3::try_normalize).collect()
    }

    pub(crate) fn start(&self, h: u32) -> u32 {
        self.corners[h as usize]
    }

    pub(crate) fn end(&self, h: u32) -> u32 {
        self.start(self.next(h))
    }

    pub(crate) fn next(&self, h: u32) -> u32 {
        let face = self.faces_of[h as usize] as usize;
        if h + 1 == self.face_starts[face + 1] { self.face_starts[face] } else { h + 1 }
    }

    pub(crate) fn prev(&self, h: u32) -> u32 {
        let face = self.faces_of[h as usize] as usize;
        if h == self.face_starts[face] { self.face_starts[face + 1] - 1 } else { h - 1 }
    }

    /// The half-edge on the other side, or [`NONE`] on the boundary.
    pub(crate) fn twin(&self, h: u32) -> u32 {
        let directed = self.directed_edges[h as usize];
        let [along, against] = self.edges[(directed / 2) as usize];
        if directed.is_multiple_of(2) { against } else { along }
    }

    /// The end of an edge that is not `vertex`.
    pub(crate) fn other_end(&self, edge: EdgeId, vertex: u32) -> u32 {
        let [start, end] = self.edge(edge);
        if start == vertex { end } else { start }
    }

    /// The half-edges that start where `first` starts, counter-clockwise, until the ring closes or meets the boundary.
    pub(crate) fn ring(&self, first: u32) -> impl Iterator<Item = u32> {
        std::iter::successors(Some(first), move |&h| {
            let turned = self.twin(self.prev(h));
            (turned != NONE && turned != first).then_some(turned)
        })
    }

    /// Unused vertices, and boundary vertices of a single face if the boundary rule fixes them.
    fn fixed_vertices(&self, boundary: BoundaryRule) -> Result<Vec<u32>, MeshError> {
        let mut faces = vec![0_usize; self.vertex_count()];
        // A half-edge that leaves each vertex along the boundary, if it is on it: there a turn meets all faces.
        let mut firsts = self.outgoing.clone();
        for h in 0..id(self.corners.len()) {
            let vertex = self.start(h) as usize;
            faces[vertex] += 1;
            if self.twin(h) == NONE {
                firsts[vertex] = h;
            }
        }
        let mut fixed = Vec::new();
        for vertex in 0..id(self.vertex_count()) {
            let (first, faces) = (firsts[vertex as usize], faces[vertex as usize]);
            if first != NONE && self.ring(first).count() != faces {
                return Err(MeshError::NonManifoldVertex { vertex });
            }
            if first == NONE || (faces == 1 && boundary == BoundaryRule::EdgeCorner) {
                fixed.push(vertex);
            }
        }
        Ok(fixed)
    }
}

/// Makes edges with one face infinitely sharp.
fn sharpen_boundary(sharpness: &mut [f32], edges: &[[u32; 2]]) {
    for (sharpness, &[_, against]) in sharpness.iter_mut().zip(edges) {
        if against == NONE {
            *sharpness = INFINITE_SHARPNESS;
        }
    }
}
