use glam::DVec3;
use rayon::prelude::*;
use subzero::{CurveMesh, EdgeId, TriangleMesh};

/// Edges whose lengths one task adds up: fixed, so that the sum does not depend on the number of threads.
const EDGES_PER_TASK: usize = 4096;

/// The elements of the network: triangles in space, segments in the plane.
#[derive(Debug, Clone, PartialEq)]
pub enum Mesh {
    /// Surfaces.
    Triangles(TriangleMesh),
    /// Lines in the plane z = 0.
    Segments(CurveMesh),
}

impl Mesh {
    /// Number of vertices.
    pub(crate) fn vertex_count(&self) -> usize {
        match self {
            Self::Triangles(mesh) => mesh.vertex_count(),
            Self::Segments(mesh) => mesh.vertex_count(),
        }
    }

    /// The points one level on, which follow from those of this level.
    pub(crate) fn step(&self, points: &[DVec3]) -> Vec<DVec3> {
        match self {
            Self::Triangles(mesh) => mesh.loop_step(points),
            Self::Segments(mesh) => mesh.spline_step(points),
        }
    }

    /// Puts the points of this level that make up a point of the next one in place of `entries`, each with its weight.
    pub(crate) fn stencil(&self, point: u32, entries: &mut Vec<(u32, f64)>) {
        match self {
            Self::Triangles(mesh) => mesh.loop_stencil(point, entries),
            Self::Segments(mesh) => mesh.spline_stencil(point, entries),
        }
    }

    /// The mean length of the edges; in the plane of the segments.
    pub(crate) fn mean_edge_length(&self, points: &[DVec3]) -> f64 {
        let length = |[a, b]: [u32; 2]| points[a as usize].distance(points[b as usize]);
        match self {
            Self::Triangles(mesh) => {
                let edges = (0..mesh.counts().edges).into_par_iter();
                let sums = edges.fold_chunks(
                    EDGES_PER_TASK,
                    || 0.0,
                    |sum, edge| sum + length(mesh.edge(EdgeId(edge))),
                );
                sums.collect::<Vec<f64>>().iter().sum::<f64>() / mesh.edge_count() as f64
            }
            Self::Segments(mesh) => {
                mesh.segments().iter().copied().map(length).sum::<f64>() / mesh.segments().len() as f64
            }
        }
    }
}
