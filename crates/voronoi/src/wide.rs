//! Loops over columns of planes and sites, compiled again for processors that take more numbers at once than the oldest, which
//! takes a fraction of their time.
//!
//! Rust compiles for the oldest processors of an architecture unless told otherwise. Only the speed differs: no version
//! contracts or reorders operations. The crate's only unsafe code is here: calls of functions that need AVX2 or AVX-512, each
//! behind the question whether the processor has it, and loads and stores of whole lanes, each within a slice.
#![allow(unsafe_code)]

use std::ops::Range;

use glam::{DVec3, Vec3};

use crate::box_tree::{BoxSearch, BoxTree, Boxes, Slabs};
use crate::generator::Generator;
use crate::half_space::EVALUATION_ERROR;
use crate::site_tree::Columns;

/// Numbers that loops take at a time.
pub(crate) const LANES: usize = 8;

/// x, y and z of normals, and offsets, of planes `normal . y <= offset`.
pub(crate) type PlaneColumns<'a> = [&'a [[f32; LANES]]; 4];

/// A ray, and how much the normal of a plane must lie along it for the two to meet.
#[derive(Clone, Copy)]
pub(crate) struct Ray {
    pub(crate) start: Vec3,
    pub(crate) direction: Vec3,
    pub(crate) threshold: f32,
}

impl Ray {
    /// Where the ray meets a plane, in units of the direction; infinity if it does not.
    #[inline(always)]
    pub(crate) fn crossing(&self, x: f32, y: f32, z: f32, offset: f32) -> f32 {
        let slope = x * self.direction.x + y * self.direction.y + z * self.direction.z;
        let gap = offset - (x * self.start.x + y * self.start.y + z * self.start.z);
        let crossing = gap / slope;
        if slope > self.threshold { crossing } else { f32::INFINITY }
    }
}

/// Defines a function that calls `$anywhere`, compiled for what the processor has.
macro_rules! compiled_thrice {
    ($(#[$doc:meta])* fn $name:ident($($argument:ident: $type:ty),*) -> $result:ty = $anywhere:ident) => {
        $(#[$doc])*
        #[inline]
        pub(crate) fn $name($($argument: $type),*) -> $result {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn avx2($($argument: $type),*) -> $result {
                    $anywhere($($argument),*)
                }
                #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
                fn avx512($($argument: $type),*) -> $result {
                    $anywhere($($argument),*)
                }
                if has_avx512() {
                    // SAFETY: the processor has AVX-512.
                    return unsafe { avx512($($argument),*) };
                }
                if is_x86_feature_detected!("avx2") {
                    // SAFETY: the processor has AVX2.
                    return unsafe { avx2($($argument),*) };
                }
            }
            $anywhere($($argument),*)
        }
    };
}

#[cfg(target_arch = "x86_64")]
#[inline]
fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512dq")
}

compiled_thrice! {
    /// The first plane that a ray meets, and where; of several the first in number.
    fn first_crossing(columns: PlaneColumns, ray: &Ray) -> (f32, usize) = first_crossing_anywhere
}

#[inline(always)]
fn first_crossing_anywhere([x, y, z, offsets]: PlaneColumns, ray: &Ray) -> (f32, usize) {
    let mut nearest = [f32::INFINITY; LANES];
    let mut chunks = [0u32; LANES];
    for (chunk, (((x, y), z), offsets)) in (0u32..).zip(x.iter().zip(y).zip(z).zip(offsets)) {
        for lane in 0..LANES {
            let crossing = ray.crossing(x[lane], y[lane], z[lane], offsets[lane]);
            let is_nearer = crossing < nearest[lane];
            nearest[lane] = if is_nearer { crossing } else { nearest[lane] };
            chunks[lane] = if is_nearer { chunk } else { chunks[lane] };
        }
    }
    let mut least = nearest;
    for half in [4, 2, 1] {
        for lane in 0..half {
            least[lane] = if least[lane + half] < least[lane] { least[lane + half] } else { least[lane] };
        }
    }
    let mut first = usize::MAX;
    for lane in 0..LANES {
        let number = chunks[lane] as usize * LANES + lane;
        first = first.min(if nearest[lane] == least[0] { number } else { usize::MAX });
    }
    (least[0], first)
}

