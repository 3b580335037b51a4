//! The control mesh of grains whose boundaries are made up of many elements.

use subzero::{Crease, CurveMesh, EdgeId, FaceId, Features, TriangleMesh};
use voronoi::{Dimension, PeriodicPair, Tessellation, Translation, VertexId};

use crate::mesh::adjacency::{Adjacency, Inner, by_edge};
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::id::id;
use crate::mesh::node_type::Meeting;
use crate::network::control_mesh::{ControlMesh, JunctionCounts, Meetings, boundary, originals};
use crate::network::grain_complex::{GrainPart, grain_complex};
use crate::network::labelled_mesh::Lines;
use crate::{
    Boundary, BoundaryId, Elements, FaceMesh, Junctions, Level, Mesh, NetworkError, PeriodicCopies, Twin,
    WallSets,
};

impl ControlMesh {
    /// That of grains instead of cells: what lies between cells of one grain is left out, and boundaries are made up of what hangs together
    /// between two grains. In space, edges collapse that are shorter than the `lengths` of all grains there.
    pub(crate) fn of_grains(
        tessellation: &Tessellation,
        parts: &[GrainPart],
        lengths: &[f64],
        face_mesh: FaceMesh,
        junctions: Junctions,
    ) -> Result<Self, NetworkError> {
        let of_cells = Self::new(tessellation, face_mesh, junctions)?;
        Self::of_elements(&grain_complex(tessellation, parts, lengths, &of_cells)?, junctions)
    }

    /// That of a complex whose faces are triangles (in the plane: segments), of which those that hang together between two grains are one boundary.
    pub(super) fn of_elements(complex: &Tessellation, junctions: Junctions) -> Result<Self, NetworkError> {
        let mut points = complex.vertices().to_vec();
        let sides: Vec<[voronoi::Side; 2]> = complex.faces().map(|face| complex.face_sides(face)).collect();
        let corners = complex.faces().map(|face| complex.face_corners(face));
        let mesh = match complex.domain().dimension() {
            Dimension::Two => ElementList::Segments(corners.map(numbers).collect()),
            Dimension::Three => ElementList::Triangles(corners.map(numbers).collect()),
        };
        let elements = Elements::from(&mesh);
        let mut groups = sides.clone();
        groups.sort_unstable();
        groups.dedup();
        let group_of = |sides| BoundaryId(id(groups.binary_search(sides).expect("all were listed")));
        let group_of: Vec<BoundaryId> = sides.iter().map(group_of).collect();
        let Adjacency { inner, incidences } = Adjacency::of_elements(elements, &group_of);
        let (mut boundaries, boundary_of) = connected(&sides, &inner);
        let copies = copies(complex, elements, &boundary_of);
        join_twins(&mut boundaries, &boundary_of, &copies.elements)?;
        let of_faces: Vec<Boundary> = sides.iter().map(|sides| boundary(*sides)).collect();
        let (wall_sets, walls) = match &mesh {
            ElementList::Segments(_) => WallSets::new(complex, &of_faces, std::iter::empty()),
            ElementList::Triangles(triangles) => {
                let ends = triangles.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]);
                WallSets::new(complex, &of_faces, ends.map(|ends| ends.map(|end| end as usize)))
            }
        };
        points
            .iter_mut()
            .zip(&walls)
            .for_each(|(point, walls)| *point = wall_sets.put_on_walls(*walls, *point));

        let mut at_points = Meetings::new(points.len(), copies.vertices.iter().copied());
        for (element, sides) in (0u32..).zip(&sides) {
            elements.corners(element).iter().for_each(|corner| at_points.note(*corner as usize, *sides));
        }
        let meetings = at_points.all();
        let of_points = || originals(&meetings, copies.vertices.iter().map(|pair| pair.secondary));
        let (mesh, at_edges, junctions) = match mesh {
            ElementList::Segments(segments) => {
                let mut corners: Vec<u32> = by_edge(&incidences).map(|at| at[0].edge).collect();
                copies.spread(&mut corners);
                let mesh = CurveMesh::new(points.len(), segments, &corners)?;
                (Mesh::Segments(mesh), Vec::new(), JunctionCounts::new(of_points(), of_points()))
            }
            ElementList::Triangles(triangles) => {
                let elements = Elements::Triangles(&triangles);
                let ends: Vec<[u32; 2]> = by_edge(&incidences).map(|at| at[0].ends(elements)).collect();
                let copied_edges = copies.of_edges(points.len(), &ends);
                let mut at_lines = Meetings::new(ends.len(), copied_edges.iter().copied());
                for (line, at) in by_edge(&incidences).enumerate() {
                    at.iter().for_each(|at| at_lines.note(line, sides[at.element as usize]));
                }
                let at_lines = at_lines.all();
                let lines = Lines::new(points.len(), &ends);
                let mut corners = lines.corners(junctions);
                copies.spread(&mut corners);
                let creases: Vec<Crease> = ends.iter().map(|ends| Crease::infinite(*ends)).collect();
                let features = Features { creases: &creases, corners: &corners, ..Features::default() };
                let of_lines = lines.sides(&at_lines, &copied_edges).collect::<Vec<_>>().into_iter();
                let junctions = JunctionCounts::new(of_lines, of_points());
                let mesh = TriangleMesh::new(points.len(), triangles, &features)?;
                let mut at_edges = vec![None; mesh.edge_count()];
                for (at, meeting) in by_edge(&incidences).zip(&at_lines) {
                    let edge = mesh.triangle_edges(FaceId(at[0].element))[usize::from(at[0].corner)];
                    at_edges[edge.index()] = Some(*meeting);
                }
                let inside = |edge: EdgeId| {
                    let triangle = mesh.edge_triangles(edge).expect("an edge inside a boundary has two")[0];
                    Meeting::inside(&boundaries[boundary_of[triangle.index()].index()])
                };
                let at_edges = (0u32..)
                    .zip(at_edges)
                    .map(|(edge, at)| at.unwrap_or_else(|| inside(EdgeId(edge))))
                    .collect();
                (Mesh::Triangles(mesh), at_edges, junctions)
            }
        };
        let level = Level {
            mesh,
            boundary_of,
            node_types: meetings.iter().map(|at| at.node_type).collect(),
            grain_counts: meetings.iter().map(|at| at.grains).collect(),
            generations: vec![0; points.len()],
            walls,
            copies,
            at_edges,
        };
        Ok(Self { level, points, boundaries, wall_sets, junctions })
    }
}

