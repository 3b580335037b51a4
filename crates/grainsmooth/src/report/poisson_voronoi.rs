//! What the cells of random seeds in unbounded space are like: the curves beside a run's own histograms.

use std::f64::consts::PI;

use voronoi::Dimension;

/// Width of the bins of [`size_shares`], in units of the mean volume.
pub(super) const SIZE_BIN: f64 = 0.1;

/// Shares of cells by volume (in the plane: area) in units of the mean, in bins from 0.
///
/// No closed form is known. These are of a million periodic cells made by this program (`--seeds 1000000 --periodic x,y,z`, and
/// x,y in the plane), whose variances, 0.1784 and 0.2807, are within their errors the exact 0.1790 (Gilbert 1962) and 0.2802.
pub(super) fn size_shares(dimension: Dimension) -> &'static [f64] {
    match dimension {
        Dimension::Two => &AREAS,
        Dimension::Three => &VOLUMES,
    }
}

/// The least number of faces (in the plane: edges) of a cell, and the shares of cells by that number, from there on.
///
/// Of the same cells; their means are 15.537 and 6.000, exactly 2 + 48 pi^2/35 = 15.535 (Meijering 1953) and 6.
pub(super) fn face_shares(dimension: Dimension) -> (usize, &'static [f64]) {
    match dimension {
        Dimension::Two => (3, &EDGES),
        Dimension::Three => (4, &FACES),
    }
}

/// Density of the angle between two boundaries in radians, weighted by the length of the triple line; in the plane at a triple point.
///
/// The circle through the three seeds about a line has the triangle of seeds in it with a density proportional to the square of its
/// area (in the plane: to its area), by the Blaschke-Petkantschin formula (Moeller 1989); the angle is pi less that of the triangle.
/// Mean 120 degrees, standard deviation 23.85 (29.40).
pub(super) fn angle_density(dimension: Dimension, angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    match dimension {
        Dimension::Two => 4.0 * sin * (sin - angle * cos) / (3.0 * PI),
        Dimension::Three => {
            let (sin_twice, cos_twice) = (2.0 * angle).sin_cos();
            4.0 * sin * sin * (2.0 * angle * (2.0 + cos_twice) - 3.0 * sin_twice) / (3.0 * PI * PI)
        }
    }
}

#[rustfmt::skip]
const VOLUMES: [f64; 41] = [
    0.000160, 0.002963, 0.012435, 0.029592, 0.050696, 0.072758, 0.088889, 0.098061,
    0.100715, 0.096142, 0.087932, 0.077017, 0.064826, 0.053063, 0.042273, 0.032640,
    0.025068, 0.018537, 0.013766, 0.009885, 0.007053, 0.004966, 0.003383, 0.002336,
    0.001704, 0.001070, 0.000745, 0.000474, 0.000275, 0.000194, 0.000145, 0.000089,
    0.000059, 0.000034, 0.000021, 0.000013, 0.000006, 0.000010, 0.000002, 0.000001,
    0.000002,
];

#[rustfmt::skip]
const FACES: [f64; 33] = [
    0.000004, 0.000030, 0.000361, 0.001791, 0.005862, 0.015141, 0.030787, 0.052126,
    0.076652, 0.099831, 0.114885, 0.120752, 0.114228, 0.101131, 0.083127, 0.062805,
    0.045304, 0.030269, 0.019260, 0.011556, 0.006685, 0.003636, 0.001951, 0.000989,
    0.000445, 0.000225, 0.000098, 0.000041, 0.000017, 0.000005, 0.000001, 0.000001,
    0.000003,
];

#[rustfmt::skip]
const AREAS: [f64; 54] = [
    0.001892, 0.013269, 0.031395, 0.050169, 0.066422, 0.077732, 0.083702, 0.084708,
    0.081992, 0.077066, 0.070055, 0.062073, 0.053740, 0.045721, 0.039060, 0.032071,
    0.026628, 0.021629, 0.017287, 0.013759, 0.011050, 0.008676, 0.006885, 0.005385,
    0.004109, 0.003186, 0.002459, 0.001884, 0.001497, 0.001076, 0.000822, 0.000650,
    0.000485, 0.000378, 0.000268, 0.000216, 0.000156, 0.000101, 0.000094, 0.000068,
    0.000049, 0.000047, 0.000028, 0.000017, 0.000014, 0.000008, 0.000009, 0.000003,
    0.000002, 0.000001, 0.000001, 0.000002, 0.000000, 0.000002,
];

#[rustfmt::skip]
const EDGES: [f64; 12] = [
    0.011291, 0.106588, 0.259539, 0.294518, 0.199495, 0.089848, 0.029527, 0.007450,
    0.001479, 0.000238, 0.000024, 0.000002,
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean and variance of a histogram.
    fn moments(values: impl Iterator<Item = f64> + Clone, shares: &[f64]) -> [f64; 2] {
        let mean: f64 = values.clone().zip(shares).map(|(value, share)| value * share).sum();
        let square: f64 = values.zip(shares).map(|(value, share)| value * value * share).sum();
        [mean, square - mean * mean]
    }

    #[test]
    fn histograms_have_the_exact_moments() {
        for (dimension, variance, faces) in
            [(Dimension::Three, 0.179_032, 2.0 + 48.0 * PI * PI / 35.0), (Dimension::Two, 0.280_176, 6.0)]
        {
            let middles = (0..).map(|bin| (f64::from(bin) + 0.5) * SIZE_BIN);
            let [mean, spread] = moments(middles, size_shares(dimension));
            assert!((mean - 1.0).abs() < 1e-3, "{mean}");
            // Sheppard's correction for the width of bins.
            assert!((spread - SIZE_BIN * SIZE_BIN / 12.0 - variance).abs() < 2e-3, "{spread}");
            let (least, shares) = face_shares(dimension);
            let [mean, _] = moments((least..).map(|count| count as f64), shares);
            assert!((mean - faces).abs() < 0.01, "{mean}");
        }
    }

    #[test]
    fn angles_have_the_known_mean_and_spread() {
        // Muche 1996 for the plane; in space 23.81 was measured on 20 000 cells.
        for (dimension, spread) in [(Dimension::Three, 23.853), (Dimension::Two, 29.399)] {
            let steps = 10_000;
            let angle = |step: i32| (f64::from(step) + 0.5) * PI / f64::from(steps);
            let width = PI / f64::from(steps);
            let shares: Vec<f64> =
                (0..steps).map(|step| angle_density(dimension, angle(step)) * width).collect();
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-6);
            let [mean, variance] = moments((0..steps).map(|step| angle(step).to_degrees()), &shares);
            assert!((mean - 120.0).abs() < 1e-3, "{mean}");
            assert!((variance.sqrt() - spread).abs() < 1e-3, "{}", variance.sqrt());
        }
    }
}
