//! Meshes and their subdivision as users of the library meet them.

mod bad_meshes;
#[path = "../common/mod.rs"]
mod common;
mod curve_order;
mod curve_reference;
mod edge_choice;
mod half_edge;
mod merged_teapot;
mod numbering;
mod opensubdiv;
mod orient;
mod polygon_reference;
mod properties;
mod teapot;
mod triangle_reference;
mod triangulate;