compiled_thrice! {
    /// Number of planes from which the point is not known to be more than `slack` inside.
    fn count_beyond(columns: PlaneColumns, point: Vec3, slack: f32) -> u32 = count_beyond_anywhere
}

#[inline(always)]
fn count_beyond_anywhere(columns: PlaneColumns, point: Vec3, slack: f32) -> u32 {
    let [x, y, z, offsets] = columns.map(<[_]>::as_flattened);
    let mut beyond = 0u32;
    for (((x, y), z), offset) in x.iter().zip(y).zip(z).zip(offsets) {
        let excess = x * point.x + y * point.y + z * point.z - offset;
        // What is not a number may be anything.
        let is_inside = excess < -slack;
        beyond += u32::from(!is_inside);
    }
    beyond
}

/// Points that are looked at together, of a number of which most are not wanted.
pub(crate) const CHUNK: usize = 4 * LANES;

compiled_thrice! {
    /// Lists the chunks of points, of which x, y, z and errors are given, that have one which may be farther beyond the plane
    /// `normal . y = offset` than a limit.
    fn find_beyond(points: [&[f64]; 4], normal: DVec3, offset: f64, limit: f64, chunks: &mut Vec<u32>) -> () = find_beyond_anywhere
}

#[inline(always)]
fn find_beyond_anywhere(
    [x, y, z, errors]: [&[f64]; 4],
    normal: DVec3,
    offset: f64,
    limit: f64,
    chunks: &mut Vec<u32>,
) {
    let sum = normal.x.abs() + normal.y.abs() + normal.z.abs();
    chunks.clear();
    let points = x.chunks(CHUNK).zip(y.chunks(CHUNK)).zip(z.chunks(CHUNK)).zip(errors.chunks(CHUNK));
    for (chunk, (((x, y), z), errors)) in (0u32..).zip(points) {
        let mut beyond = 0u64;
        for (((x, y), z), error) in x.iter().zip(y).zip(z).zip(errors) {
            let value = normal.x * x + normal.y * y + normal.z * z - offset;
            // What is not a number may be anything.
            let is_inside = value + sum * error < limit;
            beyond += u64::from(!is_inside);
        }
        if beyond > 0 {
            chunks.push(chunk);
        }
    }
}

compiled_thrice! {
    /// The largest square of a distance from the origin and the largest error of points, of which x, y, z and errors are given.
    fn farthest(points: [&[f64]; 4]) -> (f64, f64) = farthest_anywhere
}

#[inline(always)]
fn farthest_anywhere([x, y, z, errors]: [&[f64]; 4]) -> (f64, f64) {
    let (mut squares, mut largest) = ([0.0; LANES], [0.0; LANES]);
    let [xs, ys, zs, all_errors] = [x, y, z, errors].map(|column| column.as_chunks::<LANES>());
    for (((x, y), z), errors) in xs.0.iter().zip(ys.0).zip(zs.0).zip(all_errors.0) {
        for lane in 0..LANES {
            squares[lane] = larger(x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane], squares[lane]);
            largest[lane] = larger(errors[lane], largest[lane]);
        }
    }
    for (((x, y), z), error) in xs.1.iter().zip(ys.1).zip(zs.1).zip(all_errors.1) {
        squares[0] = larger(x * x + y * y + z * z, squares[0]);
        largest[0] = larger(*error, largest[0]);
    }
    (squares.into_iter().fold(0.0, larger), largest.into_iter().fold(0.0, larger))
}

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
    fn visit(&mut self, places: Range<usize>) -> bool {
        self.count += places.len();
        let [start, end] = [places.start, places.end].map(|place| place as u32);
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

/// The square, negative for a negative number.
#[inline(always)]
pub(crate) fn signed_square(number: f64) -> f64 {
    number * number.abs()
}

/// The larger of two numbers, in one instruction: which of them counts if one is none does not matter.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The ball around a vertex of a cell, in terms of powers: what lies in it cuts the vertex off.
pub(crate) struct Ball {
    /// The cell's seed.
    pub(crate) center: DVec3,
    pub(crate) own_weight: f64,
    /// Relative to the seed.
    pub(crate) vertex: DVec3,
    /// Bound on the errors of the coordinates of the vertex and of sites together.
    pub(crate) error: f64,
    /// What meets in the vertex.
    pub(crate) generators: [Generator; 4],
}

/// A search for the site that lies deepest in a ball, of those that certainly do.
pub(crate) struct DeepestSearch<'a> {
    ball: &'a Ball,
    columns: Columns<'a>,
    /// Bounds on the errors of depths are the first times the square of a site's distance from the seed, and the second.
    error: [f64; 2],
    /// The place of the deepest so far, and its depth.
    pub(crate) deepest: Option<usize>,
    depth: f64,
    /// As long as there is none, those that may lie in the ball.
    maybe: &'a mut Vec<Generator>,
}

