//! A cell complex whose topology changes.

use glam::DVec3;
use rayon::prelude::*;
use smallvec::SmallVec;
use voronoi::{CellId, Domain, FaceId, PeriodicVertex, Side, Tessellation, Translation, Wall};

use crate::complex::edge::ComplexEdge;
use crate::mesh::id::id;

/// The corners of a face, in place up to so many: faces have five on average.
pub(super) type Corners = SmallVec<[PeriodicVertex; 8]>;

/// The faces at a vertex, in place up to six: as many as lie between four sides.
pub(super) type FacesAt = SmallVec<[u32; 6]>;

/// The faces of a cell, in place up to so many: random cells have 15.5 on average, one in ten has more.
pub(super) type FacesOf = SmallVec<[u32; 20]>;

/// The cells of a [`Tessellation`] in space in a form that can be changed: each vertex, edge and face once, also in a
/// periodic domain.
///
/// Cells that come together or part change the complex in two ways, each the other's reverse ([`Self::edge_to_triangle`] and
/// [`Self::triangle_to_edge`]). Numbers of vertices and faces that are gone are not given to others.
#[derive(Debug, Clone)]
pub struct CellComplex {
    pub(super) domain: Domain,
    pub(super) seeds: Vec<DVec3>,
    /// Where vertices are.
    pub vertices: Vec<DVec3>,
    pub(super) faces: Vec<Face>,
    /// The faces at each vertex; none where it is gone.
    pub(super) faces_at: Vec<FacesAt>,
    /// The faces of each cell; one between a cell and its own image comes twice.
    pub(super) faces_of: Vec<FacesOf>,
}

/// A polygon between two sides, as its first side, a cell, sees it.
#[derive(Debug, Clone)]
pub(super) struct Face {
    pub(super) sides: [Side; 2],
    /// Counter-clockwise as seen from the second side; none where the face is gone.
    pub(super) corners: Corners,
}

impl From<&Tessellation> for CellComplex {
    fn from(tessellation: &Tessellation) -> Self {
        let vertex_count = tessellation.vertices().len() - tessellation.periodic_vertices().len();
        let face_count = tessellation.face_count() - tessellation.periodic_faces().len();
        let faces = tessellation.faces().take(face_count).map(|face| Face {
            sides: tessellation.face_sides(face),
            corners: tessellation
                .face_corners(face)
                .iter()
                .map(|vertex| tessellation.periodic_vertex(*vertex))
                .collect(),
        });
        let mut complex = Self {
            domain: tessellation.domain().clone(),
            seeds: tessellation.seeds().to_vec(),
            vertices: tessellation.vertices()[..vertex_count].to_vec(),
            faces: Vec::new(),
            faces_at: vec![FacesAt::new(); vertex_count],
            faces_of: vec![FacesOf::new(); tessellation.cell_count()],
        };
        faces.for_each(|face| {
            complex.add_face(face);
        });
        complex
    }
}

impl CellComplex {
    /// The complex with whole cells, and the vertex that each of its vertices is.
    ///
    /// Vertices and faces keep their order; those that are gone are left out.
    pub fn tessellation(&self) -> (Tessellation, Vec<PeriodicVertex>) {
        let live = self.faces.iter().filter(|face| !face.corners.is_empty());
        let faces = live.map(|face| (face.sides, face.corners.iter().copied()));
        Tessellation::of_whole_cells(&self.domain, &self.seeds, &self.vertices, faces)
    }

    /// Number of cells, with those that are gone.
    pub fn cell_count(&self) -> usize {
        self.faces_of.len()
    }

    /// Where a corner is.
    pub fn position(&self, corner: PeriodicVertex) -> DVec3 {
        self.vertices[corner.vertex as usize] + corner.translation.vector(&self.domain)
    }

    /// All edges, sorted.
    pub fn edges(&self) -> Vec<ComplexEdge> {
        let mut edges: Vec<ComplexEdge> = self.faces.par_iter().flat_map_iter(Face::edges).collect();
        edges.par_sort_unstable();
        edges.dedup();
        edges
    }

    /// The edges of a face, in order.
    pub fn edges_of(&self, face: FaceId) -> impl Iterator<Item = ComplexEdge> {
        self.faces[face.index()].edges()
    }

    /// Whether an edge is still there.
    pub fn has_edge(&self, edge: ComplexEdge) -> bool {
        let faces = &self.faces_at[edge.start as usize];
        let mut edges = faces.iter().flat_map(|face| self.faces[*face as usize].edges());
        edges.any(|other| other == edge)
    }

