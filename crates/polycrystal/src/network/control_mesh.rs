//! The triangulated network whose vertices are the control points: the vertices of the tessellation, points on its triple
//! lines, and points inside its faces. In the plane: its vertices and points on its edges.

use std::collections::BTreeMap;

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;
use subzero::{Crease, CurveMesh, Features, TriangleMesh};
use voronoi::{Dimension, Edges, FaceId, PeriodicPair, Tessellation, Translation};

use crate::mesh::id::id;
use crate::mesh::node_type::Meeting;
use crate::mesh::periodic::PeriodicCopies;
use crate::network::face_mesh::{FaceTriangles, LinePoints, triangulate_faces};
use crate::{
    Boundary, BoundaryId, FaceMesh, GrainId, Junctions, Level, Mesh, NetworkError, Side, Twin, WallSet,
    WallSets,
};

/// The connectivity of the control mesh, its points, and the boundaries: one for each face of the tessellation.
pub(crate) struct ControlMesh {
    pub(crate) level: Level,
    pub(crate) points: Vec<DVec3>,
    pub(crate) boundaries: Vec<Boundary>,
    pub(crate) wall_sets: WallSets,
    pub(crate) junctions: JunctionCounts,
}

/// How many places there are where boundaries meet, on the domain's surface and inside. The exterior is one side, and a grain
/// a period away another one than the grain itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JunctionCounts {
    /// Lines where at least three sides (grains, or the exterior) meet; in the plane, such points.
    pub triple_lines: usize,
    /// Points where at least four sides meet.
    pub quadruple_points: usize,
    /// The triple lines by the number of sides, which is that of the boundaries that meet there; 255 stands for that many and
    /// more.
    pub lines_by_sides: BTreeMap<u8, usize>,
    /// The same of the quadruple points.
    pub points_by_sides: BTreeMap<u8, usize>,
}

impl JunctionCounts {
    /// The junctions among lines and points where so many sides meet.
    pub(crate) fn new(lines: impl Iterator<Item = u8>, points: impl Iterator<Item = u8>) -> Self {
        let lines_by_sides = by_sides(lines.filter(|sides| *sides >= 3));
        let points_by_sides = by_sides(points.filter(|sides| *sides >= 4));
        Self {
            triple_lines: lines_by_sides.values().sum(),
            quadruple_points: points_by_sides.values().sum(),
            lines_by_sides,
            points_by_sides,
        }
    }
}

fn by_sides(places: impl Iterator<Item = u8>) -> BTreeMap<u8, usize> {
    let mut counts = BTreeMap::new();
    places.for_each(|sides| *counts.entry(sides).or_default() += 1);
    counts
}

impl ControlMesh {
    pub(crate) fn new(
        tessellation: &Tessellation,
        face_mesh: FaceMesh,
        junctions: Junctions,
    ) -> Result<Self, NetworkError> {
        let boundaries = boundaries(tessellation);
        match tessellation.domain().dimension() {
            Dimension::Three => surfaces(tessellation, boundaries, face_mesh, junctions, None),
            Dimension::Two => lines(tessellation, boundaries, |lines, copies| {
                LinePoints::new(tessellation, lines, copies, face_mesh)
            }),
        }
    }

    /// That of cells in the plane whose edges are divided into so many equal parts.
    pub(crate) fn of_divided_lines(
        tessellation: &Tessellation,
        counts: &[u32],
    ) -> Result<ControlMesh, NetworkError> {
        let divided = |ends: &[_], _: &[_]| LinePoints::of_counts(tessellation, ends, counts);
        lines(tessellation, boundaries(tessellation), divided)
    }

    /// That of cells in space whose lines are curved: each goes through one point, its middle. Boundaries are filled by fans with as
    /// many centres as their outline takes; `centers` are places from which all of it is seen.
    pub(crate) fn of_curved_lines(
        tessellation: &Tessellation,
        middles: &[DVec3],
        centers: &[DVec3],
        junctions: Junctions,
    ) -> Result<ControlMesh, NetworkError> {
        let boundaries = boundaries(tessellation);
        surfaces(tessellation, boundaries, FaceMesh::SparseFan, junctions, Some([middles, centers]))
    }
}

fn boundaries(tessellation: &Tessellation) -> Vec<Boundary> {
    let mut boundaries: Vec<Boundary> =
        tessellation.faces().map(|face| boundary(tessellation.face_sides(face))).collect();
    for PeriodicPair { secondary, primary, translation } in tessellation.periodic_faces() {
        let twin = |face: &FaceId, translation| Some(Twin { boundary: BoundaryId(face.0), translation });
        boundaries[primary.index()].twin = twin(secondary, *translation);
        boundaries[secondary.index()].twin = twin(primary, Translation::ZERO - *translation);
    }
    boundaries
}

