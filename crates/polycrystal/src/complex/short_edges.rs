//! Collapse of short edges and small faces.
//!
//! Random cells have edges and faces of any size down to nothing. Merging the two ends of a short edge makes a vertex of
//! higher order: one where the cells of both meet. A triangle that loses an edge collapses to one, and so a small face
//! shrinks to an edge or a vertex. Every cell stays a closed ball as long as the ends have nothing in common but what
//! lies around their edge (the link condition of Dey, Edelsbrunner, Guha and Nekhayev 1999, for cells instead of simplices).
//!
//! The complex of a periodic domain is that of the torus. What is said of edges and cells then holds for those of all space,
//! and an edge collapses together with its copies, if nothing around it is a copy of something else there.

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;
use smallvec::SmallVec;
use voronoi::{CellId, Dimension, FaceId, PeriodicVertex, Side, Tessellation, Translation, Wall};

use crate::complex::cell_complex::Corners;
use crate::complex::edge::ComplexEdge;
use crate::complex::ring::{is_folded, is_star_shaped};

/// What a regularisation took out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Collapsed {
    /// Edges whose ends became one vertex.
    pub edges: usize,
    /// Faces that collapsed.
    pub faces: usize,
}

/// The complex without short edges: those shorter than `length` times the mean size of all cells, and than `length`
/// times that of the smallest cell around. A cell's size is the edge of a cube (in the plane, of a square) as large.
///
/// The ends of such an edge become one vertex in its middle, or where a wall holds one of them. Faces that are left with
/// two edges vanish. Edges stay where a cell would no longer be a closed ball, or a face would fold. Cells are no longer
/// quite convex, nor faces quite plane.
///
/// ```
/// use glam::DVec3;
/// use polycrystal::remove_short_edges;
/// use voronoi::{Domain, Tessellation};
///
/// // Four grains whose corners nearly meet in one point: a short line parts two of them.
/// let seeds = [[0.25, 0.25], [0.75, 0.26], [0.25, 0.75], [0.75, 0.75]].map(|[x, y]| DVec3::new(x, y, 0.0));
/// let cells = Tessellation::new(&Domain::unit_square(), &seeds)?;
/// let (_, collapsed) = remove_short_edges(&cells, 0.1);
/// assert_eq!(collapsed.edges, 1);
/// # Ok::<(), voronoi::VoronoiError>(())
/// ```
#[must_use]
pub fn remove_short_edges(cells: &Tessellation, length: f64) -> (Tessellation, Collapsed) {
    remove_edges_that_shorten(cells, length, cells.vertices())
}

/// As [`remove_short_edges`], where vertices will move: an edge is short if it will be, with its ends at the `future` places of the
/// vertices.
///
/// # Panics
/// When there is not one place for each vertex.
#[must_use]
pub fn remove_edges_that_shorten(
    cells: &Tessellation,
    length: f64,
    future: &[DVec3],
) -> (Tessellation, Collapsed) {
    assert_eq!(future.len(), cells.vertices().len(), "one place for each vertex");
    let mut is_strict = vec![false; cells.face_count()];
    loop {
        let mut complex = Complex::new(cells, length, future, is_strict);
        complex.collapse_short_edges();
        // Faces that were let fold because they would collapse soon, and then did not, may not do so again.
        let folded = complex.folded_faces();
        if folded.is_empty() {
            return complex.finish();
        }
        is_strict = complex.is_strict;
        folded.into_iter().for_each(|face| is_strict[face] = true);
    }
}

/// A face moved by whole periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct MovedFace {
    face: u32,
    translation: Translation,
}

/// A cell moved by whole periods, or nothing for the exterior.
type MovedCell = Option<(CellId, Translation)>;

/// A cell complex whose vertices merge. That of a periodic domain has each vertex, edge and face once.
struct Complex<'a> {
    original: &'a Tessellation,
    vertices: Vec<DVec3>,
    /// Where vertices will be.
    future: Vec<DVec3>,
    /// Original vertices that each stands for.
    weights: Vec<f64>,
    walls: Vec<SmallVec<[Wall; 3]>>,
    /// The corners of each face; empty for those that have collapsed.
    faces: Vec<Corners>,
    /// The faces at each vertex, moved to where it has its own place; empty for those that have merged into another.
    faces_at: Vec<SmallVec<[MovedFace; 6]>>,
    /// Number of faces that each cell has.
    face_counts: Vec<usize>,
    /// Length below which an edge of each cell is short.
    short: Vec<f64>,
    /// Whether each face has to stay unfolded however thin it gets.
    is_strict: Vec<bool>,
    collapsed: Collapsed,
}

