//! Loops over columns of planes and sites, compiled again for processors that take more numbers at once than the oldest, which
//! takes a fraction of their time.
//!
//! Rust compiles for the oldest processors of an architecture unless told otherwise. Only the speed differs: no version
//! contracts or reorders operations. The crate's only unsafe code is here: calls of functions that need AVX2 or AVX-512, each
//! behind the question whether the processor has it, and loads and stores of whole lanes, each within a slice.
#![allow(unsafe_code)]

use glam::{DVec3, Vec3};

use crate::generator::Generator;
use crate::grid::Run;

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

/// The bisectors of `seed` at `center` with the sites of a run, of which the squares of their distances are more than `from` and at
/// most `to`. They are written to the columns' beginnings, and counted.
///
/// # Panics
/// If columns are not longer than the run by at least [`LANES`].
#[inline]
pub(crate) fn compact(
    run: &Run,
    seed: u32,
    center: DVec3,
    squares: [f64; 2],
    units: Units,
    generators: &mut [Generator],
    columns: [&mut [f32]; 4],
) -> usize {
    #[cfg(target_arch = "x86_64")]
    if has_avx512() {
        // SAFETY: the processor has AVX-512.
        return unsafe { avx512::compact(run, seed, center, squares, units, generators, columns) };
    }
    compact_anywhere(run, seed, center, squares, units, generators, columns)
}

#[expect(clippy::cast_possible_truncation, reason = "to be rounded")]
fn compact_anywhere(
    run: &Run,
    seed: u32,
    center: DVec3,
    [from, to]: [f64; 2],
    units: Units,
    generators: &mut [Generator],
    columns: [&mut [f32]; 4],
) -> usize {
    let count = run.sites.len();
    let (run_x, run_y, run_z) = (&run.x[..count], &run.y[..count], &run.z[..count]);
    let [x, y, z, offsets] = columns.map(|column| &mut column[..count]);
    let generators = &mut generators[..count];
    let mut kept = 0;
    for k in 0..count {
        let normal = DVec3::new(run_x[k], run_y[k], run_z[k]) - center;
        let squared = normal.length_squared();
        // Written in any case, and kept or overwritten by the next: branches would be mispredicted.
        let unit = unit(squared);
        generators[kept] = Generator(run.sites[k]);
        (x[kept], y[kept], z[kept]) = (normal * unit).as_vec3().into();
        let offset = squared * units.half_square * unit;
        let is_too_near = (unit > units.largest_unit) & (run.sites[k] >= units.first_rounded);
        offsets[kept] = if is_too_near { f32::NEG_INFINITY } else { offset as f32 };
        kept += usize::from((squared > from) & (squared <= to) & (run.sites[k] != seed));
    }
    kept
}

#[cfg(target_arch = "x86_64")]
mod avx512 {
    use std::arch::x86_64::*;

    use glam::DVec3;

    use crate::generator::Generator;
    use crate::grid::Run;
    use crate::wide::Units;

    /// Doubles in a register.
    const WIDTH: usize = 8;

    #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
    pub(super) fn compact(
        run: &Run,
        seed: u32,
        center: DVec3,
        [from, to]: [f64; 2],
        units: Units,
        generators: &mut [Generator],
        [x, y, z, offsets]: [&mut [f32]; 4],
    ) -> usize {
        let count = run.sites.len();
        let [center_x, center_y, center_z] = center.to_array().map(|coordinate| _mm512_set1_pd(coordinate));
        let [from, to] = [from, to].map(|square| _mm512_set1_pd(square));
        let half_square = _mm512_set1_pd(units.half_square);
        let largest_unit = _mm512_set1_pd(units.largest_unit);
        let first_rounded = _mm256_set1_epi32(units.first_rounded.cast_signed());
        let nowhere = _mm512_set1_pd(f64::NEG_INFINITY);
        let biases = _mm512_set1_epi64(3 * 1023);
        let seed = _mm256_set1_epi32(seed.cast_signed());
        let mut kept = 0;
        for first in (0..count).step_by(WIDTH) {
            let lanes = (count - first).min(WIDTH);
            let mask = 0xffu8 >> (WIDTH - lanes);
            let range = first..first + lanes;
            // SAFETY: only the lanes of the slices are loaded.
            let (x_1, y_1, z_1, sites) = unsafe {
                (
                    _mm512_maskz_loadu_pd(mask, run.x[range.clone()].as_ptr()),
                    _mm512_maskz_loadu_pd(mask, run.y[range.clone()].as_ptr()),
                    _mm512_maskz_loadu_pd(mask, run.z[range.clone()].as_ptr()),
                    _mm256_maskz_loadu_epi32(mask, run.sites[range].as_ptr().cast()),
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
                & _mm256_cmpge_epu32_mask(sites, first_rounded);
            let offset = _mm512_mask_mov_pd(offset, is_too_near, nowhere);
            let keep = _mm512_mask_cmp_pd_mask::<_CMP_GT_OQ>(mask, squared, from)
                & _mm512_cmp_pd_mask::<_CMP_LE_OQ>(squared, to)
                & _mm256_cmpneq_epi32_mask(sites, seed);
            let room = kept..kept + WIDTH;
            let single = |wide| _mm512_cvtpd_ps(wide);
            // SAFETY: the slices have the length of what is stored; a generator is a number of 32 bits.
            unsafe {
                let store = |column: &mut [f32], lanes| {
                    _mm256_storeu_ps(
                        column[room.clone()].as_mut_ptr(),
                        _mm256_maskz_compress_ps(keep, lanes),
                    );
                };
                store(x, single(_mm512_mul_pd(x_1, unit)));
                store(y, single(_mm512_mul_pd(y_1, unit)));
                store(z, single(_mm512_mul_pd(z_1, unit)));
                store(offsets, single(offset));
                _mm256_storeu_si256(
                    generators[room.clone()].as_mut_ptr().cast(),
                    _mm256_maskz_compress_epi32(keep, sites),
                );
            }
            kept += keep.count_ones() as usize;
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
        let run = Run { sites: &sites, x: &x, y: &y, z: &z };
        let (center, squares) = (DVec3::new(0.1, 0.2, 0.3), [0.01, 0.9]);
        let [mut found, mut plain] =
            [(); 2].map(|()| (vec![Generator(0); 101 + LANES], [const { [0.0f32; 101 + LANES] }; 4]));
        let (generators, columns) = (&mut found.0, found.1.each_mut().map(|column| &mut column[..]));
        // From site 30 on those nearer than about a quarter are too near.
        let units = Units { scale: 2.0, half_square: 1.0, first_rounded: 30, largest_unit: 2.0 };
        let count = compact(&run, 17, center, squares, units, generators, columns);
        let (generators, columns) = (&mut plain.0, plain.1.each_mut().map(|column| &mut column[..]));
        assert_eq!(count, compact_anywhere(&run, 17, center, squares, units, generators, columns));
        let (generators, columns) = (&found.0[..count], found.1.each_ref().map(|column| &column[..count]));
        assert_eq!(generators, &plain.0[..count]);
        assert_eq!(columns, plain.1.each_ref().map(|column| &column[..count]));
        assert!(columns[3].contains(&f32::NEG_INFINITY));
        let near = |k: usize| {
            let squared = (DVec3::new(x[k], y[k], z[k]) - center).length_squared();
            k != 17 && squared > squares[0] && squared <= squares[1]
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
