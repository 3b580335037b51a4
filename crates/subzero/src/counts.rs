//! The numbering of a refined triangle mesh: from a child to its parent by arithmetic.

use crate::{EdgeId, FaceId, MeshError};

/// How many vertices, edges and triangles a mesh has, and with them who descends from whom one level on.
///
/// A refinement numbers its vertices, edges and triangles by index arithmetic. With V vertices, E edges, T triangles
/// and the half-edge h = 3 t + k from corner k to corner k + 1 of triangle t:
///
/// | refined | id | where |
/// |---|---|---|
/// | vertex | v | old vertex v |
/// | vertex | V + e | on edge e |
/// | edge | 2 e, 2 e + 1 | the halves of edge e, at its end 0 and at its end 1 |
/// | edge | 2 E + h | inside triangle t, across its corner k |
/// | triangle | h | at corner k of triangle t |
/// | triangle | 3 T + t | the centre of triangle t |
///
/// The corner triangle h starts at the old corner, so its edges are a half of the edge h, the edge 2 E + h, and a half
/// of the edge before h. Corner k of the centre triangle is the vertex on the edge *before* corner k.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshCounts {
    /// Number of vertices.
    pub vertices: u32,
    /// Number of edges.
    pub edges: u32,
    /// Number of triangles.
    pub triangles: u32,
}

/// Where a vertex of a refined mesh comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VertexParent {
    /// It is the image of this vertex.
    Vertex(u32),
    /// It was inserted on this edge.
    Edge(EdgeId),
}

/// Where an edge of a refined mesh comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeParent {
    /// It is a half of this edge.
    Edge(EdgeId),
    /// It lies inside this triangle.
    Triangle(FaceId),
}

impl MeshCounts {
    /// The counts one level on.
    ///
    /// ```
    /// use subzero::MeshCounts;
    ///
    /// let tetrahedron = MeshCounts { vertices: 4, edges: 6, triangles: 4 };
    /// assert_eq!(tetrahedron.refined()?, MeshCounts { vertices: 10, edges: 24, triangles: 16 });
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the half-edges or vertices of the next level outgrow 32-bit ids.
    pub fn refined(self) -> Result<Self, MeshError> {
        let fit = |what, count: u64| {
            u32::try_from(count).map_err(|_| MeshError::TooLarge {
                what,
                count: usize::try_from(count).unwrap_or(usize::MAX),
            })
        };
        let [vertices, edges, triangles] = [self.vertices, self.edges, self.triangles].map(u64::from);
        // Twice an edge id and three times a triangle id are ids too.
        fit("half-edges", 12 * triangles)?;
        fit("edge directions", 2 * (2 * edges + 3 * triangles))?;
        Ok(Self {
            vertices: fit("vertices", vertices + edges)?,
            edges: fit("edges", 2 * edges + 3 * triangles)?,
            triangles: fit("triangles", 4 * triangles)?,
        })
    }

    /// The parent in this mesh of vertex `v` of the mesh refined from it.
    pub fn vertex_parent(self, v: u32) -> VertexParent {
        if v < self.vertices {
            VertexParent::Vertex(v)
        } else {
            VertexParent::Edge(EdgeId(v - self.vertices))
        }
    }

    /// The parent in this mesh of edge `e` of the mesh refined from it.
    pub fn edge_parent(self, EdgeId(e): EdgeId) -> EdgeParent {
        if e < 2 * self.edges {
            EdgeParent::Edge(EdgeId(e / 2))
        } else {
            EdgeParent::Triangle(FaceId((e - 2 * self.edges) / 3))
        }
    }

    /// The parent in this mesh of triangle `t` of the mesh refined from it.
    pub fn triangle_parent(self, FaceId(t): FaceId) -> FaceId {
        FaceId(if t < 3 * self.triangles { t / 3 } else { t - 3 * self.triangles })
    }

    /// The vertex of the refined mesh that lies on edge `e`.
    pub fn edge_vertex(self, EdgeId(e): EdgeId) -> u32 {
        self.vertices + e
    }

    /// The halves of edge `e` in the refined mesh: the one at its end 0, the one at its end 1.
    pub fn edge_children(self, EdgeId(e): EdgeId) -> [EdgeId; 2] {
        [2 * e, 2 * e + 1].map(EdgeId)
    }

    /// The triangles of the refined mesh in triangle `t`: at its corners 0, 1, 2 and in its centre.
    pub fn triangle_children(self, FaceId(t): FaceId) -> [FaceId; 4] {
        [3 * t, 3 * t + 1, 3 * t + 2, 3 * self.triangles + t].map(FaceId)
    }
}
