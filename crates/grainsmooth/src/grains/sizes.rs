//! The volumes that grains are to have, drawn from what is asked for, and what was reached.

use std::fmt;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde::Serialize;
use sizes::Distribution;
use voronoi::volumes::TOLERANCE;
use voronoi::{Dimension, Domain};

use super::assigned::assigned;
use super::quantiles::{quantile_volumes, volumes_at};
use super::wanted_sizes::{MOST_CORRECTIONS, Wanted};
use crate::config::spelling::name_of;
use crate::figures::asked::AskedAndReached;
use crate::seeds::random::unit_fraction;
use crate::{Config, Error, PhasesError, SizeDraw};

/// The generator's stream for sizes, apart from those of the seeds' positions (0) and of orientations (1, 2).
const STREAM: u64 = 3;

/// The volumes that grains are to have.
#[derive(Debug, Clone, PartialEq)]
pub struct GrainSizes {
    dimension: Dimension,
    draw: SizeDraw,
    /// What was asked for: of all grains, or where phases have diameters of their own, of each phase.
    groups: Vec<SizeGroup>,
    /// Index of each grain's phase; 0 without phases.
    phase_of: Vec<usize>,
    /// The share of the domain that each phase is to have; one, of 1, without phases.
    fractions: Vec<f64>,
    has_phases: bool,
    /// By which diameters of one group are multiplied so that each phase has its share, beside the group's scale.
    phase_scales: Vec<f64>,
    volumes: Vec<f64>,
    /// What a gradient multiplied each volume by; nothing without one.
    factors: Vec<f64>,
    /// How many times seeds moved to the centroids of their cells, and how many times they were to.
    centroid_steps: [usize; 2],
}

/// Grains whose sizes were asked for together.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SizeGroup {
    asked: String,
    /// Whether nothing was.
    is_usual: bool,
    distribution: Option<Distribution>,
    /// By which diameters are multiplied to fill the domain, or the phase's share of it.
    scale: f64,
}

impl SizeGroup {
    /// The distribution of diameters that was asked for, if one was.
    pub(crate) fn distribution(&self) -> Option<&Distribution> {
        self.distribution.as_ref()
    }
}

/// How near volumes came to what was asked for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SizesReached {
    /// Of all grains; nothing where phases have diameters of their own.
    #[serde(flatten)]
    of_all: Option<SizesFit>,
    /// Of each phase, where these have diameters of their own.
    #[serde(skip)]
    of_phases: Vec<SizesFit>,
    #[serde(skip)]
    has_phases: bool,
    /// Of the cells' volumes.
    largest_volume_error_of_cells: f64,
    /// Of the finished grains' volumes, where they are kept.
    largest_volume_error: Option<f64>,
    centroid_steps: usize,
    centroid_steps_asked: usize,
}

/// How near the diameters of some grains came to a distribution.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SizesFit {
    /// What was asked for, in words.
    asked: String,
    /// Whether nothing was asked for: these are the usual sizes.
    is_usual: bool,
    draw: SizeDraw,
    /// By which the diameters asked for are multiplied to fill the domain.
    scale: f64,
    /// Mean of the distribution that was asked for, before it is scaled, and its coefficient of variation.
    asked_mean: Option<f64>,
    asked_cv: Option<f64>,
    /// The same of the grains, as if they were not scaled.
    mean: f64,
    cv: f64,
    /// The largest difference between the share of grains up to a diameter and the distribution's.
    cdf_distance: Option<f64>,
    /// The same of the shares of the volume, which tells of large grains that are missing.
    cdf_distance_by_volume: Option<f64>,
}

