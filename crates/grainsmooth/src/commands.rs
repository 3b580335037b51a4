//! What the program does, a file for each of its commands.

pub mod check;
pub mod measure;
pub mod mesh;
pub mod network;
pub mod page;
pub mod remesh;
mod result_files;
pub mod smooth;
