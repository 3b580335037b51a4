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

    /// A step of the points inside boundaries and on lines that some places depend on, toward the middle of their neighbours, near ones counting more
    /// (scale-dependent umbrella: Desbrun et al., Implicit fairing, SIGGRAPH 1999). With equal weights, long edges beside a small grain drew its points out of it.
    pub(super) fn rounding(&self, points: &[DVec3], places: &[Vec<u32>]) -> Vec<DVec3> {
        let mut moves = vec![DVec3::ZERO; points.len()];
        let Mesh::Triangles(mesh) = self.control_mesh() else { return moves };
        let mut is_moved = vec![false; points.len()];
        places.iter().flatten().for_each(|point| is_moved[*point as usize] = true);
        let mut weights = vec![0.0; points.len()];
        let mut crease_counts = vec![0; points.len()];
        for (edge, ends) in (0..).map(EdgeId).zip(mesh.edges()) {
            let [a, b] = ends.map(|end| end as usize);
            if mesh.is_crease(edge) {
                crease_counts[a] += 1;
                crease_counts[b] += 1;
            }
            let way = points[b] - points[a];
            let length = way.length();
            if length > 0.0 {
                moves[a] += way / length;
                moves[b] -= way / length;
                weights[a] += 1.0 / length;
                weights[b] += 1.0 / length;
            }
        }
        for (place, by) in moves.iter_mut().enumerate() {
            // What lies within a line can move, also where all points on lines are corners.
            let moves_it = is_moved[place] && matches!(crease_counts[place], 0 | 2);
            let step = *by * (UNFOLDING / weights[place]);
            *by = if moves_it && weights[place] > 0.0 {
                self.freedom(id(place)).project(step)
            } else {
                DVec3::ZERO
            };
        }
        moves
    }
}

#[cfg(test)]
mod tests {
    use super::super::torn_grains::tests::cluster;
    use super::*;
    use crate::{GrainId, Tuning, Volumes};

    /// Its lines have edges of half its width, and edges of twenty times that to the centres of the boundaries that go out from there.
    #[test]
    fn rounding_leaves_the_points_of_a_small_grain_at_it() {
        let (network, start) = cluster();
        let flow = Flow::new(&network, 0, Volumes::Kept, network.mean_tension(), Tuning::default());
        let own = flow.points_of(GrainId(12));
        let width = 0.01;
        let moves = flow.rounding(&start, std::slice::from_ref(&own));
        let lengths: Vec<f64> = own.iter().map(|point| moves[*point as usize].length()).collect();
        assert!(lengths.iter().any(|length| *length > 1e-3 * width));
        assert!(lengths.iter().all(|length| *length < 0.25 * width), "{lengths:?}");
    }
}
