//! Edges that are too short for their ends to be told apart.
//!
//! Seeds that nearly form a lattice have vertices that nearly coincide: four seeds off a face-centred lattice by 1e-8 of the box
//! make faces 1e-16 of it wide. The cells are right, but what is made of them needs the directions of such edges, and these are
//! rounding errors.

use crate::diagram::united_vertices::UnitedVertices;
use crate::diagram::whole_cells::unwrapped;
use crate::{CellId, Tessellation};

/// Shortest edge that has a direction, relative to the largest coordinate of the domain or its extent. Vertices are some 1e-16 of
/// that beside their exact places, a few times more where planes meet at small angles; so this edge's direction is right to a
/// hundredth.
const RESOLUTION: f64 = 1e-13;

impl Tessellation {
    /// The complex in which the ends of each edge below the resolution of double precision are one vertex: 1e-13 of the domain's
    /// extent, or of its largest coordinate. Faces that are left with two edges vanish. Nothing where
    /// there is no such edge, or a cell would vanish as well.
    ///
    /// Vertices that nearly coincide so meet as those do that exactly coincide, and no cell changes its volume by more than
    /// rounding does.
    #[must_use]
    pub fn resolved(&self) -> Option<Self> {
        let domain = self.domain();
        let extent =
            domain.size().max_element().max(domain.lower().abs().max(domain.upper().abs()).max_element());
        let resolution = RESOLUTION * extent;
        let count = self.vertices().len() - self.periodic_vertices().len();
        let mut united = UnitedVertices::new(count);
        let mut is_resolved = true;
        for face in self.faces() {
            let corners = self.face_corners(face);
            for (start, end) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                let [at_start, at_end] = [start, end].map(|vertex| self.vertices()[vertex.index()]);
                if at_start.distance(at_end) < resolution {
                    united.unite(self.periodic_vertex(*start), self.periodic_vertex(*end));
                    is_resolved = false;
                }
            }
        }
        if is_resolved {
            return None;
        }
        let mut resolved = unwrapped(domain, self.seeds(), &united.faces(self), &self.vertices()[..count]);
        resolved.list_faces_of_cells_in_order();
        let fewest_faces = domain.dimension().fewest_faces();
        let is_kept = |cell| resolved.cell_faces(cell).len() >= fewest_faces.min(self.cell_faces(cell).len());
        (0u32..).map(CellId).take(self.cell_count()).all(is_kept).then_some(resolved)
    }
}
