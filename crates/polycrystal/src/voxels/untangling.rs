//! Points that leave no element that crosses another, and fewer folds.

use std::cell::OnceCell;

use cancellation::check_cancelled;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::mesh::grouped::Grouped;
use crate::mesh::volume::VOLUME_RESTORED;
use crate::voxels::bending::Boxes;
use crate::voxels::copies::across;
use crate::voxels::graph::Graph;
use crate::voxels::neighbors::Neighbors;
use crate::voxels::tuning::VoxelTuning;
use crate::voxels::volumes::{Restored, VolumeSearch};

/// What points are moved by.
pub(super) struct Untangling<'a> {
    pub(super) graph: &'a Graph,
    pub(super) boxes: &'a Boxes<'a>,
    /// The points that do not start in the middles of their boxes, and by how much, so that nothing crosses.
    pub(super) apart: &'a [(u32, Vec3)],
    pub(super) search: &'a VolumeSearch<'a>,
    pub(super) tuning: &'a VoxelTuning,
}

/// Points, and what is wrong with them.
#[derive(Debug, Clone)]
struct Untangled {
    points: Vec<DVec3>,
    crossings: usize,
    /// The largest error of a volume, as a share of it.
    volume_error: f64,
}

impl Untangling<'_> {
    /// Takes points of elements that cross part of the way back to where they started, then smooths points around folds; the others restore the volumes.
    ///
    /// Folds stay where grains are one voxel thick: a plate has a rim. Others hardly move when points around a place do, so crossings are looked for there alone, and everywhere
    /// only at the start and in the end.
    pub(super) fn untangle(&self, points: Vec<DVec3>, restored: Restored) -> Vec<DVec3> {
        let neighbors = Neighbors::new(self.search);
        let home = OnceCell::new();
        let free = vec![false; points.len()];
        let crossings = neighbors.crossings(&points);
        let mut best = self.without_crossings(points, free, restored, crossings, &neighbors, &home);
        let mut folds = neighbors.folds(&best.points);
        while !folds.is_empty() {
            let mut points = best.points.clone();
            let is_held = self.smooth_folds(&mut points, &folds, &neighbors);
            let restored = self.search.restore(&mut points, self.boxes, &is_held);
            if restored.error > VOLUME_RESTORED {
                break;
            }
            let moved: Vec<u32> =
                (0u32..).zip(&is_held).filter(|(_, is)| **is).map(|(point, _)| point).collect();
            let crossings = neighbors.crossings_at(&points, &moved, self.boxes.places);
            let tried = self.without_crossings(points, is_held, restored, crossings, &neighbors, &home);
            let folds_left = neighbors.folds(&tried.points);
            if tried.volume_error > VOLUME_RESTORED
                || tried.crossings > best.crossings
                || folds_left.len() >= folds.len()
            {
                break;
            }
            (best, folds) = (tried, folds_left);
        }
        for _ in 0..self.tuning.crossing_rounds {
            let crossings = neighbors.crossings(&best.points);
            if crossings.is_empty() {
                break;
            }
            let Untangled { points, .. } = best;
            let free = vec![false; points.len()];
            best = self.without_crossings(points, free, Restored::default(), crossings, &neighbors, &home);
        }
        best.points
    }

    /// Points of elements that cross go half the way home, and stay there while the others restore the volumes. Those of grains that cannot have their volumes then go all
    /// the way.
    fn without_crossings(
        &self,
        mut points: Vec<DVec3>,
        mut is_held: Vec<bool>,
        mut restored: Restored,
        mut crossings: Vec<[u32; 2]>,
        neighbors: &Neighbors<'_>,
        home: &OnceCell<Vec<DVec3>>,
    ) -> Untangled {
        for round in 0.. {
            let is_done = crossings.is_empty() && restored.stuck.is_empty();
            if is_done || round == self.tuning.crossing_rounds {
                return Untangled { points, crossings: crossings.len(), volume_error: restored.error };
            }
            let home = home.get_or_init(|| self.home());
            let mut moved = self.around(&crossings, round / self.tuning.rounds_of_ring);
            for point in &moved {
                let point = *point as usize;
                is_held[point] = true;
                points[point] = points[point].midpoint(home[point]);
            }
            for point in self.search.slopes.cut.points_of_grains(&restored.stuck, self.search.slopes.sides) {
                is_held[point as usize] = true;
                points[point as usize] = home[point as usize];
                moved.push(point);
            }
            restored = self.search.restore(&mut points, self.boxes, &is_held);
            crossings = neighbors.crossings_at(&points, &moved, self.boxes.places);
        }
        unreachable!("rounds end")
    }

    /// Where points start, moved so that grains have their volumes. Without that, grains whose points are all held never got them.
    fn home(&self) -> Vec<DVec3> {
        let mut home: Vec<DVec3> = self.boxes.places.iter().map(|place| place.as_dvec3()).collect();
        self.apart.iter().for_each(|(point, start)| home[*point as usize] += start.as_dvec3());
        let free = vec![false; home.len()];
        self.search.restore(&mut home, self.boxes, &free);
        home
    }

    /// Points at folds, and after some rounds those around, go half the way to the mean of those that they follow. Returns which moved.
    ///
    /// Ends when a wider ring of points mends little.
    fn smooth_folds(&self, points: &mut [DVec3], folds: &[[u32; 2]], neighbors: &Neighbors<'_>) -> Vec<bool> {
        let mut is_moved = vec![false; points.len()];
        let mut folds = folds.to_vec();
        let mut before = usize::MAX;
        for ring in 0..=self.tuning.rings {
            for _ in 0..self.tuning.rounds_of_smoothing {
                check_cancelled();
                if folds.is_empty() {
                    return is_moved;
                }
                let moving = self.around(&folds, ring);
                let moved: Vec<DVec3> =
                    moving.par_iter().map(|point| self.smoothed(points, *point as usize)).collect();
                for (point, place) in moving.iter().zip(moved) {
                    points[*point as usize] = place;
                    is_moved[*point as usize] = true;
                }
                folds = neighbors.folds_at(points, &moving);
            }
            if 2 * folds.len() > before {
                break;
            }
            before = folds.len();
        }
        is_moved
    }

    /// Half the way from a point to the mean of those that it follows, in its box.
    fn smoothed(&self, points: &[DVec3], point: usize) -> DVec3 {
        let followed = match self.graph.followed(point) {
            [] => self.graph.beside(point),
            followed => followed,
        };
        let place = points[point];
        let to = followed.iter().map(|other| across(self.boxes.periods, place, points[*other as usize]));
        let mean = to.sum::<DVec3>() / followed.len() as f64;
        self.boxes.nearest(point, place + 0.5 * mean)
    }

    /// The corners of elements, and all points so many edges around them, in order.
    fn around(&self, pairs: &[[u32; 2]], rings: usize) -> Vec<u32> {
        let mut points: Vec<u32> = self.search.slopes.cut.points_of(pairs).collect();
        for _ in 0..rings {
            let beside = points.iter().flat_map(|point| self.graph.beside(*point as usize));
            points = beside.chain(&points).copied().collect();
            points.sort_unstable();
            points.dedup();
        }
        points.sort_unstable();
        points.dedup();
        points
    }
}

