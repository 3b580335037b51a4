use subzero::{CurveMesh, TriangleMesh};

/// The elements of the network: triangles in space, segments in the plane.
#[derive(Debug, Clone, PartialEq)]
pub enum Mesh {
    /// Surfaces.
    Triangles(TriangleMesh),
    /// Lines in the plane z = 0.
    Segments(CurveMesh),
}