impl GrainSizes {
    /// Draws the volumes of so many grains, which fill the domain.
    ///
    /// # Errors
    /// [`Error::Phases`]; [`Error::VolumeCount`] where each grain is given its own and there are more or fewer; whatever is wrong with a file.
    pub(crate) fn draw(config: &Config, domain: &Domain, count: usize) -> Result<Self, Error> {
        let (dimension, draw) = (config.dimension, config.sizes.draw);
        let mut generator = ChaCha8Rng::seed_from_u64(config.random_seed);
        generator.set_stream(STREAM);
        let fractions = config.phase_fractions();
        if count < fractions.len() {
            return Err(PhasesError::FewGrains { grains: count, phases: fractions.len() }.into());
        }
        let mut groups = Vec::new();
        let mut volumes = Vec::new();
        let mut phase_of = Vec::new();
        if config.phases_have_diameters() {
            let wanted = config.wanted_sizes_of_phases()?;
            let counts = apportioned(dimension, count, &fractions, &wanted);
            for (phase, (distribution, own)) in wanted.into_iter().zip(counts).enumerate() {
                volumes.extend(drawn(dimension, &distribution, draw, own, &mut generator));
                phase_of.resize(volumes.len(), phase);
                let asked = config.asked_sizes_of_phase(phase);
                groups.push(SizeGroup {
                    asked,
                    is_usual: false,
                    distribution: Some(distribution),
                    scale: 1.0,
                });
            }
            let mut order: Vec<usize> = (0..count).collect();
            shuffle(&mut order, &mut generator);
            volumes = order.iter().map(|grain| volumes[*grain]).collect();
            phase_of = order.iter().map(|grain| phase_of[*grain]).collect();
        } else {
            let asked = config.asked_sizes();
            let distribution = match config.wanted_sizes()? {
                Wanted::Volumes(given) if given.len() == count => {
                    volumes = given;
                    None
                }
                Wanted::Volumes(given) => {
                    return Err(Error::VolumeCount { asked, volumes: given.len(), seeds: count });
                }
                Wanted::Diameters(distribution) => {
                    volumes = drawn(dimension, &distribution, draw, count, &mut generator);
                    Some(distribution)
                }
            };
            phase_of = if fractions.is_empty() { vec![0; count] } else { assigned(&volumes, &fractions) };
            let is_usual = config.sizes.source.is_none();
            groups.push(SizeGroup { asked, is_usual, distribution, scale: 1.0 });
        }
        let fractions = if fractions.is_empty() { vec![1.0] } else { fractions };
        let mut sizes = Self {
            dimension,
            draw,
            groups,
            phase_of,
            phase_scales: vec![1.0; fractions.len()],
            fractions,
            has_phases: !config.phases.is_empty(),
            volumes,
            factors: Vec::new(),
            centroid_steps: [0, config.centroid_steps() as usize],
        };
        sizes.fill(domain.measure());
        Ok(sizes)
    }

    /// Multiplies volumes so that they fill the domain, and each phase its share of it.
    fn fill(&mut self, measure: f64) {
        if self.groups.len() == 1 {
            let factor = measure / self.volumes.iter().sum::<f64>();
            self.volumes.iter_mut().for_each(|volume| *volume *= factor);
            self.groups[0].scale *= self.dimension.cube_edge(factor);
        }
        if self.fractions.len() == 1 {
            return;
        }
        let mut sums = vec![0.0; self.fractions.len()];
        self.volumes.iter().zip(&self.phase_of).for_each(|(volume, phase)| sums[*phase] += volume);
        let factors: Vec<f64> =
            self.fractions.iter().zip(sums).map(|(fraction, sum)| fraction * measure / sum).collect();
        self.volumes.iter_mut().zip(&self.phase_of).for_each(|(volume, phase)| *volume *= factors[*phase]);
        for (phase, factor) in factors.into_iter().enumerate() {
            let scale = self.dimension.cube_edge(factor);
            match self.groups.len() {
                1 => self.phase_scales[phase] *= scale,
                _ => self.groups[phase].scale *= scale,
            }
        }
    }

    /// The same with each volume multiplied by a factor of its own, and all so that they fill what they filled before.
    pub(crate) fn with_factors(mut self, factors: Vec<f64>) -> Self {
        let before: f64 = self.volumes.iter().sum();
        self.volumes.iter_mut().zip(&factors).for_each(|(volume, factor)| *volume *= factor);
        self.fill(before);
        Self { factors, ..self }
    }

    /// The same with other numbers: grain k is what grain `order[k]` was.
    pub(crate) fn in_order(self, order: &[usize]) -> Self {
        Self {
            volumes: order.iter().map(|grain| self.volumes[*grain]).collect(),
            phase_of: order.iter().map(|grain| self.phase_of[*grain]).collect(),
            ..self
        }
    }

    /// The volumes that grains are to have (in the plane: areas).
    pub fn volumes(&self) -> &[f64] {
        &self.volumes
    }

    /// Index of each grain's phase; 0 without phases.
    pub(crate) fn phase_of(&self) -> &[usize] {
        &self.phase_of
    }

    /// By which diameters that all phases share are multiplied in each phase.
    pub(crate) fn phase_scales(&self) -> &[f64] {
        &self.phase_scales
    }

    /// The same after so many centroid steps.
    pub(crate) fn with_centroid_steps(self, done: usize) -> Self {
        Self { centroid_steps: [done, self.centroid_steps[1]], ..self }
    }

