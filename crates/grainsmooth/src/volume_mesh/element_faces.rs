//! Which faces of tetrahedra are triangles of boundaries.

use std::collections::BTreeMap;

use polycrystal::{GrainId, Mesh, Network};

use super::VolumeMesh;

/// The corners of a tetrahedron's faces, in the order of Abaqus and CalculiX: S1 to S4. Abaqus Analysis User's Guide, "Three-dimensional solid element library".
pub(crate) const FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

/// A face of a tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ElementFace {
    /// The tetrahedron, by number.
    pub(crate) element: usize,
    /// Which of [`FACES`].
    pub(crate) face: usize,
}

impl VolumeMesh {
    /// Of each triangle of the network's finest level, the face of the tetrahedron on its first side, and that on its second one; nothing at the exterior.
    pub(crate) fn faces_at_triangles(&self, network: &Network) -> Vec<[Option<ElementFace>; 2]> {
        let level = network.finest_level();
        let Mesh::Triangles(triangles) = &level.mesh else { return Vec::new() };
        let is_on_surface = |corner: &u32| (*corner as usize) < self.surface_points;
        let mut faces: BTreeMap<(GrainId, [u32; 3]), ElementFace> = BTreeMap::new();
        for (element, (corners, grain)) in self.tetrahedra.iter().zip(&self.grains).enumerate() {
            for (face, of_face) in FACES.iter().enumerate() {
                let corners = of_face.map(|corner| corners[corner]);
                if corners.iter().all(is_on_surface) {
                    faces.insert((*grain, sorted(corners)), ElementFace { element, face });
                }
            }
        }
        let boundaries = network.boundaries();
        let both = triangles.triangles().iter().zip(&level.boundary_of);
        let at = |(corners, boundary): (&[u32; 3], &polycrystal::BoundaryId)| {
            let key = sorted(*corners);
            boundaries[boundary.index()].sides.map(|side| faces.get(&(side.grain()?, key)).copied())
        };
        both.map(at).collect()
    }
}

fn sorted(mut corners: [u32; 3]) -> [u32; 3] {
    corners.sort_unstable();
    corners
}
