//! The control mesh of grains that several cells make up.

use glam::DVec3;
use subzero::{Crease, CurveMesh, Features, TriangleMesh};
use voronoi::{CellId, PeriodicPair, Shift, Tessellation};

use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::id::id;
use crate::mesh::node_type::Meeting;
use crate::mesh::seams::Seams;
use crate::network::coarsening::{coarsened, coarsened_segments};
use crate::network::control_mesh::{ControlMesh, JunctionCounts, Meetings, boundary, originals};
use crate::network::labelled_mesh::Lines;
use crate::{
    Boundary, BoundaryId, Elements, FaceMesh, GrainId, Junctions, Level, Mesh, NetworkError, PeriodicCopies,
    Twin,
};

impl ControlMesh {
    /// That of grains instead of cells: what lies between cells of one grain is left out, and boundaries are made up of what hangs together
    /// between two grains. In space, edges close that are shorter than the `lengths` of all grains there.
    pub(crate) fn of_grains(
        tessellation: &Tessellation,
        grain_of_cell: &[GrainId],
        lengths: &[f64],
        face_mesh: FaceMesh,
        junctions: Junctions,
    ) -> Result<Self, NetworkError> {
        check_grains(tessellation, grain_of_cell)?;
        let Self { level, points, wall_sets, .. } = Self::new(tessellation, face_mesh, junctions)?;
        let kept = KeptElements::new(tessellation, grain_of_cell, &level, lengths, &points);
        let kept_points = || (0u32..).zip(&kept.numbers).filter(|(_, number)| number.is_some());
        let points: Vec<DVec3> = kept_points().map(|(old, _)| points[old as usize]).collect();
        let walls: Vec<_> = kept_points().map(|(old, _)| level.walls[old as usize]).collect();
        let elements = (&kept.mesh).into();
        let mut groups = kept.sides.clone();
        groups.sort_unstable();
        groups.dedup();
        let group_of = |sides| BoundaryId(id(groups.binary_search(sides).expect("all were listed")));
        let group_of: Vec<BoundaryId> = kept.sides.iter().map(group_of).collect();
        let seams = Seams::of_elements(elements, &group_of);
        let (mut boundaries, boundary_of) = connected(&kept.sides, &seams);
        let copies = kept.copies(&level.copies, &boundary_of);
        join_twins(&mut boundaries, &boundary_of, &copies.elements)?;

        let mut at_points = Meetings::new(points.len(), copies.vertices.iter().copied());
        for (element, sides) in (0u32..).zip(&kept.sides) {
            elements.corners(element).iter().for_each(|corner| at_points.note(*corner as usize, *sides));
        }
        let meetings = at_points.all();
        let of_points = || originals(&meetings, copies.vertices.iter().map(|pair| pair.secondary));
        let (mesh, at_edges, junctions) = match kept.mesh {
            KeptMesh::Segments(segments) => {
                let mut corners: Vec<u32> = seams.places().map(|at| at[0].place).collect();
                copies.spread(&mut corners);
                let mesh = CurveMesh::new(points.len(), segments, &corners)?;
                (Mesh::Segments(mesh), Vec::new(), JunctionCounts::new(of_points(), of_points()))
            }
            KeptMesh::Triangles(triangles) => {
                let elements = Elements::Triangles(&triangles);
                let ends: Vec<[u32; 2]> = seams.places().map(|at| at[0].ends(elements)).collect();
                let copied_edges = copies.of_edges(points.len(), &ends);
                let mut at_lines = Meetings::new(ends.len(), copied_edges.iter().copied());
                for (line, at) in seams.places().enumerate() {
                    at.iter().for_each(|at| at_lines.note(line, kept.sides[at.element as usize]));
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
                for (at, meeting) in seams.places().zip(&at_lines) {
                    let edge = mesh.triangle_edges(at[0].element)[usize::from(at[0].corner)];
                    at_edges[edge as usize] = Some(*meeting);
                }
                let inside = |edge: u32| {
                    let triangle = mesh.edge_triangles(edge).expect("an edge inside a boundary has two")[0];
                    Meeting::inside(&boundaries[boundary_of[triangle as usize].index()])
                };
                let at_edges =
                    (0u32..).zip(at_edges).map(|(edge, at)| at.unwrap_or_else(|| inside(edge))).collect();
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

/// Checks that grains are numbered from 0 without gaps, and that the cells of each hang together where they stand.
fn check_grains(tessellation: &Tessellation, grain_of_cell: &[GrainId]) -> Result<(), NetworkError> {
    assert_eq!(grain_of_cell.len(), tessellation.cell_count(), "one grain for each cell");
    let mut pieces = DisjointSets::new(grain_of_cell.len());
    for face in tessellation.faces() {
        if let [voronoi::Side::Cell(a), voronoi::Side::Cell(b)] = tessellation.face_sides(face)
            && grain_of_cell[a.index()] == grain_of_cell[b.index()]
        {
            pieces.join(a.0, b.0);
        }
    }
    let grain_count = grain_of_cell.iter().map(|grain| grain.index() + 1).max().unwrap_or(0);
    let mut piece_of = vec![None; grain_count];
    for (cell, grain) in (0u32..).zip(grain_of_cell) {
        if tessellation.cell_faces(CellId(cell)).is_empty() {
            continue;
        }
        let root = pieces.root(cell);
        if *piece_of[grain.index()].get_or_insert(root) != root {
            return Err(NetworkError::GrainInPieces { grain: *grain });
        }
    }
    match (0u32..).zip(piece_of).find(|(_, piece)| piece.is_none()) {
        Some((grain, _)) => Err(NetworkError::MissingGrain { grain: GrainId(grain) }),
        None => Ok(()),
    }
}

/// The elements between grains, wound with the smaller grain first.
struct KeptElements {
    mesh: KeptMesh,
    /// What lies on both sides of each element, with grains for cells.
    sides: Vec<[voronoi::Side; 2]>,
    /// Of each element between cells, its number among those that are kept.
    elements: Vec<Option<u32>>,
    /// Of each point between cells, its number among those that are kept.
    numbers: Vec<Option<u32>>,
}

/// Two sides, the smaller first.
fn sorted(mut sides: [voronoi::Side; 2]) -> [voronoi::Side; 2] {
    sides.sort_unstable();
    sides
}

/// Below what edges at each point are short: the least length of all grains there; nothing where points are copies of each other.
fn limits(
    lengths: &[f64],
    elements: Elements<'_>,
    sides: &[[voronoi::Side; 2]],
    level: &Level,
    point_count: usize,
) -> Vec<Option<f64>> {
    let mut limits = vec![Some(f64::INFINITY); point_count];
    for (element, sides) in (0u32..).zip(sides) {
        for grain in sides.iter().filter_map(|side| match side {
            voronoi::Side::Cell(grain) | voronoi::Side::Image(grain, _) => Some(grain.index()),
            voronoi::Side::Wall(_) => None,
        }) {
            for corner in elements.corners(element) {
                let limit = &mut limits[*corner as usize];
                *limit = limit.map(|limit| limit.min(lengths[grain]));
            }
        }
    }
    // Points between cells of one grain.
    limits.iter_mut().for_each(|limit| *limit = limit.filter(|limit| limit.is_finite()));
    for pair in &level.copies.vertices {
        limits[pair.primary as usize] = None;
        limits[pair.secondary as usize] = None;
    }
    limits
}

enum KeptMesh {
    Triangles(Vec<[u32; 3]>),
    Segments(Vec<[u32; 2]>),
}

impl<'a> From<&'a KeptMesh> for Elements<'a> {
    fn from(mesh: &'a KeptMesh) -> Self {
        match mesh {
            KeptMesh::Triangles(triangles) => Self::Triangles(triangles),
            KeptMesh::Segments(segments) => Self::Segments(segments),
        }
    }
}

impl KeptElements {
    /// Those of a level, with edges closed that are shorter than the `lengths` of all grains there.
    fn new(
        tessellation: &Tessellation,
        grain_of_cell: &[GrainId],
        level: &Level,
        lengths: &[f64],
        points: &[DVec3],
    ) -> Self {
        let grain = |cell: CellId| CellId(grain_of_cell[cell.index()].0);
        let of_faces: Vec<[voronoi::Side; 2]> = tessellation
            .faces()
            .map(|face| {
                tessellation.face_sides(face).map(|side| match side {
                    voronoi::Side::Cell(cell) => voronoi::Side::Cell(grain(cell)),
                    voronoi::Side::Image(cell, shift) => voronoi::Side::Image(grain(cell), shift),
                    wall @ voronoi::Side::Wall(_) => wall,
                })
            })
            .collect();
        // A cell comes before what is moved and before walls: only two grains of one place may have to change places.
        let is_turned = |[first, second]: [voronoi::Side; 2]| second < first;
        let of_elements = (0u32..).zip(level.boundary_of.iter().map(|boundary| of_faces[boundary.index()]));
        let mut kept: Vec<(u32, [voronoi::Side; 2])> =
            of_elements.filter(|(_, [first, second])| first != second).collect();
        let sides: Vec<[voronoi::Side; 2]> = kept.iter().map(|(_, sides)| sorted(*sides)).collect();
        let mut mesh = match &level.mesh {
            Mesh::Triangles(mesh) => {
                let turn = |(element, sides): &(u32, _)| {
                    let [a, b, c] = mesh.triangles()[*element as usize];
                    if is_turned(*sides) { [a, c, b] } else { [a, b, c] }
                };
                let triangles: Vec<[u32; 3]> = kept.iter().map(turn).collect();
                let limits = limits(lengths, Elements::Triangles(&triangles), &sides, level, points.len());
                let left = coarsened(points, &limits, &triangles, &sides);
                let mut is_left = left.iter().map(Option::is_some);
                kept.retain(|_| is_left.next() == Some(true));
                KeptMesh::Triangles(left.into_iter().flatten().collect())
            }
            Mesh::Segments(mesh) => {
                let turn = |(element, sides): &(u32, _)| {
                    let [a, b] = mesh.segments()[*element as usize];
                    if is_turned(*sides) { [b, a] } else { [a, b] }
                };
                let segments: Vec<[u32; 2]> = kept.iter().map(turn).collect();
                let limits = limits(lengths, Elements::Segments(&segments), &sides, level, points.len());
                let left = coarsened_segments(points, &limits, &segments, &sides);
                let mut is_left = left.iter().map(Option::is_some);
                kept.retain(|_| is_left.next() == Some(true));
                KeptMesh::Segments(left.into_iter().flatten().collect())
            }
        };
        let mut elements = vec![None; level.boundary_of.len()];
        (0u32..).zip(&kept).for_each(|(number, (element, _))| elements[*element as usize] = Some(number));
        let mut is_used = vec![false; level.vertex_count()];
        mesh.corners_mut().for_each(|corner| is_used[*corner as usize] = true);
        let mut count = 0;
        let mut next = |is_used: bool| {
            is_used.then(|| {
                count += 1;
                count - 1
            })
        };
        let numbers: Vec<Option<u32>> = is_used.into_iter().map(&mut next).collect();
        mesh.corners_mut()
            .for_each(|corner| *corner = numbers[*corner as usize].expect("used points have numbers"));
        let sides = kept.into_iter().map(|(_, sides)| sorted(sides));
        Self { mesh, sides: sides.collect(), elements, numbers }
    }

    /// The copies among what is kept. Of a boundary that comes twice, the points and elements of the one of greater number are the copies.
    fn copies(&self, copies: &PeriodicCopies, boundary_of: &[BoundaryId]) -> PeriodicCopies {
        let renumbered = |pairs: &[PeriodicPair<u32>], numbers: &[Option<u32>]| {
            let kept = pairs.iter().filter_map(|pair| {
                let [secondary, primary] = [pair.secondary, pair.primary].map(|old| numbers[old as usize]);
                Some(PeriodicPair { secondary: secondary?, primary: primary?, shift: pair.shift })
            });
            kept.collect::<Vec<_>>()
        };
        let reversed = |pair: &mut PeriodicPair<u32>| {
            *pair = PeriodicPair {
                secondary: pair.primary,
                primary: pair.secondary,
                shift: Shift::NONE - pair.shift,
            };
        };
        let mut elements = renumbered(&copies.elements, &self.elements);
        for pair in &mut elements {
            if boundary_of[pair.secondary as usize] < boundary_of[pair.primary as usize] {
                reversed(pair);
            }
        }
        elements.sort_unstable_by_key(|pair| pair.secondary);
        // The boundary of points inside one.
        let mut only_boundary: Vec<Option<BoundaryId>> = vec![None; self.numbers.len()];
        let mut is_shared = vec![false; self.numbers.len()];
        for (element, boundary) in (0u32..).zip(boundary_of) {
            for corner in Elements::from(&self.mesh).corners(element) {
                let known = only_boundary[*corner as usize].get_or_insert(*boundary);
                is_shared[*corner as usize] |= known != boundary;
            }
        }
        let mut vertices = renumbered(&copies.vertices, &self.numbers);
        for pair in &mut vertices {
            let [secondary, primary] = [pair.secondary, pair.primary].map(|point| point as usize);
            let is_inside = !is_shared[secondary] && !is_shared[primary];
            if is_inside && only_boundary[secondary] < only_boundary[primary] {
                reversed(pair);
            }
        }
        vertices.sort_unstable_by_key(|pair| pair.secondary);
        PeriodicCopies { vertices, elements }
    }
}

impl KeptMesh {
    fn corners_mut(&mut self) -> Box<dyn Iterator<Item = &mut u32> + '_> {
        match self {
            Self::Triangles(triangles) => Box::new(triangles.iter_mut().flatten()),
            Self::Segments(segments) => Box::new(segments.iter_mut().flatten()),
        }
    }
}

/// Boundaries of elements with these sides, and the boundary of each element.
fn connected(sides: &[[voronoi::Side; 2]], seams: &Seams) -> (Vec<Boundary>, Vec<BoundaryId>) {
    let mut pieces = DisjointSets::new(sides.len());
    seams.inner.iter().for_each(|[a, b]| pieces.join(*a, *b));
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
        for (own, other, shift) in
            [(primary, secondary, pair.shift), (secondary, primary, Shift::NONE - pair.shift)]
        {
            let twin = Twin { boundary: other, shift };
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
        let mut places: Vec<(u32, Shift)> = (0..id(point_count)).map(|point| (point, Shift::NONE)).collect();
        for pair in &self.vertices {
            places[pair.secondary as usize] = (pair.primary, pair.shift);
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
            same[1..].iter().map(move |(_, secondary, shift)| PeriodicPair {
                secondary: *secondary,
                primary,
                shift: *shift - at,
            })
        });
        pairs.collect()
    }
}
