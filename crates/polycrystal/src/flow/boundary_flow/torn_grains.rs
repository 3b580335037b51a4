//! Grains that are torn where only some of their points move as one.

use glam::DVec3;

use super::{Flow, displaced};
use crate::{BoundaryId, GrainId};

/// Share of its volume that a grain loses or wins where it is torn: what is left cannot be made right by small motions.
const TORN: f64 = 0.5;

impl Flow<'_> {
    /// Where points are when what is joined has moved as one since the start, for an attempt that is counted from 0.
    ///
    /// Points of a small grain that move as one with others leave the rest of it behind, though it has gone many times its own size: in a cluster of grains of a hundredth of the others' size,
    /// some had ten thousand times their volume. Such a grain moves as one too.
    pub(super) fn moved_as_one(&mut self, points: &[DVec3], start: &[DVec3], attempt: usize) -> Vec<DVec3> {
        let mut moves: Vec<DVec3> = points.iter().zip(start).map(|(point, start)| *point - *start).collect();
        let before = self.volumes_at(points);
        self.groups.unite(&mut moves, |point| self.freedom(point), attempt);
        loop {
            let moved = displaced(start, &moves);
            let torn = self.torn(&before, &self.volumes_at(&moved));
            if torn.is_empty() {
                return moved;
            }
            torn.iter().for_each(|points| self.groups.join_all(points));
            self.groups.unite(&mut moves, |point| self.freedom(point), 0);
        }
    }

    /// The points of each grain that is torn, given the volumes of all before and after; none whose points move as one already.
    fn torn(&self, before: &[f64], after: &[f64]) -> Vec<Vec<u32>> {
        let grains = (0u32..).map(GrainId).zip(before.iter().zip(after));
        let torn = grains.filter(|(_, (before, after))| (*after - *before).abs() > TORN * before.abs());
        let torn = torn.map(|(grain, _)| self.points_of(grain));
        torn.filter(|points| self.groups.set_count(points) > 1).collect()
    }

    /// The control points of a grain, in order.
    fn points_of(&self, grain: GrainId) -> Vec<u32> {
        let elements = self.network.level(self.level).elements();
        let boundaries = &self.network.levels()[self.level].boundary_of;
        let is_of_grain = |boundary: BoundaryId| {
            let sides = self.network.boundaries()[boundary.index()].sides;
            sides.iter().any(|side| side.grain() == Some(grain))
        };
        let own = (0u32..).zip(boundaries).filter(|(_, boundary)| is_of_grain(**boundary));
        let mut points: Vec<u32> = own.flat_map(|(element, _)| elements.corners(element).to_vec()).collect();
        points.sort_unstable();
        points.dedup();
        points
    }
}

#[cfg(test)]
mod tests {
    use voronoi::{Domain, Tessellation};

    use super::*;
    use crate::{Freedom, Junctions, Network, Tuning, Volumes};

    /// Six cells around one in the middle of a cube, a hundredth of its width, and one beside each wall. The one in the middle is the last.
    fn cluster() -> (Network, Vec<DVec3>) {
        let ways = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
        let around = |distance: f64| ways.map(|way| DVec3::splat(0.5) + distance * way);
        let seeds: Vec<DVec3> =
            around(0.01).into_iter().chain(around(0.4)).chain([DVec3::splat(0.5)]).collect();
        let cells = Tessellation::new(&Domain::unit_cube(), &seeds).expect("distinct seeds");
        Network::new(&cells, Junctions::Crease, 1).expect("cells of different sizes")
    }

    /// The grain in the middle goes twenty times its width, but one of its points, which is joined with a far one, goes half as far.
    #[test]
    fn a_small_grain_of_which_one_point_stays_behind_moves_as_one() {
        let (network, start) = cluster();
        let small = GrainId(12);
        let mut flow = Flow::new(&network, 0, Volumes::Kept, network.mean_tension(), Tuning::default());
        let own = flow.points_of(small);
        let is_far = |point: &u32| {
            start[*point as usize].distance(DVec3::splat(0.5)) > 0.1
                && flow.freedom(*point) == Freedom::Everywhere
        };
        let far = (0u32..).take(start.len()).find(is_far).expect("between the cluster and the others");
        flow.groups.join_all(&[own[0], far]);
        let mut points = start.clone();
        own.iter().for_each(|point| points[*point as usize] += DVec3::X * 0.2);
        let mut torn = points.clone();
        torn[own[0] as usize] -= DVec3::X * 0.1;
        assert!(!flow.torn(&flow.volumes_at(&start), &flow.volumes_at(&torn)).is_empty());
        let moved = flow.moved_as_one(&points, &start, 0);
        let volume = |points: &[DVec3]| flow.volumes_at(points)[small.index()];
        assert!((volume(&moved) - volume(&start)).abs() < 1e-9 * volume(&start));
        let by = |point: u32| moved[point as usize] - start[point as usize];
        assert!(by(far).x > 0.0 && own.iter().all(|point| by(*point) == by(far)));
    }
}
