//! Points in boxes, eight to a box, and these in larger boxes, eight to one again, up to a single group.
//!
//! Each box knows the largest weight in it, so one search finds what is near and what is heavy enough to count from far away,
//! wherever points crowd and whatever their weights are.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::exact::half_space::EVALUATION_ERROR;
use crate::lanes::LANES;

/// Eight boxes: those of points that follow one another, or of groups that do. What is missing at the end is empty.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Boxes {
    pub(crate) lower: [[f64; LANES]; 3],
    pub(crate) upper: [[f64; LANES]; 3],
    /// The largest in each box.
    pub(crate) weights: [f64; LANES],
}

impl Boxes {
    const EMPTY: Self = Self {
        lower: [[f64::INFINITY; LANES]; 3],
        upper: [[f64::NEG_INFINITY; LANES]; 3],
        weights: [f64::NEG_INFINITY; LANES],
    };

    fn add(&mut self, lane: usize, lower: DVec3, upper: DVec3, weight: f64) {
        for axis in 0..3 {
            self.lower[axis][lane] = self.lower[axis][lane].min(lower[axis]);
            self.upper[axis][lane] = self.upper[axis][lane].max(upper[axis]);
        }
        self.weights[lane] = self.weights[lane].max(weight);
    }

    /// The box around all of them, and the largest weight.
    fn around(&self) -> (DVec3, DVec3, f64) {
        let lower = self.lower.map(|lanes| lanes.into_iter().fold(f64::INFINITY, f64::min));
        let upper = self.upper.map(|lanes| lanes.into_iter().fold(f64::NEG_INFINITY, f64::max));
        let weight = self.weights.into_iter().fold(f64::NEG_INFINITY, f64::max);
        (DVec3::from_array(lower), DVec3::from_array(upper), weight)
    }

    /// The sum of the shortest sides of all boxes.
    fn least_sides(&self) -> f64 {
        let side = |axis: usize, lane: usize| self.upper[axis][lane] - self.lower[axis][lane];
        let least = |lane: usize| side(0, lane).min(side(1, lane)).min(side(2, lane));
        // Empty boxes have sides of less than nothing.
        (0..LANES).map(|lane| least(lane).max(0.0)).sum()
    }
}

/// Share of the thickness of boxes below which slabs in them are worth a look: around random points they are half as thick or more.
const THIN: f64 = 0.25;

/// What the points of eight boxes lie between: pairs of parallel planes, one pair for each box, `|normal . p - middle| <= half`. Where
/// points lie on a surface that is askew, these are far closer together than the sides of a box.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Slabs {
    /// Of length 1, or 0 where points lie on a line or are too near for it: then the slab is all space.
    pub(crate) normals: [[f64; LANES]; 3],
    pub(crate) middles: [f64; LANES],
    /// With all errors of rounding.
    pub(crate) halves: [f64; LANES],
}

impl Slabs {
    const EMPTY: Self = Self { normals: [[0.0; LANES]; 3], middles: [0.0; LANES], halves: [0.0; LANES] };

    /// Puts a slab around some points, in the plane of three that are far apart.
    fn set(&mut self, lane: usize, indices: Range<usize>, position: impl Fn(usize) -> DVec3) {
        let points = || indices.clone().map(&position);
        let farthest = |square: &dyn Fn(DVec3) -> f64| {
            points().max_by(|a, b| square(*a).total_cmp(&square(*b))).unwrap_or_default()
        };
        let first = points().next().unwrap_or_default();
        let second = farthest(&|point| (point - first).length_squared());
        let third = farthest(&|point| (point - first).cross(second - first).length_squared());
        let normal = (second - first).cross(third - first).normalize_or_zero();
        // Products of what is tiny may have lost their digits.
        let is_unit = (normal.length_squared() - 1.0).abs() < EVALUATION_ERROR;
        let normal = if is_unit { normal } else { DVec3::ZERO };
        let (mut lower, mut upper) = (0.0f64, 0.0f64);
        for point in points() {
            let offset = normal.dot(point - first);
            (lower, upper) = (lower.min(offset), upper.max(offset));
        }
        for axis in 0..3 {
            self.normals[axis][lane] = normal[axis];
        }
        self.middles[lane] = normal.dot(first) + 0.5 * (lower + upper);
        let error = 2.0 * EVALUATION_ERROR * (first.abs() + second.abs()).element_sum();
        self.halves[lane] = 0.5 * (upper - lower) + error;
    }
}

/// Boxes around points in a list: what follows one another there should be near in space.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct BoxTree {
    pub(crate) point_count: usize,
    /// The groups of boxes of each level, from those around points up to one that holds all.
    pub(crate) levels: Vec<Vec<Boxes>>,
    /// Around the points of each group of boxes, level by level, where wanted and far thinner than the boxes.
    slabs: Vec<Vec<Option<Slabs>>>,
}