impl<'a> Complex<'a> {
    fn new(original: &'a Tessellation, length: f64, future: &[DVec3], is_strict: Vec<bool>) -> Self {
        let count = original.vertices().len() - original.periodic_vertices().len();
        let face_count = original.face_count() - original.periodic_faces().len();
        let mut walls = vec![SmallVec::new(); count];
        let mut faces_at = vec![SmallVec::new(); count];
        let mut faces = Vec::with_capacity(face_count);
        for face in original.faces().take(face_count) {
            check_cancelled();
            let corners: Corners =
                original.face_corners(face).iter().map(|vertex| original.periodic_vertex(*vertex)).collect();
            for PeriodicVertex { vertex, translation } in &corners {
                faces_at[*vertex as usize]
                    .push(MovedFace { face: face.0, translation: Translation::ZERO - *translation });
                match original.face_sides(face)[1] {
                    Side::Wall(wall) if !walls[*vertex as usize].contains(&wall) => {
                        walls[*vertex as usize].push(wall);
                    }
                    _ => {}
                }
            }
            faces.push(corners);
        }
        let root = |volume| original.domain().dimension().cube_edge(volume);
        let measures = original.cell_measures();
        let mean_size = root(original.domain().measure() / measures.len() as f64);
        Self {
            original,
            vertices: original.vertices()[..count].to_vec(),
            future: future[..count].to_vec(),
            weights: vec![1.0; count],
            walls,
            faces,
            faces_at,
            face_counts: measures.iter().map(|cell| cell.face_count).collect(),
            short: measures.iter().map(|cell| length * mean_size.min(root(cell.volume))).collect(),
            is_strict,
            collapsed: Collapsed::default(),
        }
    }

    /// Sweeps over all edges as long as that takes some out: each makes room for collapses that the one before had to refuse.
    fn collapse_short_edges(&mut self) {
        loop {
            let before = self.collapsed;
            for edge in self.short_edges() {
                check_cancelled();
                self.collapse(edge);
            }
            if self.collapsed == before {
                break;
            }
        }
    }

    /// Changed faces whose triangles around the centre are folded, and that were not strict.
    fn folded_faces(&self) -> Vec<usize> {
        let is_folded = |face: &usize| {
            let ring: Vec<DVec3> = self.faces[*face].iter().map(|corner| self.position(*corner)).collect();
            !self.is_strict[*face] && ring.len() > 3 && is_folded(&ring)
        };
        (0..self.faces.len()).filter(is_folded).collect()
    }

    fn dimension(&self) -> Dimension {
        self.original.domain().dimension()
    }

    fn position(&self, PeriodicVertex { vertex, translation }: PeriodicVertex) -> DVec3 {
        self.vertices[vertex as usize] + translation.vector(self.original.domain())
    }

    fn future_position(&self, PeriodicVertex { vertex, translation }: PeriodicVertex) -> DVec3 {
        self.future[vertex as usize] + translation.vector(self.original.domain())
    }

    /// What lies on both sides of a face.
    fn cells(&self, MovedFace { face, translation }: MovedFace) -> [MovedCell; 2] {
        self.original
            .face_sides(FaceId(face))
            .map(|side| side.cell().map(|(cell, image)| (cell, image + translation)))
    }

    fn corners(
        &self,
        MovedFace { face, translation: by }: MovedFace,
    ) -> impl Iterator<Item = PeriodicVertex> + Clone {
        let corners = self.faces[face as usize].iter();
        corners.map(move |&PeriodicVertex { vertex, translation }| PeriodicVertex {
            vertex,
            translation: translation + by,
        })
    }

    fn length(&self, edge: ComplexEdge) -> f64 {
        self.future[edge.start as usize].distance(self.future_position(edge.end))
    }

