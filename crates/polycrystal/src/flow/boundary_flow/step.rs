//! A step of curvature flow.

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;
use voronoi::Dimension;

use super::{Flow, displaced};
use crate::flow::assembly::gradient;
use crate::flow::boundary_flow::level_elements::LevelElements;
use crate::flow::giving_way::GivingWay;
use crate::flow::relaxation::TIME_OF_KEPT_TOPOLOGY;
use crate::flow::tangential::tangential_moves;
use crate::flow::tied_points::Numbering;
use crate::mesh::fold::{LARGEST_FOLD, are_apart, is_folded};
use crate::mesh::level_points::LevelPoints;
use crate::mesh::rounding;
use crate::mesh::volume::volumes_of_grains;
use crate::{Freedom, NetworkError, Volumes};

/// What a step found.
pub(super) struct Taken {
    /// The energy where it began.
    pub(super) energy: f64,
    /// The control points of each place that had to give way.
    pub(super) broken: Vec<Vec<u32>>,
}

impl Flow<'_> {
    /// One step of points, and of the surface with them. What the step would fold gives way.
    ///
    /// # Errors
    /// [`NetworkError::Folded`]
    pub(super) fn take_step(
        &self,
        points: &mut Vec<DVec3>,
        surface: &mut Vec<DVec3>,
        time: f64,
    ) -> Result<Taken, NetworkError> {
        let terms = self.patches.terms(points);
        let volumes = volumes_of_grains(self.network.boundaries(), &terms.cones, self.network.grain_count());
        let missing = self.missing(&volumes);
        let groups = self.with_short_edges(&self.tied, points).number();
        check_cancelled();
        let energy = terms.energy;
        let system = self.system(terms, &groups, time, points);
        let mut moves = match (self.volumes, self.network.domain().dimension()) {
            (Volumes::Kept, _) | (_, Dimension::Three) => system.displacement(&missing).0,
            (Volumes::Free, Dimension::Two) => {
                let gradient_after = |moves: &[DVec3]| {
                    let terms = self.patches.terms(&displaced(points, &groups.of_points(moves)));
                    gradient(&self.patches, &terms, &groups)
                };
                system.implicit_displacement(gradient_after)
            }
        };
        drop(system);
        check_cancelled();
        let centering = self.centering(time);
        if centering > 0.0 {
            let within = tangential_moves(self.network, self.level, &self.patches, points, centering);
            let within = groups.means(&within, |point| self.freedom(point));
            moves.iter_mut().zip(within).for_each(|(by, within)| *by += within);
        }
        let mut after = (Vec::new(), Vec::new());
        let mut broken_first = None;
        let broken = |moves: &[DVec3]| {
            let moved = displaced(points, &groups.of_points(moves));
            let refined = self.refined(&moved);
            let elements = self.broken_elements(surface, &refined).into_iter();
            let dependencies = elements.map(|element| self.dependencies(self.surface, element));
            let places: Vec<Vec<u32>> = dependencies.collect();
            after = (moved, refined);
            let of_groups = places.iter().map(|points| groups.of(points.iter().copied())).collect();
            broken_first.get_or_insert(places);
            of_groups
        };
        let mut giving_way = self.giving_way(&groups, points);
        match self.volumes {
            Volumes::Kept => giving_way.mend(&mut moves, broken)?,
            // What is smoothed does not grow.
            Volumes::Free => giving_way.mend_by_tying(&mut moves, broken)?,
        }
        drop(giving_way);
        (*points, *surface) = after;
        Ok(Taken { energy, broken: broken_first.unwrap_or_default() })
    }

    /// What gives way where groups of points start from here.
    pub(super) fn giving_way<'b>(&'b self, groups: &'b Numbering, start: &'b [DVec3]) -> GivingWay<'b> {
        let neighbors = move |group: u32| {
            let members = groups.members(group as usize).iter();
            let links =
                members.flat_map(|point| self.patches.links(*point).iter().map(|[end, _]| [*point, *end]));
            let others = links.map(|[point, end]| {
                (groups.numbers()[end as usize], start[point as usize].distance(start[end as usize]))
            });
            others.filter(|(other, _)| *other != group).collect()
        };
        GivingWay::new(neighbors, move |group| groups.freedom(group as usize, |point| self.freedom(point)))
    }

    /// How a control point can move.
    pub(super) fn freedom(&self, point: u32) -> Freedom {
        self.network.freedom(self.network.levels()[self.level].walls[point as usize])
    }

    /// The share of its way to the centre of the triangles around that a point goes in a step. Where grains grow, a step of no time moves
    /// nothing: points that move within a curved boundary leave it a little, and that counts as growth.
    fn centering(&self, time: f64) -> f64 {
        let usual =
            TIME_OF_KEPT_TOPOLOGY / self.tuning.coarse_steps as f64 * self.network.mean_grain_size().powi(2);
        match self.volumes {
            Volumes::Kept => self.tuning.centering,
            Volumes::Free => self.tuning.centering * (time / usual).min(1.0),
        }
    }

    /// Elements that a step has turned too far, or bent too far and more than they were; given the points of the level that carries the flow
    /// before and after.
    pub(super) fn broken_elements(&self, before: &[DVec3], after: &[DVec3]) -> Vec<u32> {
        // Growth is asked for step by step: where a line shrinks it bends, and what is held there would not grow as it should.
        let largest_bend = match self.volumes {
            Volumes::Kept => LARGEST_FOLD,
            Volumes::Free => -1.0,
        };
        let LevelElements { boundaries, neighbors } = &self.elements;
        let elements = self.network.level_from_before(self.surface).elements();
        let [before, after] = [before, after].map(|points| LevelPoints::held(elements, points));
        let of_boundary = |boundary: usize| {
            let [before, after] = [&before, &after].map(|points| boundaries.normals(boundary, points));
            let is_turned =
                |index: &usize| are_apart([&before, &after].map(|normals| normals[*index]), LARGEST_FOLD);
            let of_pair = |normals: &[DVec3], pair: [usize; 2]| pair.map(|index| normals[index]);
            let cosine = |pair: [DVec3; 2]| {
                let [a, b] = pair.map(DVec3::normalize_or_zero);
                a.dot(b)
            };
            let is_bent = |pair: [usize; 2]| {
                is_folded(of_pair(&after, pair), largest_bend)
                    && cosine(of_pair(&after, pair)) < cosine(of_pair(&before, pair)) - rounding::OF_COSINES
            };
            let mut broken: Vec<usize> = (0..after.len()).filter(is_turned).collect();
            neighbors.for_each_in(boundaries, boundary, |pair| {
                if is_bent(pair) {
                    broken.extend(pair);
                }
            });
            broken.into_iter().map(|index| boundaries.element(boundary, index)).collect::<Vec<u32>>()
        };
        (0..boundaries.boundary_count()).into_par_iter().flat_map_iter(of_boundary).collect()
    }
}

