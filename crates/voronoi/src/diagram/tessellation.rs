//! The cell complex that comes out.

use glam::DVec3;
use rayon::prelude::*;

use crate::diagram::cell_faces::CellFaces;
use crate::diagram::cell_sum::KeptMeasures;
use crate::{CellId, Dimension, Domain, FaceId, PeriodicPair, Side, VertexId};

/// The cells of all seeds as one cell complex: shared vertices once, shared faces once.
///
/// In three dimensions a face is a convex polygon. In the plane it is the edge between two cells, with two corners.
///
/// In a periodic domain every cell is whole: it stands around its seed and may stick out of the domain. A face between a
/// cell and a moved one then comes twice, once at each of the two cells, and so do vertices and edges, once at each position
/// where cells meet there. One of them is the primary, the others are its secondaries and listed with the translation between
/// them ([`Self::periodic_faces`], [`Self::periodic_vertices`], [`Self::periodic_edges`]). Primaries alone are the complex
/// of the periodic domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Tessellation {
    pub(crate) domain: Domain,
    pub(crate) seeds: Vec<DVec3>,
    pub(crate) vertices: Vec<DVec3>,
    pub(crate) face_sides: Vec<[Side; 2]>,
    pub(crate) face_starts: Vec<usize>,
    pub(crate) face_corners: Vec<VertexId>,
    pub(crate) cell_faces: CellFaces,
    pub(crate) periodic_vertices: Vec<PeriodicPair<VertexId>>,
    pub(crate) periodic_faces: Vec<PeriodicPair<FaceId>>,
    pub(crate) measures: KeptMeasures,
}

impl Tessellation {
    /// Cells to which faces are yet to be added.
    pub(crate) fn without_faces(domain: &Domain, seeds: &[DVec3], vertices: Vec<DVec3>) -> Self {
        Self {
            domain: domain.clone(),
            seeds: seeds.to_vec(),
            vertices,
            face_sides: Vec::new(),
            face_starts: vec![0],
            face_corners: Vec::new(),
            cell_faces: CellFaces::default(),
            periodic_vertices: Vec::new(),
            periodic_faces: Vec::new(),
            measures: KeptMeasures::default(),
        }
    }

    /// The cells with each coordinate multiplied by a factor of its axis: convex as they were, but no longer the cells of their seeds.
    ///
    /// # Panics
    /// As [`Domain::stretched`].
    #[must_use]
    pub fn stretched(&self, factors: DVec3) -> Self {
        let stretch = |points: &[DVec3]| points.iter().map(|point| point * factors).collect();
        Self {
            domain: self.domain.stretched(factors),
            seeds: stretch(&self.seeds),
            vertices: stretch(&self.vertices),
            measures: KeptMeasures::default(),
            ..self.clone()
        }
    }

    /// Reserves memory for cells without faces yet, as if the seeds were random, or a little more.
    pub(crate) fn make_room(&mut self) {
        // Random cells have 6.77 vertices, 7.77 faces and 40.6 corners each, in the plane 2, 3 and 6.
        let per_cell = match self.domain.dimension() {
            Dimension::Three => [7, 8, 42],
            Dimension::Two => [3, 4, 8],
        };
        let [vertices, faces, corners] = per_cell.map(|per_cell| per_cell * self.seeds.len());
        self.vertices.reserve(vertices);
        self.face_sides.reserve(faces);
        self.face_starts.reserve(faces);
        self.face_corners.reserve(corners);
    }

    /// Gives back the memory that vertices and faces do not need.
    pub(crate) fn shrink_to_fit(&mut self) {
        self.vertices.shrink_to_fit();
        self.face_sides.shrink_to_fit();
        self.face_starts.shrink_to_fit();
        self.face_corners.shrink_to_fit();
    }

    pub(crate) fn push_face(&mut self, sides: [Side; 2], corners: impl Iterator<Item = VertexId>) -> FaceId {
        let face = FaceId(u32::try_from(self.face_count()).expect("face ids fit 32 bits"));
        self.face_sides.push(sides);
        self.face_corners.extend(corners);
        self.face_starts.push(self.face_corners.len());
        face
    }

    /// Lists the faces of each cell, with indices and counts as in [`CellFaces::new`].
    pub(crate) fn list_faces_of_cells(&mut self, indices: &[u32], counts: Option<Vec<u32>>) {
        self.cell_faces = CellFaces::new(&self.face_sides, indices, counts);
    }

