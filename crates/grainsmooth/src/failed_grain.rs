//! The grain that a run failed at.

use std::fmt;

use polycrystal::NetworkError;

use crate::{EquivalentDiameters, Error, Tessellated};

/// Share of the mean diameter from which on a grain is not blamed for its size: of 50 000 cells of random seeds in a periodic box
/// (`--rng-seed 1`) one is below.
const SMALL: f64 = 0.4;

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
    /// The smallest of the grains that a failure names, of all if it names none; nothing if it is not about grains.
    fn of(cause: &NetworkError, cells: &Tessellated) -> Option<Self> {
        let named = cause.grains()?;
        let dimension = cells.tessellation.domain().dimension();
        let measures = cells.tessellation.cell_measures();
        let diameters: Vec<f64> = measures.iter().map(|cell| dimension.ball_diameter(cell.volume)).collect();
        let is_named = |grain: &u32| named.is_empty() || named.iter().any(|other| other.0 == *grain);
        let sized = (0u32..).zip(&diameters).filter(|(grain, _)| is_named(grain));
        let (grain, diameter) = sized.min_by(|a, b| a.1.total_cmp(b.1))?;
        Some(Self {
            grain,
            seed: cells.seed_ids[grain as usize],
            diameter: *diameter,
            share: diameter / EquivalentDiameters::new(dimension, &diameters).mean,
            is_smallest: named.is_empty(),
        })
    }
}

impl Error {
    /// The error with the grain that it is about.
    pub(crate) fn with_grain(self, cells: &Tessellated) -> Self {
        match self {
            Self::Network(cause) => match FailedGrain::of(&cause, cells) {
                Some(grain) => Self::Grain { cause, grain },
                None => Self::Network(cause),
            },
            other => other,
        }
    }
}

impl fmt::Display for FailedGrain {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { grain, seed, diameter, share, is_smallest } = self;
        let which = if *is_smallest { "the smallest is grain" } else { "grain" };
        write!(
            out,
            "{which} {grain} (SeedId {seed}) of equivalent diameter {diameter:.3e}, {share:.2e} of the mean"
        )?;
        if *share < SMALL {
            let limit = (100.0 * MARGIN * share).ceil() / 100.0;
            write!(out, "; merge such cells with --min-diameter {limit}")?;
        }
        Ok(())
    }
}
