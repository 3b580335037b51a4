//! The bisectors of a seed with many sites, in columns.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;

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
    match sites.weights {
        Some(weights) => compact_by_processor::<true>(sites, weights, runs, around, generators, planes),
        // What stands for the weights is not looked at.
        None => compact_by_processor::<false>(sites, sites.x, runs, around, generators, planes),
    }
}

#[inline]
fn compact_by_processor<const WEIGHTED: bool>(
    sites: Columns,
    weights: &[f64],
    runs: &[Range<u32>],
    around: &Around,
    generators: &mut [Generator],
    planes: [&mut [f32]; 4],
) -> usize {
    #[cfg(target_arch = "x86_64")]
    {
        if crate::lanes::has_avx512() {
            // SAFETY: the processor has AVX-512.
            return unsafe { avx512::compact::<WEIGHTED>(sites, weights, runs, around, generators, planes) };
        }
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("popcnt") {
            // SAFETY: the processor has AVX2, and counts bits.
            return unsafe { avx2::compact::<WEIGHTED>(sites, weights, runs, around, generators, planes) };
        }
    }
    compact_anywhere::<WEIGHTED>(sites, weights, runs, around, generators, planes)
}

#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "to be rounded")]
fn compact_anywhere<const WEIGHTED: bool>(
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
            let anywhere = match weights {
                Some(weights) => compact_anywhere::<true>(sites, weights, &runs, &around, generators, planes),
                None => compact_anywhere::<false>(sites, &x, &runs, &around, generators, planes),
            };
            assert_eq!(count, anywhere);
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
