//! What is written for other tools, read back by what others wrote: crates, gmsh, Surface Evolver, and Python with VTK,
//! meshio, trimesh and orix.
#![allow(clippy::unwrap_used, clippy::cast_possible_truncation, reason = "a test may panic")]

mod checked_volumes;
mod corrupt;
mod evolver;
mod given_networks;
mod grids;
mod hdf5;
mod images;
mod maps;
mod plane;
#[path = "../common/programs.rs"]
mod programs;
mod quiet_reader;
mod surfaces;
mod tess;
mod tetrahedra;
mod tools;
mod workplace;