    /// Grains whose sizes were asked for together: what was asked, and the numbers of the grains.
    pub(crate) fn groups(&self) -> impl Iterator<Item = (&SizeGroup, Vec<usize>)> {
        let is_one = self.groups.len() == 1;
        self.groups.iter().enumerate().map(move |(group, asked)| {
            let members = (0..self.volumes.len()).filter(|grain| is_one || self.phase_of[*grain] == group);
            (asked, members.collect())
        })
    }

    /// Diameters of some grains as they would be without scale and gradient.
    pub(crate) fn unscaled_diameters(
        &self,
        group: &SizeGroup,
        grains: &[usize],
        volumes: &[f64],
    ) -> Vec<f64> {
        let unscaled = |grain: &usize| {
            let volume = volumes[*grain] / self.factors.get(*grain).unwrap_or(&1.0);
            self.dimension.ball_diameter(volume) / group.scale
        };
        grains.iter().map(unscaled).collect()
    }

    /// How near cells came, and finished grains where these keep their volumes.
    pub(crate) fn reached(&self, cells: &[f64], grains: Option<&[f64]>) -> SizesReached {
        let largest_error = |volumes: &[f64]| {
            let errors =
                volumes.iter().zip(&self.volumes).map(|(volume, target)| (volume / target - 1.0).abs());
            errors.fold(0.0, f64::max)
        };
        let fit = |(group, members): (&SizeGroup, Vec<usize>)| {
            let diameters = self.unscaled_diameters(group, &members, grains.unwrap_or(cells));
            let mean = diameters.iter().sum::<f64>() / diameters.len() as f64;
            let square = |diameter: &f64| (diameter - mean).powi(2);
            let variance = diameters.iter().map(square).sum::<f64>() / diameters.len() as f64;
            let distance = |power| {
                let diameters = diameters.clone();
                group.distribution.as_ref().map(|distribution| cdf_distance(diameters, distribution, power))
            };
            SizesFit {
                asked: group.asked.clone(),
                is_usual: group.is_usual,
                draw: self.draw,
                scale: group.scale,
                asked_mean: group.distribution.as_ref().map(Distribution::mean),
                asked_cv: group.distribution.as_ref().map(Distribution::variation),
                mean,
                cv: variance.sqrt() / mean,
                cdf_distance: distance(0),
                cdf_distance_by_volume: distance(self.dimension.axes().into()),
            }
        };
        let mut of_phases: Vec<SizesFit> = self.groups().map(fit).collect();
        let of_all = if of_phases.len() == 1 { of_phases.pop() } else { None };
        SizesReached {
            of_all,
            of_phases,
            has_phases: self.has_phases,
            largest_volume_error_of_cells: largest_error(cells),
            largest_volume_error: grains.map(largest_error),
            centroid_steps: self.centroid_steps[0],
            centroid_steps_asked: self.centroid_steps[1],
        }
    }
}

impl SizesReached {
    /// The figures that were asked for, with the names of the phases.
    pub(crate) fn asked_and_reached(&self, phases: &[&str]) -> Vec<AskedAndReached> {
        let fits = self.of_all.iter().map(|fit| (fit, String::new()));
        let of_phases = self.of_phases.iter().zip(phases);
        let of_phases = of_phases.map(|(fit, name)| (fit, format!(", {name}")));
        let mut rows = Vec::new();
        for (fit, of) in fits.chain(of_phases) {
            let mut add = |what: &str, asked: Option<f64>, reached: Option<f64>| {
                if let (Some(asked), Some(reached)) = (asked, reached) {
                    rows.push(AskedAndReached { what: format!("{what}{of}"), asked, reached });
                }
            };
            add("mean diameter", fit.asked_mean.map(|mean| mean * fit.scale), Some(fit.mean * fit.scale));
            add("coefficient of variation of diameters", fit.asked_cv, Some(fit.cv));
            let distance = "largest difference from the distribution function";
            add(&format!("{distance}, by number"), Some(0.0), fit.cdf_distance);
            add(&format!("{distance}, by volume"), Some(0.0), fit.cdf_distance_by_volume);
        }
        let error = self.largest_volume_error.unwrap_or(self.largest_volume_error_of_cells);
        let what = "largest relative error of a grain's volume".to_owned();
        rows.push(AskedAndReached { what, asked: 0.0, reached: error });
        rows
    }

    /// How near each phase came, where phases have diameters of their own.
    pub fn of_phases(&self) -> &[SizesFit] {
        &self.of_phases
    }
}