impl<'a> DeepestSearch<'a> {
    pub(crate) fn new(ball: &'a Ball, columns: Columns<'a>, maybe: &'a mut Vec<Generator>) -> Self {
        // An error in the vertex counts by the site's distance d and twice the vertex's, an error in the site by twice these: with
        // the roots of 3 for errors of coordinates, by 7 times d and 14 times the other together. And d is at most half of d^2 / l
        // and l together, for any length l.
        let distance = ball.vertex.length();
        let length = (distance + LEAST_LENGTH * ball.error).max(f64::MIN_POSITIVE);
        let share = 2.0 * EVALUATION_ERROR + 3.5 * ball.error / length;
        let least = EVALUATION_ERROR * distance * distance + (3.5 * length + 14.0 * distance) * ball.error;
        Self { ball, columns, error: [share, least], deepest: None, depth: 0.0, maybe }
    }
}

/// A length that errors of squares are relative to, in units of the error of a coordinate: not so short that all would be lost.
const LEAST_LENGTH: f64 = 1e8;

compiled_thrice! {
    /// Looks for the deepest site in a ball.
    fn find_deepest(boxes: &BoxTree, search: &mut DeepestSearch) -> () = find_deepest_anywhere
}

#[inline(always)]
fn find_deepest_anywhere(boxes: &BoxTree, search: &mut DeepestSearch) {
    boxes.search(search);
}

impl BoxSearch for DeepestSearch<'_> {
    #[inline(always)]
    fn wanted(&self, boxes: &Boxes) -> u32 {
        let Ball { center, vertex, .. } = *self.ball;
        let nearest = |axis: usize, lane: usize| {
            let corners = [&boxes.lower, &boxes.upper];
            let [lower, upper] = corners.map(|corner| corner[axis][lane] - center[axis]);
            smaller(larger(vertex[axis], lower), upper)
        };
        self.may_be_deeper(nearest, &boxes.weights)
    }

    #[inline(always)]
    fn reached(&self, boxes: &Boxes, slabs: &Slabs) -> u32 {
        let Ball { center, own_weight, vertex, error, .. } = *self.ball;
        let place = center + vertex;
        // Of an offset, as errors of coordinates make at most the root of 3 times as much.
        let offset_error = 2.0 * error + EVALUATION_ERROR * (center.abs() + vertex.abs()).element_sum();
        let radius = vertex.length() * (1.0 + EVALUATION_ERROR) + 2.0 * error;
        let squared = radius * radius;
        let mut reached = 0;
        for lane in 0..LANES {
            let offset = slabs.normals[0][lane] * place.x
                + slabs.normals[1][lane] * place.y
                + slabs.normals[2][lane] * place.z
                - slabs.middles[lane];
            let gap = offset.abs() - slabs.halves[lane] - offset_error;
            let excess = boxes.weights[lane] - own_weight;
            let limit = squared + (excess + EVALUATION_ERROR * excess.abs());
            let is_beside = (gap > 0.0) & (gap * gap * (1.0 - EVALUATION_ERROR) > limit);
            reached |= u32::from(!is_beside) << lane;
        }
        reached
    }

    #[inline(always)]
    fn visit(&mut self, places: Range<usize>) -> bool {
        let Columns { sites, x, y, z, weights } = self.columns;
        let positions = [lanes(&x[places.clone()]), lanes(&y[places.clone()]), lanes(&z[places.clone()])];
        let weights = weights.map_or([0.0; LANES], |weights| lanes(&weights[places.clone()]));
        let center = self.ball.center;
        let mut chosen = self.may_be_deeper(|axis, lane| positions[axis][lane] - center[axis], &weights);
        chosen &= (1 << places.len()) - 1;
        while chosen != 0 {
            let lane = chosen.trailing_zeros() as usize;
            chosen &= chosen - 1;
            let site = Generator::site(sites[places.start + lane]);
            if self.ball.generators.contains(&site) {
                continue;
            }
            let [x, y, z] = [0, 1, 2].map(|axis| positions[axis][lane] - center[axis]);
            let (depth, error) = self.depth([x, y, z], weights[lane]);
            if depth + error < 0.0 {
                if self.deepest.is_none() || depth < self.depth {
                    (self.deepest, self.depth) = (Some(places.start + lane), depth);
                    self.maybe.clear();
                }
            } else if self.deepest.is_none() {
                self.maybe.push(site);
            }
        }
        true
    }
}