pub(crate) fn boundary(sides: [voronoi::Side; 2]) -> Boundary {
    let wall = match sides[1] {
        voronoi::Side::Wall(wall) => Some(wall),
        voronoi::Side::Cell(_) | voronoi::Side::Image(..) => None,
    };
    let sides = sides.map(|side| match side {
        voronoi::Side::Cell(cell) => Side::Grain(GrainId(cell.0)),
        voronoi::Side::Image(..) | voronoi::Side::Wall(_) => Side::Exterior,
    });
    Boundary { sides, wall, twin: None }
}

fn surfaces(
    tessellation: &Tessellation,
    boundaries: Vec<Boundary>,
    face_mesh: FaceMesh,
    junctions: Junctions,
    curved: Option<[&[DVec3]; 2]>,
) -> Result<ControlMesh, NetworkError> {
    let edges = tessellation.edges();
    let vertex_count = tessellation.vertices().len();
    let copied_lines = tessellation.periodic_edges(&edges);
    let line_mesh = if curved.is_some() { FaceMesh::Fan } else { face_mesh };
    let mut lines = LinePoints::new(tessellation, &edges.ends, &copied_lines, line_mesh);
    if let Some([middles, _]) = curved {
        lines.positions.copy_from_slice(middles);
    }
    let mut points = tessellation.vertices().to_vec();
    points.extend(&lines.positions);
    let corner_count = match junctions {
        Junctions::Crease => vertex_count,
        Junctions::Corner => points.len(),
    };

    let along_lines = || {
        let (mut meetings, at_lines) = junctions_of(tessellation, &edges, &copied_lines);
        let counts = JunctionCounts::new(
            originals(&at_lines, copied_lines.iter().map(|pair| pair.secondary)),
            originals(&meetings, copied_vertices(tessellation)),
        );
        meetings.extend(lines.lines().map(|line| at_lines[line]));
        let ends = edges.ends.iter().map(|ends| ends.map(voronoi::VertexId::index));
        let (wall_sets, mut walls) = WallSets::new(tessellation, &boundaries, ends);
        let walls_of_line = |line: usize| {
            let [start, end] = edges.ends[line];
            wall_sets.intersection(walls[start.index()], walls[end.index()])
        };
        let on_lines: Vec<WallSet> = lines.lines().map(walls_of_line).collect();
        walls.extend(on_lines);
        let creases = (0u32..).zip(&edges.ends).flat_map(|(line, ends)| {
            let along = lines.whole_line(line, *ends);
            along.windows(2).map(|ends| Crease::infinite([ends[0], ends[1]])).collect::<Vec<_>>()
        });
        (meetings, at_lines, counts, wall_sets, walls, creases.collect::<Vec<_>>())
    };
    let centers = curved.map(|[_, centers]| centers);
    let fill_faces = || triangulate_faces(tessellation, &edges, &lines, &points, face_mesh, centers);
    // What lines are takes one thread.
    let ((mut meetings, at_lines, counts, wall_sets, mut walls, creases), faces) =
        rayon::join(along_lines, fill_faces);
    let mut copies = PeriodicCopies::of_vertices(tessellation);
    copies.vertices.extend(lines.copies(tessellation, &edges.ends, &copied_lines));
    let of_faces: Vec<[usize; 2]> =
        faces.iter().map(|face| [face.triangles.len(), face.inner_points.len()]).collect();
    copies.add_faces(tessellation.periodic_faces(), &of_faces, points.len());
    let mut first_inner = Vec::with_capacity(faces.len());
    for (boundary, mesh) in boundaries.iter().zip(&faces) {
        first_inner.push(id(points.len()));
        points.extend(&mesh.inner_points);
        meetings.resize(points.len(), Meeting::inside(boundary));
        walls.resize(points.len(), wall_sets.only(boundary.wall));
    }
    let of_face = |((mesh, boundary), first_inner): ((&FaceTriangles, &Boundary), &u32)| {
        check_cancelled();
        let outline_count = id(mesh.outline.len());
        let inside = Meeting::inside(boundary);
        let number = |place: u32| match place.checked_sub(outline_count) {
            None => mesh.outline[place as usize],
            Some(inner) => first_inner + inner,
        };
        // Neighbours on the outline are joined by nothing but the line that they lie on.
        let at_edge = |[from, to]: [u32; 2]| {
            let is_on_line = from < outline_count && to == (from + 1) % outline_count;
            if is_on_line { at_lines[mesh.lines[from as usize] as usize] } else { inside }
        };
        let triangles = mesh.triangles.iter();
        triangles
            .map(|&[a, b, c]| ([a, b, c].map(number), [[a, b], [b, c], [c, a]].map(at_edge)))
            .collect::<Vec<_>>()
    };
    let meshes = faces.par_iter().zip(&boundaries).zip(&first_inner);
    let (triangles, at_triangle_edges): (Vec<_>, Vec<_>) = meshes.flat_map_iter(of_face).unzip();
    let counted = (0u32..).map(BoundaryId).zip(&faces);
    let boundary_of =
        counted.flat_map(|(face, mesh)| std::iter::repeat_n(face, mesh.triangles.len())).collect();
    // Dividing lines and faces may miss a wall by a last place.
    points.iter_mut().zip(&walls).for_each(|(point, walls)| *point = wall_sets.put_on_walls(*walls, *point));

    let corners: Vec<u32> = (0..id(corner_count)).collect();
    let features = Features { creases: &creases, corners: &corners, ..Features::default() };
    check_cancelled();
    let mesh = TriangleMesh::new(points.len(), triangles, &features)?;
    check_cancelled();
    let mut at_edges = vec![Meeting::new(2, 2, false); mesh.edge_count()];
    for (triangle, of_triangle) in (0u32..).zip(at_triangle_edges) {
        for (edge, at_edge) in mesh.triangle_edges(subzero::FaceId(triangle)).into_iter().zip(of_triangle) {
            at_edges[edge.index()] = at_edge;
        }
    }
    let generations = vec![0; points.len()];
    let level = Level {
        mesh: Mesh::Triangles(mesh),
        boundary_of,
        node_types: meetings.iter().map(|at| at.node_type).collect(),
        grain_counts: meetings.iter().map(|at| at.grains).collect(),
        generations,
        walls,
        copies,
        at_edges,
    };
    Ok(ControlMesh { level, points, boundaries, wall_sets, junctions: counts })
}

