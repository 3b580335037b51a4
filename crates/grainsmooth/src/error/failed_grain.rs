//! The grain that a run failed at.

use std::fmt;

/// Share of the mean diameter from which on a grain is not blamed for its size: of 50 000 cells of random seeds in a periodic box
/// (`--rng-seed 1`) one is below.
const SMALL: f64 = 0.4;

/// The same, below which its size alone is reason enough to fail: relaxation is made for diameters that spread over 1:100.
const TINY: f64 = 1e-3;

/// By how much the limit that is advised is above the grain, so that others like it go too.
const MARGIN: f64 = 1.2;

/// A grain with its seed and size, for messages.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FailedGrain {
    /// Its number.
    pub grain: u32,
    /// The number of its seed.
    pub seed: u32,
    /// Its equivalent diameter, in the unit of the box.
    pub diameter: f64,
    /// The same as a share of the mean.
    pub share: f64,
    /// Whether the failure names no grain, and this is the smallest of all.
    pub is_smallest: bool,
}

impl FailedGrain {
    /// Whether its size alone is reason enough to fail.
    pub(crate) fn is_tiny(&self) -> bool {
        self.share < TINY
    }

    /// The `--min-diameter`, with two decimals, that takes this grain out, if its size is to blame.
    pub(crate) fn least_diameter(&self) -> Option<f64> {
        (self.share < SMALL).then(|| (100.0 * MARGIN * self.share).ceil() / 100.0)
    }
}

impl fmt::Display for FailedGrain {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { grain, seed, diameter, share, is_smallest } = self;
        let which = if *is_smallest { "the smallest is grain" } else { "grain" };
        write!(
            out,
            "{which} {grain} (SeedId {seed}), {share:.2e} mean equivalent diameters wide ({diameter:.3e})"
        )
    }
}
