//! Collapse of short edges and small faces.
//!
//! Random cells have edges and faces of any size down to nothing. Merging the two ends of a short edge makes a vertex of
//! higher order: one where the cells of both meet. A triangle that loses an edge closes like a book, and so a small face
//! shrinks to an edge or a vertex. Every cell stays a closed ball as long as the ends have nothing in common but what
//! lies around their edge (the link condition of Dey, Edelsbrunner, Guha and Nekhayev 1999, for cells instead of simplices).

use glam::DVec3;

use crate::tessellation::{FaceId, Side, Tessellation, VertexId};
use crate::weld::list_faces_of_cells;
use crate::{CellId, Dimension, Wall};

/// Sweeps over all edges; each makes room for collapses that the one before had to refuse.
const SWEEPS: usize = 10;

/// Cosine of the largest angle between a face and one of the triangles that join its edges to its centre (60 degrees).
const LARGEST_BEND: f64 = 0.5;

/// Cosine of the largest angle between neighbouring triangles of a face in the end (75 degrees): relaxation must not reach 90.
const LARGEST_FOLD: f64 = 0.26;

/// Share of the length of a short edge below which an edge is tiny.
const TINY: f64 = 0.01;

/// What a regularisation took out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Collapsed {
    /// Edges whose ends became one vertex.
    pub edges: usize,
    /// Faces that closed.
    pub faces: usize,
}

impl Tessellation {
    /// The complex without short edges: those shorter than `length` times the mean size of all cells, and than `length`
    /// times that of the smallest cell around. A cell's size is the edge of a cube (in the plane, of a square) as large.
    ///
    /// The ends of such an edge become one vertex in its middle, or where a wall holds one of them. Faces that are left with
    /// two edges vanish. Edges stay where a cell would no longer be a closed ball, or a face would fold. Cells are no longer
    /// quite convex, nor faces quite plane.
    ///
    /// A periodic complex comes back as it is.
    #[must_use]
    pub fn regularized(&self, length: f64) -> (Self, Collapsed) {
        if !self.periodic_faces.is_empty() {
            return (self.clone(), Collapsed::default());
        }
        let mut is_strict = vec![false; self.face_count()];
        loop {
            let mut complex = Complex::new(self, length, is_strict);
            complex.collapse_short_edges();
            // Faces that were let fold because they would close soon, and then did not, may not do so again.
            let folded = complex.folded_faces();
            if folded.is_empty() {
                return complex.finish(self);
            }
            is_strict = complex.is_strict;
            folded.into_iter().for_each(|face| is_strict[face] = true);
        }
    }
}

/// A cell complex whose vertices merge.
struct Complex<'a> {
    original: &'a Tessellation,
    vertices: Vec<DVec3>,
    /// Original vertices that each stands for.
    weights: Vec<f64>,
    walls: Vec<Vec<Wall>>,
    /// The corners of each face; empty for those that have closed.
    faces: Vec<Vec<u32>>,
    /// The faces at each vertex; empty for those that have merged into another.
    faces_at: Vec<Vec<u32>>,
    /// Number of faces that each cell has.
    face_counts: Vec<usize>,
    /// Length below which an edge of each cell is short.
    short: Vec<f64>,
    /// Whether each face has to stay unfolded however thin it gets.
    is_strict: Vec<bool>,
    collapsed: Collapsed,
}

impl<'a> Complex<'a> {
    fn new(original: &'a Tessellation, length: f64, is_strict: Vec<bool>) -> Self {
        let vertices = original.vertices().to_vec();
        let mut walls = vec![Vec::new(); vertices.len()];
        let mut faces_at = vec![Vec::new(); vertices.len()];
        for face in original.faces() {
            for corner in original.face_corners(face) {
                faces_at[corner.index()].push(face.0);
                match original.face_sides(face)[1] {
                    Side::Wall(wall) if !walls[corner.index()].contains(&wall) => {
                        walls[corner.index()].push(wall);
                    }
                    _ => {}
                }
            }
        }
        let root = |volume: f64| match original.domain().dimension() {
            Dimension::Two => volume.sqrt(),
            Dimension::Three => volume.cbrt(),
        };
        let measures = original.cell_measures();
        let mean_size = root(original.domain().measure() / measures.len() as f64);
        Self {
            original,
            weights: vec![1.0; vertices.len()],
            walls,
            faces: original
                .faces()
                .map(|face| original.face_corners(face).iter().map(|v| v.0).collect())
                .collect(),
            faces_at,
            face_counts: measures.iter().map(|cell| cell.face_count).collect(),
            short: measures.iter().map(|cell| length * mean_size.min(root(cell.volume))).collect(),
            vertices,
            is_strict,
            collapsed: Collapsed::default(),
        }
    }