    /// The same with the lists in order of the cells.
    pub(crate) fn list_faces_of_cells_in_order(&mut self) {
        let indices: Vec<u32> = (0u32..).take(self.cell_count()).collect();
        self.list_faces_of_cells(&indices, None);
    }

    /// The domain that is divided up.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// The seeds, one per cell.
    pub fn seeds(&self) -> &[DVec3] {
        &self.seeds
    }

    /// Positions of the vertices.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.seeds.len()
    }

    /// Number of faces.
    pub fn face_count(&self) -> usize {
        self.face_sides.len()
    }

    /// All faces in order of id.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = FaceId> {
        (0..u32::try_from(self.face_count()).expect("face ids fit 32 bits")).map(FaceId)
    }

    /// The two sides of a face: a cell first, then a cell of greater number, any moved cell or a wall.
    pub fn face_sides(&self, face: FaceId) -> [Side; 2] {
        self.face_sides[face.index()]
    }

    /// The corners of a face, counter-clockwise as seen from its second side.
    ///
    /// In the plane: start and end of the edge, its first side to the left.
    pub fn face_corners(&self, face: FaceId) -> &[VertexId] {
        &self.face_corners[self.face_starts[face.index()]..self.face_starts[face.index() + 1]]
    }

    /// The faces of a cell.
    pub fn cell_faces(&self, cell: CellId) -> &[FaceId] {
        self.cell_faces.of(cell)
    }

    /// The cells without volume, which have no faces: seeds that their neighbours outweigh.
    pub fn empty_cells(&self) -> Vec<CellId> {
        let cells = (0u32..).take(self.cell_count()).map(CellId);
        cells.filter(|cell| self.cell_faces(*cell).is_empty()).collect()
    }

    /// What lies beyond the faces of a cell, sorted: cells by number, then moved cells, then walls.
    ///
    /// ```
    /// use glam::DVec3;
    /// use voronoi::{CellId, Domain, Side, Tessellation};
    ///
    /// let seeds = [DVec3::new(0.25, 0.5, 0.5), DVec3::new(0.75, 0.5, 0.5)];
    /// let cells = Tessellation::new(&Domain::unit_cube(), &seeds)?;
    /// let neighbors = cells.neighbors(CellId(0));
    /// assert!(neighbors.contains(&Side::Cell(CellId(1))));
    /// assert_eq!(neighbors.len(), 6, "the other cell and five walls");
    /// # Ok::<(), voronoi::VoronoiError>(())
    /// ```
    pub fn neighbors(&self, cell: CellId) -> Vec<Side> {
        let mut sides: Vec<Side> =
            self.cell_faces(cell).iter().map(|face| self.across(cell, *face)).collect();
        sides.sort_unstable();
        sides
    }

    /// What lies across a face of a cell.
    pub fn across(&self, cell: CellId, face: FaceId) -> Side {
        let [first, second] = self.face_sides(face);
        if first == Side::Cell(cell) { second } else { first }
    }

    /// The vertices that are others moved by whole periods; none unless the domain is periodic. Secondaries have the last
    /// ids, in order, and stand at the primary's position plus [`Translation::vector`](crate::Translation::vector).
    pub fn periodic_vertices(&self) -> &[PeriodicPair<VertexId>] {
        &self.periodic_vertices
    }

    /// The faces that are others moved by whole periods; none unless the domain is periodic. Secondaries have the last ids,
    /// in order.
    ///
    /// As each face's first side is a cell, a secondary is turned round: its corner k is the moved corner n - 1 - k of its
    /// primary, with n corners.
    pub fn periodic_faces(&self) -> &[PeriodicPair<FaceId>] {
        &self.periodic_faces
    }

    /// Rounding may leave a vertex of a wall's face a last place beside the wall: it gets the wall's own coordinate, unless the
    /// wall is oblique.
    pub(crate) fn put_vertices_on_walls(&mut self) {
        let domain = &self.domain;
        let on_wall = |(face, sides): (usize, &[Side; 2])| match sides[1] {
            Side::Wall(wall) => domain.across_axis(wall).map(|(axis, coordinate)| (face, axis, coordinate)),
            Side::Cell(_) | Side::Image(..) => None,
        };
        let faces: Vec<_> = self.face_sides.par_iter().enumerate().filter_map(on_wall).collect();
        for (face, axis, coordinate) in faces {
            let corners = self.face_starts[face]..self.face_starts[face + 1];
            for corner in &self.face_corners[corners] {
                self.vertices[corner.index()][axis] = coordinate;
            }
        }
    }
}
