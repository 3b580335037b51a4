//! The triangulated network whose vertices are VirMat's control points: the vertices of the tessellation, the middles of
//! its triple lines, and the centres of its faces. In the plane: its vertices and the middles of its edges.

use glam::DVec3;
use subzero::{Crease, CurveMesh, Features, TriangleMesh};
use voronoi::{Dimension, Edges, FaceId, PeriodicPair, Shift, Tessellation};

use crate::periodic::PeriodicCopies;
use crate::{
    Boundary, BoundaryId, GrainId, Junctions, Level, Mesh, NetworkError, NodeType, Side, Twin, WallSet,
};

/// The connectivity of the control mesh, its points, and the boundaries: one for each face of the tessellation.
pub(crate) struct ControlMesh {
    pub(crate) level: Level,
    pub(crate) points: Vec<DVec3>,
    pub(crate) boundaries: Vec<Boundary>,
    pub(crate) junctions: JunctionCounts,
}

/// How many places there are where boundaries meet, on the domain's surface and inside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JunctionCounts {
    /// Lines where at least three sides (grains, or the exterior) meet; in the plane, such points.
    pub triple_lines: usize,
    /// Points where at least four sides meet.
    pub quadruple_points: usize,
}

impl ControlMesh {
    pub(crate) fn new(tessellation: &Tessellation, junctions: Junctions) -> Result<Self, NetworkError> {
        let mut boundaries: Vec<Boundary> =
            tessellation.faces().map(|face| boundary(tessellation.face_sides(face))).collect();
        for PeriodicPair { secondary, primary, shift } in tessellation.periodic_faces() {
            let twin = |face: &FaceId, shift| Some(Twin { boundary: BoundaryId(face.0), shift });
            boundaries[primary.index()].twin = twin(secondary, *shift);
            boundaries[secondary.index()].twin = twin(primary, Shift::NONE - *shift);
        }
        match tessellation.domain().dimension() {
            Dimension::Three => surfaces(tessellation, boundaries, junctions),
            Dimension::Two => lines(tessellation, boundaries),
        }
    }
}

fn boundary(sides: [voronoi::Side; 2]) -> Boundary {
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
    junctions: Junctions,
) -> Result<ControlMesh, NetworkError> {
    let edges = tessellation.edges();
    let vertex_count = tessellation.vertices().len();
    let middle = |edge: u32| id(vertex_count) + edge;
    let center = |face: FaceId| id(vertex_count + edges.ends.len()) + face.0;

    let mut points = tessellation.vertices().to_vec();
    points.extend(edges.ends.iter().map(|ends| {
        let [start, end] = ends.map(|vertex| tessellation.vertices()[vertex.index()]);
        start.midpoint(end)
    }));
    points.extend(tessellation.faces().map(|face| face_center(tessellation, face)));

    let mut triangles = Vec::with_capacity(2 * edges.of_corner.len());
    let mut boundary_of = Vec::with_capacity(triangles.capacity());
    // Of each triangle, the tessellation's edge that its first edge is half of.
    let mut line_of = Vec::with_capacity(triangles.capacity());
    let mut next_corner = edges.of_corner.iter();
    for face in tessellation.faces() {
        let corners = tessellation.face_corners(face);
        for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            let edge = *next_corner.next().expect("one edge for each corner");
            triangles.push([from.0, middle(edge), center(face)]);
            triangles.push([middle(edge), to.0, center(face)]);
            boundary_of.extend([BoundaryId(face.0); 2]);
            line_of.extend([edge; 2]);
        }
    }

    let creases: Vec<Crease> = (0u32..)
        .zip(&edges.ends)
        .flat_map(|(edge, ends)| ends.map(|end| Crease::infinite([end.0, middle(edge)])))
        .collect();
    let corner_count = match junctions {
        Junctions::Crease => vertex_count,
        Junctions::Corner => vertex_count + edges.ends.len(),
    };
    let corners: Vec<u32> = (0..id(corner_count)).collect();
    let features = Features { creases: &creases, corners: &corners, ..Features::default() };
    let mesh = TriangleMesh::new(points.len(), triangles, &features)?;

    let copies = PeriodicCopies::of_control_mesh(tessellation, &edges, middle, |face| center(FaceId(face)));
    let copied_lines = tessellation.periodic_edges(&edges);
    let (mut node_types, line_types) = junction_types(tessellation, &edges, &copied_lines);
    let counts = JunctionCounts {
        triple_lines: count_originals(&line_types, 3, copied_lines.iter().map(|pair| pair.secondary)),
        quadruple_points: count_originals(&node_types, 4, copied_vertices(tessellation)),
    };
    node_types.extend(&line_types);
    node_types.extend(boundaries.iter().map(NodeType::inside));
    let mut edge_node_types = vec![NodeType::INTERIOR; mesh.edge_count()];
    for (triangle, (boundary, line)) in (0u32..).zip(boundary_of.iter().zip(line_of)) {
        let [along_line, spoke, other_spoke] = mesh.triangle_edges(triangle).map(|edge| edge as usize);
        edge_node_types[along_line] = line_types[line as usize];
        edge_node_types[spoke] = NodeType::inside(&boundaries[boundary.index()]);
        edge_node_types[other_spoke] = edge_node_types[spoke];
    }

    let mut walls = walls_of_vertices(tessellation, &boundaries);
    walls.extend(
        edges.ends.iter().map(|[a, b]| walls[a.index()].intersection(walls[b.index()])).collect::<Vec<_>>(),
    );
    walls.extend(boundaries.iter().map(walls_inside));
    let generations = vec![0; points.len()];
    let level = Level {
        mesh: Mesh::Triangles(mesh),
        boundary_of,
        node_types,
        generations,
        walls,
        copies,
        edge_node_types,
    };
    Ok(ControlMesh { level, points, boundaries, junctions: counts })
}

