//! Points that give grains the volumes of their voxels.

use std::collections::{BTreeMap, HashMap};

use cancellation::check_cancelled;
use glam::{BVec3, DVec3};
use rayon::prelude::*;

use crate::mesh::grouped::Grouped;
use crate::mesh::volume::{ConeSum, boundary_cones};
use crate::solver::conjugate_gradients::{Limits, solve};
use crate::voxels::bending::Boxes;
use crate::voxels::elements::CutFaces;
use crate::voxels::tuning::VoxelTuning;
use crate::{Elements, Side, Surface};

/// Residual of the multipliers, as a share of what volumes lack.
const SOLVED: f64 = 1e-6;

/// What volumes may lack in the end, as a share of each.
const TOLERANCE: f64 = 1e-13;

/// What grains are to have.
pub(super) struct Wanted<'a> {
    /// Volume of each grain, in the unit of the points.
    pub(super) volumes: &'a [f64],
    /// The sides of each kind of face.
    pub(super) sides: &'a [[Side; 2]],
    /// Whether some boundary at the outside is free to move.
    pub(super) is_open: bool,
}

/// Elements, and how they meet in points.
pub(super) struct VolumeSearch<'a> {
    pub(super) cut: &'a CutFaces,
    at_points: Grouped<u32>,
    wanted: &'a Wanted<'a>,
    tuning: &'a VoxelTuning,
}

/// How the volumes of grains grow with a point.
#[derive(Default)]
struct Slopes {
    of_grains: Vec<(u32, DVec3)>,
    /// How far the point goes along its slopes: the inverse of the area that stands on it.
    mobility: f64,
}

/// Points whose part of the matrix a thread adds up in one go; sums depend on it, but not on the number of threads.
const POINTS_AT_ONCE: usize = 1 << 16;

impl<'a> VolumeSearch<'a> {
    /// A search for so many points.
    pub(super) fn new(
        point_count: usize,
        cut: &'a CutFaces,
        wanted: &'a Wanted<'a>,
        tuning: &'a VoxelTuning,
    ) -> Self {
        Self { cut, at_points: cut.at_points(point_count), wanted, tuning }
    }

    /// The elements between points, with copies behind.
    pub(super) fn surface<'b>(&'b self, points: &'b [DVec3]) -> Surface<'b> {
        let CutFaces { kind_of, .. } = self.cut;
        Surface { points, elements: self.cut.elements(), boundary_of: kind_of, sides: self.wanted.sides }
    }

    /// Moves points within their boxes, but for some that stay, until grains have their volumes, and returns the largest error that is left, as a share of a volume.
    ///
    /// Newton's method: all points move along the slopes of the volumes, by one multiplier for each grain. What the bound of a box takes from that, the other points make
    /// up for in the next round.
    pub(super) fn restore(&self, points: &mut [DVec3], boxes: &Boxes<'_>, stays: &[bool]) -> f64 {
        let mut is_held = vec![BVec3::FALSE; points.len()];
        let mut largest = f64::INFINITY;
        for _ in 0..self.tuning.volume_rounds {
            check_cancelled();
            let before = self.cut.copies.with_copies(points).into_owned();
            let missing = self.missing(&before);
            largest = missing
                .iter()
                .zip(self.wanted.volumes)
                .map(|(lack, wanted)| (lack / wanted).abs())
                .fold(0.0, f64::max);
            if largest <= TOLERANCE {
                break;
            }
            let is_bound = |point: usize| boxes.is_fixed(point) | is_held[point] | BVec3::splat(stays[point]);
            let multipliers = self.multipliers(&before, is_bound, missing);
            let moving = points.par_iter_mut().zip(&mut is_held).enumerate();
            moving.filter(|(point, _)| !stays[*point]).for_each_init(
                Slopes::default,
                |slopes, (point, (place, is_held))| {
                    self.find_slopes(slopes, &before, point);
                    let along = slopes.of_grains.iter();
                    let sum: DVec3 = along.map(|(grain, slope)| *slope * multipliers[*grain as usize]).sum();
                    let motion = sum * slopes.mobility;
                    let wanted = *place + motion.clamp_length_max(self.tuning.longest_motion);
                    let inside = boxes.nearest(point, wanted);
                    *place = DVec3::select(*is_held, *place, inside);
                    // Held until it would go back inside.
                    *is_held = inside.cmpne(wanted);
                },
            );
        }
        largest
    }

    fn missing(&self, with_copies: &[DVec3]) -> Vec<f64> {
        let cones = boundary_cones(&self.surface(with_copies));
        let mut sums = vec![ConeSum::default(); self.wanted.volumes.len()];
        for (sides, cone) in self.wanted.sides.iter().zip(&cones) {
            for (side, sign) in sides.iter().zip([1.0, -1.0]) {
                if let Side::Grain(grain) = side {
                    sums[grain.index()].add(cone, sign);
                }
            }
        }
        self.wanted.volumes.iter().zip(sums).map(|(wanted, sum)| wanted - sum.volume).collect()
    }

