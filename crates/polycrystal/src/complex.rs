//! The cell complex of grains: each vertex, edge and face once, also on the torus, and how its topology changes.

mod cell_complex;
mod edge;
mod merging;
mod plane;
mod reconnect;
pub(crate) mod ring;
mod short_edges;
mod snapshot;
mod star;

pub use cell_complex::CellComplex;
pub use edge::ComplexEdge;
pub use plane::OutgoingHalfEdge;
pub use short_edges::{Collapsed, remove_edges_that_shorten, remove_short_edges};
pub use snapshot::Snapshot;
pub use star::Star;