impl DeepestSearch<'_> {
    /// Of places near the seed, one for each lane, those that may lie deeper in the ball than the deepest site so far, a bit for each.
    /// Their coordinates are given by axis and lane.
    #[inline(always)]
    fn may_be_deeper(&self, place: impl Fn(usize, usize) -> f64, weights: &[f64; LANES]) -> u32 {
        let mut least = [0.0; LANES];
        for lane in 0..LANES {
            let (depth, error) = self.depth([place(0, lane), place(1, lane), place(2, lane)], weights[lane]);
            least[lane] = depth - error;
        }
        let mut chosen = 0;
        for (lane, least) in least.into_iter().enumerate() {
            let is_outside = least > self.depth;
            chosen |= u32::from(!is_outside) << lane;
        }
        chosen
    }

    /// By how much less the power of the vertex is from a site somewhere near the seed than from the seed, negative where it is less,
    /// and a bound on the error of that.
    #[inline(always)]
    fn depth(&self, [x, y, z]: [f64; 3], weight: f64) -> (f64, f64) {
        let Ball { own_weight, vertex, .. } = *self.ball;
        let [error_share, least_error] = self.error;
        let squared = x * x + y * y + z * z;
        let product = x * vertex.x + y * vertex.y + z * vertex.z;
        let excess = own_weight - weight;
        // The powers' common term, the square of the vertex, is left out: it may be far larger than the rest.
        let depth = squared - 2.0 * product + excess;
        (depth, error_share * squared + least_error + EVALUATION_ERROR * excess.abs())
    }
}

/// Numbers that fill the first lanes.
#[inline(always)]
fn lanes(numbers: &[f64]) -> [f64; LANES] {
    numbers.try_into().unwrap_or_else(|_| {
        let mut lanes = [0.0; LANES];
        lanes[..numbers.len()].copy_from_slice(numbers);
        lanes
    })
}

/// How bisectors are scaled.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Units {
    /// Units of offsets in a length of 1.
    pub(crate) scale: f64,
    /// A bisector's offset in these, for a normal and twice an offset of 1.
    pub(crate) half_unit: f64,
    /// Share of a difference of weights by which an offset is too small.
    pub(crate) weight_error: f64,
    /// The first site of which the position is rounded, and the largest factor of the normal of such a one's bisector. What needs a
    /// larger one is too near to be known, and may be anywhere.
    pub(crate) first_rounded: u32,
    pub(crate) largest_unit: f64,
}

/// A power of two: the factor that gives a vector, of which the squared length is given, a length near 1 (between the roots of
/// a half and of 2).
#[inline(always)]
pub(crate) fn unit(squared: f64) -> f64 {
    // The exponent's bias is 1023: halving an exponent and changing its sign takes three times as much.
    f64::from_bits(((3 * 1023 - (squared.to_bits() >> 52)) >> 1) << 52)
}

/// Which bisectors are wanted: those of a seed somewhere that are farther away than the first of two limits, if there is one, and no
/// farther than the second. Limits are signed squares of twice the distances.
pub(crate) struct Around {
    pub(crate) seed: u32,
    pub(crate) center: DVec3,
    pub(crate) own_weight: f64,
    pub(crate) limits: [Option<f64>; 2],
    pub(crate) units: Units,
}

