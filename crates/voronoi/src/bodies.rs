//! Domains other than boxes.
//!
//! A polyhedron is the cell of its only seed: its box and its volume come from clipping, so this stands above all that.

mod convex_surface;
mod curved;
mod extent;
mod half_spaces;
