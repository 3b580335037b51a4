//! What folds in the end of a stage gives way: the motion of the points around is smoothed.

use glam::DVec3;

use super::Flow;
use crate::flow::tied_points::{Numbering, TiedPoints};
use crate::mesh::grouped::Grouped;
use crate::{Freedom, Mesh};

/// Most sweeps over the points that give way, and the change of a motion, as a share of the longest of all, below which a sweep is the last.
const SWEEPS: usize = 100;
const SETTLED: f64 = 1e-4;

/// Length of an edge whose ends coincide, so that the other weights count nothing beside its own and products with them stay finite.
const NO_LENGTH: f64 = 1e-150;

/// Points of a level of which the motion since the start of a stage is smoothed where they fold.
///
/// Each then moves by the mean of its neighbours, weighted by one over the distance to them at the start: what lies between points that give way is carried along, and keeps the shape that it had.
/// A small grain that drifts by many times its width with a cluster stays what it is.
pub(super) struct GivingWay<'a> {
    start: &'a [DVec3],
    /// Copies on periodic boundaries move as one.
    copies: Numbering,
    freedoms: Vec<Freedom>,
    /// Of each point that is no copy, or the first of its copies: those at the other ends of its edges, with their weights.
    neighbors: Grouped<(u32, f64)>,
    /// How often each of these was in a place that folded.
    times: Vec<usize>,
}

impl<'a> GivingWay<'a> {
    pub(super) fn new(flow: &Flow<'_>, start: &'a [DVec3]) -> Self {
        let copies = TiedPoints::new(&flow.network.levels()[flow.level]).number();
        let freedom = |group| copies.freedom(group, |point| flow.freedom(point));
        let freedoms: Vec<Freedom> = (0..copies.group_count()).map(freedom).collect();
        let edges: Vec<[u32; 2]> = match flow.control_mesh() {
            Mesh::Triangles(mesh) => mesh.edges().collect(),
            Mesh::Segments(mesh) => mesh.segments().to_vec(),
        };
        let numbers = copies.numbers();
        let half_edges = edges.iter().flat_map(|[a, b]| {
            let length = start[*a as usize].distance(start[*b as usize]);
            let weight = 1.0 / length.max(NO_LENGTH);
            let [a, b] = [a, b].map(|point| numbers[*point as usize]);
            [(a as usize, (b, weight)), (b as usize, (a, weight))]
        });
        let neighbors = Grouped::new(freedoms.len(), half_edges);
        let times = vec![0; freedoms.len()];
        Self { start, copies, freedoms, neighbors, times }
    }

    /// Where points are after so many rings around each place gave way as often as it folded, this time included.
    pub(super) fn points(&mut self, points: &[DVec3], places: &[Vec<u32>]) -> Vec<DVec3> {
        let numbers = self.copies.numbers();
        let mut folded: Vec<u32> = places.iter().flatten().map(|point| numbers[*point as usize]).collect();
        folded.sort_unstable();
        folded.dedup();
        folded.iter().for_each(|group| self.times[*group as usize] += 1);
        let giving_way = self.within_rings();
        let of_first = |group| self.copies.members(group)[0] as usize;
        let mut moves: Vec<DVec3> = (0..self.times.len())
            .map(|group| points[of_first(group)] - self.start[of_first(group)])
            .collect();
        let longest = moves.iter().map(|by| by.length()).fold(0.0, f64::max);
        for _ in 0..SWEEPS {
            let mut largest_change = 0.0f64;
            for group in &giving_way {
                let neighbors = self.neighbors.of(*group);
                let weight: f64 = neighbors.iter().map(|(_, weight)| weight).sum();
                let sum: DVec3 =
                    neighbors.iter().map(|(other, weight)| moves[*other as usize] * *weight).sum();
                let by = self.freedoms[*group].project(sum / weight);
                largest_change = largest_change.max(by.distance(moves[*group]));
                moves[*group] = by;
            }
            if largest_change <= SETTLED * longest {
                break;
            }
        }
        let mut after = points.to_vec();
        for group in giving_way {
            let members = self.copies.members(group).iter();
            members.for_each(|point| after[*point as usize] = self.start[*point as usize] + moves[group]);
        }
        after
    }

    /// The points that give way, in order.
    fn within_rings(&self) -> Vec<usize> {
        let mut rings = self.times.clone();
        for _ in 1..self.times.iter().copied().max().unwrap_or(0) {
            let before = rings.clone();
            for (group, rings) in rings.iter_mut().enumerate() {
                let around = self.neighbors.of(group).iter().map(|(other, _)| before[*other as usize]);
                *rings = (*rings).max(around.max().unwrap_or(0).saturating_sub(1));
            }
        }
        (0..rings.len()).filter(|group| rings[*group] > 0).collect()
    }
}

#[cfg(test)]
mod tests {
    use voronoi::{Domain, Tessellation};

    use super::*;
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
        let volume = |points: &[DVec3]| flow.volumes_at(points)[GrainId(12).index()];
        let own = points_in_the_middle(&start);
        let mut points = start.clone();
        own[2..].iter().for_each(|point| points[*point as usize] += DVec3::X * 0.2);
        assert!((volume(&points) - volume(&start)).abs() > volume(&start));
        let after = GivingWay::new(&flow, &start).points(&points, &[own[..2].to_vec()]);
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
        let mut giving_way = GivingWay::new(&flow, &start);
        let farthest =
            |points: &[DVec3]| points.iter().zip(&start).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        let mut distances = vec![farthest(&points)];
        for _ in 0..8 {
            points = giving_way.points(&points, std::slice::from_ref(&own));
            distances.push(farthest(&points));
        }
        assert!(distances.windows(2).all(|pair| pair[1] <= pair[0]), "{distances:?}");
        assert!(distances[8] < 0.01 * distances[0], "{distances:?}");
    }
}