    fn collapse_short_edges(&mut self) {
        for _ in 0..SWEEPS {
            let before = self.collapsed;
            for ends in self.short_edges() {
                self.collapse(ends);
            }
            if self.collapsed == before {
                break;
            }
        }
    }

    /// Changed faces whose triangles around the centre are folded, and that were not strict.
    fn folded_faces(&self) -> Vec<usize> {
        let is_folded = |face: &usize| {
            let ring: Vec<DVec3> =
                self.faces[*face].iter().map(|corner| self.vertices[*corner as usize]).collect();
            !self.is_strict[*face] && ring.len() > 3 && is_folded(&ring)
        };
        (0..self.faces.len()).filter(is_folded).collect()
    }

    fn dimension(&self) -> Dimension {
        self.original.domain().dimension()
    }

    fn sides(&self, face: u32) -> [Side; 2] {
        self.original.face_sides(FaceId(face))
    }

    fn length(&self, [a, b]: [u32; 2]) -> f64 {
        self.vertices[a as usize].distance(self.vertices[b as usize])
    }

    /// The edges that are shorter than any cell at their ends allows, shortest first.
    fn short_edges(&self) -> Vec<[u32; 2]> {
        let mut edges: Vec<[u32; 2]> = self.faces.iter().flat_map(|face| edges_of(face)).collect();
        edges.sort_unstable();
        edges.dedup();
        let mut edges: Vec<(f64, [u32; 2])> =
            edges.into_iter().map(|ends| (self.length(ends), ends)).collect();
        let count = u32::try_from(self.vertices.len()).expect("vertex ids fit 32 bits");
        let is_bend: Vec<bool> = (0..count).map(|vertex| self.is_bend(vertex)).collect();
        edges.retain(|(length, ends)| {
            *length < self.allowed(*ends) || ends.iter().any(|end| is_bend[*end as usize])
        });
        edges.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        edges.into_iter().map(|(_, ends)| ends).collect()
    }

    /// Whether a vertex is left with two edges: a mere bend in a line, where two long, thin faces have closed that crossed.
    fn is_bend(&self, vertex: u32) -> bool {
        self.dimension() == Dimension::Three && self.neighbors(vertex).len() == 2
    }

    fn allowed(&self, ends: [u32; 2]) -> f64 {
        let faces = ends.iter().flat_map(|end| &self.faces_at[*end as usize]);
        let cells = faces.flat_map(|face| self.sides(*face)).filter_map(cell_of);
        cells.map(|cell| self.short[cell.index()]).fold(f64::INFINITY, f64::min)
    }

    /// The cells at a vertex, and `None` for the exterior.
    fn cells_at(&self, vertex: u32) -> Vec<Option<CellId>> {
        let faces = self.faces_at[vertex as usize].iter();
        let mut cells: Vec<_> = faces.flat_map(|face| self.sides(*face).map(cell_of)).collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    }

    fn neighbors(&self, vertex: u32) -> Vec<u32> {
        let faces = self.faces_at[vertex as usize].iter();
        let mut neighbors: Vec<u32> = faces
            .flat_map(|face| edges_of(&self.faces[*face as usize]))
            .filter(|ends| ends.contains(&vertex))
            .map(|[a, b]| if a == vertex { b } else { a })
            .collect();
        neighbors.sort_unstable();
        neighbors.dedup();
        neighbors
    }

    /// Merges the ends of an edge, if it is still there and nothing forbids it.
    fn collapse(&mut self, ends: [u32; 2]) {
        let [u, w] = ends;
        if self.faces_at[u as usize].is_empty() || self.faces_at[w as usize].is_empty() {
            return;
        }
        let bend = ends.iter().position(|end| self.is_bend(*end));
        if bend.is_none() && self.length(ends) >= self.allowed(ends) {
            return;
        }
        // The end that walls hold stays in place, and so does what is more than a bend.
        let first_goes = match bend {
            Some(bend) => bend == 0,
            None => self.walls[w as usize].len() > self.walls[u as usize].len(),
        };
        let [kept, gone] = if first_goes { [w, u] } else { [u, w] };
        let Some(closing) = self.closing_faces(kept, gone) else { return };
        if !self.walls_allow(kept, gone) {
            return;
        }
        let place = if bend.is_none() && self.walls[u as usize].len() == self.walls[w as usize].len() {
            let [a, b] = [kept, gone].map(|end| self.weights[end as usize]);
            (self.vertices[kept as usize] * a + self.vertices[gone as usize] * b) / (a + b)
        } else {
            self.vertices[kept as usize]
        };
        if !self.stays_unfolded(kept, gone, place) {
            return;
        }
        self.merge(kept, gone, place, &closing);
    }