fn lines(tessellation: &Tessellation, boundaries: Vec<Boundary>) -> Result<ControlMesh, NetworkError> {
    let vertex_count = tessellation.vertices().len();
    let mut points = tessellation.vertices().to_vec();
    let mut segments = Vec::with_capacity(2 * tessellation.face_count());
    let mut boundary_of = Vec::with_capacity(segments.capacity());
    let mut meetings = Meetings::new(vertex_count, tessellation.periodic_vertices().iter().map(vertex_pair));
    for face in tessellation.faces() {
        let ends = tessellation.face_corners(face);
        let middle = id(points.len());
        points.push(points[ends[0].index()].midpoint(points[ends[1].index()]));
        segments.extend([[ends[0].0, middle], [middle, ends[1].0]]);
        boundary_of.extend([BoundaryId(face.0); 2]);
        for end in ends {
            meetings.note(end.index(), tessellation.face_sides(face));
        }
    }
    let mut walls = walls_of_vertices(tessellation, &boundaries);
    walls.extend(boundaries.iter().map(walls_inside));
    let corners: Vec<u32> = (0..id(vertex_count)).collect();
    let mut node_types = meetings.types();
    let at_least = |count| count_originals(&node_types, count, copied_vertices(tessellation));
    let counts = JunctionCounts { triple_lines: at_least(3), quadruple_points: at_least(4) };
    node_types.extend(boundaries.iter().map(NodeType::inside));
    let mesh = Mesh::Segments(CurveMesh::new(points.len(), segments, &corners)?);
    let generations = vec![0; points.len()];
    let copies = PeriodicCopies::of_control_lines(tessellation);
    let level =
        Level { mesh, boundary_of, node_types, generations, walls, copies, edge_node_types: Vec::new() };
    Ok(ControlMesh { level, points, boundaries, junctions: counts })
}

/// The centroid of a face's outline: inside the face, and well defined for the thinnest of slivers.
fn face_center(tessellation: &Tessellation, face: FaceId) -> DVec3 {
    let corners = tessellation.face_corners(face);
    let at = |k: usize| tessellation.vertices()[corners[k % corners.len()].index()];
    let origin = at(0);
    let (mut weighted, mut perimeter) = (DVec3::ZERO, 0.0);
    for k in 0..corners.len() {
        let length = at(k).distance(at(k + 1));
        weighted += (at(k).midpoint(at(k + 1)) - origin) * length;
        perimeter += length;
    }
    origin + weighted / perimeter
}