#[cfg(test)]
mod tests {
    use voronoi::{Domain, Tessellation};

    use super::*;
    use crate::flow::adaptive_steps::Evolution;
    use crate::{GrainId, Junctions, Network, Tuning, Volumes};

    /// Six cells around one in the middle of a cube, a hundredth of its width, and one beside each wall. The one in the middle is the last.
    fn cluster() -> (Network, Vec<DVec3>) {
        let ways = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
        let around = |distance: f64| ways.map(|way| DVec3::splat(0.5) + distance * way);
        let seeds: Vec<DVec3> =
            around(0.01).into_iter().chain(around(0.4)).chain([DVec3::splat(0.5)]).collect();
        let cells = Tessellation::new(&Domain::unit_cube(), &seeds).expect("distinct seeds");
        Network::new(&cells, Junctions::Crease, 1).expect("cells of different sizes")
    }

    fn flow(network: &Network) -> Flow<'_> {
        Flow::new(network, 0, Volumes::Kept, network.mean_tension(), Tuning::default())
    }

    /// The way of each point. Without periodic boundaries each point is a group of its own.
    fn ways(start: &[DVec3], points: &[DVec3]) -> Vec<DVec3> {
        points.iter().zip(start).map(|(to, from)| *to - *from).collect()
    }

    /// The points within a hundredth around the middle: those of the small grain.
    fn points_in_the_middle(start: &[DVec3]) -> Vec<u32> {
        let distances = (0u32..).zip(start).map(|(point, at)| (point, at.distance(DVec3::splat(0.5))));
        distances.filter(|(_, distance)| *distance < 0.01).map(|(point, _)| point).collect()
    }

    /// The grain in the middle goes twenty times its width, but for two of its points.
    #[test]
    fn points_that_stay_behind_follow_their_small_grain() {
        let (network, start) = cluster();
        let flow = flow(&network);
        let volume = |points: &Vec<DVec3>| flow.volumes(points)[GrainId(12).index()];
        let own = points_in_the_middle(&start);
        let mut points = start.clone();
        own[2..].iter().for_each(|point| points[*point as usize] += DVec3::X * 0.2);
        assert!((volume(&points) - volume(&start)).abs() > volume(&start));
        let copies = flow.copies.number();
        let mut moves = ways(&start, &points);
        flow.giving_way(&copies, &start).smooth(&mut moves, own[..2].iter().copied());
        let after = displaced(&start, &moves);
        assert!(
            (volume(&after) - volume(&start)).abs() < 0.1 * volume(&start),
            "{} {}",
            volume(&after),
            volume(&start)
        );
        own[2..].iter().for_each(|point| assert_eq!(after[*point as usize], points[*point as usize]));
    }

    /// Rings around a place grow each time: in the end all points but those in corners are carried along, and these hold them.
    #[test]
    fn what_folds_again_and_again_goes_back_to_the_start() {
        let (network, start) = cluster();
        let flow = flow(&network);
        let own = points_in_the_middle(&start);
        let mut points = start.clone();
        own.iter().for_each(|point| points[*point as usize] += DVec3::new(0.2, 0.1, 0.0));
        let copies = flow.copies.number();
        let mut giving_way = flow.giving_way(&copies, &start);
        let farthest = |moves: &[DVec3]| moves.iter().map(|by| by.length()).fold(0.0, f64::max);
        let mut moves = ways(&start, &points);
        let mut distances = vec![farthest(&moves)];
        for _ in 0..8 {
            giving_way.smooth(&mut moves, own.iter().copied());
            distances.push(farthest(&moves));
        }
        assert!(distances.windows(2).all(|pair| pair[1] <= pair[0]), "{distances:?}");
        assert!(distances[8] < 0.01 * distances[0], "{distances:?}");
    }
}
