//! How the control mesh divides triple lines and boundaries.

use glam::DVec3;
use rayon::prelude::*;
use voronoi::{Dimension, Edges, FaceId, Tessellation, VertexId, triangulate_polygon};

/// Fewest segments of a triple line: one middle, so that every line can curve.
const FEWEST_SEGMENTS: u32 = 2;

/// Triangles of a refined boundary, in units of equilateral triangles of the edge length; about 2 is usual.
const REFINED_TRIANGLES: f64 = 3.0;

/// The control points of a boundary, beside the vertices at its corners.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum FaceMesh {
    /// The middles of its triple lines, and a fan of triangles from its centre: VirMat's control points.
    #[default]
    Fan,
    /// The middles of its triple lines alone; no point inside (constrained Delaunay triangulation).
    Plain,
    /// Points on triple lines and inside, so that no edge is longer than `edge_length` and, where the outline allows, no angle
    /// is below 25 degrees.
    ///
    /// Lines are divided first, into equal parts and at least in two, for all their boundaries at once. A boundary
    /// that needs no point inside gets the fan, unless it is a sliver in which the fan has longer edges.
    Refined {
        /// In the unit of the domain.
        edge_length: f64,
    },
}

/// A number of points, edges and triangles (in the plane: 0 triangles).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeshSize {
    /// Number of points.
    pub points: u128,
    /// Number of edges; in the plane, of segments.
    pub edges: u128,
    /// Number of triangles.
    pub triangles: u128,
}

impl FaceMesh {
    /// The size of a tessellation's control mesh; estimated for boundaries that are refined.
    pub fn control_mesh_size(self, tessellation: &Tessellation) -> MeshSize {
        let vertices = tessellation.vertices();
        let count =
            |ends: [VertexId; 2]| u128::from(self.segment_count(ends.map(|end| vertices[end.index()])));
        let vertex_count = vertices.len() as u128;
        if tessellation.domain().dimension() == Dimension::Two {
            let ends = |face| <[VertexId; 2]>::try_from(tessellation.face_corners(face)).expect("two ends");
            let edges: u128 = tessellation.faces().map(|face| count(ends(face))).sum();
            return MeshSize {
                points: vertex_count + edges - tessellation.face_count() as u128,
                edges,
                triangles: 0,
            };
        }
        let lines = tessellation.edges();
        let segments: u128 = lines.ends.iter().map(|ends| count(*ends)).sum();
        let mut corner_edges = lines.of_corner.iter();
        let (mut inner, mut triangles) = (0, 0);
        for face in tessellation.faces() {
            let corners = tessellation.face_corners(face);
            let of_face = corner_edges.by_ref().take(corners.len());
            let outline: u128 = of_face.map(|edge| count(lines.ends[*edge as usize])).sum();
            let (more_points, more_triangles) = match self {
                Self::Fan => (1, outline),
                Self::Plain => (0, outline - 2),
                Self::Refined { edge_length } => {
                    let equilateral = 3f64.sqrt() / 4.0 * edge_length * edge_length;
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
                    let inner =
                        1 + (REFINED_TRIANGLES / 2.0 * area(tessellation, face) / equilateral) as u128;
                    (inner, outline + 2 * inner - 2)
                }
            };
            inner += more_points;
            triangles += more_triangles;
        }
        let points = vertex_count + segments - lines.ends.len() as u128 + inner;
        // An edge inside a boundary has a triangle on either side; outlines are few beside those.
        MeshSize { points, edges: segments + (3 * triangles).div_ceil(2), triangles }
    }

    fn segment_count(self, [start, end]: [DVec3; 2]) -> u32 {
        match self {
            Self::Fan | Self::Plain => FEWEST_SEGMENTS,
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
            Self::Refined { edge_length } => {
                ((start.distance(end) / edge_length).ceil() as u32).max(FEWEST_SEGMENTS)
            }
        }
    }

    /// The points between two ends that divide the line into equal segments.
    pub(crate) fn divide(self, [start, end]: [DVec3; 2]) -> Vec<DVec3> {
        let count = self.segment_count([start, end]);
        let point = |k: u32| match 2 * k == count {
            true => start.midpoint(end),
            false => start.lerp(end, f64::from(k) / f64::from(count)),
        };
        (1..count).map(point).collect()
    }
}

/// The area of a planar face.
fn area(tessellation: &Tessellation, face: FaceId) -> f64 {
    let corners = tessellation.face_corners(face);
    let at =
        |k: usize| tessellation.vertices()[corners[k].index()] - tessellation.vertices()[corners[0].index()];
    let doubled: DVec3 = (2..corners.len()).map(|k| at(k - 1).cross(at(k))).sum();
    doubled.length() / 2.0
}