/// The types of the tessellation's vertices and of the points inside its edges.
fn junction_types(
    tessellation: &Tessellation,
    edges: &Edges,
    copied_lines: &[PeriodicPair<u32>],
) -> (Vec<NodeType>, Vec<NodeType>) {
    let vertices = tessellation.periodic_vertices().iter().map(vertex_pair);
    let mut at_vertices = Meetings::new(tessellation.vertices().len(), vertices);
    let mut at_edges = Meetings::new(edges.ends.len(), copied_lines.iter().copied());
    let mut next_corner = edges.of_corner.iter();
    for face in tessellation.faces() {
        let sides = tessellation.face_sides(face);
        for (corner, edge) in tessellation.face_corners(face).iter().zip(&mut next_corner) {
            at_vertices.note(corner.index(), sides);
            at_edges.note(*edge as usize, sides);
        }
    }
    (at_vertices.types(), at_edges.types())
}

fn vertex_pair(pair: &PeriodicPair<voronoi::VertexId>) -> PeriodicPair<u32> {
    PeriodicPair { secondary: pair.secondary.0, primary: pair.primary.0, shift: pair.shift }
}

/// How many places, periodic copies left out, have so many sides.
fn count_originals(types: &[NodeType], side_count: i8, copies: impl Iterator<Item = u32>) -> usize {
    let has_enough = |node_type: &NodeType| node_type.side_count() >= side_count;
    let all = types.iter().filter(|node_type| has_enough(node_type)).count();
    all - copies.filter(|copy| has_enough(&types[*copy as usize])).count()
}

fn copied_vertices(tessellation: &Tessellation) -> impl Iterator<Item = u32> {
    tessellation.periodic_vertices().iter().map(|pair| pair.secondary.0)
}

/// The sides that meet at places: cells, each in the place where it is seen from an original, or the exterior.
struct Meetings {
    /// Of each place, its original and the shift from there.
    originals: Vec<(usize, Shift)>,
    /// Originals and sides that touch them, with repeats.
    sides: Vec<(usize, Side, Shift)>,
    is_outer: Vec<bool>,
}

impl Meetings {
    fn new(count: usize, copies: impl Iterator<Item = PeriodicPair<u32>>) -> Self {
        let mut originals: Vec<(usize, Shift)> = (0..count).map(|place| (place, Shift::NONE)).collect();
        for pair in copies {
            originals[pair.secondary as usize] = (pair.primary as usize, pair.shift);
        }
        Self { originals, sides: Vec::new(), is_outer: vec![false; count] }
    }

    /// Notes that a face with these sides touches a place.
    fn note(&mut self, place: usize, sides: [voronoi::Side; 2]) {
        let (original, shift) = self.originals[place];
        for side in sides {
            let (side, moved, is_outside) = match side {
                voronoi::Side::Cell(cell) => (Side::Grain(GrainId(cell.0)), Shift::NONE - shift, false),
                voronoi::Side::Image(cell, image) => (Side::Grain(GrainId(cell.0)), image - shift, true),
                voronoi::Side::Wall(_) => (Side::Exterior, Shift::NONE, true),
            };
            self.sides.push((original, side, moved));
            self.is_outer[place] |= is_outside;
        }
    }

    fn types(mut self) -> Vec<NodeType> {
        self.sides.sort_unstable();
        self.sides.dedup();
        let mut side_counts = vec![0; self.originals.len()];
        for (original, ..) in &self.sides {
            side_counts[*original] += 1;
        }
        let places = self.originals.iter().zip(&self.is_outer);
        places.map(|((original, _), is_outer)| NodeType::new(side_counts[*original], *is_outer)).collect()
    }
}

fn walls_inside(boundary: &Boundary) -> WallSet {
    boundary.wall.map_or(WallSet::NONE, |wall| WallSet::NONE.with(wall))
}

fn walls_of_vertices(tessellation: &Tessellation, boundaries: &[Boundary]) -> Vec<WallSet> {
    let mut walls = vec![WallSet::NONE; tessellation.vertices().len()];
    for (face, boundary) in tessellation.faces().zip(boundaries) {
        if let Some(wall) = boundary.wall {
            for corner in tessellation.face_corners(face) {
                walls[corner.index()] = walls[corner.index()].with(wall);
            }
        }
    }
    walls
}

/// Control points are far fewer than 2^32: [`crate::Network::new`] has checked the number of their triangles.
fn id(index: usize) -> u32 {
    u32::try_from(index).expect("the control mesh was checked to fit 32-bit ids")
}