impl BoxTree {
    /// Boxes around some points, given the position and the weight at each index.
    pub(crate) fn new(point_count: usize, point: impl Fn(usize) -> (DVec3, f64) + Sync) -> Self {
        let group_of_points = |group: usize| {
            let mut boxes = Boxes::EMPTY;
            let first = group * LANES * LANES;
            for index in first..point_count.min(first + LANES * LANES) {
                let (position, weight) = point(index);
                boxes.add((index - first) / LANES, position, position, weight);
            }
            boxes
        };
        let group_of_groups = |groups: &[Boxes]| {
            let mut boxes = Boxes::EMPTY;
            for (lane, group) in groups.iter().enumerate() {
                let (lower, upper, weight) = group.around();
                boxes.add(lane, lower, upper, weight);
            }
            boxes
        };
        let group_count = point_count.div_ceil(LANES * LANES).max(1);
        let mut level: Vec<Boxes> = (0..group_count).into_par_iter().map(group_of_points).collect();
        let mut levels = Vec::new();
        while level.len() > 1 {
            let next = level.chunks(LANES).map(group_of_groups).collect();
            levels.push(std::mem::replace(&mut level, next));
        }
        levels.push(level);
        Self { point_count, levels, slabs: Vec::new() }
    }

    /// Puts slabs around what is in boxes where these are far thinner, given the position at each index.
    pub(crate) fn add_slabs(&mut self, position: impl Fn(usize) -> DVec3 + Sync) {
        let mut points_in_box = LANES;
        for groups in &self.levels {
            let slabs_of_group = |(group, boxes): (usize, &Boxes)| {
                let mut slabs = Slabs::EMPTY;
                for lane in 0..LANES {
                    let [first, end] = [0, 1].map(|k| (group * LANES + lane + k) * points_in_box);
                    slabs.set(lane, first.min(self.point_count)..end.min(self.point_count), &position);
                }
                let thickness: f64 = slabs.halves.iter().map(|half| 2.0 * half).sum();
                (thickness < THIN * boxes.least_sides()).then_some(slabs)
            };
            let slabs: Vec<Option<Slabs>> = groups.par_iter().enumerate().map(slabs_of_group).collect();
            // What is not thin in small boxes is not in large ones.
            if slabs.iter().all(Option::is_none) {
                return;
            }
            self.slabs.push(slabs);
            points_in_box *= LANES;
        }
    }

    #[cfg(test)]
    pub(crate) fn has_slabs(&self) -> bool {
        self.slabs.iter().flatten().any(Option::is_some)
    }

    /// Looks through the boxes that are wanted.
    #[inline(always)]
    pub(crate) fn search(&self, search: &mut impl BoxSearch) {
        let mut stack = [(0, 0); MOST_WAITING];
        stack[0] = (self.levels.len() - 1, 0);
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let (level, group) = stack[waiting];
            // What is beyond the end is wanted only if numbers overflow.
            let Some(boxes) = self.levels[level].get(group) else { continue };
            let mut chosen = search.wanted(boxes);
            if chosen != 0
                && let Some(slabs) = self.slabs.get(level).and_then(|level| level[group].as_ref())
            {
                chosen &= search.reached(boxes, slabs);
            }
            while chosen != 0 {
                // The last first: so the first waits on top.
                let lane = chosen.ilog2();
                chosen ^= 1 << lane;
                let child = group * LANES + lane as usize;
                if level > 0 {
                    stack[waiting] = (level - 1, child);
                    waiting += 1;
                } else {
                    let run = child * LANES..self.point_count.min((child + 1) * LANES);
                    if !run.is_empty() && !search.visit(run) {
                        return;
                    }
                }
            }
        }
    }
}

/// A search through boxes. Not two closures, for these are not always compiled for what the processor has.
pub(crate) trait BoxSearch {
    /// Which boxes of a group are to be looked into, a bit for each.
    fn wanted(&self, boxes: &Boxes) -> u32;

    /// Of some boxes, those of which the slabs may hold what is wanted.
    #[inline(always)]
    fn reached(&self, _boxes: &Boxes, _slabs: &Slabs) -> u32 {
        u32::MAX
    }

    /// Visits points that follow one another; false to end the search.
    fn visit(&mut self, indices: Range<usize>) -> bool;
}

/// Groups of boxes that may wait at once: eight for each level but one, and there are at most eleven levels above 2^32 points.
const MOST_WAITING: usize = 8 * 11;

/// Brings points, of which numbers are given, into an order in which few boxes hold what is near: halves of boxes across their
/// longest sides, halves of these and so on, each as many points as whole boxes hold where there are enough. The first point has
/// some index among all.
pub(crate) fn sort_into_boxes(points: &mut [u32], first: usize, position: &impl Fn(u32) -> DVec3) {
    if points.len() <= LANES {
        return;
    }
    let (mut lower, mut upper) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for point in points.iter() {
        let position = position(*point);
        (lower, upper) = (lower.min(position), upper.max(position));
    }
    let axis = (upper - lower).max_position();
    let mut unit = LANES;
    while 2 * LANES * unit <= points.len() {
        unit *= LANES;
    }
    // Within a unit from the middle, and so not at the ends.
    let middle = (first + points.len() / 2) / unit * unit;
    let at = if middle > first { middle - first } else { middle + unit - first };
    points
        .select_nth_unstable_by(at, |a, b| position(*a)[axis].total_cmp(&position(*b)[axis]).then(a.cmp(b)));
    let (left, right) = points.split_at_mut(at);
    sort_into_boxes(left, first, position);
    sort_into_boxes(right, first + at, position);
}