    /// Whether an edge is one of a face's.
    pub fn is_edge_of(&self, edge: ComplexEdge, face: FaceId) -> bool {
        self.edges_of(face).any(|other| other == edge)
    }

    /// The domain that the cells fill.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// The faces with so many corners.
    pub fn faces_with_corners(&self, count: usize) -> Vec<FaceId> {
        let faces = (0u32..).zip(&self.faces);
        faces.filter(|(_, face)| face.corners.len() == count).map(|(number, _)| FaceId(number)).collect()
    }

    /// The corners of a face, as its first side sees them; none where it is gone.
    pub fn corners(&self, face: FaceId) -> &[PeriodicVertex] {
        &self.faces[face.index()].corners
    }

    /// The faces of a cell; one between the cell and its own image comes twice.
    pub fn faces_of_cell(&self, cell: CellId) -> impl ExactSizeIterator<Item = FaceId> {
        self.faces_of[cell.index()].iter().copied().map(FaceId)
    }

    /// The two sides of a face: a cell, and what its corners are counter-clockwise seen from.
    pub fn sides(&self, face: FaceId) -> [Side; 2] {
        self.faces[face.index()].sides
    }

    /// All faces at some vertices, sorted; in place those at the four of a boundary.
    pub(crate) fn faces_at(&self, vertices: &[u32]) -> SmallVec<[FaceId; 24]> {
        let faces = vertices.iter().flat_map(|vertex| &self.faces_at[*vertex as usize]);
        let mut faces: SmallVec<[FaceId; 24]> = faces.copied().map(FaceId).collect();
        faces.sort_unstable();
        faces.dedup();
        faces
    }

    /// The faces that meet at an edge, sorted.
    pub fn faces_of_edge(&self, edge: ComplexEdge) -> Vec<FaceId> {
        let faces = self.faces_at(&[edge.start]).into_iter();
        faces.filter(|face| self.is_edge_of(edge, *face)).collect()
    }

    /// The walls that a vertex lies on, sorted.
    pub fn walls_at(&self, vertex: u32) -> Vec<Wall> {
        let faces = self.faces_at[vertex as usize].iter();
        let walls = faces.filter_map(|face| match self.faces[*face as usize].sides[1] {
            Side::Wall(wall) => Some(wall),
            Side::Cell(_) | Side::Image(..) => None,
        });
        let mut walls: Vec<Wall> = walls.collect();
        walls.sort_unstable();
        walls.dedup();
        walls
    }

    /// All faces that are there, in order.
    pub fn faces(&self) -> Vec<FaceId> {
        let faces = (0u32..).zip(&self.faces);
        faces.filter(|(_, face)| !face.corners.is_empty()).map(|(number, _)| FaceId(number)).collect()
    }

    pub(super) fn add_face(&mut self, face: Face) {
        self.register(id(self.faces.len()), &face);
        self.faces.push(face);
    }

    /// Notes a face of the given number at its corners and with its cells.
    pub(super) fn register(&mut self, number: u32, face: &Face) {
        face.corners.iter().for_each(|corner| self.faces_at[corner.vertex as usize].push(number));
        face.sides.into_iter().filter_map(cell_of).for_each(|cell| self.faces_of[cell.index()].push(number));
    }

    pub(super) fn remove_face(&mut self, number: u32) {
        let face = &mut self.faces[number as usize];
        for corner in std::mem::take(&mut face.corners) {
            self.faces_at[corner.vertex as usize].retain(|other| *other != number);
        }
        for cell in face.sides.into_iter().filter_map(cell_of) {
            self.faces_of[cell.index()].retain(|other| *other != number);
        }
    }

    pub(super) fn add_vertex(&mut self, position: DVec3) -> PeriodicVertex {
        self.vertices.push(position);
        self.faces_at.push(FacesAt::new());
        PeriodicVertex { vertex: id(self.vertices.len() - 1), translation: Translation::ZERO }
    }
}

impl Face {
    fn edges(&self) -> impl Iterator<Item = ComplexEdge> {
        self.corners
            .iter()
            .zip(self.corners.iter().cycle().skip(1))
            .map(|(from, to)| ComplexEdge::between([*from, *to]))
    }
}

pub(super) fn cell_of(side: Side) -> Option<CellId> {
    side.cell().map(|(cell, _)| cell)
}
