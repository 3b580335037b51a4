//! The bisectors of a seed with many sites, in columns.
#![allow(unsafe_code)]

use std::ops::Range;

use glam::DVec3;

use crate::exact::generator::Generator;
use crate::sites::columns::Columns;

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
/// If columns are not longer than all runs together by at least [`LANES`](crate::lanes::LANES).
#[inline]
pub(crate) fn compact(
    sites: Columns,
    runs: &[Range<u32>],
    around: &Around,
    generators: &mut [Generator],
    planes: [&mut [f32]; 4],
) -> usize {
    #[cfg(target_arch = "x86_64")]
    if crate::lanes::has_avx512() {
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

    use super::{Around, Columns, Generator};

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
                // SAFETY: the lanes that are loaded are indices of the run, which all columns have.
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
                    // SAFETY: weights have the same indices.
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

/// The square, negative for a negative number.
#[inline(always)]
pub(crate) fn signed_square(number: f64) -> f64 {
    number * number.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::LANES;

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
    }
}
