//! Points that give grains the volumes of their voxels.

use std::collections::BTreeMap;

use cancellation::check_cancelled;
use glam::{BVec3, DVec3};
use rayon::prelude::*;

use crate::mesh::id::id;
use crate::mesh::volume::{VOLUME_RESTORED, largest_relative_error};
use crate::solver::conjugate_gradients::{Limits, SOLVED, solve};
use crate::voxels::bending::Boxes;
use crate::voxels::elements::CutFaces;
use crate::voxels::tuning::VoxelTuning;
use crate::voxels::volume_slopes::VolumeSlopes;
use crate::{GrainId, Side};

/// What volumes may lack in the end, as a share of each.
const TOLERANCE: f64 = 1e-13;

/// How much more grains gain than others lose when points move, as a share, for rounding alone.
const ROUNDING: f64 = 1e-9;

/// What grains are to have.
pub(super) struct Wanted<'a> {
    /// Volume of each grain, in the unit of the points.
    pub(super) volumes: &'a [f64],
    /// The sides of each kind of face.
    pub(super) sides: &'a [[Side; 2]],
}

/// What a search for volumes found.
#[derive(Default)]
pub(super) struct Restored {
    /// The largest error that is left, as a share of a volume.
    pub(super) error: f64,
    /// Grains that cannot have their volumes, as too many of their points stay.
    pub(super) stuck: Vec<GrainId>,
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

    /// Moves points within their boxes, but for some that stay, until grains have their volumes.
    ///
    /// Newton's method: all points move along the slopes of the volumes, by one multiplier for each grain. What the bound of a box takes from that, the other points make
    /// up for in the next round.
    pub(super) fn restore(&self, points: &mut [DVec3], boxes: &Boxes<'_>, stays: &[bool]) -> Restored {
        let volumes = self.wanted.volumes;
        let mut is_held = vec![BVec3::FALSE; points.len()];
        let mut motions = vec![DVec3::ZERO; points.len()];
        let mut restored = Restored { error: f64::INFINITY, stuck: Vec::new() };
        for _ in 0..self.tuning.volume_rounds {
            check_cancelled();
            let is_bound = |point: usize| boxes.is_fixed(point) | is_held[point] | BVec3::splat(stays[point]);
            let growth = self.slopes.growth(volumes.len(), points, is_bound, &mut motions);
            let mut missing: Vec<f64> =
                volumes.iter().zip(growth.volumes).map(|(wanted, is)| wanted - is).collect();
            restored.error = largest_relative_error(&missing, volumes).1;
            restored.stuck.clear();
            if restored.error <= TOLERANCE {
                break;
            }
            restored.stuck = give_up_sums(&growth.matrix, &mut missing, volumes);
            let multipliers = multipliers(&growth.matrix, &missing);
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
        restored
    }
}

/// Takes from what grains lack that which no motion gives them: grains that exchange volumes with each other alone keep the sum of these. Returns the grains of such
/// groups that lack something together, but for a group of most grains, which has what the others lack.
fn give_up_sums(matrix: &[BTreeMap<u32, f64>], missing: &mut [f64], volumes: &[f64]) -> Vec<GrainId> {
    let mut is_known = vec![false; missing.len()];
    let mut groups = Vec::new();
    for first in 0..missing.len() {
        if std::mem::replace(&mut is_known[first], true) {
            continue;
        }
        let mut group = vec![id(first)];
        let mut next = 0;
        while let Some(grain) = group.get(next) {
            next += 1;
            let row = &matrix[*grain as usize];
            let beside = row.iter().filter(|(_, value)| **value != 0.0).map(|(other, _)| *other);
            let new: Vec<u32> =
                beside.filter(|other| !std::mem::replace(&mut is_known[*other as usize], true)).collect();
            group.extend(new);
        }
        // What a grain takes from others is what these lose, unless the outside takes part.
        let is_closed = group.iter().all(|grain| {
            let row = &matrix[*grain as usize];
            row.values().sum::<f64>() <= ROUNDING * row.get(grain).copied().unwrap_or(0.0)
        });
        if is_closed {
            groups.push(group);
        }
    }
    let mut stuck = Vec::new();
    for group in groups {
        let rest = group.iter().map(|grain| missing[*grain as usize]).sum::<f64>() / group.len() as f64;
        group.iter().for_each(|grain| missing[*grain as usize] -= rest);
        let lacks = |grain: &u32| rest.abs() > VOLUME_RESTORED * volumes[*grain as usize];
        if 2 * group.len() <= missing.len() && group.iter().any(lacks) {
            stuck.extend(group.into_iter().map(GrainId));
        }
    }
    stuck
}

/// By how much points go along the slopes of each grain, so that volumes grow by what they lack, to first order.
fn multipliers(matrix: &[BTreeMap<u32, f64>], missing: &[f64]) -> Vec<f64> {
    let apply = |multipliers: &[f64]| -> Vec<f64> {
        let row = |row: &BTreeMap<u32, f64>| {
            row.iter().map(|(other, value)| value * multipliers[*other as usize]).sum()
        };
        matrix.par_iter().map(row).collect()
    };
    let diagonal: Vec<f64> =
        (0u32..).zip(matrix).map(|(grain, row)| row.get(&grain).copied().unwrap_or(0.0)).collect();
    let precondition = |residual: &[f64]| -> Vec<f64> {
        let entry = |(value, diagonal): (&f64, &f64)| if *diagonal > 0.0 { value / diagonal } else { 0.0 };
        residual.iter().zip(&diagonal).map(entry).collect()
    };
    solve(apply, precondition, missing, &Limits::of(missing.len(), SOLVED))
}
