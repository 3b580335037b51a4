//! Loops over columns of planes and sites, compiled again for processors that take more numbers at once than the oldest, which
//! takes a fraction of their time.
//!
//! Rust compiles for the oldest processors of an architecture unless told otherwise. Only the speed differs: no version
//! contracts or reorders operations. The crate's only unsafe code is here: calls of functions that need AVX2 or AVX-512, each
//! behind the question whether the processor has it, and loads and stores of whole lanes, each within a slice.
#![allow(unsafe_code)]

use std::ops::Range;

use glam::{DVec3, Vec3};

use crate::generator::Generator;
use crate::grid::Columns;

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

/// How bisectors are scaled.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Units {
    /// Units of offsets in a length of 1.
    pub(crate) scale: f64,
    /// A bisector's offset in these, for a normal and a square of the distance between its sites of 1.
    pub(crate) half_square: f64,
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

/// Which bisectors are wanted: those of a seed somewhere with sites of which the squares of the distances are more than the first of
/// two and at most the second.
pub(crate) struct Around {
    pub(crate) seed: u32,
    pub(crate) center: DVec3,
    pub(crate) squares: [f64; 2],
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
        return unsafe { avx512::compact(sites, runs, around, generators, planes) };
    }
    compact_anywhere(sites, runs, around, generators, planes)
}

#[expect(clippy::cast_possible_truncation, reason = "to be rounded")]
fn compact_anywhere(
    sites: Columns,
    runs: &[Range<u32>],
    &Around { seed, center, squares: [from, to], units }: &Around,
    generators: &mut [Generator],
    [x, y, z, offsets]: [&mut [f32]; 4],
) -> usize {
    let mut kept = 0;
    for run in runs.iter().map(|run| run.start as usize..run.end as usize) {
        let columns = sites.x[run.clone()].iter().zip(&sites.y[run.clone()]).zip(&sites.z[run.clone()]);
        for (((site_x, site_y), site_z), site) in columns.zip(&sites.sites[run]) {
            let normal = DVec3::new(*site_x, *site_y, *site_z) - center;
            let squared = normal.length_squared();
            // Written in any case, and kept or overwritten by the next: branches would be mispredicted.
            let unit = unit(squared);
            generators[kept] = Generator(*site);
            (x[kept], y[kept], z[kept]) = (normal * unit).as_vec3().into();
            let offset = squared * units.half_square * unit;
            let is_too_near = (unit > units.largest_unit) & (*site >= units.first_rounded);
            offsets[kept] = if is_too_near { f32::NEG_INFINITY } else { offset as f32 };
            kept += usize::from((squared > from) & (squared <= to) & (*site != seed));
        }
    }
    kept
}

#[cfg(target_arch = "x86_64")]
mod avx512 {
    use std::arch::x86_64::*;
    use std::ops::Range;

    use crate::generator::Generator;
    use crate::grid::Columns;
    use crate::wide::Around;

    /// Doubles in a register.
    const WIDTH: usize = 8;

    #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
    pub(super) fn compact(
        sites: Columns,
        runs: &[Range<u32>],
        around: &Around,
        generators: &mut [Generator],
        planes: [&mut [f32]; 4],
    ) -> usize {
        let len = sites.sites.len();
        assert!([sites.x, sites.y, sites.z].iter().all(|column| column.len() == len));
        let most: usize = runs.iter().map(|run| run.len()).sum();
        assert!(generators.len() >= most + WIDTH && planes.iter().all(|column| column.len() >= most + WIDTH));
        let [x, y, z, offsets] = planes.map(<[f32]>::as_mut_ptr);
        let generators: *mut Generator = generators.as_mut_ptr();

        let [center_x, center_y, center_z] = around.center.to_array().map(|number| _mm512_set1_pd(number));
        let [from, to] = around.squares.map(|square| _mm512_set1_pd(square));
        let half_square = _mm512_set1_pd(around.units.half_square);
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
                let offset = _mm512_mul_pd(_mm512_mul_pd(squared, half_square), unit);
                let is_too_near = _mm512_cmp_pd_mask::<_CMP_GT_OQ>(unit, largest_unit)
                    & _mm256_cmpge_epu32_mask(numbers, first_rounded);
                let offset = _mm512_mask_mov_pd(offset, is_too_near, nowhere);
                let keep = _mm512_mask_cmp_pd_mask::<_CMP_GT_OQ>(mask, squared, from)
                    & _mm512_cmp_pd_mask::<_CMP_LE_OQ>(squared, to)
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
        let (x, y, z) = (column(12_345), column(23_456), column(34_567));
        let sites: Vec<u32> = (0..101).collect();
        let sites = Columns { sites: &sites, x: &x, y: &y, z: &z };
        let runs = [0..7, 9..42, 42..50, 50..101];
        let (center, squares) = (DVec3::new(0.1, 0.2, 0.3), [0.01, 0.9]);
        // From site 30 on those nearer than about a quarter are too near.
        let units = Units { scale: 2.0, half_square: 1.0, first_rounded: 30, largest_unit: 2.0 };
        let around = Around { seed: 17, center, squares, units };
        let [mut found, mut plain] =
            [(); 2].map(|()| (vec![Generator(0); 101 + LANES], [const { [0.0f32; 101 + LANES] }; 4]));
        let (generators, columns) = (&mut found.0, found.1.each_mut().map(|column| &mut column[..]));
        let count = compact(sites, &runs, &around, generators, columns);
        let (generators, columns) = (&mut plain.0, plain.1.each_mut().map(|column| &mut column[..]));
        assert_eq!(count, compact_anywhere(sites, &runs, &around, generators, columns));
        let (generators, columns) = (&found.0[..count], found.1.each_ref().map(|column| &column[..count]));
        assert_eq!(generators, &plain.0[..count]);
        assert_eq!(columns, plain.1.each_ref().map(|column| &column[..count]));
        assert!(columns[3].contains(&f32::NEG_INFINITY));
        let near = |k: usize| {
            let squared = (DVec3::new(x[k], y[k], z[k]) - center).length_squared();
            k != 17 && k != 7 && k != 8 && squared > squares[0] && squared <= squares[1]
        };
        let expected: Vec<usize> = (0..101).filter(|k| near(*k)).collect();
        assert!(generators.iter().map(|generator| generator.0 as usize).eq(expected.iter().copied()));

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