    /// The faces that a collapse closes; nothing where a cell would not stay a ball.
    fn closing_faces(&self, kept: u32, gone: u32) -> Option<Vec<u32>> {
        let at_gone = &self.faces_at[gone as usize];
        let common: Vec<u32> =
            self.faces_at[kept as usize].iter().copied().filter(|face| at_gone.contains(face)).collect();
        let is_edge = |face: &u32| {
            edges_of(&self.faces[*face as usize]).any(|ends| ends.contains(&kept) && ends.contains(&gone))
        };
        if common.is_empty() || !common.iter().all(is_edge) {
            return None;
        }
        let around_edge: Vec<Option<CellId>> =
            common.iter().flat_map(|face| self.sides(*face).map(cell_of)).collect();
        let cells_at_gone = self.cells_at(gone);
        let shared = self.cells_at(kept).into_iter().filter(|cell| cells_at_gone.contains(cell));
        if !shared.into_iter().all(|cell| around_edge.contains(&cell)) {
            return None;
        }
        let (least_corners, least_faces) = match self.dimension() {
            Dimension::Two => (3, 3),
            Dimension::Three => (4, 4),
        };
        let closing: Vec<u32> =
            common.into_iter().filter(|face| self.faces[*face as usize].len() < least_corners).collect();
        if self.dimension() == Dimension::Three {
            let at_gone = self.neighbors(gone);
            let common = self.neighbors(kept).into_iter().filter(|vertex| at_gone.contains(vertex)).count();
            if common != closing.len() {
                return None;
            }
        }
        let losing = |cell: CellId| {
            closing.iter().filter(|face| self.sides(**face).contains(&Side::Cell(cell))).count()
        };
        let keeps_enough = |cell: CellId| self.face_counts[cell.index()] >= least_faces + losing(cell);
        let cells = closing.iter().flat_map(|face| self.sides(*face)).filter_map(cell_of);
        cells.into_iter().all(keeps_enough).then_some(closing)
    }

    /// Whether the merged vertex can lie on all walls of both, and no edge from the inside comes to lie in a wall.
    fn walls_allow(&self, kept: u32, gone: u32) -> bool {
        let [walls, gone_walls] = [kept, gone].map(|end| &self.walls[end as usize]);
        if !gone_walls.iter().all(|wall| walls.contains(wall)) {
            return false;
        }
        let at_kept = self.neighbors(kept);
        self.neighbors(gone).iter().filter(|other| **other != kept && !at_kept.contains(other)).all(|other| {
            let others = &self.walls[*other as usize];
            walls.iter().filter(|wall| !gone_walls.contains(wall)).all(|wall| !others.contains(wall))
        })
    }

    /// Whether the faces around stay star-shaped when the two vertices meet at `place`.
    fn stays_unfolded(&self, kept: u32, gone: u32, place: DVec3) -> bool {
        if self.dimension() == Dimension::Two {
            return true;
        }
        let [at_kept, at_gone] = [kept, gone].map(|end| &self.faces_at[end as usize]);
        let mut faces: Vec<u32> = at_kept.iter().chain(at_gone).copied().collect();
        faces.sort_unstable();
        faces.dedup();
        faces.into_iter().all(|face| {
            let at = |vertex: &u32| {
                if [kept, gone].contains(vertex) { place } else { self.vertices[*vertex as usize] }
            };
            let ring: Vec<DVec3> = self.faces[face as usize].iter().map(at).collect();
            let short = self.sides(face).into_iter().filter_map(cell_of);
            let short = short.map(|cell| self.short[cell.index()]).fold(f64::INFINITY, f64::min);
            is_star_shaped(&ring, if self.is_strict[face as usize] { 0.0 } else { short })
        })
    }