/// The vertices of a face with as many.
fn numbers<const COUNT: usize>(corners: &[VertexId]) -> [u32; COUNT] {
    std::array::from_fn(|corner| corners[corner].0)
}

/// The elements of a complex.
enum ElementList {
    Triangles(Vec<[u32; 3]>),
    Segments(Vec<[u32; 2]>),
}

impl<'a> From<&'a ElementList> for Elements<'a> {
    fn from(mesh: &'a ElementList) -> Self {
        match mesh {
            ElementList::Triangles(triangles) => Self::Triangles(triangles),
            ElementList::Segments(segments) => Self::Segments(segments),
        }
    }
}

/// The copies in a complex of elements. Of a boundary that comes twice, the points and elements of the one of greater number are the copies.
fn copies(complex: &Tessellation, elements: Elements<'_>, boundary_of: &[BoundaryId]) -> PeriodicCopies {
    let mut copies = PeriodicCopies::of_vertices(complex);
    copies.add_elements(complex.periodic_faces());
    // The boundary of points inside one.
    let mut only_boundary: Vec<Option<BoundaryId>> = vec![None; complex.vertices().len()];
    let mut is_shared = vec![false; only_boundary.len()];
    for (element, boundary) in (0u32..).zip(boundary_of) {
        for corner in elements.corners(element).iter() {
            let known = only_boundary[*corner as usize].get_or_insert(*boundary);
            is_shared[*corner as usize] |= known != boundary;
        }
    }
    for pair in &mut copies.vertices {
        let [secondary, primary] = [pair.secondary, pair.primary].map(|point| point as usize);
        let is_inside = !is_shared[secondary] && !is_shared[primary];
        if is_inside && only_boundary[secondary] < only_boundary[primary] {
            *pair = PeriodicPair {
                secondary: pair.primary,
                primary: pair.secondary,
                translation: Translation::ZERO - pair.translation,
            };
        }
    }
    copies.vertices.sort_unstable_by_key(|pair| pair.secondary);
    copies
}