/// The inner points of all triple lines, numbered after the tessellation's vertices.
pub(crate) struct LinePoints {
    /// Of line e, inner points `starts[e]..starts[e + 1]`, from the end of smaller number.
    starts: Vec<u32>,
    pub(crate) positions: Vec<DVec3>,
}

impl LinePoints {
    pub(crate) fn new(tessellation: &Tessellation, lines: &[[VertexId; 2]], face_mesh: FaceMesh) -> Self {
        let vertices = tessellation.vertices();
        let first = id(vertices.len());
        let mut points = Self { starts: vec![first], positions: Vec::with_capacity(lines.len()) };
        for ends in lines {
            points.positions.extend(face_mesh.divide(ends.map(|end| vertices[end.index()])));
            points.starts.push(first + id(points.positions.len()));
        }
        points
    }

    /// The inner points of a line.
    pub(crate) fn of_line(&self, line: u32) -> std::ops::Range<u32> {
        self.starts[line as usize]..self.starts[line as usize + 1]
    }

    /// The line of each point.
    pub(crate) fn lines(&self) -> impl Iterator<Item = usize> {
        let counts = self.starts.windows(2).map(|ends| (ends[1] - ends[0]) as usize);
        counts.enumerate().flat_map(|(line, count)| std::iter::repeat_n(line, count))
    }

    /// All points of a line, ends included.
    pub(crate) fn whole_line(&self, line: u32, ends: [VertexId; 2]) -> Vec<u32> {
        [ends[0].0].into_iter().chain(self.of_line(line)).chain([ends[1].0]).collect()
    }
}

/// One boundary's triangles.
pub(crate) struct FaceTriangles {
    /// Numbers of the points round the face.
    pub(crate) outline: Vec<u32>,
    /// The line that the segment from each point of the outline to the next is part of.
    pub(crate) lines: Vec<u32>,
    pub(crate) inner_points: Vec<DVec3>,
    /// Corners by their place in the outline and, after that, among the inner points.
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// Triangulates all faces, in parallel. `points` are the tessellation's vertices and those on lines.
pub(crate) fn triangulate_faces(
    tessellation: &Tessellation,
    edges: &Edges,
    lines: &LinePoints,
    points: &[DVec3],
    face_mesh: FaceMesh,
) -> Vec<FaceTriangles> {
    let mut first_corners = Vec::with_capacity(tessellation.face_count());
    let mut corner_count = 0;
    for face in tessellation.faces() {
        first_corners.push((face, corner_count));
        corner_count += tessellation.face_corners(face).len();
    }
    let triangulate = |(face, first): &(FaceId, usize)| {
        let corners = tessellation.face_corners(*face);
        let (mut outline, mut lines_of) = (Vec::new(), Vec::new());
        for (corner, &line) in corners.iter().zip(&edges.of_corner[*first..]) {
            outline.push(corner.0);
            let inner = lines.of_line(line);
            if edges.ends[line as usize][0] == *corner {
                outline.extend(inner);
            } else {
                outline.extend(inner.rev());
            }
            lines_of.resize(outline.len(), line);
        }
        let (inner_points, triangles) = fill(&outline, points, face_mesh);
        FaceTriangles { outline, lines: lines_of, inner_points, triangles }
    };
    first_corners.par_iter().map(triangulate).collect()
}

fn fill(outline: &[u32], points: &[DVec3], face_mesh: FaceMesh) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let positions: Vec<DVec3> = outline.iter().map(|point| points[*point as usize]).collect();
    let mesh = match face_mesh {
        FaceMesh::Fan => None,
        FaceMesh::Plain => triangulate_polygon(&positions, None),
        FaceMesh::Refined { edge_length } => {
            triangulate_polygon(&positions, Some(edge_length)).filter(|mesh| !mesh.inner_points.is_empty())
        }
    };
    match mesh {
        Some(mesh) => (mesh.inner_points, mesh.triangles),
        // Also what rounding leaves no triangulation of: the centre of a sliver still sees all of its outline.
        None => {
            let count = id(outline.len());
            let triangles = (0..count).map(|k| [k, (k + 1) % count, count]).collect();
            (vec![outline_center(&positions)], triangles)
        }
    }
}

/// The centroid of an outline: inside the face, and well defined for the thinnest of slivers.
fn outline_center(outline: &[DVec3]) -> DVec3 {
    let origin = outline[0];
    let (mut weighted, mut perimeter) = (DVec3::ZERO, 0.0);
    for (from, to) in outline.iter().zip(outline.iter().cycle().skip(1)) {
        let length = from.distance(*to);
        weighted += (from.midpoint(*to) - origin) * length;
        perimeter += length;
    }
    origin + weighted / perimeter
}

/// Control points are far fewer than 2^32: [`crate::Network`] has checked the number of their triangles.
pub(crate) fn id(index: usize) -> u32 {
    u32::try_from(index).expect("the control mesh was checked to fit 32-bit ids")
}
