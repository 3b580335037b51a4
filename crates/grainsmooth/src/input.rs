//! What users hand in: seeds, sizes, orientations, domains, tessellations and labelled networks from files.

pub(crate) mod domain_file;
mod evolver;
pub(crate) mod labelled_file;
mod polygons;
pub(crate) mod seed_file;
pub(crate) mod size_file;
mod stl_set;
pub(crate) mod tess;
mod tess_network;
pub(crate) mod texture_file;
pub(crate) mod volume_file;
