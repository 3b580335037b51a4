//! Points of least bending, each within its box.

use std::ops::Range;

use cancellation::check_cancelled;
use glam::{BVec3, BVec3A, DVec3, I8Vec3, UVec3, Vec3, Vec3A};
use rayon::prelude::*;

use crate::mesh::id::id;
use crate::solver::chebyshev::Chebyshev;
use crate::voxels::copies::across;
use crate::voxels::graph::{Graph, Part, few};
use crate::voxels::labels::Grid;
use crate::voxels::tuning::VoxelTuning;

/// The places of points, and how these may move from there: by [`VoxelTuning::within`] along each axis that is free.
pub(super) struct Boxes<'a> {
    pub(super) places: &'a [UVec3],
    /// The last place along each axis; at it, and at 0, points are on walls and stay there.
    last: UVec3,
    is_periodic: BVec3,
    /// Lengths of the periods; 0 along other axes.
    pub(super) periods: DVec3,
    within: f64,
}

impl<'a> Boxes<'a> {
    /// The boxes around places of the lattice between voxels.
    pub(super) fn new(places: &'a [UVec3], grid: &Grid, within: f64) -> Self {
        Self {
            places,
            last: UVec3::from_array(grid.shape.map(id)),
            is_periodic: grid.domain.periodic(),
            periods: grid.periods(),
            within,
        }
    }

    /// The middle of a point's box.
    pub(super) fn middle(&self, point: usize) -> DVec3 {
        self.places[point].as_dvec3()
    }

    /// The axes along which a point stays.
    pub(super) fn is_fixed(&self, point: usize) -> BVec3 {
        let place = self.places[point];
        (place.cmpeq(UVec3::ZERO) | place.cmpeq(self.last)) & !self.is_periodic
    }

    /// The place within a point's box that is nearest to one.
    pub(super) fn nearest(&self, point: usize, place: DVec3) -> DVec3 {
        let middle = self.middle(point);
        let free = place.clamp(middle - self.within, middle + self.within);
        DVec3::select(self.is_fixed(point), middle, free)
    }
}

/// What a step needs of a point.
#[derive(Clone, Copy)]
struct Row {
    /// The first of its neighbours among those of all points.
    first: usize,
    /// How many of them it follows, from the first one on.
    followed: u8,
    /// After how many of them those come that follow it, and how many they are.
    followers: [u8; 2],
    /// The axes that it stays on, a bit each.
    fixed: u8,
    /// How far the middle of its box is from the mean of the middles of those that it follows, times their number: whole edges.
    bend_of_middle: I8Vec3,
    part: Part,
}

impl Row {
    fn new(graph: &Graph, boxes: &Boxes<'_>, point: usize) -> Self {
        let followed = graph.followed(point);
        let middle = boxes.middle(point);
        let from = |other: &u32| across(boxes.periods, boxes.middle(*other as usize), middle);
        let [fixed, ..] = boxes.is_fixed(point).bitmask().to_le_bytes();
        let Range { start, end } = graph.followers_among_neighbors(point);
        Self {
            first: graph.first_neighbor(point),
            followed: few(followed.len()),
            followers: [start, end - start],
            fixed,
            bend_of_middle: followed.iter().map(from).sum::<DVec3>().as_i8vec3(),
            part: graph.part(point),
        }
    }

    /// That of one point in the mean that this one follows.
    fn share(self) -> f32 {
        1.0 / f32::from(self.followed.max(1))
    }

    fn followed(self, neighbors: &[u32]) -> &[u32] {
        &neighbors[self.first..][..usize::from(self.followed)]
    }

    fn followers(self, neighbors: &[u32]) -> &[u32] {
        let [before, count] = self.followers.map(usize::from);
        &neighbors[self.first + before..][..count]
    }
}

/// How much a point counts in the sum that is to be least.
struct Weights {
    /// Its distance from where it starts.
    pull: f32,
    /// Its distance from the mean of those that it follows.
    bending: f32,
}

impl Weights {
    fn new(part: Part, tuning: &VoxelTuning) -> Self {
        match part {
            Part::Boundary => Self { pull: 1.0, bending: tuning.bending },
            Part::BesideLine => {
                Self { pull: tuning.pull_beside_lines, bending: tuning.bending_beside_lines * tuning.bending }
            }
            Part::Line => Self { pull: 1.0, bending: tuning.bending_of_lines * tuning.bending },
            Part::Node => Self { pull: 1.0, bending: 0.0 },
        }
    }
}

