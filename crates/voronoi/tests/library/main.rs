//! Cells as users of the library meet them.

#[path = "../common/mod.rs"]
mod common;
mod degenerate;
mod division;
mod domains;
mod grain_shapes;
mod inclusions;
mod lloyd;
mod periodic;
mod planar;
mod properties;
mod reference;
mod volumes;
