use std::ops::{Add, Sub};

use glam::DVec3;

use crate::cell_faces::CellFaces;
use crate::generator::Generator;
use crate::measure::{CellMeasure, KeptMeasures, cell_measures};
use crate::periodic_weld::weld_periodic;
use crate::search::Search;
use crate::tile::cut_tiles;
use crate::weld::weld;
use crate::{Dimension, Domain, VoronoiError, Wall, planar_cells};

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);

        impl $name {
            /// The id as an index into the arrays of a [`Tessellation`].
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// Number of a cell: its seed's place in the input.
    CellId
);
id!(
    /// Number of a vertex.
    VertexId
);
id!(
    /// Number of a face (in the plane: of an edge between two cells).
    FaceId
);

/// Whole periods of the domain along x, y and z.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Shift(pub [i8; 3]);

impl Shift {
    /// No period at all.
    pub const NONE: Self = Self([0; 3]);

    /// The shift as a length.
    pub fn vector(self, domain: &Domain) -> DVec3 {
        DVec3::from_array(self.0.map(f64::from)) * domain.size()
    }
}

impl Add for Shift {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self([0, 1, 2].map(|axis| self.0[axis] + other.0[axis]))
    }
}

impl Sub for Shift {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self([0, 1, 2].map(|axis| self.0[axis] - other.0[axis]))
    }
}

/// A vertex, edge or face that is another one moved by whole periods: `secondary = primary + shift`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PeriodicPair<Id> {
    /// The moved one.
    pub secondary: Id,
    /// The one that stands for all of its kind.
    pub primary: Id,
    /// How far the secondary is from the primary.
    pub shift: Shift,
}

/// What lies on one side of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// A cell.
    Cell(CellId),
    /// A cell of a periodic domain, moved by whole periods from where it stands.
    Image(CellId, Shift),
    /// The outside of the domain, beyond a wall.
    Wall(Wall),
}

