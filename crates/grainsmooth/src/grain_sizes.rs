//! The volumes that grains are to have, drawn from what is asked for, and what was reached.

use std::fmt;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;
use serde::Serialize;
use sizes::Distribution;
use voronoi::volumes::TOLERANCE;
use voronoi::{Dimension, Domain};

use crate::seeding::unit_fraction;
use crate::size_options::Wanted;
use crate::{Config, Error, SizeDraw};

/// The generator's stream for sizes, apart from those of the seeds' positions (0) and of orientations (1, 2).
const STREAM: u64 = 3;

/// The volumes that grains are to have.
#[derive(Debug, Clone, PartialEq)]
pub struct GrainSizes {
    dimension: Dimension,
    /// What was asked for.
    asked: String,
    /// Whether nothing was.
    is_usual: bool,
    draw: SizeDraw,
    distribution: Option<Distribution>,
    /// By which diameters are multiplied to fill the domain.
    scale: f64,
    volumes: Vec<f64>,
    /// What a gradient multiplied each volume by; nothing without one.
    factors: Vec<f64>,
    /// How many times seeds moved to the centroids of their cells, and how many times they were to.
    centroid_steps: [usize; 2],
}

/// How near volumes came to what was asked for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SizesReached {
    /// What was asked for, in words.
    asked: String,
    /// Whether nothing was asked for: these are the usual sizes.
    is_usual: bool,
    draw: &'static str,
    /// By which the diameters asked for are multiplied to fill the domain.
    scale: f64,
    /// Mean of the distribution that was asked for, before it is scaled, and its coefficient of variation.
    asked_mean: Option<f64>,
    asked_cv: Option<f64>,
    /// The largest difference between the share of grains up to a diameter and the distribution's.
    cdf_distance: Option<f64>,
    /// The same of the shares of the volume, which tells of large grains that are missing.
    cdf_distance_by_volume: Option<f64>,
    /// Of the cells' volumes.
    largest_volume_error_of_cells: f64,
    /// Of the finished grains' volumes, where they are kept.
    largest_volume_error: Option<f64>,
    centroid_steps: usize,
    centroid_steps_asked: usize,
}

impl GrainSizes {
    /// Draws the volumes of so many grains, which fill the domain.
    ///
    /// # Errors
    /// [`Error::VolumeCount`] where each grain is given its own and there are more or fewer; whatever is wrong with a file.
    pub(crate) fn draw(config: &Config, domain: &Domain, count: usize) -> Result<Self, Error> {
        let dimension = config.dimension;
        let mut generator = ChaCha8Rng::seed_from_u64(config.random_seed);
        generator.set_stream(STREAM);
        let (mut volumes, distribution) = match config.wanted_sizes()? {
            Wanted::Volumes(volumes) if volumes.len() == count => (volumes, None),
            Wanted::Volumes(volumes) => {
                return Err(Error::VolumeCount {
                    asked: config.asked_sizes(),
                    volumes: volumes.len(),
                    seeds: count,
                });
            }
            Wanted::Diameters(distribution) => {
                let volumes = match config.sizes.draw {
                    SizeDraw::Quantiles => {
                        let mut volumes = quantile_volumes(dimension, &distribution, count);
                        shuffle(&mut volumes, &mut generator);
                        volumes
                    }
                    SizeDraw::Random => {
                        // Never 0 or 1, where distributions may have no end.
                        let share = |bits: u64| unit_fraction(bits) + 0.5f64.powi(54);
                        let shares: Vec<f64> = (0..count).map(|_| share(generator.next_u64())).collect();
                        volumes_at(dimension, &distribution, shares)
                    }
                };
                (volumes, Some(distribution))
            }
        };
        let factor = domain.measure() / volumes.iter().sum::<f64>();
        volumes.iter_mut().for_each(|volume| *volume *= factor);
        Ok(Self {
            dimension,
            asked: config.asked_sizes(),
            is_usual: config.sizes.source.is_none(),
            draw: config.sizes.draw,
            distribution,
            scale: dimension.cube_edge(factor),
            volumes,
            factors: Vec::new(),
            centroid_steps: [0, config.centroid_steps() as usize],
        })
    }

    /// The same with each volume multiplied by a factor of its own, and all so that they fill what they filled before.
    pub(crate) fn with_factors(mut self, factors: Vec<f64>) -> Self {
        let before: f64 = self.volumes.iter().sum();
        self.volumes.iter_mut().zip(&factors).for_each(|(volume, factor)| *volume *= factor);
        let factor = before / self.volumes.iter().sum::<f64>();
        self.volumes.iter_mut().for_each(|volume| *volume *= factor);
        self.scale *= self.dimension.cube_edge(factor);
        Self { factors, ..self }
    }

    /// The volumes that grains are to have (in the plane: areas).
    pub fn volumes(&self) -> &[f64] {
        &self.volumes
    }

    /// The same after so many centroid steps.
    pub(crate) fn with_centroid_steps(self, done: usize) -> Self {
        Self { centroid_steps: [done, self.centroid_steps[1]], ..self }
    }

