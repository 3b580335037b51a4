//! Points of least bending, each within its box.

use cancellation::check_cancelled;
use glam::{BVec3, BVec3A, DVec3, I8Vec3, UVec3, Vec3, Vec3A};
use rayon::prelude::*;

use crate::mesh::id::id;
use crate::voxels::copies::across;
use crate::voxels::graph::Graph;
use crate::voxels::lattice::Lattice;
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
    /// The boxes around places of a lattice.
    pub(super) fn new(places: &'a [UVec3], lattice: &Lattice<'_>, within: f64) -> Self {
        Self {
            places,
            last: UVec3::from_array(lattice.shape.map(id)),
            is_periodic: lattice.periodic.into(),
            periods: lattice.periods(),
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

/// The points x for which this is least, each within its box, in units of the edge of a voxel:
///
/// sum of |x - where it starts|^2 + `bending` (sum inside boundaries of |x - mean of its neighbours|^2 + sum along lines of |x - mean of both neighbours along the line|^2).
///
/// `starts` are displacements from the middles of the boxes. `progress` is told how many steps of how many are done.
///
/// A projected gradient with constant momentum (Nesterov, Introductory lectures on convex optimization, 2004, section 2.2.4); each point has the step that its row of the matrix allows.
/// The search is for displacements, in single precision: they are below 1, so this is exact to 1e-7 of a voxel.
pub(super) fn least_bending(
    graph: &Graph,
    starts: &[Vec3],
    boxes: &Boxes<'_>,
    tuning: &VoxelTuning,
    progress: &(impl Fn(usize, usize) + Sync),
) -> Vec<DVec3> {
    let count = graph.count();
    // Of one point in the mean that a point follows.
    let share = |point: usize| match graph.followed(point).len() {
        0 => 0.0,
        followed => 1.0 / followed as f32,
    };
    let steps: Vec<f32> = (0..count)
        .into_par_iter()
        .map(|point| {
            // Rows of the matrix of means have the sum 2 at most; so this bounds the sum of a row of its square.
            let own = if graph.followed(point).is_empty() { 0.0 } else { 1.0 };
            let sum: f32 = graph.followers(point).map(|other| share(other as usize)).sum();
            1.0 / (1.0 + tuning.bending * 2.0 * (own + sum))
        })
        .collect();
    // The distances from the starts alone curve the sum by 1: this is the root of its least curvature as a share of the largest.
    let curvature = steps.iter().copied().fold(1.0, f32::min).sqrt();
    let momentum = (1.0 - curvature) / (1.0 + curvature);
    // Of the lattice: whole numbers of edges.
    let bend_of_middle = |point: usize| {
        let middle = |point: u32| boxes.middle(point as usize);
        let followed = graph.followed(point).iter();
        let from = followed.map(|other| across(boxes.periods, middle(*other), boxes.middle(point)));
        from.sum::<DVec3>().as_i8vec3()
    };
    let bends_of_middles: Vec<I8Vec3> = (0..count).into_par_iter().map(bend_of_middle).collect();
    let mut points: Vec<Vec3A> = starts.iter().map(|start| Vec3A::from(*start)).collect();
    let mut ahead = points.clone();
    // Distances from means, each times the share of one point in its mean.
    let mut bends = vec![Vec3A::ZERO; count];
    let within = DVec3::splat(boxes.within).as_vec3a();
    for step in 0..tuning.bending_steps {
        check_cancelled();
        progress(step, tuning.bending_steps);
        bends.par_iter_mut().enumerate().for_each(|(point, bend)| {
            let followed = graph.followed(point);
            let sum: Vec3A = followed.iter().map(|other| ahead[*other as usize]).sum();
            let all = bends_of_middles[point].as_vec3a() + ahead[point] * followed.len() as f32 - sum;
            *bend = all * share(point) * share(point);
        });
        points.par_iter_mut().zip(&mut ahead).enumerate().for_each(|(point, (at, ahead))| {
            let from: Vec3A = graph.followers(point).map(|other| bends[other as usize]).sum();
            let own = bends[point] * graph.followed(point).len() as f32;
            let slope = *ahead - Vec3A::from(starts[point]) + tuning.bending * (own - from);
            let next = (*ahead - slope * steps[point]).clamp(-within, within);
            let is_fixed = BVec3A::from_array(boxes.is_fixed(point).into());
            let next = Vec3A::select(is_fixed, Vec3A::ZERO, next);
            *ahead = next + (next - *at) * momentum;
            *at = next;
        });
    }
    let place = |(point, displacement): (usize, &Vec3A)| boxes.middle(point) + displacement.as_dvec3();
    points.par_iter().enumerate().map(place).collect()
}
