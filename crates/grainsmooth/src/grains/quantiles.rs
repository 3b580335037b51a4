//! Volumes of a distribution of diameters.

use rayon::prelude::*;
use sizes::Distribution;
use voronoi::Dimension;

/// The volumes at the middles of so many equal shares of a distribution of diameters, from small to large.
pub(crate) fn quantile_volumes(dimension: Dimension, distribution: &Distribution, count: usize) -> Vec<f64> {
    let share = |place: usize| (place as f64 + 0.5) / count as f64;
    volumes_at(dimension, distribution, (0..count).map(share).collect())
}

/// The volumes below which there are such shares of the grains.
pub(crate) fn volumes_at(dimension: Dimension, distribution: &Distribution, shares: Vec<f64>) -> Vec<f64> {
    let volume = |share| dimension.ball_volume(distribution.quantile(share));
    shares.into_par_iter().map(volume).collect()
}
