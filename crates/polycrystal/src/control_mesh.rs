//! The triangulated network whose vertices are VirMat's control points: the vertices of the tessellation, the middles of
//! its triple lines, and the centres of its faces. In the plane: its vertices and the middles of its edges.

use glam::DVec3;
use subzero::{Crease, CurveMesh, Features, TriangleMesh};
use voronoi::{Dimension, Edges, FaceId, Tessellation};

use crate::{Boundary, BoundaryId, GrainId, Junctions, Level, Mesh, NetworkError, NodeType, Side, WallSet};

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
        let boundaries: Vec<Boundary> =
            tessellation.faces().map(|face| boundary(tessellation.face_sides(face))).collect();
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
    Boundary { sides, wall }
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

    let (mut node_types, line_types) = junction_types(tessellation, &edges);
    let counts = JunctionCounts {
        triple_lines: line_types.iter().filter(|line| line.side_count() >= 3).count(),
        quadruple_points: node_types.iter().filter(|point| point.side_count() >= 4).count(),
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
    let level =
        Level { mesh: Mesh::Triangles(mesh), boundary_of, node_types, generations, walls, edge_node_types };
    Ok(ControlMesh { level, points, boundaries, junctions: counts })
}

fn lines(tessellation: &Tessellation, boundaries: Vec<Boundary>) -> Result<ControlMesh, NetworkError> {
    let vertex_count = tessellation.vertices().len();
    let mut points = tessellation.vertices().to_vec();
    let mut segments = Vec::with_capacity(2 * tessellation.face_count());
    let mut boundary_of = Vec::with_capacity(segments.capacity());
    let mut sides_at: Vec<(usize, Side)> = Vec::with_capacity(4 * tessellation.face_count());
    for (face, boundary) in tessellation.faces().zip(&boundaries) {
        let ends = tessellation.face_corners(face);
        let middle = id(points.len());
        points.push(points[ends[0].index()].midpoint(points[ends[1].index()]));
        segments.extend([[ends[0].0, middle], [middle, ends[1].0]]);
        boundary_of.extend([BoundaryId(face.0); 2]);
        sides_at.extend(ends.iter().flat_map(|end| boundary.sides.map(|side| (end.index(), side))));
    }
    let mut walls = walls_of_vertices(tessellation, &boundaries);
    walls.extend(boundaries.iter().map(walls_inside));
    let corners: Vec<u32> = (0..id(vertex_count)).collect();
    let mut node_types = types_by_place(vertex_count, sides_at);
    let at_least = |count| node_types.iter().filter(|point| point.side_count() >= count).count();
    let counts = JunctionCounts { triple_lines: at_least(3), quadruple_points: at_least(4) };
    node_types.extend(boundaries.iter().map(NodeType::inside));
    let mesh = Mesh::Segments(CurveMesh::new(points.len(), segments, &corners)?);
    let generations = vec![0; points.len()];
    let level = Level { mesh, boundary_of, node_types, generations, walls, edge_node_types: Vec::new() };
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
fn junction_types(tessellation: &Tessellation, edges: &Edges) -> (Vec<NodeType>, Vec<NodeType>) {
    let (mut at_vertices, mut at_edges) = (Vec::new(), Vec::new());
    let mut next_corner = edges.of_corner.iter();
    for face in tessellation.faces() {
        let sides = boundary(tessellation.face_sides(face)).sides;
        for (corner, edge) in tessellation.face_corners(face).iter().zip(&mut next_corner) {
            at_vertices.extend(sides.map(|side| (corner.index(), side)));
            at_edges.extend(sides.map(|side| (*edge as usize, side)));
        }
    }
    let vertices = types_by_place(tessellation.vertices().len(), at_vertices);
    (vertices, types_by_place(edges.ends.len(), at_edges))
}

/// Node types from pairs of a place and a side that touches it.
fn types_by_place(count: usize, mut sides_at: Vec<(usize, Side)>) -> Vec<NodeType> {
    sides_at.sort_unstable();
    sides_at.dedup();
    let mut types = vec![NodeType::INTERIOR; count];
    for at_place in sides_at.chunk_by(|left, right| left.0 == right.0) {
        let sides: Vec<Side> = at_place.iter().map(|(_, side)| *side).collect();
        types[at_place[0].0] = NodeType::of_sides(&sides);
    }
    types
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
