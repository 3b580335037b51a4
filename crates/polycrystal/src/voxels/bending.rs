//! Points of least bending, each within its box.

use cancellation::check_cancelled;
use glam::{BVec3, BVec3A, DVec3, Vec3A};
use rayon::prelude::*;

use crate::mesh::grouped::Grouped;
use crate::mesh::id::id;
use crate::voxels::copies::across;
use crate::voxels::graph::Graph;
use crate::voxels::lattice::{Lattice, Place};
use crate::voxels::tuning::VoxelTuning;

/// Where points started, and how they may move: by [`VoxelTuning::within`] along each axis that is free.
pub(super) struct Boxes {
    pub(super) middles: Vec<DVec3>,
    pub(super) is_fixed: Vec<BVec3>,
    /// Lengths of the periods; 0 along other axes.
    pub(super) periods: DVec3,
    within: f64,
}

impl Boxes {
    /// The boxes around places. Points on walls of the lattice stay there.
    pub(super) fn new(places: &[Place], lattice: &Lattice, within: f64) -> Self {
        let middle = |place: &Place| DVec3::from_array(place.map(|at| at as f64));
        Self {
            middles: places.par_iter().map(middle).collect(),
            is_fixed: places.par_iter().map(|place| lattice.is_on_walls(*place)).collect(),
            periods: lattice.periods(),
            within,
        }
    }

    /// The place within a point's box that is nearest to one.
    pub(super) fn nearest(&self, point: usize, place: DVec3) -> DVec3 {
        let middle = self.middles[point];
        let free = place.clamp(middle - self.within, middle + self.within);
        DVec3::select(self.is_fixed[point], middle, free)
    }
}

/// The points x for which this is least, each within its box, in units of the edge of a voxel:
///
/// sum of |x - where it starts|^2 + `bending` (sum inside boundaries of |x - mean of its neighbours|^2 + sum along lines of |x - mean of both neighbours along the line|^2).
///
/// `progress` is told how many steps of how many are done.
///
/// A projected gradient with constant momentum (Nesterov, Introductory lectures on convex optimization, 2004, section 2.2.4); each point has the step that its row of the matrix allows.
/// The search is for displacements from the middles of the boxes, in single precision: they are below 1, so this is exact to 1e-7 of a voxel.
pub(super) fn least_bending(
    graph: &Graph,
    starts: &[DVec3],
    boxes: &Boxes,
    tuning: &VoxelTuning,
    progress: &(impl Fn(usize, usize) + Sync),
) -> Vec<DVec3> {
    let count = graph.count();
    let followers = Grouped::new(
        count,
        (0..count)
            .flat_map(|point| graph.followed(point).iter().map(move |other| (*other as usize, id(point)))),
    );
    let share = |point: usize| match graph.followed(point).len() {
        0 => 0.0,
        followed => 1.0 / followed as f32,
    };
    let shares: Vec<f32> = (0..count).into_par_iter().map(share).collect();
    let steps: Vec<f32> = (0..count)
        .into_par_iter()
        .map(|point| {
            // Rows of the matrix of means have the sum 2 at most; so this bounds the sum of a row of its square.
            let own = if shares[point] > 0.0 { 1.0 } else { 0.0 };
            let sum: f32 = followers.of(point).iter().map(|other| shares[*other as usize]).sum();
            1.0 / (1.0 + tuning.bending * 2.0 * (own + sum))
        })
        .collect();
    // The distances from the starts alone curve the sum by 1: this is the root of its least curvature as a share of the largest.
    let curvature = steps.iter().copied().fold(1.0, f32::min).sqrt();
    let momentum = (1.0 - curvature) / (1.0 + curvature);
    let bend_of_middle = |point: usize| {
        let followed = graph.followed(point).iter();
        let from =
            followed.map(|other| across(boxes.periods, boxes.middles[*other as usize], boxes.middles[point]));
        from.sum::<DVec3>().as_vec3a()
    };
    let bends_of_middles: Vec<Vec3A> = (0..count).into_par_iter().map(bend_of_middle).collect();
    let displacement = |(start, middle): (&DVec3, &DVec3)| (*start - *middle).as_vec3a();
    let starts: Vec<Vec3A> = starts.par_iter().zip(&boxes.middles).map(displacement).collect();
    let mut points = starts.clone();
    let mut ahead = starts.clone();
    // Distances from means, each times the share of one point in its mean.
    let mut bends = vec![Vec3A::ZERO; count];
    let within = DVec3::splat(boxes.within).as_vec3a();
    for step in 0..tuning.bending_steps {
        check_cancelled();
        progress(step, tuning.bending_steps);
        bends.par_iter_mut().enumerate().for_each(|(point, bend)| {
            let followed = graph.followed(point);
            let sum: Vec3A = followed.iter().map(|other| ahead[*other as usize]).sum();
            let all = bends_of_middles[point] + ahead[point] * followed.len() as f32 - sum;
            *bend = all * shares[point] * shares[point];
        });
        points.par_iter_mut().zip(&mut ahead).enumerate().for_each(|(point, (at, ahead))| {
            let from: Vec3A = followers.of(point).iter().map(|other| bends[*other as usize]).sum();
            let own = bends[point] * graph.followed(point).len() as f32;
            let slope = *ahead - starts[point] + tuning.bending * (own - from);
            let next = (*ahead - slope * steps[point]).clamp(-within, within);
            let is_fixed = BVec3A::from_array(boxes.is_fixed[point].into());
            let next = Vec3A::select(is_fixed, Vec3A::ZERO, next);
            *ahead = next + (next - *at) * momentum;
            *at = next;
        });
    }
    points.par_iter().zip(&boxes.middles).map(|(point, middle)| *middle + point.as_dvec3()).collect()
}