/// Where the points of a staircase start, from the middles of their boxes: several at one place stand apart, each a part of the way to the middle of its own faces. So no two
/// elements cross.
pub(super) fn starts<'a>(
    boxes: &Boxes<'_>,
    faces_at: &Grouped<u32>,
    corners: impl Fn(u32) -> &'a [u32] + Sync,
    apart: f64,
) -> Vec<Vec3> {
    let places = boxes.places;
    let is_alone = |point: usize| {
        let near = [point.checked_sub(1), Some(point + 1)];
        near.into_iter().flatten().filter_map(|other| places.get(other)).all(|other| *other != places[point])
    };
    let mean = |of: &mut dyn Iterator<Item = DVec3>| {
        let (sum, count) = of.fold((DVec3::ZERO, 0.0), |(sum, count), place| (sum + place, count + 1.0));
        sum / count
    };
    let start = |point: usize| {
        if is_alone(point) {
            return Vec3::ZERO;
        }
        let to = |corner: &u32| across(boxes.periods, boxes.middle(point), boxes.middle(*corner as usize));
        let middle = |face: &u32| mean(&mut corners(*face).iter().map(to));
        (apart * mean(&mut faces_at.of(point).iter().map(middle))).as_vec3()
    };
    (0..places.len()).into_par_iter().map(start).collect()
}
