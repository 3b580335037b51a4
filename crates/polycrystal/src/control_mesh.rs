//! The triangulated network whose vertices are the control points: the vertices of the tessellation, points on its triple
//! lines, and points inside its faces. In the plane: its vertices and points on its edges.

use glam::DVec3;
use subzero::{Crease, CurveMesh, Features, TriangleMesh};
use voronoi::{Dimension, Edges, Tessellation};

use crate::face_mesh::{LinePoints, id, triangulate_faces};
use crate::{
    Boundary, BoundaryId, FaceMesh, GrainId, Junctions, Level, Mesh, NetworkError, NodeType, Side, WallSet,
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
    pub(crate) fn new(
        tessellation: &Tessellation,
        face_mesh: FaceMesh,
        junctions: Junctions,
    ) -> Result<Self, NetworkError> {
        let boundaries: Vec<Boundary> =
            tessellation.faces().map(|face| boundary(tessellation.face_sides(face))).collect();
        match tessellation.domain().dimension() {
            Dimension::Three => surfaces(tessellation, boundaries, face_mesh, junctions),
            Dimension::Two => lines(tessellation, boundaries, face_mesh),
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
    face_mesh: FaceMesh,
    junctions: Junctions,
) -> Result<ControlMesh, NetworkError> {
    let edges = tessellation.edges();
    let vertex_count = tessellation.vertices().len();
    let lines = LinePoints::new(tessellation, &edges.ends, face_mesh);
    let mut points = tessellation.vertices().to_vec();
    points.extend(&lines.positions);
    let corner_count = match junctions {
        Junctions::Crease => vertex_count,
        Junctions::Corner => points.len(),
    };

    let (mut node_types, line_types) = junction_types(tessellation, &edges);
    let counts = JunctionCounts {
        triple_lines: line_types.iter().filter(|line| line.side_count() >= 3).count(),
        quadruple_points: node_types.iter().filter(|point| point.side_count() >= 4).count(),
    };
    node_types.extend(lines.lines().map(|line| line_types[line]));
    let mut walls = walls_of_vertices(tessellation, &boundaries);
    let walls_of_line = |line: usize| {
        let [start, end] = edges.ends[line];
        walls[start.index()].intersection(walls[end.index()])
    };
    let on_lines: Vec<WallSet> = lines.lines().map(walls_of_line).collect();
    walls.extend(on_lines);

    let faces = triangulate_faces(tessellation, &edges, &lines, &points, face_mesh);
    let (mut triangles, mut boundary_of, mut triangle_edge_types) = (Vec::new(), Vec::new(), Vec::new());
    for ((face, boundary), mesh) in (0u32..).zip(&boundaries).zip(faces) {
        let outline_count = id(mesh.outline.len());
        let first_inner = id(points.len());
        let inside = NodeType::inside(boundary);
        let number = |place: u32| match place.checked_sub(outline_count) {
            None => mesh.outline[place as usize],
            Some(inner) => first_inner + inner,
        };
        // Neighbours on the outline are joined by nothing but the line that they lie on.
        let edge_type = |[from, to]: [u32; 2]| {
            let is_on_line = from < outline_count && to == (from + 1) % outline_count;
            if is_on_line { line_types[mesh.lines[from as usize] as usize] } else { inside }
        };
        for &[a, b, c] in &mesh.triangles {
            triangles.push([a, b, c].map(number));
            triangle_edge_types.push([[a, b], [b, c], [c, a]].map(edge_type));
            boundary_of.push(BoundaryId(face));
        }
        let inner_count = mesh.inner_points.len();
        points.extend(mesh.inner_points);
        node_types.resize(node_types.len() + inner_count, inside);
        walls.resize(walls.len() + inner_count, walls_inside(boundary));
    }
    // Dividing lines and faces may miss a wall by a last place.
    let domain = tessellation.domain();
    points.iter_mut().zip(&walls).for_each(|(point, walls)| *point = walls.put_on_walls(domain, *point));

    let creases: Vec<Crease> = (0u32..)
        .zip(&edges.ends)
        .flat_map(|(line, ends)| {
            let along = lines.whole_line(line, *ends);
            along.windows(2).map(|ends| Crease::infinite([ends[0], ends[1]])).collect::<Vec<_>>()
        })
        .collect();
    let corners: Vec<u32> = (0..id(corner_count)).collect();
    let features = Features { creases: &creases, corners: &corners, ..Features::default() };
    let mesh = TriangleMesh::new(points.len(), triangles, &features)?;
    let mut edge_node_types = vec![NodeType::INTERIOR; mesh.edge_count()];
    for (triangle, types) in (0u32..).zip(triangle_edge_types) {
        for (edge, edge_type) in mesh.triangle_edges(triangle).into_iter().zip(types) {
            edge_node_types[edge as usize] = edge_type;
        }
    }
    let generations = vec![0; points.len()];
    let level =
        Level { mesh: Mesh::Triangles(mesh), boundary_of, node_types, generations, walls, edge_node_types };
    Ok(ControlMesh { level, points, boundaries, junctions: counts })
}

fn lines(
    tessellation: &Tessellation,
    boundaries: Vec<Boundary>,
    face_mesh: FaceMesh,
) -> Result<ControlMesh, NetworkError> {
    let vertex_count = tessellation.vertices().len();
    let mut points = tessellation.vertices().to_vec();
    let (mut segments, mut boundary_of) = (Vec::new(), Vec::new());
    let mut sides_at: Vec<(usize, Side)> = Vec::with_capacity(4 * tessellation.face_count());
    let mut walls = walls_of_vertices(tessellation, &boundaries);
    let mut types_inside = Vec::new();
    for (face, boundary) in tessellation.faces().zip(&boundaries) {
        let &[start, end] = tessellation.face_corners(face) else { unreachable!("an edge has two ends") };
        let inner = face_mesh.divide([start, end].map(|end| points[end.index()]));
        let mut last = start.0;
        for point in inner {
            let next = id(points.len());
            segments.push([last, next]);
            points.push(walls_inside(boundary).put_on_walls(tessellation.domain(), point));
            walls.push(walls_inside(boundary));
            types_inside.push(NodeType::inside(boundary));
            last = next;
        }
        segments.push([last, end.0]);
        boundary_of.resize(segments.len(), BoundaryId(face.0));
        sides_at.extend([start, end].iter().flat_map(|end| boundary.sides.map(|side| (end.index(), side))));
    }
    let corners: Vec<u32> = (0..id(vertex_count)).collect();
    let mut node_types = types_by_place(vertex_count, sides_at);
    let at_least = |count| node_types.iter().filter(|point| point.side_count() >= count).count();
    let counts = JunctionCounts { triple_lines: at_least(3), quadruple_points: at_least(4) };
    node_types.extend(types_inside);
    let mesh = Mesh::Segments(CurveMesh::new(points.len(), segments, &corners)?);
    let generations = vec![0; points.len()];
    let level = Level { mesh, boundary_of, node_types, generations, walls, edge_node_types: Vec::new() };
    Ok(ControlMesh { level, points, boundaries, junctions: counts })
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