/// Writes those bisectors with sites of some runs that are wanted to the beginnings of columns, and counts them.
///
/// # Panics
/// If columns are not longer than all runs together by at least [`LANES`].
#[inline]
pub(crate) fn compact(
    sites: Columns,
    runs: &[Range<u32>],
    around: &Around,
    generators: &mut [Generator],
    planes: [&mut [f32]; 4],
) -> usize {
    #[cfg(target_arch = "x86_64")]
    if has_avx512() {
        // SAFETY: the processor has AVX-512.
        return unsafe {
            match sites.weights {
                Some(weights) => avx512::compact::<true>(sites, weights, runs, around, generators, planes),
                None => avx512::compact::<false>(sites, &[], runs, around, generators, planes),
            }
        };
    }
    compact_anywhere(sites, runs, around, generators, planes)
}

fn compact_anywhere(
    sites: Columns,
    runs: &[Range<u32>],
    around: &Around,
    generators: &mut [Generator],
    planes: [&mut [f32]; 4],
) -> usize {
    match sites.weights {
        Some(weights) => compact_with::<true>(sites, weights, runs, around, generators, planes),
        // What stands for the weights is not looked at.
        None => compact_with::<false>(sites, sites.x, runs, around, generators, planes),
    }
}

#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "to be rounded")]
fn compact_with<const WEIGHTED: bool>(
    sites: Columns,
    weights: &[f64],
    runs: &[Range<u32>],
    &Around { seed, center, own_weight, limits: [from, to], units }: &Around,
    generators: &mut [Generator],
    [x, y, z, offsets]: [&mut [f32]; 4],
) -> usize {
    // Nothing is as near as what is not a number.
    let [from, to] = [from, to].map(|limit| limit.unwrap_or(f64::NAN));
    let mut kept = 0;
    for run in runs.iter().map(|run| run.start as usize..run.end as usize) {
        let positions = sites.x[run.clone()].iter().zip(&sites.y[run.clone()]).zip(&sites.z[run.clone()]);
        let weights = &weights[run.clone()];
        for ((((site_x, site_y), site_z), weight), site) in positions.zip(weights).zip(&sites.sites[run]) {
            let normal = DVec3::new(*site_x, *site_y, *site_z) - center;
            let squared = normal.length_squared();
            let (doubled_offset, is_within, is_nearer);
            if WEIGHTED {
                let excess = own_weight - weight;
                doubled_offset = squared + (excess - units.weight_error * excess.abs());
                let square = signed_square(squared + excess);
                is_within = square <= to * squared + f64::MIN_POSITIVE;
                is_nearer = square <= from * squared + f64::MIN_POSITIVE;
            } else {
                (doubled_offset, is_within, is_nearer) = (squared, squared <= to, squared <= from);
            }
            // Written in any case, and kept or overwritten by the next: branches would be mispredicted.
            let unit = unit(squared);
            generators[kept] = Generator(*site);
            (x[kept], y[kept], z[kept]) = (normal * unit).as_vec3().into();
            let offset = doubled_offset * units.half_unit * unit;
            let is_too_near = (unit > units.largest_unit) & (*site >= units.first_rounded);
            offsets[kept] = if is_too_near { f32::NEG_INFINITY } else { offset as f32 };
            kept += usize::from(!is_nearer & is_within & (*site != seed));
        }
    }
    kept
}

#[cfg(target_arch = "x86_64")]
mod avx512 {
    use std::arch::x86_64::*;
    use std::ops::Range;

    use crate::generator::Generator;
    use crate::site_tree::Columns;
    use crate::wide::Around;

    /// Doubles in a register.
    const WIDTH: usize = 8;

