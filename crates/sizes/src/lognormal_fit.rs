//! The lognormal distribution of measured diameters.

use crate::{Distribution, Law, Part};

/// Digits of the numbers in [`LognormalFit::spec`]: with six a distribution is told to a millionth.
const DIGITS: usize = 6;

/// A lognormal distribution of diameters, fitted to a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LognormalFit {
    /// Median by number, a length.
    pub median: f64,
    /// Standard deviation of the natural logarithm.
    pub sigma: f64,
}

impl LognormalFit {
    /// The distribution whose logarithm has the mean and the standard deviation of the sample's, each diameter counted as `d^power`: with
    /// 0 the fit by number (that of greatest likelihood), with 3 by volume, with 2 by area in the plane.
    ///
    /// A lognormal distribution of the median m is one by volume too, with the median `m exp(3 sigma^2)` and the same sigma; the fit by
    /// volume tells the one by number that belongs to it. Few small diameters so weigh little.
    ///
    /// Nothing without diameters, or where one is not positive and finite.
    ///
    /// ```
    /// use sizes::LognormalFit;
    ///
    /// let fit = LognormalFit::new(&[1.0, 2.0, 4.0], 0).expect("diameters that differ");
    /// assert!((fit.median - 2.0).abs() < 1e-12);
    /// assert_eq!(LognormalFit::new(&[], 0), None);
    /// ```
    pub fn new(diameters: &[f64], power: u32) -> Option<Self> {
        if diameters.is_empty() || !diameters.iter().all(|diameter| diameter.is_finite() && *diameter > 0.0) {
            return None;
        }
        // In units of the largest, no power leaves the range of numbers.
        let largest = diameters.iter().copied().fold(0.0, f64::max);
        let weight = |diameter: &f64| libm::pow(diameter / largest, f64::from(power));
        let mean = |value: &dyn Fn(f64) -> f64| {
            let sum: f64 = diameters.iter().map(|d| weight(d) * value(libm::log(d / largest))).sum();
            sum / diameters.iter().map(weight).sum::<f64>()
        };
        let center = mean(&|logarithm| logarithm);
        let variance = mean(&|logarithm| (logarithm - center).powi(2));
        let median = largest * libm::exp(center - f64::from(power) * variance);
        Some(Self { median, sigma: variance.sqrt() })
    }

    /// The mean diameter by number.
    pub fn mean(&self) -> f64 {
        self.median * libm::exp(0.5 * self.sigma * self.sigma)
    }

    /// The coefficient of variation by number: standard deviation over mean.
    pub fn variation(&self) -> f64 {
        libm::expm1(self.sigma * self.sigma).sqrt()
    }

    /// The distribution in words, as [`Spec`](crate::Spec) reads it; of equal diameters it is that one.
    pub fn spec(&self) -> String {
        match self.law() {
            Law::Equal(diameter) => format!("equal({})", in_digits(diameter)),
            _ => format!("lognormal(mean={}, cv={})", in_digits(self.mean()), in_digits(self.variation())),
        }
    }

    /// The distribution.
    pub fn distribution(&self) -> Distribution {
        let all = Part::new(self.law(), 0.0, f64::INFINITY).expect("nothing is cut off");
        Distribution::new(vec![(1.0, all)], None)
    }

    fn law(&self) -> Law {
        // Rounding of equal diameters leaves a spread of some 1e-16.
        if self.sigma < 1e-9 {
            Law::Equal(self.median)
        } else {
            Law::LogNormal { median: self.median, sigma: self.sigma }
        }
    }
}

/// A number to [`DIGITS`], without zeros at its end.
fn in_digits(number: f64) -> String {
    let rounded: f64 = format!("{number:.*e}", DIGITS - 1).parse().expect("a number as it was written");
    if (1e-4..1e6).contains(&rounded.abs()) { format!("{rounded}") } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Spec;

    fn sample(text: &str, count: u32) -> Vec<f64> {
        let distribution = text.parse::<Spec>().unwrap().distribution(3);
        (0..count).map(|k| distribution.quantile((f64::from(k) + 0.5) / f64::from(count))).collect()
    }

    #[test]
    fn middles_of_equal_shares_give_their_distribution_back() {
        let diameters = sample("lognormal(mean=20, cv=0.35)", 100_000);
        for (power, tolerance) in [(0, 1e-4), (2, 2e-3), (3, 5e-3)] {
            let fit = LognormalFit::new(&diameters, power).unwrap();
            assert!((fit.mean() / 20.0 - 1.0).abs() < tolerance, "{power}: {fit:?}");
            assert!((fit.variation() / 0.35 - 1.0).abs() < tolerance, "{power}: {fit:?}");
        }
    }

    #[test]
    fn words_are_read_as_the_distribution_that_they_tell() {
        for (median, sigma) in [(1.2345678e-7, 0.3), (20.0, 1.5), (8.7654321e9, 1e-3), (3.0, 0.0)] {
            let fit = LognormalFit { median, sigma };
            let read = fit.spec().parse::<Spec>().unwrap().distribution(3);
            for share in [0.1, 0.5, 0.9] {
                let ratio = read.quantile(share) / fit.distribution().quantile(share);
                assert!((ratio - 1.0).abs() < 2e-5, "{}: {ratio}", fit.spec());
            }
        }
    }

    #[test]
    fn a_sample_without_a_distribution_has_none() {
        for sample in [&[][..], &[1.0, 0.0], &[1.0, f64::NAN], &[f64::INFINITY]] {
            assert_eq!(LognormalFit::new(sample, 0), None);
        }
    }
}