    /// The edges that are shorter than any cell at their ends allows, shortest first.
    fn short_edges(&self) -> Vec<ComplexEdge> {
        let count = u32::try_from(self.vertices.len()).expect("vertex ids fit 32 bits");
        let is_bend: Vec<bool> = (0..count).into_par_iter().map(|vertex| self.is_bend(vertex)).collect();
        let largest = self.short.iter().copied().fold(0.0, f64::max);
        let edges = self.faces.par_iter().flat_map_iter(|face| edges_of(face.iter().copied()));
        let mut edges: Vec<(f64, ComplexEdge)> = edges
            .map(|edge| (self.length(edge), edge))
            .filter(|(length, edge)| {
                // No cell allows more than the largest does; most edges need no other look.
                (*length < largest && *length < self.allowed(*edge))
                    || [edge.start, edge.end.vertex].iter().any(|end| is_bend[*end as usize])
            })
            .collect();
        edges.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        edges.dedup();
        edges.into_iter().map(|(_, edge)| edge).collect()
    }

    /// Whether a vertex is left with two edges: a mere bend in a line, where two long, thin faces have collapsed that crossed.
    fn is_bend(&self, vertex: u32) -> bool {
        if self.dimension() == Dimension::Two || self.faces_at[vertex as usize].is_empty() {
            return false;
        }
        // Nearly all vertices show a third neighbour in their second face.
        let vertex = PeriodicVertex { vertex, translation: Translation::ZERO };
        let mut known = [None; 2];
        self.edges_at(vertex).all(|neighbor| {
            let place = known.iter_mut().find(|known| known.is_none_or(|known| known == neighbor));
            place.is_some_and(|place| {
                *place = Some(neighbor);
                true
            })
        })
    }

    fn allowed(&self, edge: ComplexEdge) -> f64 {
        let faces = edge.across(false).into_iter().flat_map(|end| self.faces_at(end));
        let cells = faces.flat_map(|face| self.cells(face)).flatten();
        cells.map(|(cell, _)| self.short[cell.index()]).fold(f64::INFINITY, f64::min)
    }

    /// The faces at a vertex.
    fn faces_at(
        &self,
        PeriodicVertex { vertex, translation: by }: PeriodicVertex,
    ) -> impl Iterator<Item = MovedFace> {
        let faces = self.faces_at[vertex as usize].iter();
        faces.map(move |&MovedFace { face, translation }| MovedFace { face, translation: translation + by })
    }

    /// The cells at a vertex, and the exterior.
    fn cells_at(&self, vertex: PeriodicVertex) -> Vec<MovedCell> {
        let mut cells: Vec<_> = self.faces_at(vertex).flat_map(|face| self.cells(face)).collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    }

    /// The other ends of the edges at a vertex, those of face after face.
    fn edges_at(&self, vertex: PeriodicVertex) -> impl Iterator<Item = PeriodicVertex> {
        self.faces_at(vertex)
            .flat_map(|face| pairs_of(self.corners(face)))
            .filter(move |ends| ends.contains(&vertex))
            .map(move |[a, b]| if a == vertex { b } else { a })
    }

    fn neighbors(&self, vertex: PeriodicVertex) -> Vec<PeriodicVertex> {
        let mut neighbors: Vec<PeriodicVertex> = self.edges_at(vertex).collect();
        neighbors.sort_unstable();
        neighbors.dedup();
        neighbors
    }

    /// Merges the ends of an edge, if it is still there and nothing forbids it.
    fn collapse(&mut self, edge: ComplexEdge) {
        let ends = [edge.start, edge.end.vertex];
        if ends.iter().any(|end| self.faces_at[*end as usize].is_empty()) {
            return;
        }
        let bend = ends.iter().position(|end| self.is_bend(*end));
        if bend.is_none() && self.length(edge) >= self.allowed(edge) {
            return;
        }
        // The end that walls hold stays in place, and so does what is more than a bend.
        let [first_walls, second_walls] = ends.map(|end| self.walls[end as usize].len());
        let first_goes = match bend {
            Some(bend) => bend == 0,
            None => second_walls > first_walls,
        };
        let [kept, gone] = edge.across(first_goes);
        let Some(collapsing) = self.collapsing_faces(kept, gone) else { return };
        if !self.walls_allow(kept, gone) {
            return;
        }
        let is_mean = bend.is_none() && first_walls == second_walls;
        let merged = |[at_kept, at_gone]: [DVec3; 2]| {
            let [a, b] = [kept, gone].map(|end| self.weights[end.vertex as usize]);
            if is_mean { (at_kept * a + at_gone * b) / (a + b) } else { at_kept }
        };
        let place = merged([kept, gone].map(|end| self.position(end)));
        let future = merged([kept, gone].map(|end| self.future_position(end)));
        if !self.stays_unfolded(kept, gone, place) {
            return;
        }
        self.future[kept.vertex as usize] = future;
        self.merge(kept, gone, place, &collapsing);
    }