fn lines(
    tessellation: &Tessellation,
    boundaries: Vec<Boundary>,
    divide: impl FnOnce(&[[voronoi::VertexId; 2]], &[PeriodicPair<u32>]) -> LinePoints,
) -> Result<ControlMesh, NetworkError> {
    let vertex_count = tessellation.vertices().len();
    let ends: Vec<[voronoi::VertexId; 2]> = tessellation
        .faces()
        .map(|face| tessellation.face_corners(face).try_into().expect("an edge has two ends"))
        .collect();
    let copied_lines: Vec<PeriodicPair<u32>> = tessellation
        .periodic_faces()
        .iter()
        .map(|pair| PeriodicPair {
            secondary: pair.secondary.0,
            primary: pair.primary.0,
            translation: pair.translation,
        })
        .collect();
    let lines = divide(&ends, &copied_lines);
    let mut points = tessellation.vertices().to_vec();
    points.extend(&lines.positions);
    let (mut segments, mut boundary_of) = (Vec::new(), Vec::new());
    let mut first_segments = vec![0];
    let mut vertices = Meetings::new(vertex_count, tessellation.periodic_vertices().iter().map(vertex_pair));
    for (face, ends) in tessellation.faces().zip(&ends) {
        check_cancelled();
        segments.extend(lines.whole_line(face.0, *ends).windows(2).map(|ends| [ends[0], ends[1]]));
        boundary_of.resize(segments.len(), BoundaryId(face.0));
        first_segments.push(id(segments.len()));
        for end in ends {
            vertices.note(end.index(), tessellation.face_sides(face));
        }
    }
    let (wall_sets, mut walls) = WallSets::new(tessellation, &boundaries, std::iter::empty());
    walls.extend(lines.lines().map(|line| wall_sets.only(boundaries[line].wall)));
    points.iter_mut().zip(&walls).for_each(|(point, walls)| *point = wall_sets.put_on_walls(*walls, *point));
    let corners: Vec<u32> = (0..id(vertex_count)).collect();
    let mut meetings = vertices.all();
    let at_points = || originals(&meetings, copied_vertices(tessellation));
    let counts = JunctionCounts::new(at_points(), at_points());
    meetings.extend(lines.lines().map(|line| Meeting::inside(&boundaries[line])));
    let mesh = Mesh::Segments(CurveMesh::new(points.len(), segments, &corners)?);
    let generations = vec![0; points.len()];
    let mut copies = PeriodicCopies::of_vertices(tessellation);
    copies.vertices.extend(lines.copies(tessellation, &ends, &copied_lines));
    copies.add_lines(&copied_lines, &first_segments);
    let level = Level {
        mesh,
        boundary_of,
        node_types: meetings.iter().map(|at| at.node_type).collect(),
        grain_counts: meetings.iter().map(|at| at.grains).collect(),
        generations,
        walls,
        copies,
        at_edges: Vec::new(),
    };
    Ok(ControlMesh { level, points, boundaries, wall_sets, junctions: counts })
}

