//! What a pointer may be at: points that can be moved, and edges and triangles between them.

use glam::DVec3;

use super::super::grains::Frame;
use crate::Scene;
use crate::mesh::EditedEdges;

/// Points, edges and triangles by number.
#[derive(Debug, Default)]
pub(super) struct Cage {
    /// In the page's frame.
    pub(super) points: Vec<DVec3>,
    /// The ends of each edge. Of half-edges these are places, which an edit leaves where they are; a place without an edge has one point twice.
    pub(super) edges: Vec<[u32; 2]>,
    /// The corners of each triangle; in a place without one, the same point.
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Cage {
    /// Points alone.
    pub(super) fn of_points(points: &[DVec3], frame: Frame) -> Self {
        let points = points.iter().map(|point| frame.in_frame(*point)).collect();
        Self { points, ..Self::default() }
    }

    /// Triangles that are edited.
    pub(super) fn add_half_edges(&mut self, edges: &EditedEdges) {
        self.edges = edges.edge_places().map(Option::unwrap_or_default).collect();
        self.triangles = edges.triangle_places().map(Option::unwrap_or_default).collect();
    }

    /// Faces between the points.
    pub(super) fn add_faces(&mut self, faces: &[Vec<u32>]) {
        self.edges = edges(faces);
        self.triangles = triangles(&self.points, faces);
    }

    /// Polylines between the points.
    pub(super) fn add_polylines(&mut self, lines: &[Vec<u32>]) {
        self.edges = lines.iter().flat_map(|line| line.windows(2).map(|ends| [ends[0], ends[1]])).collect();
    }

    /// Number of edges that there are.
    pub(super) fn edge_count(&self) -> usize {
        self.edges.iter().filter(|[start, end]| start != end).count()
    }

    /// Number of triangles that there are.
    pub(super) fn triangle_count(&self) -> usize {
        self.triangles.iter().filter(|[first, second, _]| first != second).count()
    }
}

/// Each edge of some faces once.
pub(super) fn edges(faces: &[Vec<u32>]) -> Vec<[u32; 2]> {
    let sides = |face: &Vec<u32>| -> Vec<[u32; 2]> {
        let next = face.iter().cycle().skip(1);
        face.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)]).collect()
    };
    let mut edges: Vec<[u32; 2]> = faces.iter().flat_map(sides).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Faces cut into triangles.
pub(super) fn triangles(points: &[DVec3], faces: &[Vec<u32>]) -> Vec<[u32; 3]> {
    let all: Option<Vec<[u32; 3]>> = faces.iter().map(|face| face.as_slice().try_into().ok()).collect();
    all.unwrap_or_else(|| {
        Scene { points: points.to_vec(), faces: faces.to_vec(), ..Scene::default() }.triangles().0
    })
}
