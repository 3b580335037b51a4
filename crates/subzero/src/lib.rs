//! Subdivision of curves, triangle meshes and polygon meshes, with connectivity apart from positions.
//!
//! A mesh holds connectivity only. Refining it gives the finer mesh and a [`StencilTable`] that says how each new
//! point is averaged from the old ones, so that topology is refined once and new control points cost one `apply`:
//!
//! ```
//! use glam::DVec3;
//! use subzero::{Features, Refinement, TriangleMesh};
//!
//! let tetrahedron = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
//! let points = [DVec3::new(1., 1., 1.), DVec3::new(-1., 1., -1.), DVec3::new(1., -1., -1.), DVec3::new(-1., -1., 1.)];
//!
//! let mesh = TriangleMesh::new(4, tetrahedron, &Features::default())?;
//! let Refinement { mesh: finer, stencils } = mesh.loop_refine()?;
//! let finer_points = stencils.apply(&points);
//!
//! assert_eq!(finer.triangles().len(), 16);
//! assert_eq!(finer_points.len(), 10);
//! assert!((finer_points[0].x - 0.25).abs() < 1e-12);
//! # Ok::<(), subzero::MeshError>(())
//! ```

mod base_rings;
mod bezier;
mod bezier_error;
mod bezier_merge;
mod butterfly;
mod catmull_clark;
mod catmull_clark_limits;
mod counts;
mod curve_mesh;
mod curve_order;
mod doo_sabin;
mod edge_choice;
mod edge_table;
mod error;
mod features;
mod half_edge_edit;
mod half_edge_mesh;
mod ids;
mod large_vec;
mod limit_masks;
mod loop_beyond;
mod loop_hierarchy;
mod loop_limit;
mod loop_points;
mod loop_scheme;
mod loop_step;
mod mesh_checks;
mod orient;
mod point;
mod polygon_mesh;
mod prefetch;
mod refined_mesh;
mod refined_triangle;
mod sharpness;
mod split_and_flip;
mod stencil;
mod teapot;
mod triangle_build;
mod triangle_mesh;
mod triangle_refine;
mod triangulate;
mod vertex_stencils;

pub use bezier::{BezierCurve, BezierSurface};
pub use bezier_error::BezierError;
pub use bezier_merge::MergedSurfaces;
pub use catmull_clark_limits::CatmullClarkLimits;
pub use counts::{EdgeParent, MeshCounts, VertexParent};
pub use curve_mesh::CurveMesh;
pub use curve_order::CurveOrder;
pub use doo_sabin::{DooSabinLimits, DooSabinWeights};
pub use error::MeshError;
pub use features::{BoundaryRule, Crease, Features, INFINITE_SHARPNESS, VertexRule};
pub use half_edge_mesh::HalfEdgeMesh;
pub use ids::{EdgeId, FaceId, HalfEdgeId};
pub use loop_hierarchy::LoopHierarchy;
pub use loop_limit::{LoopLimits, Sector};
pub use loop_scheme::LoopWeights;
pub use mesh_checks::check_finite;
pub use orient::{Orientation, orient};
pub use point::Point;
pub use polygon_mesh::PolygonMesh;
pub use refined_mesh::RefinedMesh;
pub use refined_triangle::RefinedTriangle;
pub use stencil::StencilTable;
pub use teapot::teapot;
pub use triangle_mesh::TriangleMesh;
pub use triangulate::triangulate;

/// One step of subdivision: the finer mesh, and how its points follow from the coarser mesh's.
#[derive(Clone, Debug, PartialEq)]
pub struct Refinement<M> {
    /// Connectivity of the finer level.
    pub mesh: M,
    /// One stencil per vertex of `mesh`, over the vertices of the mesh that was refined.
    pub stencils: StencilTable,
}
