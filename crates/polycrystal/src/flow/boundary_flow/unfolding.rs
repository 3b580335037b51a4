//! What becomes of a start that subdivision folds.

use glam::DVec3;
use subzero::EdgeId;

use super::{Flow, LevelSectors, displaced};
use crate::Mesh;
use crate::flow::tangential::tangential_moves;
use crate::mesh::id::id;

/// Most steps of either kind where a start is folded by subdivision, and the share of its way that a point goes. The walls of a host whose cells
/// are as flat as a fiftieth of it take one step.
const UNFOLDING_STEPS: usize = 10;
const UNFOLDING: f64 = 0.5;

impl Flow<'_> {
    /// Points that fold the finest level, moved until they do not: a boundary of several faces has points inside that are crowded, so that
    /// subdivision puts triangles there over each other even in a plane, and edges inside that are sharp. The first are centred within their
    /// boundaries, and where folds remain, they go to the middle of their neighbours. Nothing where no point is to move.
    pub(super) fn unfolded(&self, start: &[DVec3]) -> Option<Vec<DVec3>> {
        let finest = LevelSectors::new(self.network, self.finest());
        let mut points = start.to_vec();
        let mut places = self.folded_places(&self.finest_points(&points), &finest);
        let mut best = (places.len(), None);
        for step in 0..2 * UNFOLDING_STEPS {
            if places.is_empty() {
                break;
            }
            let moves = if step < UNFOLDING_STEPS {
                tangential_moves(self.network, self.level, &self.patches, &points, UNFOLDING)
            } else {
                self.rounding(&points, &places)
            };
            points = displaced(&points, &moves);
            places = self.folded_places(&self.finest_points(&points), &finest);
            if places.len() < best.0 {
                best = (places.len(), Some(points.clone()));
            } else if step + 1 == UNFOLDING_STEPS {
                points = best.1.clone().unwrap_or_else(|| start.to_vec());
            }
        }
        best.1
    }

    /// A step of the points inside boundaries and on lines that some places depend on, toward the middle of their neighbours.
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
            let step = *by * (UNFOLDING / counts[place]);
            *by = if moves_it { self.freedom(id(place)).project(step) } else { DVec3::ZERO };
        }
        moves
    }
}
