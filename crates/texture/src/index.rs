//! How sharp the texture of measured orientations is.

use crate::{CrystalSymmetry, Kernel, Orientation};

/// Others that each orientation is compared with at most: 20 000 orientations so take half a second.
const MOST_OTHERS: usize = 1000;

/// The angle, in halfwidths, beyond which a kernel's density is nothing: 2^-64 of its peak.
const REACH: f64 = 8.0;

/// The texture index of measured orientations with weights: the mean, by weight, of the density at each that the others have, each spread
/// by a kernel.
///
/// Random orientations have 1 on average, however few. A sharp texture has less than its own index, as the kernel spreads it. Of many
/// orientations each is compared with a thousand others, those that follow it in the list.
///
/// Nothing for fewer than two with a positive weight.
pub fn texture_index(
    weighted: &[(Orientation, f64)],
    kernel: Kernel,
    symmetry: CrystalSymmetry,
) -> Option<f64> {
    let count = weighted.len();
    let rotations = symmetry.rotations();
    let least_cosine = (0.5 * (REACH * kernel.halfwidth()).min(180.0)).to_radians().cos();
    let density = |a: Orientation, b: Orientation| {
        let between = a.raw().conjugate() * b.raw();
        let cosines = rotations.iter().map(|rotation| rotation.dot(between).abs().min(1.0));
        let near = cosines.filter(|cosine| *cosine >= least_cosine);
        near.map(|cosine| kernel.density(2.0 * cosine.acos().to_degrees())).sum::<f64>()
            / rotations.len() as f64
    };
    // Around the list, so that each meets as many others.
    let others = (count / 2).min(MOST_OTHERS);
    let (mut sum, mut weights) = (0.0, 0.0);
    for (first, (one, weight)) in weighted.iter().enumerate() {
        for step in 1..=others {
            let (other, other_weight) = weighted[(first + step) % count];
            let product = weight * other_weight;
            weights += product;
            sum += product * density(*one, other);
        }
    }
    (weights > 0.0).then(|| sum / weights)
}