/// Boundaries of elements with these sides, and the boundary of each element.
fn connected(sides: &[[voronoi::Side; 2]], inner: &Inner<'_>) -> (Vec<Boundary>, Vec<BoundaryId>) {
    let mut pieces = DisjointSets::new(sides.len());
    inner.pairs().iter().for_each(|[a, b]| pieces.join(*a, *b));
    let mut numbers = vec![None; sides.len()];
    let mut boundaries = Vec::new();
    let number = |(element, sides): (u32, &[voronoi::Side; 2])| {
        *numbers[pieces.root(element) as usize].get_or_insert_with(|| {
            boundaries.push(boundary(*sides));
            BoundaryId(id(boundaries.len() - 1))
        })
    };
    let boundary_of = (0u32..).zip(sides).map(number).collect();
    (boundaries, boundary_of)
}

/// Tells boundaries that come twice of each other.
fn join_twins(
    boundaries: &mut [Boundary],
    boundary_of: &[BoundaryId],
    copies: &[PeriodicPair<u32>],
) -> Result<(), NetworkError> {
    for pair in copies {
        let [secondary, primary] =
            [pair.secondary, pair.primary].map(|element| boundary_of[element as usize]);
        for (own, other, translation) in [
            (primary, secondary, pair.translation),
            (secondary, primary, Translation::ZERO - pair.translation),
        ] {
            let twin = Twin { boundary: other, translation };
            let boundary = &mut boundaries[own.index()];
            if *boundary.twin.get_or_insert(twin) != twin {
                // At one place more meets in a line than at another: a grain touches itself there.
                let grain = boundary.sides[0].grain().expect("a boundary's first side is a grain");
                return Err(NetworkError::GrainInPieces { grain });
            }
        }
    }
    Ok(())
}

impl PeriodicCopies {
    /// Adds to sorted points all that are copies of one of them, or that one of them is a copy of.
    fn spread(&self, points: &mut Vec<u32>) {
        if self.vertices.is_empty() {
            return;
        }
        let own = points.clone();
        let is_own = |point: u32| own.binary_search(&point).is_ok();
        let up = self.vertices.iter().filter(|pair| is_own(pair.secondary)).map(|pair| pair.primary);
        points.extend(up);
        points.sort_unstable();
        points.dedup();
        let own = points.clone();
        let is_own = |point: u32| own.binary_search(&point).is_ok();
        let down = self.vertices.iter().filter(|pair| is_own(pair.primary)).map(|pair| pair.secondary);
        points.extend(down);
        points.sort_unstable();
        points.dedup();
    }

    /// The edges, among some between so many points, that are others moved by whole periods.
    fn of_edges(&self, point_count: usize, edges: &[[u32; 2]]) -> Vec<PeriodicPair<u32>> {
        if self.vertices.is_empty() {
            return Vec::new();
        }
        let mut places: Vec<(u32, Translation)> =
            (0..id(point_count)).map(|point| (point, Translation::ZERO)).collect();
        for pair in &self.vertices {
            places[pair.secondary as usize] = (pair.primary, pair.translation);
        }
        let mut keyed: Vec<_> = (0u32..)
            .zip(edges)
            .map(|(edge, ends)| {
                let [from, to] = ends.map(|end| places[end as usize]);
                let [(start, at), (end, end_at)] = [from.min(to), from.max(to)];
                ((start, end, end_at - at), edge, at)
            })
            .collect();
        keyed.sort_unstable();
        let pairs = keyed.chunk_by(|a, b| a.0 == b.0).flat_map(|same| {
            let (_, primary, at) = same[0];
            same[1..].iter().map(move |(_, secondary, translation)| PeriodicPair {
                secondary: *secondary,
                primary,
                translation: *translation - at,
            })
        });
        pairs.collect()
    }
}