/// The cells of all seeds as one cell complex: shared vertices once, shared faces once.
///
/// In three dimensions a face is a convex polygon. In the plane it is the edge between two cells, with two corners.
///
/// In a periodic domain every cell is whole: it stands around its seed and may stick out of the domain. A face between a
/// cell and a moved one then comes twice, once at each of the two cells, and so do vertices and edges, once at each place
/// where cells meet there. One of them is the primary, the others are its secondaries and listed with the shift between
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

    /// Cuts the domain into the Voronoi cells of the seeds, in parallel. In the plane the seeds' z must be 0.
    ///
    /// The same seeds give the same result bit by bit whatever the number of threads.
    ///
    /// # Errors
    /// [`VoronoiError`] names the first seed that is not finite, outside the domain or a duplicate.
    pub fn new(domain: &Domain, seeds: &[DVec3]) -> Result<Self, VoronoiError> {
        Self::cut(domain, seeds, None)
    }

    /// Cuts the domain into the power (Laguerre) cells of the seeds: a point belongs to the seed s with the smallest
    /// `|x - s|^2 - w`. The weight w is the squared radius of a sphere around the seed.
    ///
    /// A seed whose neighbours outweigh it has no cell; [`Self::empty_cells`] lists those.
    ///
    /// # Errors
    /// As [`Self::new`]; [`VoronoiError::BadWeight`] for a weight that is not finite.
    ///
    /// # Panics
    /// When there are not as many weights as seeds.
    pub fn power(domain: &Domain, seeds: &[DVec3], weights: &[f64]) -> Result<Self, VoronoiError> {
        assert_eq!(seeds.len(), weights.len(), "one weight for each seed");
        if let Some((seed, weight)) = weights.iter().enumerate().find(|(_, weight)| !weight.is_finite()) {
            return Err(VoronoiError::BadWeight { seed, weight: *weight });
        }
        Self::cut(domain, seeds, Some(weights))
    }

    fn cut(domain: &Domain, seeds: &[DVec3], weights: Option<&[f64]>) -> Result<Self, VoronoiError> {
        check_seeds(domain, seeds)?;
        let is_plain = weights.is_none() && !domain.is_periodic() && domain.is_box();
        if is_plain
            && domain.dimension() == Dimension::Two
            && let Some(tessellation) = planar_cells::tessellate(domain, seeds)
        {
            return Ok(tessellation);
        }
        let mut search = Search::new(domain, seeds, weights)?;
        Ok(if domain.is_periodic() {
            let tiles = cut_tiles(&mut search)?;
            weld_periodic(&search, seeds, tiles)
        } else {
            weld(&search, seeds)
        })
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

    /// Lists the faces of each cell, with places and counts as in [`CellFaces::new`].
    pub(crate) fn list_faces_of_cells(&mut self, places: &[u32], counts: Option<Vec<u32>>) {
        self.cell_faces = CellFaces::new(&self.face_sides, places, counts);
    }

    /// The same with the lists in order of the cells.
    pub(crate) fn list_faces_of_cells_in_order(&mut self) {
        let places: Vec<u32> = (0u32..).take(self.cell_count()).collect();
        self.list_faces_of_cells(&places, None);
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
    pub fn neighbors(&self, cell: CellId) -> Vec<Side> {
        let own = Side::Cell(cell);
        let across = |face: &FaceId| {
            let [first, second] = self.face_sides(*face);
            if first == own { second } else { first }
        };
        let mut sides: Vec<Side> = self.cell_faces(cell).iter().map(across).collect();
        sides.sort_unstable();
        sides
    }

    /// The vertices that are others moved by whole periods; none unless the domain is periodic. Secondaries have the last
    /// ids, in order, and stand at the primary's position plus [`Shift::vector`].
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

    /// Of the given edges, those that are others moved by whole periods, in order.
    pub fn periodic_edges(&self, edges: &Edges) -> Vec<PeriodicPair<u32>> {
        edges.periodic_pairs(&self.periodic_vertices)
    }

    /// Volume, surface and counts of every cell.
    pub fn cell_measures(&self) -> Vec<CellMeasure> {
        cell_measures(self)
    }

    /// The centroid of every cell, in the domain: where a step of Lloyd's algorithm moves the seeds. That of an empty cell is
    /// its seed.
    ///
    /// Seeds in the centroids of their cells, again and again, even the cells out: each step lowers the sum over all cells
    /// of the integral of `|x - s|^2 - w`.
    pub fn centroids(&self) -> Vec<DVec3> {
        self.toward_centroids(&self.cell_measures(), 1.0)
    }

    /// The seeds moved by a fraction of the way to the centroids of their cells, in the domain.
    pub(crate) fn toward_centroids(&self, measures: &[CellMeasure], fraction: f64) -> Vec<DVec3> {
        let (lower, upper) = (self.domain.lower(), self.domain.upper());
        let inside = measures.iter().zip(&self.seeds).map(|(cell, seed)| {
            let goal = if fraction < 1.0 { seed.lerp(cell.centroid, fraction) } else { cell.centroid };
            // Across periodic walls the cell of a seed inside may have its centroid outside.
            let wrapped = self.domain.wrapped(goal);
            // Rounding may put the centroid of a very thin cell a last place outside.
            let clamped = wrapped.clamp(lower, upper);
            // The same beside an oblique wall, where the way to the seed leads inside.
            let steps = (-52..=0).map(|exponent| clamped.lerp(*seed, 2f64.powi(exponent)));
            let mut places = std::iter::once(clamped).chain(steps);
            places.find(|place| self.domain.contains(*place)).unwrap_or(*seed)
        });
        inside.collect()
    }

    /// The edges between corners of the faces (three dimensions), or the faces' own (in the plane).
    pub fn edges(&self) -> Edges {
        Edges::new(self)
    }
}

/// The edges of a tessellation, each once.
#[derive(Debug, Clone, PartialEq)]
pub struct Edges {
    /// The two ends of each edge, smaller id first; sorted.
    pub ends: Vec<[VertexId; 2]>,
    /// For each corner of each face, in the order of the faces, the edge from it to the next corner.
    pub of_corner: Vec<u32>,
}

impl Edges {
    fn new(tessellation: &Tessellation) -> Self {
        let mut uses: Vec<([VertexId; 2], usize)> = Vec::with_capacity(tessellation.face_corners.len());
        let mut corner = 0;
        for face in tessellation.faces() {
            let corners = tessellation.face_corners(face);
            for (&from, &to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                uses.push(([from.min(to), from.max(to)], corner));
                corner += 1;
            }
        }
        uses.sort_unstable();
        let mut edges = Self { ends: Vec::new(), of_corner: vec![0; uses.len()] };
        for same in uses.chunk_by(|left, right| left.0 == right.0) {
            let edge = u32::try_from(edges.ends.len()).expect("edge ids fit 32 bits");
            edges.ends.push(same[0].0);
            for (_, corner) in same {
                edges.of_corner[*corner] = edge;
            }
        }
        edges
    }

    fn periodic_pairs(&self, vertices: &[PeriodicPair<VertexId>]) -> Vec<PeriodicPair<u32>> {
        let Some(first_secondary) = vertices.first().map(|pair| pair.secondary) else { return Vec::new() };
        let primary = |vertex: VertexId| match vertex.0.checked_sub(first_secondary.0) {
            None => (vertex, Shift::NONE),
            Some(place) => (vertices[place as usize].primary, vertices[place as usize].shift),
        };
        // An edge of the torus is a primary vertex, another one, and the shift of the other as seen from the first.
        let mut places: Vec<_> = (0u32..)
            .zip(&self.ends)
            .map(|(edge, ends)| {
                let [(a, at_a), (b, at_b)] = ends.map(primary);
                let (name, shift) = ((a, b, at_b - at_a), at_a).min(((b, a, at_a - at_b), at_b));
                (name, edge, shift)
            })
            .collect();
        places.sort_unstable();
        let same = places.chunk_by(|left, right| left.0 == right.0);
        let mut pairs: Vec<PeriodicPair<u32>> = same
            .flat_map(|same| {
                let (_, primary, at_primary) = same[0];
                let pair = move |&(_, secondary, shift): &_| PeriodicPair {
                    secondary,
                    primary,
                    shift: shift - at_primary,
                };
                same[1..].iter().map(pair)
            })
            .collect();
        pairs.sort_unstable_by_key(|pair| pair.secondary);
        pairs
    }
}

fn check_seeds(domain: &Domain, seeds: &[DVec3]) -> Result<(), VoronoiError> {
    if seeds.is_empty() {
        return Err(VoronoiError::NoSeeds);
    }
    if seeds.len() > Generator::MAX_SITES {
        return Err(VoronoiError::TooManySeeds { count: seeds.len() });
    }
    for (seed, &position) in seeds.iter().enumerate() {
        if !position.is_finite() {
            return Err(VoronoiError::NotFinite { seed, position });
        }
        if !domain.contains(position) {
            return Err(VoronoiError::OutsideDomain { seed, position, domain: domain.to_string() });
        }
    }
    Ok(())
}
