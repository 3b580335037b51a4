//! Rounding of what was folded before anything moved.

use glam::DVec3;
use subzero::EdgeId;

use super::Flow;
use crate::Mesh;
use crate::mesh::id::id;

impl Flow<'_> {
    /// The way of the points inside boundaries and on lines that some places depend on to the middle of their neighbours.
    pub(super) fn rounding(&self, points: &[DVec3], places: &[Vec<u32>]) -> Vec<DVec3> {
        let mut moves = vec![DVec3::ZERO; points.len()];
        let Mesh::Triangles(mesh) = self.control_mesh() else { return moves };
        let mut is_moved = vec![false; points.len()];
        places.iter().flatten().for_each(|point| is_moved[*point as usize] = true);
        let mut counts = vec![0.0; points.len()];
        let mut crease_counts = vec![0; points.len()];
        for (edge, ends) in (0..).map(EdgeId).zip(mesh.edges()) {
            let [a, b] = ends.map(|end| end as usize);
            if mesh.is_crease(edge) {
                crease_counts[a] += 1;
                crease_counts[b] += 1;
            }
            let way = points[b] - points[a];
            moves[a] += way;
            moves[b] -= way;
            counts[a] += 1.0;
            counts[b] += 1.0;
        }
        for (place, by) in moves.iter_mut().enumerate() {
            // What lies within a line can move, also where all points on lines are corners.
            let moves_it = is_moved[place] && matches!(crease_counts[place], 0 | 2);
            let step = *by / counts[place];
            *by = if moves_it { self.freedom(id(place)).project(step) } else { DVec3::ZERO };
        }
        moves
    }
}
