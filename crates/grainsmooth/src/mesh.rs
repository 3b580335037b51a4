//! Meshes and curves of any kind, apart from grains: their files, subdivision, edits, Bezier patches.

mod bezier;
mod carried;
mod data;
mod edit;
mod edited_edges;
pub mod file;
mod json;
pub(crate) mod normal;
mod subdivide;

pub use bezier::{BezierFile, Construction, read_bezier};
pub use carried::CarriedData;
pub use edit::{EdgeChoice, Edited, MeshEdit};
pub(crate) use edited_edges::EditedEdges;
pub use json::{bezier_json, construction_json, levels_json, mesh_json};
pub(crate) use subdivide::grown_generations;
pub use subdivide::{Connectivity, Curves, Level, Limits, Scheme, limits, subdivide};
