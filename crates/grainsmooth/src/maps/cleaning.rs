//! A map as it is used: a part of it, without small grains, its grains numbered from 0.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec3;

use super::label_map::{LabelMap, MeasuredMap};
use super::options::MapOptions;
use crate::error::map_file::MapProblem;

/// The label of voxels that belong to no grain.
pub(crate) const NO_GRAIN: i32 = -1;

impl MeasuredMap {
    /// The grains of labels in memory, cropped and cleaned as options say.
    ///
    /// # Errors
    /// [`MapProblem`] where labels and options do not go together.
    pub fn of_labels(map: LabelMap, options: &MapOptions) -> Result<Self, MapProblem> {
        cleaned(map, options)
    }
}

/// Crops a map, takes small grains out and numbers the others from 0 in the order of their labels.
pub(super) fn cleaned(map: LabelMap, options: &MapOptions) -> Result<MeasuredMap, MapProblem> {
    let mut map = cropped(map, options)?;
    for label in &mut map.labels {
        if *label < 0 || Some(*label) == options.exterior_label {
            *label = NO_GRAIN;
        }
    }
    let counts = counts(&map.labels);
    let is_small = |label: i32| counts[&label] < options.min_voxels;
    let dropped = counts.iter().filter(|(label, _)| is_small(**label));
    let dropped = dropped.fold([0; 2], |[grains, voxels], (_, count)| [grains + 1, voxels + count]);
    let kept: Vec<i32> = counts.keys().copied().filter(|label| !is_small(*label)).collect();
    if kept.is_empty() {
        return Err(MapProblem::NoGrain { least: options.min_voxels });
    }
    if dropped[0] > 0 {
        let is_hole: Vec<bool> =
            map.labels.iter().map(|label| *label != NO_GRAIN && is_small(*label)).collect();
        fill(&mut map, is_hole);
    }
    let numbers: BTreeMap<i32, i32> = kept.iter().copied().zip(0..).collect();
    for label in map.labels.iter_mut().filter(|label| **label != NO_GRAIN) {
        *label = numbers[label];
    }
    let labels = kept.into_iter().map(i32::cast_unsigned).collect();
    Ok(MeasuredMap { map, labels, dropped })
}

/// The part of a map that is asked for.
fn cropped(map: LabelMap, options: &MapOptions) -> Result<LabelMap, MapProblem> {
    let Some(crop) = &options.crop else { return Ok(map) };
    let range = |axis: usize| -> Result<Range<usize>, MapProblem> {
        let count = map.shape[axis];
        let range = crop.0.get(axis).cloned().unwrap_or(0..count);
        if range.end <= count {
            return Ok(range);
        }
        let axis = ['x', 'y', 'z'][axis];
        Err(MapProblem::Crop { axis, count, first: range.start, end: range.end })
    };
    let [xs, ys, zs] = [range(0)?, range(1)?, range(2)?];
    let [nx, ny, _] = map.shape;
    let mut labels = Vec::with_capacity(xs.len() * ys.len() * zs.len());
    for z in zs.clone() {
        for y in ys.clone() {
            let row = (z * ny + y) * nx;
            labels.extend_from_slice(&map.labels[row + xs.start..row + xs.end]);
        }
    }
    let first = DVec3::new(xs.start as f64, ys.start as f64, zs.start as f64);
    Ok(LabelMap {
        shape: [xs.len(), ys.len(), zs.len()],
        origin: map.origin + first * map.spacing,
        spacing: map.spacing,
        labels,
    })
}

/// Number of voxels of each grain.
fn counts(labels: &[i32]) -> BTreeMap<i32, u64> {
    let mut counts = BTreeMap::new();
    for row in labels.chunk_by(|a, b| a == b).filter(|row| row[0] != NO_GRAIN) {
        *counts.entry(row[0]).or_default() += row.len() as u64;
    }
    counts
}

/// Gives voxels the label that most of their six neighbours have, of equals the smallest, layer by layer from those around; holes that nothing but other
/// holes touch stay as they are until their neighbours are filled.
fn fill(map: &mut LabelMap, mut is_hole: Vec<bool>) {
    let [nx, ny, nz] = map.shape;
    let steps = [1, nx, nx * ny];
    let mut holes: Vec<usize> = (0..is_hole.len()).filter(|voxel| is_hole[*voxel]).collect();
    while !holes.is_empty() {
        let filled: Vec<(usize, i32)> = holes
            .iter()
            .filter_map(|voxel| {
                let place = [voxel % nx, voxel / nx % ny, voxel / nx / ny];
                let beside = (0..3).flat_map(|axis| {
                    let lower = (place[axis] > 0).then(|| voxel - steps[axis]);
                    let upper = (place[axis] + 1 < [nx, ny, nz][axis]).then(|| voxel + steps[axis]);
                    [lower, upper]
                });
                let mut labels: Vec<i32> = beside
                    .flatten()
                    .filter(|other| !is_hole[*other])
                    .map(|other| map.labels[other])
                    .collect();
                labels.sort_unstable();
                let most = labels.chunk_by(|a, b| a == b);
                most.max_by_key(|alike| (alike.len(), std::cmp::Reverse(alike[0])))
                    .map(|alike| (*voxel, alike[0]))
            })
            .collect();
        if filled.is_empty() {
            return;
        }
        for (voxel, label) in filled {
            map.labels[voxel] = label;
            is_hole[voxel] = false;
        }
        holes.retain(|voxel| is_hole[*voxel]);
    }
}