    /// How volumes grow with a point, where elements are between these.
    fn find_slopes(&self, found: &mut Slopes, with_copies: &[DVec3], point: usize) {
        let surface = self.surface(with_copies);
        // A third of each triangle's area, and half of each segment's length, belongs to each corner.
        let share = if let Elements::Segments(_) = surface.elements { 2.0 } else { 6.0 };
        found.of_grains.clear();
        let mut area = 0.0;
        for element in self.at_points.of(point) {
            let normal = surface.elements.normal(with_copies, *element) / share;
            let sides = surface.sides_of(*element);
            // Elements of copies, which alone have the outside first, are there already.
            if sides[0] != Side::Exterior {
                area += normal.length();
            }
            for (side, sign) in sides.into_iter().zip([1.0, -1.0]) {
                let Side::Grain(grain) = side else { continue };
                match found.of_grains.iter_mut().find(|(known, _)| *known == grain.0) {
                    Some((_, slope)) => *slope += normal * sign,
                    None => found.of_grains.push((grain.0, normal * sign)),
                }
            }
        }
        found.mobility = if area > 0.0 { 1.0 / area } else { 0.0 };
    }

    /// By how much points go along the slopes of each grain, so that volumes grow by what they lack, to first order.
    fn multipliers(
        &self,
        with_copies: &[DVec3],
        is_bound: impl Fn(usize) -> BVec3 + Sync,
        mut missing: Vec<f64>,
    ) -> Vec<f64> {
        let point_count = self.at_points.count();
        let part = |first: usize| {
            // The order of its entries decides nothing: each is there once in a part.
            let mut part: HashMap<[u32; 2], f64> = HashMap::new();
            let mut slopes = Slopes::default();
            for point in first..point_count.min(first + POINTS_AT_ONCE) {
                self.find_slopes(&mut slopes, with_copies, point);
                let is_bound = is_bound(point);
                for (place, (grain, slope)) in slopes.of_grains.iter().enumerate() {
                    let free = DVec3::select(is_bound, DVec3::ZERO, *slope * slopes.mobility);
                    for (other, along) in &slopes.of_grains[..=place] {
                        let pair = [*grain.min(other), *grain.max(other)];
                        *part.entry(pair).or_default() += free.dot(*along);
                    }
                }
            }
            part
        };
        let firsts = (0..point_count.div_ceil(POINTS_AT_ONCE)).into_par_iter();
        let parts: Vec<_> = firsts.map(|chunk| part(chunk * POINTS_AT_ONCE)).collect();
        let mut matrix: Vec<BTreeMap<u32, f64>> = vec![BTreeMap::new(); missing.len()];
        for ([grain, other], value) in parts.into_iter().flatten() {
            *matrix[grain as usize].entry(other).or_default() += value;
            if grain != other {
                *matrix[other as usize].entry(grain).or_default() += value;
            }
        }
        let apply = |multipliers: &[f64]| -> Vec<f64> {
            let row = |row: &BTreeMap<u32, f64>| {
                row.iter().map(|(other, value)| value * multipliers[*other as usize]).sum()
            };
            matrix.par_iter().map(row).collect()
        };
        let diagonal: Vec<f64> =
            (0u32..).zip(&matrix).map(|(grain, row)| row.get(&grain).copied().unwrap_or(0.0)).collect();
        let can_grow: Vec<bool> = diagonal.iter().map(|diagonal| *diagonal > 0.0).collect();
        // A grain whose points are all at the walls of their boxes waits.
        missing.iter_mut().zip(&can_grow).filter(|(_, can)| !**can).for_each(|(missing, _)| *missing = 0.0);
        if !self.wanted.is_open {
            // No motion changes the sum, so what waiting grains and rounding leave of it has no answer.
            let growing = can_grow.iter().filter(|can| **can).count();
            let rest = missing.iter().sum::<f64>() / growing.max(1) as f64;
            missing
                .iter_mut()
                .zip(&can_grow)
                .filter(|(_, can)| **can)
                .for_each(|(missing, _)| *missing -= rest);
        }
        let precondition = |residual: &[f64]| -> Vec<f64> {
            let entry =
                |(value, diagonal): (&f64, &f64)| if *diagonal > 0.0 { value / diagonal } else { 0.0 };
            residual.iter().zip(&diagonal).map(entry).collect()
        };
        solve(apply, precondition, &missing, &Limits { tolerance: SOLVED, steps: 2 * missing.len() + 20 })
    }
}
