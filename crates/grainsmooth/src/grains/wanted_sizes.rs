//! The sizes that grains are to have, and how many of them fill a domain.

use sizes::{Distribution, Law, Part, Spec};
use voronoi::Domain;

use super::gradient::Gradient;
use super::quantiles::quantile_volumes;
use crate::config::sizes::{SizeDraw, SizeSource, USUAL_DIAMETERS};
use crate::input::size_file::{read_diameter_file, read_volume_file};
use crate::memory::{available_memory, check_cells};
use crate::{Config, Error, PhaseOptions, PhasesError, SeedSource};

/// How often the number of grains is corrected by the volumes of those that would be drawn: two or three times change it.
pub(crate) const MOST_CORRECTIONS: usize = 20;

/// What grains are to be like.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Wanted {
    /// Diameters of a distribution.
    Diameters(Distribution),
    /// These volumes, but for a common factor.
    Volumes(Vec<f64>),
}

impl Config {
    /// What grains are to be like, where they have given volumes.
    ///
    /// # Errors
    /// [`Error::Unreadable`]; [`Error::BadLine`].
    pub(crate) fn wanted_sizes(&self) -> Result<Wanted, Error> {
        self.wanted(self.sizes.source.as_ref())
    }

    /// What the grains of each phase are to be like.
    ///
    /// # Errors
    /// As of [`Self::wanted_sizes`].
    pub(crate) fn wanted_sizes_of_phases(&self) -> Result<Vec<Distribution>, Error> {
        let of_phase = |phase: &PhaseOptions| match self
            .wanted(phase.diameters.as_ref().or(self.sizes.source.as_ref()))?
        {
            Wanted::Diameters(distribution) => Ok(distribution),
            Wanted::Volumes(_) => Err(PhasesError::Volumes.into()),
        };
        self.phases.iter().map(of_phase).collect()
    }

    fn wanted(&self, source: Option<&SizeSource>) -> Result<Wanted, Error> {
        let axes = self.dimension.axes().into();
        Ok(match source {
            None => Wanted::Diameters(
                USUAL_DIAMETERS.parse::<Spec>().expect("a good distribution").distribution(axes),
            ),
            Some(SizeSource::Diameters(spec)) => Wanted::Diameters(spec.distribution(axes)),
            Some(SizeSource::DiameterFile(path)) => {
                let law = Law::Table(read_diameter_file(path, self.dimension)?);
                let all = Part::new(law, 0.0, f64::INFINITY).expect("nothing is cut off");
                Wanted::Diameters(Distribution::new(vec![(1.0, all)], None))
            }
            Some(SizeSource::VolumeFile(path)) => Wanted::Volumes(read_volume_file(path, self.dimension)?),
        })
    }

    /// The same with as many random seeds as grains of the sizes asked for fill the domain; with those of a file of volumes.
    ///
    /// # Errors
    /// [`Error::GrainTooLarge`]; [`MemoryError::CellsExceedMemory`](crate::memory::MemoryError::CellsExceedMemory); whatever is wrong with the domain or a file.
    pub fn with_count_of_sizes(self) -> Result<Self, Error> {
        self.check()?;
        let domain = self.domain()?;
        let factor = Gradient::of_config(&self)?.map_or(1.0, |gradient| gradient.mean_volume_factor());
        let draw = self.sizes.draw;
        let found = if self.phases_have_diameters() {
            let wanted = self.wanted_sizes_of_phases()?;
            let mut all = 0_usize;
            for ((distribution, fraction), phase) in
                wanted.iter().zip(self.phase_fractions()).zip(&self.phases)
            {
                let share = Share { fraction, of: format!("the share of phase {}", phase.name) };
                all = all.saturating_add(count_that_fills(&domain, &share, distribution, draw, factor)?);
            }
            check_cells(all, available_memory())?;
            all
        } else {
            match self.wanted_sizes()? {
                Wanted::Volumes(volumes) => volumes.len(),
                Wanted::Diameters(distribution) => {
                    let share = Share { fraction: 1.0, of: "the domain".to_owned() };
                    count_that_fills(&domain, &share, &distribution, draw, factor)?
                }
            }
        };
        let seeds = match self.seeds {
            SeedSource::Random { .. } => SeedSource::Random { count: found },
            SeedSource::PoissonDisc { .. } => SeedSource::PoissonDisc { count: found },
            SeedSource::Packed { .. } => SeedSource::Packed { count: found },
            others => others,
        };
        Ok(Self { seeds, ..self })
    }
}

/// What of a domain grains fill.
struct Share {
    fraction: f64,
    /// In words.
    of: String,
}

/// The number of grains of a distribution that fills a share of a domain. Few grains lack the largest ones of a distribution, so their mean volume is
/// smaller than its own: what they would have is looked at. Volumes are multiplied by a factor on average.
fn count_that_fills(
    domain: &Domain,
    share: &Share,
    distribution: &Distribution,
    draw: SizeDraw,
    factor: f64,
) -> Result<usize, Error> {
    let (dimension, measure) = (domain.dimension(), share.fraction * domain.measure());
    let mean_volume = dimension.ball_volume(1.0) * distribution.moment(dimension.axes().into());
    let room = measure / factor;
    let mut count = whole(room / mean_volume);
    check_cells(count, available_memory())?;
    let mut tried = Vec::new();
    while draw == SizeDraw::Quantiles && tried.len() < MOST_CORRECTIONS && !tried.contains(&count) {
        tried.push(count);
        let volumes: f64 = quantile_volumes(dimension, distribution, count).iter().sum();
        count = whole(room / volumes * count as f64);
        check_cells(count, available_memory())?;
    }
    let largest = distribution.quantile(1.0 - 0.5 / count as f64);
    let longest = domain.size().max_element();
    let fits = dimension.ball_diameter(measure).min(longest);
    if largest > fits {
        return Err(Error::GrainTooLarge { diameter: largest, of: share.of.clone(), fits });
    }
    Ok(count)
}

/// The nearest whole number of grains, one or more.
fn whole(number: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "numbers too large take the largest"
    )]
    let whole = number.round() as usize;
    whole.max(1)
}
