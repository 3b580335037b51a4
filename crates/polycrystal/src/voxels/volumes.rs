//! Points that give grains the volumes of their voxels.

use std::collections::BTreeMap;

use cancellation::check_cancelled;
use glam::{BVec3, DVec3};
use rayon::prelude::*;

use crate::Side;
use crate::solver::conjugate_gradients::{Limits, solve};
use crate::voxels::bending::Boxes;
use crate::voxels::elements::CutFaces;
use crate::voxels::tuning::VoxelTuning;
use crate::voxels::volume_slopes::VolumeSlopes;

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

/// Newton's search for points.
pub(super) struct VolumeSearch<'a> {
    pub(super) slopes: VolumeSlopes<'a>,
    wanted: &'a Wanted<'a>,
    tuning: &'a VoxelTuning,
}

impl<'a> VolumeSearch<'a> {
    /// A search for so many points.
    pub(super) fn new(
        point_count: usize,
        cut: &'a CutFaces,
        wanted: &'a Wanted<'a>,
        tuning: &'a VoxelTuning,
    ) -> Self {
        Self { slopes: VolumeSlopes::new(point_count, cut, wanted.sides), wanted, tuning }
    }

    /// Moves points within their boxes, but for some that stay, until grains have their volumes, and returns the largest error that is left, as a share of a volume.
    ///
    /// Newton's method: all points move along the slopes of the volumes, by one multiplier for each grain. What the bound of a box takes from that, the other points make
    /// up for in the next round.
    pub(super) fn restore(&self, points: &mut [DVec3], boxes: &Boxes<'_>, stays: &[bool]) -> f64 {
        let volumes = self.wanted.volumes;
        let mut is_held = vec![BVec3::FALSE; points.len()];
        let mut motions = vec![DVec3::ZERO; points.len()];
        let mut largest = f64::INFINITY;
        for _ in 0..self.tuning.volume_rounds {
            check_cancelled();
            let is_bound = |point: usize| boxes.is_fixed(point) | is_held[point] | BVec3::splat(stays[point]);
            let growth = self.slopes.growth(volumes.len(), points, is_bound, &mut motions);
            let missing: Vec<f64> =
                volumes.iter().zip(growth.volumes).map(|(wanted, is)| wanted - is).collect();
            largest =
                missing.iter().zip(volumes).map(|(lack, wanted)| (lack / wanted).abs()).fold(0.0, f64::max);
            if largest <= TOLERANCE {
                break;
            }
            let multipliers = self.multipliers(&growth.matrix, missing);
            self.slopes.motions(points, &multipliers, &mut motions);
            let moving = points.par_iter_mut().zip(&mut is_held).zip(&motions).zip(stays).enumerate();
            moving.filter(|(_, (_, stays))| !**stays).for_each(|(point, (((place, is_held), motion), _))| {
                let wanted = *place + motion.clamp_length_max(self.tuning.longest_motion);
                let inside = boxes.nearest(point, wanted);
                *place = DVec3::select(*is_held, *place, inside);
                // Held until it would go back inside.
                *is_held = inside.cmpne(wanted);
            });
        }
        largest
    }

    /// By how much points go along the slopes of each grain, so that volumes grow by what they lack, to first order.
    fn multipliers(&self, matrix: &[BTreeMap<u32, f64>], mut missing: Vec<f64>) -> Vec<f64> {
        let apply = |multipliers: &[f64]| -> Vec<f64> {
            let row = |row: &BTreeMap<u32, f64>| {
                row.iter().map(|(other, value)| value * multipliers[*other as usize]).sum()
            };
            matrix.par_iter().map(row).collect()
        };
        let diagonal: Vec<f64> =
            (0u32..).zip(matrix).map(|(grain, row)| row.get(&grain).copied().unwrap_or(0.0)).collect();
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
