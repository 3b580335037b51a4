//! Networks as users of the library meet them.

mod box_cut;
mod catenoid;
mod cell_complex;
mod certificate;
#[path = "../common/mod.rs"]
mod common;
#[path = "../../../voronoi/tests/common/mod.rs"]
mod complexes;
mod domains;
mod equilibrium;
mod face_mesh;
mod foams;
mod free;
mod grain_cells;
mod growth;
mod growth_in_space;
mod inclusions;
mod labelled;
mod many_threads;
mod measures;
mod network;
mod periodic;
mod plane_equilibrium;
mod relaxation;
mod remesh;
mod remesh_plane;
mod short_edges;
mod tensions;
mod voxels;
