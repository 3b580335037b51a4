//! Voronoi cells in two and three dimensions, welded into one cell complex.
//!
//! [`Tessellation::new`] cuts a box into the cells of a set of seeds. Every geometric decision is exact (floating filter,
//! then integers, then a symbolic tie-break), so all cells agree and the weld is purely combinatorial: a vertex *is* the
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

mod batch;
mod convex_cell;
mod domain;
mod error;
mod flat_cells;
mod generator;
mod grid;
mod images;
mod measure;
mod near_seeds;
mod periodic_weld;
mod planar;
mod polygon;
mod predicate;
mod search;
mod tessellation;
mod torus;
mod weld;

pub use domain::{Dimension, Domain, Wall};
pub use error::VoronoiError;
pub use measure::CellMeasure;
pub use tessellation::{CellId, Edges, FaceId, PeriodicPair, Shift, Side, Tessellation, VertexId};
