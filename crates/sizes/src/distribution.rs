//! Distributions of diameters: sums of laws between cut-offs.

use thiserror::Error;

use crate::Law;

/// The least share of a law that cut-offs must leave: of the tails beyond, doubles have too few digits.
const LEAST_LEFT: f64 = 1e-6;

/// Halvings until a quantile is exact to the last digit: doubles have 53 of them, and exponents take a few more.
const MOST_HALVINGS: u32 = 200;

/// Cut-offs leave next to nothing of a law.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("almost nothing of it is left from {from} to {to} (a share of {left:.1e}); widen the cut-offs")]
pub struct CutError {
    from: f64,
    to: f64,
    left: f64,
}

/// A law between two cut-offs.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    law: Law,
    /// The cut-offs; both belong to it.
    ends: [f64; 2],
    /// What of the law is between them.
    left: f64,
}

impl Part {
    /// A law between two diameters; from 0 to infinity is all of it but what is negative.
    ///
    /// # Errors
    /// [`CutError`].
    pub fn new(law: Law, from: f64, to: f64) -> Result<Self, CutError> {
        let mut part = Self { law, ends: [from.max(0.0), to], left: 1.0 };
        let left = part.partial_moment(0, to);
        if left.is_nan() || left < LEAST_LEFT {
            return Err(CutError { from, to, left });
        }
        part.left = left;
        Ok(part)
    }

    fn partial_moment(&self, power: u32, x: f64) -> f64 {
        let [from, to] = self.ends;
        if x < from {
            return 0.0;
        }
        // Diameters that are equal to the first cut-off stay.
        let below = self.law.partial_moment(power, from.next_down());
        (self.law.partial_moment(power, x.min(to)) - below) / self.left
    }

    fn upper_end(&self) -> f64 {
        self.law.upper_end().min(self.ends[1])
    }
}

/// A distribution of diameters by number: a sum of parts with weights.
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution {
    /// With their shares by number.
    parts: Vec<(f64, Part)>,
}

impl Distribution {
    /// The sum of parts with weights by number, or with a number of axes by the volumes of grains of so many dimensions (2: areas).
    /// Weights are divided by their sum.
    ///
    /// # Panics
    /// When there is no part, or a weight is not positive.
    pub fn new(parts: Vec<(f64, Part)>, weights_by: Option<u32>) -> Self {
        assert!(parts.iter().all(|(weight, _)| *weight > 0.0) && !parts.is_empty(), "positive weights");
        let by_number = |(weight, part): (f64, Part)| match weights_by {
            Some(axes) => (weight / part.partial_moment(axes, f64::INFINITY), part),
            None => (weight, part),
        };
        let parts: Vec<(f64, Part)> = parts.into_iter().map(by_number).collect();
        let sum: f64 = parts.iter().map(|(weight, _)| weight).sum();
        Self { parts: parts.into_iter().map(|(weight, part)| (weight / sum, part)).collect() }
    }

    /// The share of diameters that are no larger than x, by number.
    ///
    /// ```
    /// use sizes::Spec;
    ///
    /// let diameters = "uniform(1, 3)".parse::<Spec>()?.distribution(3);
    /// assert_eq!([0.5, 2.0, 4.0].map(|diameter| diameters.cdf(diameter)), [0.0, 0.5, 1.0]);
    /// # Ok::<(), sizes::SpecError>(())
    /// ```
    pub fn cdf(&self, x: f64) -> f64 {
        self.partial_moment(0, x)
    }

    /// What those that are no larger than x have of the sum of `d^power`: of 3 the share of the volume, of 2 of the area in the
    /// plane.
    pub fn share_below(&self, x: f64, power: u32) -> f64 {
        self.partial_moment(power, x) / self.moment(power)
    }

    /// The mean of `d^power`.
    pub fn moment(&self, power: u32) -> f64 {
        self.partial_moment(power, f64::INFINITY)
    }

    /// The mean diameter.
    pub fn mean(&self) -> f64 {
        self.moment(1)
    }

    /// The coefficient of variation: standard deviation over mean.
    pub fn variation(&self) -> f64 {
        let mean = self.mean();
        (self.moment(2) / (mean * mean) - 1.0).max(0.0).sqrt()
    }

    /// The largest diameter, infinite where there is none.
    pub fn upper_end(&self) -> f64 {
        self.parts.iter().map(|(_, part)| part.upper_end()).fold(0.0, f64::max)
    }

    /// The least diameter that a share from 0 to 1 is no larger than, by number: the inverse of [`Self::cdf`].
    ///
    /// ```
    /// use sizes::Spec;
    ///
    /// let diameters = "uniform(1, 3)".parse::<Spec>()?.distribution(3);
    /// assert!((diameters.quantile(0.5) - 2.0).abs() < 1e-12, "the median");
    /// # Ok::<(), sizes::SpecError>(())
    /// ```
    pub fn quantile(&self, share: f64) -> f64 {
        let mut above = self.upper_end();
        if above.is_infinite() {
            above = self.mean();
            while above.is_finite() && self.cdf(above) < share {
                above *= 2.0;
            }
        }
        let mut below = 0.0;
        for _ in 0..MOST_HALVINGS {
            let middle = 0.5 * (below + above);
            if middle <= below || middle >= above {
                break;
            }
            if self.cdf(middle) < share {
                below = middle;
            } else {
                above = middle;
            }
        }
        above
    }

    fn partial_moment(&self, power: u32, x: f64) -> f64 {
        self.parts.iter().map(|(share, part)| share * part.partial_moment(power, x)).sum()
    }
}
