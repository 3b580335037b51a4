//! Which faces of elements lie on boundaries.

use std::collections::BTreeMap;

use polycrystal::{GrainId, Network};

use super::element_nodes::ElementNodes;
use super::element_shape::{ElementFace, boundary_elements, face_key};

impl ElementNodes<'_> {
    /// Of each triangle of the network's finest level, in the plane of each segment, the face of the element on its first side, and that on its second one; nothing at the exterior.
    pub(crate) fn faces_at_boundaries(&self, network: &Network) -> Vec<[Option<ElementFace>; 2]> {
        let is_on_boundary = |corner: &u32| (*corner as usize) < self.boundary_points;
        let mut faces: BTreeMap<(GrainId, [u32; 3]), ElementFace> = BTreeMap::new();
        for (element, (nodes, grain)) in self.iter().zip(self.grains).enumerate() {
            for (face, of_face) in self.shape.faces().enumerate() {
                let corners: Vec<u32> = of_face.iter().map(|corner| nodes[*corner]).collect();
                if corners.iter().all(is_on_boundary) {
                    faces.insert((*grain, face_key(&corners)), ElementFace { element, face });
                }
            }
        }
        let boundaries = network.boundaries();
        let level = network.finest_level();
        let at = |(boundary, corners): (polycrystal::BoundaryId, polycrystal::Corners)| {
            let key = face_key(&corners);
            boundaries[boundary.index()].sides.map(|side| faces.get(&(side.grain()?, key)).copied())
        };
        boundary_elements(&level).map(at).collect()
    }
}