/// The volumes of so many grains of a distribution, in random order.
fn drawn(
    dimension: Dimension,
    distribution: &Distribution,
    draw: SizeDraw,
    count: usize,
    generator: &mut ChaCha8Rng,
) -> Vec<f64> {
    match draw {
        SizeDraw::Quantiles => {
            let mut volumes = quantile_volumes(dimension, distribution, count);
            shuffle(&mut volumes, generator);
            volumes
        }
        SizeDraw::Random => {
            // Never 0 or 1, where distributions may have no end.
            let share = |bits: u64| unit_fraction(bits) + 0.5f64.powi(54);
            let shares: Vec<f64> = (0..count).map(|_| share(generator.next_u64())).collect();
            volumes_at(dimension, distribution, shares)
        }
    }
}

/// How many of some grains each phase has, so that diameters are multiplied by one number in all as nearly as whole numbers allow; one
/// at least.
fn apportioned(
    dimension: Dimension,
    count: usize,
    fractions: &[f64],
    distributions: &[Distribution],
) -> Vec<usize> {
    let mut mean_volumes: Vec<f64> = distributions
        .iter()
        .map(|distribution| dimension.ball_volume(1.0) * distribution.moment(dimension.axes().into()))
        .collect();
    let mut tried: Vec<Vec<usize>> = Vec::new();
    loop {
        let quotas: Vec<f64> =
            fractions.iter().zip(&mean_volumes).map(|(fraction, volume)| fraction / volume).collect();
        let counts = whole_shares(count, &quotas);
        // Few grains lack the largest ones of a distribution, so their mean volume is smaller than its own.
        if tried.contains(&counts) || tried.len() >= MOST_CORRECTIONS {
            return counts;
        }
        for ((volume, distribution), own) in mean_volumes.iter_mut().zip(distributions).zip(&counts) {
            *volume = quantile_volumes(dimension, distribution, *own).iter().sum::<f64>() / *own as f64;
        }
        tried.push(counts);
    }
}

/// A number in whole parts, one at least, as quotas have it: what is left over goes where it is missed most.
fn whole_shares(count: usize, quotas: &[f64]) -> Vec<usize> {
    let total: f64 = quotas.iter().sum();
    let mut parts = vec![1; quotas.len()];
    for _ in quotas.len()..count {
        let lack = |part: usize| quotas[part] / total * count as f64 - parts[part] as f64;
        let most = (0..quotas.len()).reduce(|best, part| if lack(part) > lack(best) { part } else { best });
        parts[most.unwrap_or(0)] += 1;
    }
    parts
}

/// Fisher and Yates's.
fn shuffle<T>(items: &mut [T], generator: &mut ChaCha8Rng) {
    for last in (1..items.len()).rev() {
        let drawn = u128::from(generator.next_u64()) * (last as u128 + 1);
        items.swap(last, usize::try_from(drawn >> 64).unwrap_or(last));
    }
}

/// The largest difference between the shares of diameters up to any one and those of a distribution: by number with power 0, by
/// volume with 3, by area with 2. What volumes may miss counts as none.
pub(crate) fn cdf_distance(mut diameters: Vec<f64>, distribution: &Distribution, power: u32) -> f64 {
    diameters.sort_unstable_by(f64::total_cmp);
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
        match &self.of_all {
            Some(fit) => {
                let others = match (fit.is_usual, self.has_phases) {
                    (false, _) => "",
                    (true, false) => "; others by --diameters, Voronoi cells by --seeding random",
                    (true, true) => "; others by --diameters",
                };
                let scale = fit.scale;
                writeln!(
                    out,
                    "sizes       {}{others}; diameters times {scale:.6} to fill the domain",
                    fit.words()
                )?;
                write!(out, "            reached{}", fit.distances())?;
            }
            None => {
                writeln!(out, "sizes       of each phase")?;
                write!(out, "            reached")?;
            }
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

impl SizesFit {
    /// What was asked for.
    fn words(&self) -> String {
        match (self.asked_mean, self.asked_cv) {
            _ if self.is_usual => format!("usual {}", self.asked),
            (Some(mean), Some(cv)) => {
                format!("asked {} (mean {mean:.4}, cv {cv:.4}; {})", self.asked, name_of(&self.draw))
            }
            _ => format!("asked {}", self.asked),
        }
    }

    /// How near the distribution is.
    fn distances(&self) -> String {
        let mut words = String::new();
        if let Some(distance) = self.cdf_distance {
            words += &format!(" distribution function within {distance:.4}");
        }
        if let Some(distance) = self.cdf_distance_by_volume {
            words += &format!(" (by volume {distance:.4}),");
        }
        words
    }
}

/// Part of a phase's line in a summary.
impl fmt::Display for SizesFit {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            out,
            "{}, diameters times {:.6},{}",
            self.words(),
            self.scale,
            self.distances().trim_end_matches(',')
        )
    }
}
