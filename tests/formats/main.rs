//! What is written for other tools, read back by what others wrote: crates, and where they are installed gmsh, Surface
//! Evolver, and Python with VTK, meshio and trimesh.
#![allow(clippy::unwrap_used, clippy::cast_possible_truncation, reason = "a test may panic")]

mod corrupt;
mod evolver;
mod grids;
mod quiet_reader;
mod surfaces;
mod tess;
mod tools;
mod workplace;
