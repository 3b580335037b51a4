//! The sites whose bisectors with a seed are near.

use std::ops::Range;

use glam::DVec3;

use crate::box_tree::{BoxSearch, BoxTree, Boxes};
use crate::lanes::{LANES, compiled_thrice, larger};
use crate::sites::bisectors::signed_square;

/// Whose bisectors with a seed are wanted: those within a radius.
pub(crate) struct Within {
    pub(crate) center: DVec3,
    pub(crate) own_weight: f64,
    pub(crate) radius: f64,
}

compiled_thrice! {
    /// Finds the runs of points in boxes that may have bisectors within a radius; false if these are more than `most` points.
    fn find_runs(boxes: &BoxTree, within: &Within, most: usize, runs: &mut Vec<Range<u32>>) -> bool = find_runs_anywhere
}

#[inline(always)]
fn find_runs_anywhere(boxes: &BoxTree, within: &Within, most: usize, runs: &mut Vec<Range<u32>>) -> bool {
    let limit = signed_square(2.0 * within.radius);
    let mut search = RunSearch { within, limit, most, count: 0, runs };
    boxes.search(&mut search);
    search.count <= most
}

struct RunSearch<'a> {
    within: &'a Within,
    limit: f64,
    most: usize,
    count: usize,
    runs: &'a mut Vec<Range<u32>>,
}

impl BoxSearch for RunSearch<'_> {
    #[inline(always)]
    fn wanted(&self, boxes: &Boxes) -> u32 {
        let &Within { center, own_weight, radius } = self.within;
        let mut wanted = 0;
        for lane in 0..LANES {
            let mut squared = 0.0;
            for axis in 0..3 {
                let below = boxes.lower[axis][lane] - center[axis];
                let above = center[axis] - boxes.upper[axis][lane];
                let beside = larger(larger(below, above), 0.0);
                squared += beside * beside;
            }
            // Of bisectors with sites of one weight, those with sites at the distance of the radius are nearest.
            let squared = larger(squared, radius * radius);
            let excess = own_weight - boxes.weights[lane];
            wanted |= u32::from(!is_farther(squared + excess, squared, self.limit)) << lane;
        }
        wanted
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "sites have numbers of 32 bits")]
    fn visit(&mut self, indices: Range<usize>) -> bool {
        self.count += indices.len();
        let [start, end] = [indices.start, indices.end].map(|index| index as u32);
        match self.runs.last_mut() {
            Some(last) if last.end == start => last.end = end,
            _ => self.runs.push(start..end),
        }
        self.count <= self.most
    }
}

/// Whether a bisector is farther away than a limit, given twice its offset and the square of the length of its normal. The limit is
/// the [`signed_square`] of twice the distance.
#[inline(always)]
fn is_farther(doubled_offset: f64, squared: f64, limit: f64) -> bool {
    // Spares roots. What underflows is near.
    doubled_offset * doubled_offset.abs() > limit * squared + f64::MIN_POSITIVE
}
