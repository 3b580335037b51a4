//! Laws that diameters may follow, by number.

use std::f64::consts::{PI, SQRT_2};

use crate::Table;
use crate::gamma::gamma_share;

/// A law of diameters, by number. Lengths have the user's unit.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// One diameter.
    Equal(f64),
    /// The normal distribution.
    Normal {
        /// Its mean.
        mean: f64,
        /// Its standard deviation.
        deviation: f64,
    },
    /// The logarithm is normal.
    LogNormal {
        /// The median; its logarithm is the mean of the logarithms.
        median: f64,
        /// Standard deviation of the natural logarithm.
        sigma: f64,
    },
    /// Every diameter between two is alike.
    Uniform {
        /// The least.
        least: f64,
        /// The largest.
        largest: f64,
    },
    /// Weibull's distribution: `1 - exp(-(d / scale)^shape)` are smaller than d.
    Weibull {
        /// Its shape.
        shape: f64,
        /// Its scale, a length.
        scale: f64,
    },
    /// The gamma distribution, with the density `d^(shape - 1) exp(-d / scale)` but for a factor.
    Gamma {
        /// Its shape.
        shape: f64,
        /// Its scale, a length.
        scale: f64,
    },
    /// A list, a histogram, or a distribution function.
    Table(Table),
}

impl Law {
    /// The largest diameter, infinite where there is none.
    pub fn upper_end(&self) -> f64 {
        match self {
            Self::Equal(diameter) => *diameter,
            Self::Uniform { largest, .. } => *largest,
            Self::Table(table) => table.largest(),
            Self::Normal { .. } | Self::LogNormal { .. } | Self::Weibull { .. } | Self::Gamma { .. } => {
                f64::INFINITY
            }
        }
    }

    /// The integral of `d^power` over all diameters up to x, x among them. With power 0 this is the distribution function.
    pub fn partial_moment(&self, power: u32, x: f64) -> f64 {
        let exponent = f64::from(power);
        match self {
            Self::Equal(diameter) if *diameter <= x => libm::pow(*diameter, exponent),
            Self::Equal(_) => 0.0,
            Self::Normal { mean, deviation } => normal_moment(*mean, *deviation, power, x),
            Self::LogNormal { median, sigma } => {
                if x <= 0.0 {
                    return 0.0;
                }
                let whole = libm::pow(*median, exponent) * libm::exp(0.5 * (exponent * sigma).powi(2));
                whole * normal_share(libm::log(x / median) / sigma - exponent * sigma)
            }
            Self::Uniform { least, largest } => {
                let x = x.clamp(*least, *largest);
                let power_of = |x: f64| libm::pow(x, exponent + 1.0);
                (power_of(x) - power_of(*least)) / ((exponent + 1.0) * (largest - least))
            }
            Self::Weibull { shape, scale } => {
                let above = 1.0 + exponent / shape;
                let whole = libm::pow(*scale, exponent) * libm::tgamma(above);
                whole * gamma_share(above, libm::pow((x / scale).max(0.0), *shape))
            }
            Self::Gamma { shape, scale } => {
                let rising = (0..power).map(|step| shape + f64::from(step)).product::<f64>();
                libm::pow(*scale, exponent) * rising * gamma_share(shape + exponent, x / scale)
            }
            Self::Table(table) => table.partial_moment(power, x),
        }
    }
}

/// The share of the standard normal distribution below a number.
fn normal_share(x: f64) -> f64 {
    0.5 * libm::erfc(-x / SQRT_2)
}

/// The integral of `d^power` over a normal distribution up to x, from those of the two powers below (by parts).
fn normal_moment(mean: f64, deviation: f64, power: u32, x: f64) -> f64 {
    let reduced = (x - mean) / deviation;
    // With the unit 1 / deviation.
    let density = libm::exp(-0.5 * reduced * reduced) / (2.0 * PI).sqrt();
    let (mut before, mut last) = (0.0, normal_share(reduced));
    let mut edge = if density == 0.0 { 0.0 } else { deviation * density };
    for step in 1..=power {
        let next = mean * last + f64::from(step - 1) * deviation * deviation * before - edge;
        (before, last) = (last, next);
        edge = if edge == 0.0 { 0.0 } else { edge * x };
    }
    last
}
