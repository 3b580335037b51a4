//! Points that give grains the volumes of their voxels.

use std::collections::BTreeMap;

use cancellation::check_cancelled;
use glam::{BVec3, DVec3};
use rayon::prelude::*;

use crate::mesh::grouped::Grouped;
use crate::mesh::volume::{ConeSum, boundary_cones};
use crate::solver::conjugate_gradients::{Limits, solve};
use crate::voxels::bending::Boxes;
use crate::voxels::copies::Copies;
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
    /// Its points stand for any others, which have the same copies.
    pub(super) surface: Surface<'a>,
    pub(super) copies: &'a Copies,
    at_points: Grouped<u32>,
    wanted: &'a Wanted<'a>,
    tuning: &'a VoxelTuning,
}

/// How the volumes of grains grow with a point.
struct Slopes {
    /// Of each point, where its slopes start.
    starts: Vec<usize>,
    of_grains: Vec<(u32, DVec3)>,
    /// How far each point goes along its slopes: the inverse of the area that stands on it.
    mobilities: Vec<f64>,
}

impl Slopes {
    fn of(&self, point: usize) -> &[(u32, DVec3)] {
        &self.of_grains[self.starts[point]..self.starts[point + 1]]
    }
}

impl<'a> VolumeSearch<'a> {
    pub(super) fn new(
        points: &'a [DVec3],
        cut: &'a CutFaces,
        wanted: &'a Wanted<'a>,
        tuning: &'a VoxelTuning,
    ) -> Self {
        let elements = cut.elements();
        let surface = Surface { points, elements, boundary_of: &cut.kind_of, sides: wanted.sides };
        let at_points = cut.at_points(points.len());
        Self { surface, copies: &cut.copies, at_points, wanted, tuning }
    }

    /// Moves points within their boxes, but for some that stay, until grains have their volumes, and returns the largest error that is left, as a share of a volume.
    ///
    /// Newton's method: all points move along the slopes of the volumes, by one multiplier for each grain. What the bound of a box takes from that, the other points make
    /// up for in the next round.
    pub(super) fn restore(&self, points: &mut [DVec3], boxes: &Boxes, stays: &[bool]) -> f64 {
        let mut is_held = vec![BVec3::FALSE; points.len()];
        let mut largest = f64::INFINITY;
        for _ in 0..self.tuning.volume_rounds {
            check_cancelled();
            let missing = self.missing(points);
            largest = missing
                .iter()
                .zip(self.wanted.volumes)
                .map(|(lack, wanted)| (lack / wanted).abs())
                .fold(0.0, f64::max);
            if largest <= TOLERANCE {
                break;
            }
            let slopes = self.slopes(points);
            let is_bound = |point: usize| boxes.is_fixed[point] | is_held[point] | BVec3::splat(stays[point]);
            let multipliers = self.multipliers(&slopes, is_bound, missing);
            points.par_iter_mut().zip(&mut is_held).enumerate().filter(|(point, _)| !stays[*point]).for_each(
                |(point, (place, is_held))| {
                    let along = slopes.of(point).iter();
                    let sum: DVec3 = along.map(|(grain, slope)| *slope * multipliers[*grain as usize]).sum();
                    let motion = sum * slopes.mobilities[point];
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

    fn missing(&self, points: &[DVec3]) -> Vec<f64> {
        let cones = boundary_cones(&Surface { points: &self.copies.with_copies(points), ..self.surface });
        let mut sums = vec![ConeSum::default(); self.wanted.volumes.len()];
        for (sides, cone) in self.surface.sides.iter().zip(&cones) {
            for (side, sign) in sides.iter().zip([1.0, -1.0]) {
                if let Side::Grain(grain) = side {
                    sums[grain.index()].add(cone, sign);
                }
            }
        }
        self.wanted.volumes.iter().zip(sums).map(|(wanted, sum)| wanted - sum.volume).collect()
    }

    fn slopes(&self, points: &[DVec3]) -> Slopes {
        // A third of each triangle's area, and half of each segment's length, belongs to each corner.
        let elements = self.surface.elements;
        let share = if let Elements::Segments(_) = elements { 2.0 } else { 6.0 };
        let with_copies = self.copies.with_copies(points);
        let normal = |element: u32| elements.normal(&with_copies, element) / share;
        let of_point = |point: usize| {
            let mut slopes: Vec<(u32, DVec3)> = Vec::new();
            let mut area = 0.0;
            for element in self.at_points.of(point) {
                let normal = normal(*element);
                let sides = self.surface.sides_of(*element);
                // Elements of copies, which alone have the outside first, are there already.
                if sides[0] != Side::Exterior {
                    area += normal.length();
                }
                for (side, sign) in sides.into_iter().zip([1.0, -1.0]) {
                    let Side::Grain(grain) = side else { continue };
                    match slopes.iter_mut().find(|(known, _)| *known == grain.0) {
                        Some((_, slope)) => *slope += normal * sign,
                        None => slopes.push((grain.0, normal * sign)),
                    }
                }
            }
            (slopes, if area > 0.0 { 1.0 / area } else { 0.0 })
        };
        let all: Vec<_> = (0..points.len()).into_par_iter().map(of_point).collect();
        let mut slopes =
            Slopes { starts: vec![0], of_grains: Vec::new(), mobilities: Vec::with_capacity(all.len()) };
        for (own, mobility) in all {
            slopes.of_grains.extend(own);
            slopes.starts.push(slopes.of_grains.len());
            slopes.mobilities.push(mobility);
        }
        slopes
    }

    /// By how much points go along the slopes of each grain, so that volumes grow by what they lack, to first order.
    fn multipliers(
        &self,
        slopes: &Slopes,
        is_bound: impl Fn(usize) -> BVec3,
        mut missing: Vec<f64>,
    ) -> Vec<f64> {
        let mut matrix: Vec<BTreeMap<u32, f64>> = vec![BTreeMap::new(); missing.len()];
        for (point, mobility) in slopes.mobilities.iter().enumerate() {
            let is_bound = is_bound(point);
            for (grain, slope) in slopes.of(point) {
                let free = DVec3::select(is_bound, DVec3::ZERO, *slope * *mobility);
                for (other, along) in slopes.of(point) {
                    *matrix[*grain as usize].entry(*other).or_default() += free.dot(*along);
                }
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