/// What meets at the tessellation's vertices, and along its edges.
fn junctions_of(
    tessellation: &Tessellation,
    edges: &Edges,
    copied_lines: &[PeriodicPair<u32>],
) -> (Vec<Meeting>, Vec<Meeting>) {
    let vertices = tessellation.periodic_vertices().iter().map(vertex_pair);
    let mut at_vertices = Meetings::new(tessellation.vertices().len(), vertices);
    let mut at_edges = Meetings::new(edges.ends.len(), copied_lines.iter().copied());
    let mut next_corner = edges.of_corner.iter();
    for face in tessellation.faces() {
        check_cancelled();
        let sides = tessellation.face_sides(face);
        for (corner, edge) in tessellation.face_corners(face).iter().zip(&mut next_corner) {
            at_vertices.note(corner.index(), sides);
            at_edges.note(*edge as usize, sides);
        }
    }
    (at_vertices.all(), at_edges.all())
}

fn vertex_pair(pair: &PeriodicPair<voronoi::VertexId>) -> PeriodicPair<u32> {
    PeriodicPair { secondary: pair.secondary.0, primary: pair.primary.0, translation: pair.translation }
}

/// The number of sides at each place, periodic copies left out.
pub(crate) fn originals(meetings: &[Meeting], copies: impl Iterator<Item = u32>) -> impl Iterator<Item = u8> {
    let mut is_copy = vec![false; meetings.len()];
    copies.for_each(|copy| is_copy[copy as usize] = true);
    meetings.iter().zip(is_copy).filter(|(_, is_copy)| !is_copy).map(|(at, _)| at.sides)
}

fn copied_vertices(tessellation: &Tessellation) -> impl Iterator<Item = u32> {
    tessellation.periodic_vertices().iter().map(|pair| pair.secondary.0)
}

/// The sides that meet at places: cells, each in the place where it is seen from an original, or the exterior.
pub(crate) struct Meetings {
    /// Of each place, its original and the translation from there.
    originals: Vec<(usize, Translation)>,
    /// Originals and sides that touch them, with repeats.
    sides: Vec<(usize, Side, Translation)>,
    is_outer: Vec<bool>,
}

impl Meetings {
    pub(crate) fn new(count: usize, copies: impl Iterator<Item = PeriodicPair<u32>>) -> Self {
        let mut originals: Vec<(usize, Translation)> =
            (0..count).map(|place| (place, Translation::ZERO)).collect();
        for pair in copies {
            originals[pair.secondary as usize] = (pair.primary as usize, pair.translation);
        }
        Self { originals, sides: Vec::new(), is_outer: vec![false; count] }
    }

    /// Notes that a face with these sides touches a place.
    pub(crate) fn note(&mut self, place: usize, sides: [voronoi::Side; 2]) {
        let (original, translation) = self.originals[place];
        for side in sides {
            let (side, moved, is_outside) = match side {
                voronoi::Side::Cell(cell) => {
                    (Side::Grain(GrainId(cell.0)), Translation::ZERO - translation, false)
                }
                voronoi::Side::Image(cell, image) => {
                    (Side::Grain(GrainId(cell.0)), image - translation, true)
                }
                voronoi::Side::Wall(_) => (Side::Exterior, Translation::ZERO, true),
            };
            self.sides.push((original, side, moved));
            self.is_outer[place] |= is_outside;
        }
    }

    /// What meets at every place.
    pub(crate) fn all(mut self) -> Vec<Meeting> {
        self.sides.par_sort_unstable();
        self.sides.dedup();
        let mut counts = vec![[0, 0]; self.originals.len()];
        for (original, side, _) in &self.sides {
            let [sides, grains] = &mut counts[*original];
            *sides += 1;
            *grains += usize::from(side.grain().is_some());
        }
        let places = self.originals.iter().zip(&self.is_outer);
        let meeting = |((original, _), is_outer): (&(usize, Translation), &bool)| {
            let [sides, grains] = counts[*original];
            Meeting::new(sides, grains, *is_outer)
        };
        places.map(meeting).collect()
    }
}