    /// The faces that collapse with an edge; nothing where a cell would not stay a ball.
    fn collapsing_faces(&self, kept: PeriodicVertex, gone: PeriodicVertex) -> Option<Vec<MovedFace>> {
        if !self.is_apart_from_copies(kept, gone) {
            return None;
        }
        let at_gone: Vec<MovedFace> = self.faces_at(gone).collect();
        let common: Vec<MovedFace> = self.faces_at(kept).filter(|face| at_gone.contains(face)).collect();
        let is_edge = |face: &MovedFace| {
            pairs_of(self.corners(*face)).any(|ends| ends.contains(&kept) && ends.contains(&gone))
        };
        if common.is_empty() || !common.iter().all(is_edge) {
            return None;
        }
        let around_edge: Vec<MovedCell> = common.iter().flat_map(|face| self.cells(*face)).collect();
        let cells_at_gone = self.cells_at(gone);
        let shared = self.cells_at(kept).into_iter().filter(|cell| cells_at_gone.contains(cell));
        if !shared.into_iter().all(|cell| around_edge.contains(&cell)) {
            return None;
        }
        let (least_corners, least_faces) = match self.dimension() {
            Dimension::Two => (3, 3),
            Dimension::Three => (4, 4),
        };
        let collapses = |face: &MovedFace| self.faces[face.face as usize].len() < least_corners;
        let collapsing: Vec<MovedFace> = common.into_iter().filter(collapses).collect();
        if self.dimension() == Dimension::Three {
            let at_gone = self.neighbors(gone);
            let common = self.neighbors(kept).into_iter().filter(|vertex| at_gone.contains(vertex)).count();
            if common != collapsing.len() {
                return None;
            }
        }
        let losing =
            |cell: &MovedCell| collapsing.iter().filter(|face| self.cells(**face).contains(cell)).count();
        let keeps_enough = |cell: MovedCell| {
            cell.is_none_or(|(id, _)| self.face_counts[id.index()] >= least_faces + losing(&cell))
        };
        collapsing.iter().flat_map(|face| self.cells(*face)).all(keeps_enough).then_some(collapsing)
    }

    /// Whether all that is around two vertices is there once, so that what happens there happens nowhere else to the same faces
    /// and cells. Only where a period is a few cells long is it not.
    fn is_apart_from_copies(&self, kept: PeriodicVertex, gone: PeriodicVertex) -> bool {
        if self.original.periodic_faces().is_empty() {
            return true;
        }
        let mut faces: Vec<MovedFace> = self.faces_at(kept).chain(self.faces_at(gone)).collect();
        let mut cells: Vec<(CellId, Translation)> =
            faces.iter().flat_map(|face| self.cells(*face)).flatten().collect();
        faces.sort_unstable();
        faces.dedup();
        cells.sort_unstable();
        cells.dedup();
        kept.vertex != gone.vertex
            && faces.windows(2).all(|pair| pair[0].face != pair[1].face)
            && cells.windows(2).all(|pair| pair[0].0 != pair[1].0)
    }

    /// Whether the merged vertex can lie on all walls of both, and no edge from the inside comes to lie in a wall.
    fn walls_allow(&self, kept: PeriodicVertex, gone: PeriodicVertex) -> bool {
        let [walls, gone_walls] = [kept, gone].map(|end| &self.walls[end.vertex as usize]);
        if !gone_walls.iter().all(|wall| walls.contains(wall)) {
            return false;
        }
        let at_kept = self.neighbors(kept);
        self.neighbors(gone).iter().filter(|other| **other != kept && !at_kept.contains(other)).all(|other| {
            let others = &self.walls[other.vertex as usize];
            walls.iter().filter(|wall| !gone_walls.contains(wall)).all(|wall| !others.contains(wall))
        })
    }

