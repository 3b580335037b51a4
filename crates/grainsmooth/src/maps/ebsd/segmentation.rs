//! Points that are turned little against their neighbours are one grain.

use std::collections::BTreeSet;

use rayon::prelude::*;
use texture::{CrystalSymmetry, Orientation};

use super::super::ebsd_options::AxisAngle;
use super::super::neighbors::Grid;
use super::super::sets::Sets;

/// A point with a good solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crystal {
    /// Index of its phase.
    pub(super) phase: usize,
    pub(super) orientation: Orientation,
}

/// The grain of each point: neighbours of one phase that differ by a threshold at most, in degrees, are in one. Grains are numbered from 0 by their first points.
pub(super) fn segmented(
    crystals: &[Option<Crystal>],
    grid: Grid,
    symmetries: &[CrystalSymmetry],
    threshold: f64,
) -> Vec<i32> {
    let is_one = |first: &Crystal, second: &Crystal| {
        first.phase == second.phase
            && symmetries[first.phase].disorientation_angle(first.orientation, second.orientation)
                <= threshold
    };
    let before = |place: usize| grid.neighbors(place).filter(move |other| *other < place).enumerate();
    // A bit for each neighbour before a place.
    let joined: Vec<u8> = (0..crystals.len())
        .into_par_iter()
        .map(|place| {
            let Some(own) = &crystals[place] else { return 0 };
            let is_joined = |other: usize| crystals[other].as_ref().is_some_and(|other| is_one(own, other));
            before(place).filter(|(_, other)| is_joined(*other)).fold(0, |joined, (bit, _)| joined | 1 << bit)
        })
        .collect();
    let mut sets = Sets::new(crystals.len());
    for (place, joined) in joined.into_iter().enumerate().filter(|(_, joined)| *joined > 0) {
        before(place)
            .filter(|(bit, _)| joined >> bit & 1 == 1)
            .for_each(|(_, other)| sets.join(place, other));
    }
    sets.numbers(|place| crystals[place].is_some())
}

/// The grain that each becomes part of when twins are one, by their mean orientations; grains keep their order.
pub(super) fn merged_twins(
    labels: &[i32],
    grid: Grid,
    grains: &[Crystal],
    symmetries: &[CrystalSymmetry],
    twin: AxisAngle,
    tolerance: f64,
) -> Vec<i32> {
    let mut pairs = BTreeSet::new();
    for (place, label) in labels.iter().enumerate() {
        let others = grid.neighbors(place).map(|other| labels[other]);
        pairs.extend(others.filter(|other| other > label && *label >= 0).map(|other| [*label, other]));
    }
    let index = |label: i32| usize::try_from(label).expect("grains are numbered from 0");
    let mut sets = Sets::new(grains.len());
    for [first, second] in pairs.into_iter().map(|pair| pair.map(index)) {
        let [one, other] = [grains[first], grains[second]];
        if one.phase == other.phase
            && symmetries[one.phase].twin_deviation(one.orientation, other.orientation, twin.angle, twin.axis)
                <= tolerance
        {
            sets.join(first, second);
        }
    }
    sets.numbers(|_| true)
}