    /// The distribution of diameters that was asked for, if one was.
    pub(crate) fn distribution(&self) -> Option<&Distribution> {
        self.distribution.as_ref()
    }

    /// Diameters of grains as they would be without scale and gradient.
    pub(crate) fn unscaled_diameters(&self, volumes: &[f64]) -> Vec<f64> {
        let factors = self.factors.iter().copied().chain(std::iter::repeat(1.0));
        let volumes = volumes.iter().zip(factors).map(|(volume, factor)| volume / factor);
        volumes.map(|volume| self.dimension.ball_diameter(volume) / self.scale).collect()
    }

    /// How near cells came, and finished grains where these keep their volumes.
    pub(crate) fn reached(&self, cells: &[f64], grains: Option<&[f64]>) -> SizesReached {
        let largest_error = |volumes: &[f64]| {
            let errors =
                volumes.iter().zip(&self.volumes).map(|(volume, target)| (volume / target - 1.0).abs());
            errors.fold(0.0, f64::max)
        };
        let distance = |power| {
            let diameters = self.unscaled_diameters(grains.unwrap_or(cells));
            self.distribution.as_ref().map(|distribution| cdf_distance(diameters, distribution, power))
        };
        SizesReached {
            asked: self.asked.clone(),
            is_usual: self.is_usual,
            draw: self.draw.name(),
            scale: self.scale,
            asked_mean: self.distribution.as_ref().map(Distribution::mean),
            asked_cv: self.distribution.as_ref().map(Distribution::variation),
            cdf_distance: distance(0),
            cdf_distance_by_volume: distance(self.dimension.axes().into()),
            largest_volume_error_of_cells: largest_error(cells),
            largest_volume_error: grains.map(largest_error),
            centroid_steps: self.centroid_steps[0],
            centroid_steps_asked: self.centroid_steps[1],
        }
    }
}

/// The volumes at the middles of so many equal shares of a distribution of diameters, from small to large.
pub(crate) fn quantile_volumes(dimension: Dimension, distribution: &Distribution, count: usize) -> Vec<f64> {
    let share = |place: usize| (place as f64 + 0.5) / count as f64;
    volumes_at(dimension, distribution, (0..count).map(share).collect())
}

fn volumes_at(dimension: Dimension, distribution: &Distribution, shares: Vec<f64>) -> Vec<f64> {
    let volume = |share| dimension.ball_volume(distribution.quantile(share));
    shares.into_par_iter().map(volume).collect()
}

/// Fisher and Yates's.
fn shuffle(volumes: &mut [f64], generator: &mut ChaCha8Rng) {
    for last in (1..volumes.len()).rev() {
        let drawn = u128::from(generator.next_u64()) * (last as u128 + 1);
        volumes.swap(last, usize::try_from(drawn >> 64).unwrap_or(last));
    }
}

/// The largest difference between the shares of diameters up to any one and those of a distribution: by number with power 0, by
/// volume with 3, by area with 2. What volumes may miss counts as none.
fn cdf_distance(mut diameters: Vec<f64>, distribution: &Distribution, power: u32) -> f64 {
    diameters.sort_by(f64::total_cmp);
    let weight = |diameter: &f64| (0..power).map(|_| diameter).product::<f64>();
    let total: f64 = diameters.iter().map(weight).sum();
    let mut sum = 0.0;
    let differences = diameters.iter().map(|diameter| {
        let below = distribution.share_below(diameter * (1.0 - TOLERANCE), power) - sum / total;
        sum += weight(diameter);
        below.max(sum / total - distribution.share_below(diameter * (1.0 + TOLERANCE), power))
    });
    let largest = differences.fold(0.0, f64::max);
    // What the distribution has above the largest diameter is missing.
    let end = diameters.last().map_or(0.0, |diameter| diameter * (1.0 + TOLERANCE));
    largest.max(1.0 - distribution.share_below(end, power))
}

/// The lines of a summary.
impl fmt::Display for SizesReached {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "sizes       {} {}", if self.is_usual { "usual" } else { "asked" }, self.asked)?;
        match (self.asked_mean, self.asked_cv) {
            _ if self.is_usual => write!(out, "; others by --diameters, Voronoi cells by --seeding random")?,
            (Some(mean), Some(cv)) => write!(out, " (mean {mean:.4}, cv {cv:.4}; {})", self.draw)?,
            _ => {}
        }
        writeln!(out, "; diameters times {:.6} to fill the domain", self.scale)?;
        write!(out, "            reached")?;
        if let Some(distance) = self.cdf_distance {
            write!(out, " distribution function within {distance:.4}")?;
        }
        if let Some(distance) = self.cdf_distance_by_volume {
            write!(out, " (by volume {distance:.4}),")?;
        }
        write!(out, " volumes of cells within {:.1e}", self.largest_volume_error_of_cells)?;
        if let Some(error) = self.largest_volume_error {
            write!(out, ", of finished grains within {error:.1e}")?;
        }
        let Self { centroid_steps: done, centroid_steps_asked: asked, .. } = self;
        match done == asked {
            true => writeln!(out, "; {done} centroid steps"),
            false => writeln!(out, "; {done} of {asked} centroid steps, as the next left a cell empty"),
        }
    }
}