    fn merge(&mut self, kept: u32, gone: u32, mut place: DVec3, closing: &[u32]) {
        // A mean of equal coordinates may miss them by a last place.
        for wall in &self.walls[kept as usize] {
            if let Some((axis, coordinate)) = self.original.domain().across_axis(*wall) {
                place[axis] = coordinate;
            }
        }
        self.vertices[kept as usize] = place;
        self.weights[kept as usize] += self.weights[gone as usize];
        for face in std::mem::take(&mut self.faces_at[gone as usize]) {
            let corners = &mut self.faces[face as usize];
            if corners.contains(&kept) {
                corners.retain(|corner| *corner != gone);
            } else {
                corners.iter_mut().filter(|corner| **corner == gone).for_each(|corner| *corner = kept);
                self.faces_at[kept as usize].push(face);
            }
        }
        for face in closing {
            for corner in std::mem::take(&mut self.faces[*face as usize]) {
                self.faces_at[corner as usize].retain(|other| other != face);
            }
            for cell in self.sides(*face).into_iter().filter_map(cell_of) {
                self.face_counts[cell.index()] -= 1;
            }
        }
        self.collapsed.edges += 1;
        self.collapsed.faces += closing.len();
    }

    /// The complex as a tessellation, with vertices and faces numbered anew in their old order.
    fn finish(self, original: &Tessellation) -> (Tessellation, Collapsed) {
        let mut tessellation = original.clone();
        let mut numbers = vec![VertexId(0); self.vertices.len()];
        tessellation.vertices.clear();
        let is_kept = |vertex: &usize| !self.faces_at[*vertex].is_empty();
        for (number, vertex) in (0u32..).zip((0..self.vertices.len()).filter(is_kept)) {
            numbers[vertex] = VertexId(number);
            tessellation.vertices.push(self.vertices[vertex]);
        }
        tessellation.face_starts = vec![0];
        tessellation.face_corners.clear();
        tessellation.face_sides.clear();
        for face in original.faces().filter(|face| !self.faces[face.index()].is_empty()) {
            let corners = self.faces[face.index()].iter();
            tessellation.face_corners.extend(corners.map(|corner| numbers[*corner as usize]));
            tessellation.face_starts.push(tessellation.face_corners.len());
            tessellation.face_sides.push(original.face_sides(face));
        }
        list_faces_of_cells(&mut tessellation);
        (tessellation, self.collapsed)
    }
}

fn cell_of(side: Side) -> Option<CellId> {
    match side {
        Side::Cell(cell) => Some(cell),
        Side::Image(..) | Side::Wall(_) => None,
    }
}

/// The edges of a face: one in the plane, where a face has two corners.
fn edges_of(corners: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    let count = if corners.len() == 2 { 1 } else { corners.len() };
    let after = corners.iter().cycle().skip(1);
    corners.iter().zip(after).take(count).map(|(a, b)| [*a.min(b), *a.max(b)])
}

/// The triangles that join the edges of a ring to its centre.
struct Fan {
    /// Length of each edge, and twice the area of its triangle as a vector.
    triangles: Vec<(f64, DVec3)>,
    perimeter: f64,
    /// Twice the area of all as a vector.
    normal: DVec3,
}

impl Fan {
    fn new(ring: &[DVec3]) -> Self {
        let edges = || ring.iter().zip(ring.iter().cycle().skip(1)).filter(|(a, b)| a != b);
        let perimeter: f64 = edges().map(|(a, b)| a.distance(*b)).sum();
        let center: DVec3 = edges().map(|(a, b)| (*a + *b) * (0.5 * a.distance(*b) / perimeter)).sum();
        let triangle = |(a, b): (&DVec3, &DVec3)| (a.distance(*b), (*a - center).cross(*b - center));
        let triangles: Vec<(f64, DVec3)> = edges().map(triangle).collect();
        let normal = triangles.iter().map(|(_, triangle)| *triangle).sum();
        Self { triangles, perimeter, normal }
    }
}

/// Whether no triangle from the ring's centre to an edge turns its back to the others. Rings thinner than `short` may, and
/// tiny edges: they are about to go themselves.
fn is_star_shaped(ring: &[DVec3], short: f64) -> bool {
    let Fan { triangles, perimeter, normal } = Fan::new(ring);
    if 0.5 * normal.length() < 0.5 * short * perimeter {
        return true;
    }
    triangles
        .iter()
        .filter(|(length, _)| *length > TINY * short)
        .all(|(_, triangle)| triangle.dot(normal) > LARGEST_BEND * triangle.length() * normal.length())
}

/// Whether two neighbouring triangles from the ring's centre to its edges are bent by more than [`LARGEST_FOLD`] tells.
fn is_folded(ring: &[DVec3]) -> bool {
    let Fan { triangles, .. } = Fan::new(ring);
    let mut pairs = triangles.iter().zip(triangles.iter().cycle().skip(1));
    pairs.any(|((_, a), (_, b))| a.dot(*b) < LARGEST_FOLD * a.length() * b.length())
}