    /// Whether the faces around stay star-shaped when the two vertices meet at `place`.
    fn stays_unfolded(&self, kept: PeriodicVertex, gone: PeriodicVertex, place: DVec3) -> bool {
        if self.dimension() == Dimension::Two {
            return true;
        }
        let mut faces: Vec<MovedFace> = self.faces_at(kept).chain(self.faces_at(gone)).collect();
        faces.sort_unstable();
        faces.dedup();
        faces.into_iter().all(|face| {
            let at = |corner: PeriodicVertex| {
                if [kept, gone].contains(&corner) { place } else { self.position(corner) }
            };
            let ring: Vec<DVec3> = self.corners(face).map(at).collect();
            let short = self.cells(face).into_iter().flatten();
            let short = short.map(|(cell, _)| self.short[cell.index()]).fold(f64::INFINITY, f64::min);
            is_star_shaped(&ring, if self.is_strict[face.face as usize] { 0.0 } else { short })
        })
    }

    fn merge(
        &mut self,
        kept: PeriodicVertex,
        gone: PeriodicVertex,
        mut place: DVec3,
        collapsing: &[MovedFace],
    ) {
        // A mean of equal coordinates may miss them by a last place.
        for wall in &self.walls[kept.vertex as usize] {
            if let Some((axis, coordinate)) = self.original.domain().across_axis(*wall) {
                place[axis] = coordinate;
            }
        }
        self.vertices[kept.vertex as usize] = place;
        self.weights[kept.vertex as usize] += self.weights[gone.vertex as usize];
        for MovedFace { face, translation } in std::mem::take(&mut self.faces_at[gone.vertex as usize]) {
            // In the face's own place, the two are here.
            let at = translation + gone.translation;
            let [kept, gone] = [kept, gone]
                .map(|end| PeriodicVertex { vertex: end.vertex, translation: end.translation - at });
            let corners = &mut self.faces[face as usize];
            if corners.contains(&kept) {
                corners.retain(|corner| *corner != gone);
            } else {
                corners.iter_mut().filter(|corner| **corner == gone).for_each(|corner| *corner = kept);
                self.faces_at[kept.vertex as usize].push(MovedFace { face, translation: at });
            }
        }
        for gone_face in collapsing {
            for corner in std::mem::take(&mut self.faces[gone_face.face as usize]) {
                self.faces_at[corner.vertex as usize].retain(|other| other.face != gone_face.face);
            }
            for (cell, _) in self.cells(*gone_face).into_iter().flatten() {
                self.face_counts[cell.index()] -= 1;
            }
        }
        self.collapsed.edges += 1;
        self.collapsed.faces += collapsing.len();
    }

    /// The complex as a tessellation, with vertices and faces numbered anew in their old order.
    fn finish(self) -> (Tessellation, Collapsed) {
        let original = self.original;
        let faces = original.faces().zip(&self.faces).filter(|(_, corners)| !corners.is_empty());
        let faces = faces.map(|(face, corners)| (original.face_sides(face), corners.iter().copied()));
        let (whole, _) =
            Tessellation::of_whole_cells(original.domain(), original.seeds(), &self.vertices, faces);
        (whole, self.collapsed)
    }
}

/// The ends of the edges of a face: of one in the plane, where a face has two corners.
fn pairs_of(
    corners: impl Iterator<Item = PeriodicVertex> + Clone,
) -> impl Iterator<Item = [PeriodicVertex; 2]> {
    let count = corners.clone().count();
    let after = corners.clone().cycle().skip(1);
    corners.zip(after).take(if count == 2 { 1 } else { count }).map(|(a, b)| [a, b])
}

fn edges_of(corners: impl Iterator<Item = PeriodicVertex> + Clone) -> impl Iterator<Item = ComplexEdge> {
    pairs_of(corners).map(|[a, b]| ComplexEdge::between([a, b]))
}
