//! The same for processors with AVX2. They have no instruction that packs what is kept: a table tells where it goes.

use std::arch::x86_64::*;
use std::ops::Range;

use super::{Around, Columns, Generator};

/// Doubles in a register.
const WIDTH: usize = 4;

/// Of each set of lanes, its lanes first, in order.
const PACKED: [[i32; WIDTH]; 1 << WIDTH] = {
    let lanes: [i32; WIDTH] = [0, 1, 2, 3];
    let mut packed = [[0; WIDTH]; 1 << WIDTH];
    let mut set = 0;
    while set < packed.len() {
        let (mut lane, mut place) = (0, 0);
        while lane < WIDTH {
            if set >> lane & 1 == 1 {
                packed[set][place] = lanes[lane];
                place += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    packed
};

#[target_feature(enable = "avx2,popcnt")]
pub(super) fn compact<const WEIGHTED: bool>(
    sites: Columns,
    weights: &[f64],
    runs: &[Range<u32>],
    around: &Around,
    generators: &mut [Generator],
    [x, y, z, offsets]: [&mut [f32]; 4],
) -> usize {
    let wide = |number| _mm256_set1_pd(number);
    let [center_x, center_y, center_z] =
        [wide(around.center.x), wide(around.center.y), wide(around.center.z)];
    // Nothing is as near as what is not a number.
    let [from, to] = [wide(around.limits[0].unwrap_or(f64::NAN)), wide(around.limits[1].unwrap_or(f64::NAN))];
    let least = wide(f64::MIN_POSITIVE);
    let sign = wide(-0.0);
    let own_weight = wide(around.own_weight);
    let weight_error = wide(around.units.weight_error);
    let half_unit = wide(around.units.half_unit);
    let largest_unit = wide(around.units.largest_unit);
    let first_rounded = _mm_set1_epi32(around.units.first_rounded.cast_signed());
    let nowhere = _mm_set1_ps(f32::NEG_INFINITY);
    let biases = _mm256_set1_epi64x(3 * 1023);
    let seed = _mm_set1_epi32(around.seed.cast_signed());
    let mut kept = 0;
    for run in runs.iter().map(|run| run.start as usize..run.end as usize) {
        for first in run.clone().step_by(WIDTH) {
            let lanes = first..run.end.min(first + WIDTH);
            // The seed is not wanted: what lies beyond the run is taken for it.
            let numbers = numbers_of(&sites.sites[lanes.clone()], around.seed);
            let x_1 = _mm256_sub_pd(doubles(&sites.x[lanes.clone()]), center_x);
            let y_1 = _mm256_sub_pd(doubles(&sites.y[lanes.clone()]), center_y);
            let z_1 = _mm256_sub_pd(doubles(&sites.z[lanes.clone()]), center_z);
            let squared = _mm256_add_pd(
                _mm256_add_pd(_mm256_mul_pd(x_1, x_1), _mm256_mul_pd(y_1, y_1)),
                _mm256_mul_pd(z_1, z_1),
            );
            let exponent = _mm256_srli_epi64::<52>(_mm256_castpd_si256(squared));
            let halved = _mm256_srli_epi64::<1>(_mm256_sub_epi64(biases, exponent));
            let unit = _mm256_castsi256_pd(_mm256_slli_epi64::<52>(halved));
            let (offset, size, limits) = if WEIGHTED {
                let excess = _mm256_sub_pd(own_weight, doubles(&weights[lanes]));
                let error = _mm256_mul_pd(weight_error, _mm256_andnot_pd(sign, excess));
                let doubled = _mm256_add_pd(squared, excess);
                let limit = |limit| _mm256_add_pd(_mm256_mul_pd(limit, squared), least);
                (
                    _mm256_add_pd(squared, _mm256_sub_pd(excess, error)),
                    _mm256_mul_pd(doubled, _mm256_andnot_pd(sign, doubled)),
                    [limit(from), limit(to)],
                )
            } else {
                (squared, squared, [from, to])
            };
            let is_near = _mm256_cmp_pd::<_CMP_LE_OQ>(size, limits[1]);
            let is_wanted = _mm256_and_pd(_mm256_cmp_pd::<_CMP_NLE_UQ>(size, limits[0]), is_near);
            let is_own = _mm_castsi128_ps(_mm_cmpeq_epi32(numbers, seed));
            let keep = _mm256_movemask_pd(is_wanted) & !_mm_movemask_ps(is_own);
            let is_rounded = _mm_cmpeq_epi32(_mm_max_epu32(numbers, first_rounded), numbers);
            let is_too_near = _mm_and_ps(
                halves(_mm256_cmp_pd::<_CMP_GT_OQ>(unit, largest_unit)),
                _mm_castsi128_ps(is_rounded),
            );
            let offset = _mm256_cvtpd_ps(_mm256_mul_pd(_mm256_mul_pd(offset, half_unit), unit));
            let offset = _mm_blendv_ps(offset, nowhere, is_too_near);
            let [a, b, c, d] = PACKED[keep.cast_unsigned() as usize & (PACKED.len() - 1)];
            let places = _mm_setr_epi32(a, b, c, d);
            let slots = kept..kept + WIDTH;
            for (column, lanes) in [(&mut *x, x_1), (&mut *y, y_1), (&mut *z, z_1)] {
                let lanes = _mm256_cvtpd_ps(_mm256_mul_pd(lanes, unit));
                column[slots.clone()].copy_from_slice(&singles(_mm_permutevar_ps(lanes, places)));
            }
            offsets[slots.clone()].copy_from_slice(&singles(_mm_permutevar_ps(offset, places)));
            let packed = _mm_castps_si128(_mm_permutevar_ps(_mm_castsi128_ps(numbers), places));
            generators[slots].copy_from_slice(&generators_of(packed));
            kept += keep.count_ones() as usize;
        }
    }
    kept
}

/// Numbers in a register, and zeros where there are fewer.
#[inline]
#[target_feature(enable = "avx2")]
fn doubles(numbers: &[f64]) -> __m256d {
    match *numbers {
        [a, b, c, d] => _mm256_setr_pd(a, b, c, d),
        [a, b, c] => _mm256_setr_pd(a, b, c, 0.0),
        [a, b] => _mm256_setr_pd(a, b, 0.0, 0.0),
        [a] => _mm256_setr_pd(a, 0.0, 0.0, 0.0),
        _ => _mm256_setzero_pd(),
    }
}

/// Numbers of sites in a register, and another number where there are fewer.
#[inline]
#[target_feature(enable = "avx2")]
fn numbers_of(sites: &[u32], other: u32) -> __m128i {
    let number = |lane: usize| sites.get(lane).map_or(other, |site| *site).cast_signed();
    match *sites {
        [a, b, c, d] => _mm_setr_epi32(a.cast_signed(), b.cast_signed(), c.cast_signed(), d.cast_signed()),
        _ => _mm_setr_epi32(number(0), number(1), number(2), other.cast_signed()),
    }
}

#[inline]
#[target_feature(enable = "avx2")]
fn singles(lanes: __m128) -> [f32; WIDTH] {
    bits(_mm_castps_si128(lanes)).map(f32::from_bits)
}

#[inline]
#[target_feature(enable = "avx2")]
fn generators_of(lanes: __m128i) -> [Generator; WIDTH] {
    bits(lanes).map(Generator)
}

/// What the lanes hold: compiled to one store.
#[inline]
#[target_feature(enable = "avx2")]
fn bits(lanes: __m128i) -> [u32; WIDTH] {
    [
        _mm_extract_epi32::<0>(lanes).cast_unsigned(),
        _mm_extract_epi32::<1>(lanes).cast_unsigned(),
        _mm_extract_epi32::<2>(lanes).cast_unsigned(),
        _mm_extract_epi32::<3>(lanes).cast_unsigned(),
    ]
}

/// The lower halves of lanes that are all ones or all zeros.
#[inline]
#[target_feature(enable = "avx2")]
fn halves(mask: __m256d) -> __m128 {
    let mask = _mm256_castpd_ps(mask);
    _mm_shuffle_ps::<0b10_00_10_00>(_mm256_castps256_ps128(mask), _mm256_extractf128_ps::<1>(mask))
}
