//! The beta distribution.

use std::f64::consts::PI;

/// The logarithm of the gamma function of a positive number: Stirling's series from 12 on, where its next term is below 1e-16.
fn ln_gamma(number: f64) -> f64 {
    let (mut shifted, mut product) = (number, 1.0);
    while shifted < 12.0 {
        product *= shifted;
        shifted += 1.0;
    }
    let inverse = 1.0 / shifted;
    let square = inverse * inverse;
    let terms = [1.0 / 12.0, -1.0 / 360.0, 1.0 / 1260.0, -1.0 / 1680.0, 1.0 / 1188.0, -691.0 / 360_360.0];
    let series = inverse * terms.iter().rev().fold(0.0, |sum, term| sum * square + term);
    (shifted - 0.5) * shifted.ln() - shifted + 0.5 * (2.0 * PI).ln() + series - product.ln()
}

/// The logarithm of the beta function of positive numbers.
pub(crate) fn ln_beta(a: f64, b: f64) -> f64 {
    ln_gamma(a) + ln_gamma(b) - ln_gamma(a + b)
}

/// The share of the beta distribution below `x` from 0 to 1, by its continued fraction (Lentz's method).
pub(crate) fn beta_share(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    // Where the fraction converges slowly, the other side's does so fast.
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - beta_share(1.0 - x, b, a);
    }
    let factor = (a * x.ln() + b * (-x).ln_1p() - ln_beta(a, b)).exp() / a;
    let away_from_zero = |value: f64| if value.abs() < 1e-300 { 1e-300 } else { value };
    let mut numerator = 1.0;
    let mut denominator = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut fraction = denominator;
    // Some square root of the larger of a and b is what it takes.
    for step in 1..100_000 {
        let m = f64::from(step);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut change = 1.0;
        for term in [even, odd] {
            denominator = 1.0 / away_from_zero(1.0 + term * denominator);
            numerator = away_from_zero(1.0 + term / numerator);
            change = denominator * numerator;
            fraction *= change;
        }
        if (change - 1.0).abs() < 1e-15 {
            break;
        }
    }
    factor * fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_those_of_closed_forms() {
        // Of (1, b) it is 1 - (1 - x)^b; of (3/2, 1/2), as of angles of rotations, (w - sin w) / pi at x = sin^2(w/2).
        for b in [0.5_f64, 3.0, 80.0] {
            for x in [1e-6_f64, 0.02, 0.5, 0.9] {
                assert!((beta_share(x, 1.0, b) - (1.0 - (1.0 - x).powf(b))).abs() < 2e-13);
            }
        }
        for angle in [0.01_f64, 1.0, 2.0, 3.0] {
            let exact = (angle - angle.sin()) / PI;
            assert!((beta_share((angle / 2.0).sin().powi(2), 1.5, 0.5) - exact).abs() < 1e-14);
        }
        assert!((ln_gamma(0.5) - 0.5 * PI.ln()).abs() < 1e-14);
        assert!((ln_gamma(10.0) - 362_880_f64.ln()).abs() < 1e-14);
    }
}
