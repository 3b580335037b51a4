//! One file for each format that is written.

mod ang;
mod blocks;
mod connected;
mod ctf;
mod euler;
mod evolver;
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

pub(crate) use label_grid::LABEL_BYTES;
pub use label_grid::LabelGrid;
pub use names::Names;
pub use stl::StlEncoding;
pub use tess::{
    Oriented, Tess, TessCopy, TessDomain, TessFace, TessPeriodicity, TessProblem, TessSeed, read_tess,
};

pub(crate) use blocks::escaped;
pub(crate) use ctf::{hkl_symmetry, hkl_turn, write as write_ctf};
pub(crate) use euler::write as write_euler;
pub(crate) use gmsh::write_script as write_gmsh_script;
pub(crate) use inp::write as write_inp;
pub(crate) use orientation_map::OrientationMap;
pub(crate) use surface::{Part, Surface, label, unit_normal};
pub(crate) use {ang::write as write_ang, evolver::write as write_evolver, gmsh::write as write_gmsh};
pub(crate) use {material::write as write_material, ori::write as write_ori};
pub(crate) use {npy::write as write_npy, obj::write as write_obj, ply::write as write_ply};
pub(crate) use {stl::write as write_stl, tess::write as write_tess};