/// The points x for which this is least, each within its box, in units of the edge of a voxel:
///
/// sum of `pull` |x - where it starts|^2 + sum of `bending` |x - mean of those that it follows|^2,
///
/// where points of lines follow both neighbours along the line, and those inside boundaries all their neighbours.
///
/// `starts` are displacements from the middles of the boxes. `progress` is told how many steps of how many are done.
///
/// Chebyshev's semi-iteration (Golub and Varga 1961), where each point has the step that its row of the matrix allows, and stays within its box.
/// The search is for displacements, in single precision: they are below 1, so this is exact to 1e-7 of a voxel.
pub(super) fn least_bending(
    graph: &Graph,
    starts: &[Vec3],
    boxes: &Boxes<'_>,
    tuning: &VoxelTuning,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Vec<DVec3> {
    let count = graph.count();
    let row = |point: usize| Row::new(graph, boxes, point);
    let rows: Vec<Row> = (0..count).into_par_iter().map(row).collect();
    let neighbors = graph.neighbors();
    let weights =
        [Part::Boundary, Part::BesideLine, Part::Line, Part::Node].map(|part| Weights::new(part, tuning));
    let weights_of = |row: &Row| &weights[row.part as usize];
    let step = |row: &Row| {
        // Rows of the matrix of means have the sum 2 at most; so this bounds the sum of a row of its square.
        let of_follower = |other: &u32| {
            let other = &rows[*other as usize];
            other.share() * weights_of(other).bending
        };
        let sum: f32 = row.followers(neighbors).iter().map(of_follower).sum();
        let Weights { pull, bending } = weights_of(row);
        1.0 / (pull + 2.0 * (bending + sum))
    };
    let steps: Vec<f32> = rows.par_iter().map(step).collect();
    // The distances from the starts alone curve the sum by 1 or more. So curvatures, times steps, are between the least step and 1.
    let least = tuning.least_curvature * steps.iter().copied().fold(1.0, f32::min);
    let mut acceleration = Chebyshev::new(least.min(0.5));
    // Zero along the axes that a point stays on.
    let within = DVec3::splat(boxes.within).as_vec3a();
    let ways: [Vec3A; 8] = std::array::from_fn(|fixed| {
        let is_fixed = BVec3A::new(fixed & 1 != 0, fixed & 2 != 0, fixed & 4 != 0);
        Vec3A::select(is_fixed, Vec3A::ZERO, within)
    });
    let mut points: Vec<Vec3A> = starts.iter().map(|start| Vec3A::from(*start)).collect();
    let mut moves = vec![Vec3A::ZERO; count];
    // Distances from means, each times the share of one point in its mean.
    let mut bends = moves.clone();
    for step in 0..tuning.bending_steps {
        check_cancelled();
        progress(step, tuning.bending_steps);
        bends.par_iter_mut().zip(&rows).zip(&points).for_each(|((bend, row), at)| {
            let sum: Vec3A = row.followed(neighbors).iter().map(|other| points[*other as usize]).sum();
            let all = row.bend_of_middle.as_vec3a() + *at * f32::from(row.followed) - sum;
            *bend = all * (row.share() * row.share() * weights_of(row).bending);
        });
        let [of_last, of_slope] = acceleration.next();
        let moving = points.par_iter_mut().zip(&mut moves).zip(&bends).zip(&rows).zip(&steps).zip(starts);
        moving.for_each(|(((((at, last), bend), row), step), start)| {
            let from: Vec3A = row.followers(neighbors).iter().map(|other| bends[*other as usize]).sum();
            let own = *bend * f32::from(row.followed);
            let slope = (*at - Vec3A::from(*start)) * weights_of(row).pull + own - from;
            let way = ways[usize::from(row.fixed)];
            let next = (*at + *last * of_last - slope * (*step * of_slope)).clamp(-way, way);
            *last = next - *at;
            *at = next;
        });
    }
    // Boxes in single precision are larger by 1e-8 of a voxel.
    let place = |(point, displacement): (usize, &Vec3A)| {
        boxes.nearest(point, boxes.middle(point) + displacement.as_dvec3())
    };
    points.par_iter().enumerate().map(place).collect()
}
