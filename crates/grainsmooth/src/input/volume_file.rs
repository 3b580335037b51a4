//! Tetrahedra from files, with what solvers are given beside them.

mod bdf;
mod inp;
mod msh;
mod numbered;
mod vtu;

use std::collections::BTreeMap;
use std::path::Path;

use glam::DVec3;
use polycrystal::GrainId;

use crate::Error;
use crate::mesh::file::{MeshFileProblem, check_lengths};

/// Tetrahedra from a file, and the sets and ties beside them. Nodes and elements are named by their places in the lists, in the order of the file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct VolumeFile {
    /// Coordinates of all nodes.
    pub points: Vec<DVec3>,
    /// What the file calls each node.
    pub node_numbers: Vec<u64>,
    /// The corners of each tetrahedron.
    pub tetrahedra: Vec<[u32; 4]>,
    /// The nodes in the middles of the edges 12, 23, 13, 14, 24, 34 of each tetrahedron; none of first order.
    pub middles: Vec<[u32; 6]>,
    /// What the file calls each tetrahedron.
    pub element_numbers: Vec<u64>,
    /// The grains that each tetrahedron is part of, which should be one.
    pub grains: Vec<Vec<GrainId>>,
    /// Cohesive elements: three nodes of one side, then those of the other.
    pub prisms: Vec<[u32; 6]>,
    /// Sets of nodes, by the names of .inp.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Sets of faces of tetrahedra, by the names of .inp.
    pub surfaces: BTreeMap<String, Vec<[u32; 3]>>,
    /// Nodes that are tied to others, whole periods away.
    pub ties: Vec<Tie>,
    /// Nodes that are part of no element, but control the others.
    pub control_nodes: Vec<u32>,
    /// The volumes that the file says grains to have, in the order of their numbers.
    pub volumes: Option<Vec<f64>>,
}

/// A node that stands whole periods away from another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tie {
    /// The node.
    pub copy: u32,
    /// The other one.
    pub original: u32,
    /// The periods between them, where the file tells how many.
    pub periods: Option<[i8; 3]>,
}

impl VolumeFile {
    /// Reads tetrahedra from a file .inp, .msh, .bdf or .vtu; nothing where a .vtu or another file holds none.
    ///
    /// # Errors
    /// [`Error::MeshFile`] when the file cannot be read or is corrupt.
    pub fn read(path: &Path) -> Result<Option<Self>, Error> {
        let located = |problem| Error::MeshFile { path: path.to_owned(), problem };
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let read: fn(&[u8]) -> Result<Self, MeshFileProblem> = match extension.to_str() {
            Some("inp") => |bytes| inp::read(&String::from_utf8_lossy(bytes)),
            Some("msh") => |bytes| msh::read(&String::from_utf8_lossy(bytes)),
            Some("bdf") => |bytes| bdf::read(&String::from_utf8_lossy(bytes)),
            Some("vtu") => vtu::read,
            _ => return Ok(None),
        };
        let bytes = std::fs::read(path).map_err(MeshFileProblem::Unreadable).map_err(located)?;
        if extension == "vtu" && !vtu::has_tetrahedra(&bytes) {
            return Ok(None);
        }
        let file = read(&bytes).map_err(located)?;
        if file.tetrahedra.is_empty() {
            return Err(located(MeshFileProblem::NoTetrahedra));
        }
        check_lengths(&file.points).map_err(located)?;
        Ok(Some(file))
    }
}
