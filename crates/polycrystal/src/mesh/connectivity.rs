use glam::DVec3;
use subzero::{CurveMesh, TriangleMesh};

/// The elements of the network: triangles in space, segments in the plane.
#[derive(Debug, Clone, PartialEq)]
pub enum Mesh {
    /// Surfaces.
    Triangles(TriangleMesh),
    /// Lines in the plane z = 0.
    Segments(CurveMesh),
}

impl Mesh {
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
}
