//! Points of least bending, each within its box.

use cancellation::check_cancelled;
use glam::{BVec3, DVec3};
use rayon::prelude::*;

use crate::voxels::graph::{Graph, Part};
use crate::voxels::lattice::{Lattice, Place};
use crate::voxels::tuning::VoxelTuning;

/// Points that are summed as one: few enough for all threads, many enough for each; the sum does not depend on the number of threads.
const CHUNK: usize = 4096;

/// Where points started, and how they may move: by [`VoxelTuning::within`] along each axis that is free.
pub(super) struct Boxes {
    pub(super) middles: Vec<DVec3>,
    pub(super) is_fixed: Vec<BVec3>,
    within: f64,
}

impl Boxes {
    /// The boxes around places. Points on walls of the lattice stay there.
    pub(super) fn new(places: &[Place], lattice: &Lattice, within: f64) -> Self {
        let middle = |place: &Place| DVec3::from_array(place.map(|at| at as f64));
        Self {
            middles: places.par_iter().map(middle).collect(),
            is_fixed: places.par_iter().map(|place| lattice.is_on_walls(*place)).collect(),
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
/// A projected gradient with acceleration that starts anew where it overshoots (Beck and Teboulle, 2009; O'Donoghue and Candès, 2015); each point has the step that its row of the matrix
/// allows.
pub(super) fn least_bending(
    graph: &Graph,
    starts: &[DVec3],
    boxes: &Boxes,
    tuning: &VoxelTuning,
    progress: &(impl Fn(usize, usize) + Sync),
) -> Vec<DVec3> {
    let count = graph.count();
    let share = |point: usize| match graph.followed(point).len() {
        0 => 0.0,
        followed => 1.0 / followed as f64,
    };
    let shares: Vec<f64> = (0..count).into_par_iter().map(share).collect();
    let followers = |point: usize| followers(graph, point);
    let steps: Vec<f64> = (0..count)
        .into_par_iter()
        .map(|point| {
            // Rows of the matrix of means have the sum 2 at most; so this bounds the sum of a row of its square.
            let own = if shares[point] > 0.0 { 1.0 } else { 0.0 };
            let sum: f64 = followers(point).map(|other| shares[other as usize]).sum();
            1.0 / (1.0 + tuning.bending * 2.0 * (own + sum))
        })
        .collect();
    let mut points = starts.to_vec();
    let mut ahead = points.clone();
    // Taken once: the pages of large maps would be new in each step.
    let mut next = points.clone();
    let mut bends = vec![DVec3::ZERO; count];
    let mut momentum = 1.0f64;
    for step in 0..tuning.bending_steps {
        check_cancelled();
        progress(step, tuning.bending_steps);
        bends.par_iter_mut().enumerate().for_each(|(point, bend)| {
            let sum: DVec3 = graph.followed(point).iter().map(|other| ahead[*other as usize]).sum();
            *bend = if shares[point] > 0.0 { ahead[point] - sum * shares[point] } else { DVec3::ZERO };
        });
        next.par_iter_mut().enumerate().for_each(|(point, next)| {
            let from: DVec3 =
                followers(point).map(|other| bends[other as usize] * shares[other as usize]).sum();
            let slope = ahead[point] - starts[point] + tuning.bending * (bends[point] - from);
            *next = boxes.nearest(point, ahead[point] - slope * steps[point]);
        });
        let overshoot = |(start, next): (usize, &[DVec3])| -> f64 {
            let all = next
                .iter()
                .zip(&ahead[start * CHUNK..])
                .zip(&points[start * CHUNK..])
                .zip(&steps[start * CHUNK..]);
            all.map(|(((next, ahead), was), step)| (*ahead - *next).dot(*next - *was) / step).sum()
        };
        let sums: Vec<f64> = next.par_chunks(CHUNK).enumerate().map(overshoot).collect();
        let is_beyond = sums.iter().sum::<f64>() > 0.0;
        let before = if is_beyond { 1.0 } else { momentum };
        momentum = if is_beyond { 1.0 } else { 0.5 * (1.0 + (1.0 + 4.0 * momentum * momentum).sqrt()) };
        let further = if is_beyond { 0.0 } else { (before - 1.0) / momentum };
        ahead.par_iter_mut().zip(&next).zip(&points).for_each(|((ahead, next), was)| {
            *ahead = *next + (*next - *was) * further;
        });
        std::mem::swap(&mut points, &mut next);
    }
    points
}

/// The points that are to be the mean of others, of which this is one.
fn followers(graph: &Graph, point: usize) -> impl Iterator<Item = u32> {
    let (along, off) = graph.along_and_off(point);
    let along = along.iter().filter(|other| graph.part(**other as usize) == Part::Line);
    let off = off.iter().filter(|other| graph.part(**other as usize) == Part::Boundary);
    along.chain(off).copied()
}
