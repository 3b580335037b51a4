//! Voronoi cells in two and three dimensions, merged into one cell complex.
//!
//! [`Tessellation::new`] cuts a box into the cells of a set of seeds. Every geometric decision is exact (floating filter,
//! then integers, then a symbolic tie-break), so all cells agree and merging is purely combinatorial: a vertex *is* the
//! set of seeds and walls that meet there. No distance tolerance appears anywhere.
//!
//! ```
//! use glam::DVec3;
//! use voronoi::{Domain, Tessellation};
//!
//! let seeds = [DVec3::new(0.25, 0.5, 0.5), DVec3::new(0.75, 0.5, 0.5)];
//! let tessellation = Tessellation::new(&Domain::unit_cube(), &seeds)?;
//! assert!((tessellation.cell_measures()[0].volume - 0.5).abs() < 1e-15);
//! assert_eq!(tessellation.vertices().len(), 12);
//! # Ok::<(), voronoi::VoronoiError>(())
//! ```
//!
//! A domain may repeat along any axes. Its cells are whole and stick out of the box, and what a cell meets a period away is
//! an image, be it of itself:
//!
//! ```
//! use glam::{BVec3, DVec3};
//! use voronoi::{CellId, Domain, Translation, Side, Tessellation};
//!
//! let domain = Domain::unit_cube().with_periods(BVec3::new(true, false, false));
//! let tessellation = Tessellation::new(&domain, &[DVec3::new(0.1, 0.5, 0.5)])?;
//! let neighbors = tessellation.neighbors(CellId(0));
//! assert_eq!(neighbors[..2], [-1, 1].map(|x| Side::Image(CellId(0), Translation([x, 0, 0]))));
//! assert_eq!(neighbors.len(), 6, "two images and four walls");
//! // The face at x = -0.4 is the primary of that at x = 0.6, or the other way round.
//! assert_eq!(tessellation.periodic_faces().len(), 1);
//! # Ok::<(), voronoi::VoronoiError>(())
//! ```

mod bodies;
mod box_tree;
mod build;
mod clip;
mod diagram;
mod domain;
mod error;
mod exact;
mod lanes;
mod line_triangulation;
mod polygon_triangulation;
mod resolution;
mod sites;
pub mod volumes;

pub use build::stream::{CellStream, SingleCell};
pub use diagram::cell_sum::CellMeasure;
pub use diagram::edges::Edges;
pub use diagram::ids::{CellId, FaceId, PeriodicPair, VertexId};
pub use diagram::periodic_vertex::PeriodicVertex;
pub use diagram::side::Side;
pub use diagram::tessellation::Tessellation;
pub use domain::{Dimension, Domain};
pub use error::VoronoiError;
pub use exact::translation::Translation;
pub use exact::wall::{Wall, WallPlane};
pub use line_triangulation::triangulate_between_lines;
pub use polygon_triangulation::{PolygonTriangulation, triangulate_polygon};
