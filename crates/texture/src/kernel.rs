//! How orientations spread around a mode.

use std::f64::consts::{FRAC_PI_2, PI};

use thiserror::Error;

use crate::beta::{beta_share, ln_beta};

/// Halfwidths in degrees that a kernel can have: below, `10^9` directions would be too few to tell it from none; above, it is all but random.
const HALFWIDTHS: std::ops::RangeInclusive<f64> = 0.01..=90.0;

/// A halfwidth that no kernel has.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "a halfwidth of {0} degrees is not between 0.01 and 90; give 0 for no spread, and 'random' for any orientation"
)]
pub struct HalfwidthError(pub f64);

/// The exponent of de la Vallee Poussin's kernel of a halfwidth in degrees.
fn exponent(halfwidth: f64) -> Result<f64, HalfwidthError> {
    if HALFWIDTHS.contains(&halfwidth) {
        Ok(0.5_f64.ln() / (2.0 * (0.5 * halfwidth.to_radians()).cos().ln()))
    } else {
        Err(HalfwidthError(halfwidth))
    }
}

/// De la Vallee Poussin's kernel: the density falls with the angle w from the mode as cos^2k(w/2), to half of its peak at the halfwidth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kernel {
    halfwidth: f64,
    exponent: f64,
    peak: f64,
}

impl Kernel {
    /// The kernel of a halfwidth in degrees.
    ///
    /// # Errors
    /// When the halfwidth is not from 0.01 to 90.
    pub fn new(halfwidth: f64) -> Result<Self, HalfwidthError> {
        let exponent = exponent(halfwidth)?;
        Ok(Self { halfwidth, exponent, peak: peak(exponent) })
    }

    /// In degrees.
    pub fn halfwidth(self) -> f64 {
        self.halfwidth
    }

    /// The exponent k.
    pub fn exponent(self) -> f64 {
        self.exponent
    }

    /// Density at an angle in degrees from the mode, in multiples of random, without crystal symmetry.
    pub fn density(self, angle: f64) -> f64 {
        self.peak * (2.0 * self.exponent * (0.5 * angle.to_radians()).cos().abs().ln()).exp()
    }

    /// Integral of the squared density over all orientations: the texture index, without crystal symmetry.
    pub fn sharpness(self) -> f64 {
        self.peak * self.peak / peak(2.0 * self.exponent)
    }

    /// Share of the orientations within an angle in degrees of the mode.
    pub fn share_within(self, angle: f64) -> f64 {
        beta_share((0.5 * angle.to_radians()).sin().powi(2), 1.5, self.exponent + 0.5)
    }

    /// The angle in degrees from the mode within which a share of the orientations lies: [`Self::share_within`] turned round.
    pub fn angle_within(self, share: f64) -> f64 {
        let (mut below, mut above) = (0.0, 180.0);
        let mut angle = 1.3 * self.halfwidth;
        // Newton's steps, halving where these lead outside; a dozen do.
        for _ in 0..100 {
            let excess = self.share_within(angle) - share;
            if excess < 0.0 {
                below = angle;
            } else {
                above = angle;
            }
            // Angles of random rotations have the density (1 - cos w) / pi.
            let slope = self.density(angle) * (1.0 - angle.to_radians().cos()) / 180.0;
            let newton = angle - excess / slope;
            let next = if newton > below && newton < above { newton } else { 0.5 * (below + above) };
            if (next - angle).abs() <= 1e-13 * angle {
                return next;
            }
            angle = next;
        }
        angle
    }
}

/// Density at the mode in multiples of random.
fn peak(exponent: f64) -> f64 {
    (FRAC_PI_2.ln() - ln_beta(1.5, exponent + 0.5)).exp()
}

/// De la Vallee Poussin's kernel on the sphere: how directions spread around one of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FiberKernel {
    halfwidth: f64,
    exponent: f64,
}

impl FiberKernel {
    /// The kernel of a halfwidth in degrees.
    ///
    /// # Errors
    /// When the halfwidth is not from 0.01 to 90.
    pub fn new(halfwidth: f64) -> Result<Self, HalfwidthError> {
        Ok(Self { halfwidth, exponent: exponent(halfwidth)? })
    }

    /// In degrees.
    pub fn halfwidth(self) -> f64 {
        self.halfwidth
    }

    /// Density at a tilt whose cosine is given, in multiples of random.
    pub fn density(self, cosine: f64) -> f64 {
        (1.0 + self.exponent) * (0.5 * (1.0 + cosine)).max(0.0).powf(self.exponent)
    }

    /// The cosine of the tilt at which the density is a share of its peak.
    pub(crate) fn cosine_at(self, share: f64) -> f64 {
        2.0 * share.powf(1.0 / self.exponent) - 1.0
    }

    /// The tilt in degrees within which a share of the directions lies.
    pub fn tilt_within(self, share: f64) -> f64 {
        // sin^2(t/2) = 1 - U^(1/(k+1)), without the difference of two numbers near 1.
        let square = -((-share).ln_1p() / (1.0 + self.exponent)).exp_m1();
        2.0 * square.max(0.0).sqrt().min(1.0).asin() * 180.0 / PI
    }
}