    #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
    pub(super) fn compact<const WEIGHTED: bool>(
        sites: Columns,
        weights: &[f64],
        runs: &[Range<u32>],
        around: &Around,
        generators: &mut [Generator],
        planes: [&mut [f32]; 4],
    ) -> usize {
        let len = sites.sites.len();
        assert!([sites.x, sites.y, sites.z].iter().all(|column| column.len() == len));
        assert!(!WEIGHTED || weights.len() == len);
        let most: usize = runs.iter().map(|run| run.len()).sum();
        assert!(generators.len() >= most + WIDTH && planes.iter().all(|column| column.len() >= most + WIDTH));
        let [x, y, z, offsets] = planes.map(<[f32]>::as_mut_ptr);
        let generators: *mut Generator = generators.as_mut_ptr();

        let [center_x, center_y, center_z] = around.center.to_array().map(|number| _mm512_set1_pd(number));
        // Nothing is as near as what is not a number.
        let [from, to] = around.limits.map(|limit| _mm512_set1_pd(limit.unwrap_or(f64::NAN)));
        let least = _mm512_set1_pd(f64::MIN_POSITIVE);
        let own_weight = _mm512_set1_pd(around.own_weight);
        let weight_error = _mm512_set1_pd(around.units.weight_error);
        let half_unit = _mm512_set1_pd(around.units.half_unit);
        let largest_unit = _mm512_set1_pd(around.units.largest_unit);
        let first_rounded = _mm256_set1_epi32(around.units.first_rounded.cast_signed());
        let nowhere = _mm512_set1_pd(f64::NEG_INFINITY);
        let biases = _mm512_set1_epi64(3 * 1023);
        let seed = _mm256_set1_epi32(around.seed.cast_signed());
        let mut kept = 0;
        for run in runs.iter().map(|run| run.start as usize..run.end as usize) {
            assert!(run.end <= len);
            for first in run.clone().step_by(WIDTH) {
                let lanes = (run.end - first).min(WIDTH);
                let mask = 0xffu8 >> (WIDTH - lanes);
                // SAFETY: the lanes that are loaded are places of the run, which all columns have.
                let (x_1, y_1, z_1, numbers) = unsafe {
                    (
                        _mm512_maskz_loadu_pd(mask, sites.x.as_ptr().add(first)),
                        _mm512_maskz_loadu_pd(mask, sites.y.as_ptr().add(first)),
                        _mm512_maskz_loadu_pd(mask, sites.z.as_ptr().add(first)),
                        _mm256_maskz_loadu_epi32(mask, sites.sites.as_ptr().add(first).cast()),
                    )
                };
                let x_1 = _mm512_sub_pd(x_1, center_x);
                let y_1 = _mm512_sub_pd(y_1, center_y);
                let z_1 = _mm512_sub_pd(z_1, center_z);
                let squared = _mm512_add_pd(
                    _mm512_add_pd(_mm512_mul_pd(x_1, x_1), _mm512_mul_pd(y_1, y_1)),
                    _mm512_mul_pd(z_1, z_1),
                );
                let exponent = _mm512_srli_epi64::<52>(_mm512_castpd_si512(squared));
                let halved = _mm512_srli_epi64::<1>(_mm512_sub_epi64(biases, exponent));
                let unit = _mm512_castsi512_pd(_mm512_slli_epi64::<52>(halved));
                let (offset, size, limits) = if WEIGHTED {
                    // SAFETY: weights have the same places.
                    let weight = unsafe { _mm512_maskz_loadu_pd(mask, weights.as_ptr().add(first)) };
                    let excess = _mm512_sub_pd(own_weight, weight);
                    let error = _mm512_mul_pd(weight_error, _mm512_abs_pd(excess));
                    let doubled = _mm512_add_pd(squared, excess);
                    let limit = |limit| _mm512_add_pd(_mm512_mul_pd(limit, squared), least);
                    (
                        _mm512_add_pd(squared, _mm512_sub_pd(excess, error)),
                        _mm512_mul_pd(doubled, _mm512_abs_pd(doubled)),
                        [limit(from), limit(to)],
                    )
                } else {
                    (squared, squared, [from, to])
                };
                let offset = _mm512_mul_pd(_mm512_mul_pd(offset, half_unit), unit);
                let is_too_near = _mm512_cmp_pd_mask::<_CMP_GT_OQ>(unit, largest_unit)
                    & _mm256_cmpge_epu32_mask(numbers, first_rounded);
                let offset = _mm512_mask_mov_pd(offset, is_too_near, nowhere);
                let keep = _mm512_mask_cmp_pd_mask::<_CMP_NLE_UQ>(mask, size, limits[0])
                    & _mm512_cmp_pd_mask::<_CMP_LE_OQ>(size, limits[1])
                    & _mm256_cmpneq_epi32_mask(numbers, seed);
                let single = |wide| _mm512_cvtpd_ps(wide);
                // SAFETY: fewer planes were kept than there are sites before `first` in the runs, and that and the width is at
                // most the length of all columns; a generator is a number of 32 bits.
                unsafe {
                    let store = |column: *mut f32, lanes| {
                        _mm256_storeu_ps(column.add(kept), _mm256_maskz_compress_ps(keep, lanes));
                    };
                    store(x, single(_mm512_mul_pd(x_1, unit)));
                    store(y, single(_mm512_mul_pd(y_1, unit)));
                    store(z, single(_mm512_mul_pd(z_1, unit)));
                    store(offsets, single(offset));
                    let numbers = _mm256_maskz_compress_epi32(keep, numbers);
                    _mm256_storeu_si256(generators.add(kept).cast(), numbers);
                }
                kept += keep.count_ones() as usize;
            }
        }
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers between -1 and 1 without a pattern.
    fn column(seed: u32) -> Vec<f64> {
        (0..101u32).map(|i| f64::from((i + 1) * seed).sin()).collect()
    }

    #[test]
    fn what_processors_differ_in_gives_the_same_planes() {
        let (x, y, z, weights) = (column(12_345), column(23_456), column(34_567), column(45_678));
        let sites: Vec<u32> = (0..101).collect();
        let runs = [0..7, 9..42, 42..50, 50..101];
        let (center, own_weight) = (DVec3::new(0.1, 0.2, 0.3), 0.4);
        // From site 30 on those nearer than about a quarter are too near.
        let units =
            Units { scale: 2.0, half_unit: 1.0, weight_error: 1e-6, first_rounded: 30, largest_unit: 2.0 };
        let limits = [Some(signed_square(0.1)), Some(signed_square(0.9))];
        let around = Around { seed: 17, center, own_weight, limits, units };
        let mut columns = [const { Vec::new() }; 4];
        for weights in [Some(&weights[..]), None] {
            let sites = Columns { sites: &sites, x: &x, y: &y, z: &z, weights };
            let [mut found, mut plain] =
                [(); 2].map(|()| (vec![Generator(0); 101 + LANES], [const { [0.0f32; 101 + LANES] }; 4]));
            let (generators, planes) = (&mut found.0, found.1.each_mut().map(|column| &mut column[..]));
            let count = compact(sites, &runs, &around, generators, planes);
            let (generators, planes) = (&mut plain.0, plain.1.each_mut().map(|column| &mut column[..]));
            assert_eq!(count, compact_anywhere(sites, &runs, &around, generators, planes));
            let generators = &found.0[..count];
            columns = found.1.each_ref().map(|column| column[..count].to_vec());
            assert_eq!(generators, &plain.0[..count]);
            assert_eq!(columns, plain.1.each_ref().map(|column| column[..count].to_vec()));
            let near = |k: usize| {
                let squared = (DVec3::new(x[k], y[k], z[k]) - center).length_squared();
                let excess = weights.map_or(0.0, |weights| own_weight - weights[k]);
                let doubled_distance = (squared + excess) / squared.sqrt();
                k != 17 && k != 7 && k != 8 && doubled_distance > 0.1 && doubled_distance <= 0.9
            };
            let expected: Vec<usize> = (0..101).filter(|k| near(*k)).collect();
            assert!(generators.iter().map(|generator| generator.0 as usize).eq(expected.iter().copied()));
            assert!(!expected.is_empty());
        }

        assert!(columns[3].contains(&f32::NEG_INFINITY));
        let columns = columns.each_ref().map(|column| &column[..]);
        let planes = columns.map(|column| column.as_chunks().0);
        let point = Vec3::new(0.3, -0.2, 0.1);
        assert_eq!(count_beyond(planes, point, 0.01), count_beyond_anywhere(planes, point, 0.01));
        let ray = Ray { start: point, direction: Vec3::new(0.6, 0.0, 0.8), threshold: 1e-5 };
        let (crossing, number) = first_crossing(planes, &ray);
        assert_eq!((crossing, number), first_crossing_anywhere(planes, &ray));
        let [x, y, z, offsets] = planes.map(<[_]>::as_flattened);
        let least = (0..x.len()).map(|k| (ray.crossing(x[k], y[k], z[k], offsets[k]), k));
        assert_eq!((crossing, number), least.reduce(|a, b| if b < a { b } else { a }).expect("planes"));
    }
}
