//! The same for processors with AVX-512.

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
