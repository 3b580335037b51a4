//! Small grains taken out, holes filled, grains numbered from 0.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use super::neighbors::Grid;
use crate::error::map_file::MapProblem;

/// The label of places that belong to no grain.
pub(crate) const NO_GRAIN: i32 = -1;

/// What cleaning kept, and what it changed.
pub(super) struct Cleaned {
    /// The label before of each grain, ascending.
    pub(super) kept: Vec<i32>,
    /// Number of places of each grain, with those that were filled.
    pub(super) counts: Vec<u64>,
    /// Grains that were too small, and their places.
    pub(super) dropped: [u64; 2],
}

/// Takes grains of less than `least` places out, fills them and the other holes, and numbers the grains that are left from 0 in the order of their labels.
///
/// # Errors
/// [`MapProblem::NoGrain`].
pub(super) fn clean(
    labels: &mut [i32],
    mut is_hole: Vec<bool>,
    grid: Grid,
    least: u64,
) -> Result<Cleaned, MapProblem> {
    let before = counts(labels);
    let is_small = |label: i32| before.get(&label).is_some_and(|count| *count < least);
    let dropped = before.iter().filter(|(label, _)| is_small(**label));
    let dropped = dropped.fold([0; 2], |[grains, places], (_, count)| [grains + 1, places + count]);
    let kept: Vec<i32> = before.keys().copied().filter(|label| !is_small(*label)).collect();
    if kept.is_empty() {
        return Err(MapProblem::NoGrain { least });
    }
    for (is_hole, label) in is_hole.iter_mut().zip(labels.iter()) {
        *is_hole |= dropped[0] > 0 && is_small(*label);
    }
    fill(labels, is_hole, grid);
    let numbers: BTreeMap<i32, i32> = kept.iter().copied().zip(0..).collect();
    for row in labels.chunk_by_mut(|a, b| a == b).filter(|row| row[0] != NO_GRAIN) {
        row.fill(numbers[&row[0]]);
    }
    let counts = counts(labels).into_values().collect();
    Ok(Cleaned { kept, counts, dropped })
}

/// Number of places of each grain.
fn counts(labels: &[i32]) -> BTreeMap<i32, u64> {
    let mut counts = BTreeMap::new();
    for row in labels.chunk_by(|a, b| a == b).filter(|row| row[0] != NO_GRAIN) {
        *counts.entry(row[0]).or_default() += row.len() as u64;
    }
    counts
}

/// Gives holes the label that most of their neighbours have, of equals the smallest, layer by layer from those around; holes that nothing but other
/// holes touch stay as they are until their neighbours are filled.
fn fill(labels: &mut [i32], mut is_hole: Vec<bool>, grid: Grid) {
    let mut holes: Vec<usize> = (0..is_hole.len()).filter(|place| is_hole[*place]).collect();
    while !holes.is_empty() {
        let filled: Vec<(usize, i32)> = holes
            .iter()
            .filter_map(|place| {
                let beside = grid.neighbors(*place).filter(|other| !is_hole[*other]);
                let mut beside: Vec<i32> = beside.map(|other| labels[other]).collect();
                beside.sort_unstable();
                let most =
                    beside.chunk_by(|a, b| a == b).max_by_key(|alike| (alike.len(), Reverse(alike[0])));
                most.map(|alike| (*place, alike[0]))
            })
            .collect();
        if filled.is_empty() {
            return;
        }
        for (place, label) in filled {
            labels[place] = label;
            is_hole[place] = false;
        }
        holes.retain(|place| is_hole[*place]);
    }
}
