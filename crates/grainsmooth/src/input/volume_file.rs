//! Elements that fill grains from files, with what solvers are given beside them.

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
use crate::volume_mesh::element_shape::ElementShape;

/// Elements that fill grains, from a file: tetrahedra, or triangles in a plane; and the sets and ties beside them. Nodes and elements are named by their places in the lists, in the order of the file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct VolumeFile {
    /// Coordinates of all nodes.
    pub(crate) points: Vec<DVec3>,
    /// What the file calls each node.
    pub(crate) node_numbers: Vec<u64>,
    /// Whether elements are triangles or tetrahedra.
    pub(crate) shape: ElementShape,
    /// The corners of the elements, one element after the other.
    corners: Vec<u32>,
    /// The nodes in the middles of their edges, one element after the other; none of first order.
    middles: Vec<u32>,
    /// What the file calls each element.
    pub(crate) element_numbers: Vec<u64>,
    /// The grains that each element is part of, which should be one.
    pub(crate) grains: Vec<Vec<GrainId>>,
    /// Cohesive elements: the nodes of one side, then those of the other; in the plane the second side runs back.
    pub(crate) joints: Vec<Vec<u32>>,
    /// Sets of nodes, by the names of .inp.
    pub(crate) node_sets: BTreeMap<String, Vec<u32>>,
    /// Sets of faces of elements (in the plane: edges), by the names of .inp; each face by its corners in order, as `face_key` has them.
    pub(crate) surfaces: BTreeMap<String, Vec<[u32; 3]>>,
    /// Nodes that are tied to others, whole periods away.
    pub(crate) ties: Vec<Tie>,
    /// Nodes that are part of no element, but control the others.
    pub(crate) control_nodes: Vec<u32>,
    /// The volumes that the file says grains to have, in the order of their numbers.
    pub(crate) volumes: Option<Vec<f64>>,
}

/// A node that stands whole periods away from another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Tie {
    /// The node.
    pub(crate) copy: u32,
    /// The other one.
    pub(crate) original: u32,
    /// The periods between them, where the file tells how many.
    pub(crate) periods: Option<[i8; 3]>,
}

impl VolumeFile {
    /// Reads elements from a file .inp, .msh, .bdf or .vtu; nothing where a .vtu or another file holds none.
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
        if extension == "vtu" && !vtu::has_elements(&bytes) {
            return Ok(None);
        }
        let file = read(&bytes).map_err(located)?;
        let is_flat = || file.points.iter().all(|point| point.z == file.points[0].z);
        if file.corners.is_empty() || (file.shape == ElementShape::Triangle && !is_flat()) {
            return Err(located(MeshFileProblem::NoElements));
        }
        check_lengths(&file.points).map_err(located)?;
        Ok(Some(file))
    }
    /// Adds an element: the corners first, then, of second order, the middles of its edges. All have the same number of nodes; the error is that number.
    fn push_element(&mut self, number: u64, nodes: &[u32]) -> Result<(), usize> {
        let (corners, edges) = (self.shape.corner_count(), self.shape.edges().len());
        let is_quadratic = !self.middles.is_empty() || (self.corners.is_empty() && nodes.len() > corners);
        let wanted = if is_quadratic { corners + edges } else { corners };
        if nodes.len() != wanted {
            return Err(wanted);
        }
        let (ends, middles) = nodes.split_at(corners);
        self.corners.extend(ends);
        self.middles.extend(middles);
        self.element_numbers.push(number);
        Ok(())
    }

    /// The corners of each element.
    pub(crate) fn elements(&self) -> impl Iterator<Item = &[u32]> {
        self.corners.chunks_exact(self.shape.corner_count())
    }

    /// The corners of an element.
    pub(crate) fn element(&self, element: usize) -> &[u32] {
        let count = self.shape.corner_count();
        &self.corners[count * element..][..count]
    }

    /// The middles of the edges of each element; nothing of first order.
    pub(crate) fn middles(&self) -> impl Iterator<Item = &[u32]> {
        self.middles.chunks_exact(self.shape.edges().len())
    }

    /// Whether edges have nodes in their middle.
    pub(crate) fn is_quadratic(&self) -> bool {
        !self.middles.is_empty()
    }

    /// The faces of an element, by their corners.
    pub(crate) fn faces<'a>(&self, corners: &'a [u32]) -> impl Iterator<Item = Vec<u32>> + use<'a> {
        self.shape.faces().map(|face| face.iter().map(|corner| corners[*corner]).collect())
    }
}
