//! One file for each format that is written.

mod ang;
mod blocks;
mod connected;
mod ctf;
mod euler;
mod evolver;
mod format;
mod gmsh;
mod grains;
mod inp;
mod label_grid;
mod lines;
mod material;
mod names;
mod npy;
mod obj;
mod ori;
mod orientation_map;
mod plane_blocks;
mod ply;
mod stl;
mod surface;
mod tess;
mod vti;
mod vtk;

pub use format::OutputFormat;
pub(crate) use label_grid::LABEL_BYTES;
pub use label_grid::LabelGrid;
pub use names::Names;
pub use stl::StlEncoding;
pub use tess::{
    Oriented, Tess, TessCopy, TessDomain, TessFace, TessPeriodicity, TessProblem, TessSeed, read_tess,
};

pub(crate) use blocks::escaped;
pub(crate) use ctf::{hkl_symmetry, hkl_turn};
pub(crate) use format::FileSize;
use orientation_map::OrientationMap;
pub(crate) use surface::{Part, Surface, label, unit_normal};
