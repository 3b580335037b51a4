//! What is told of cells of which no network could be made.

use polycrystal::{Attempt, FaceMesh, Junctions, NetworkError};

use super::tessellated::Tessellated;
use crate::error::failed_grain::FailedGrain;
use crate::error::failure::Failure;
use crate::figures::equivalent_diameters::EquivalentDiameters;

impl Failure {
    /// A failure that some cells led to.
    pub(crate) fn new(error: NetworkError, mut attempts: Vec<Attempt>, cells: &Tessellated) -> Self {
        let (more, cause) = error.into_attempts();
        attempts.extend(more);
        let grain = FailedGrain::of(&cause, cells);
        let without_equilibrium = cells.law.without_equilibrium_in(|| {
            cells.network(&cells.tessellation, FaceMesh::Fan, Junctions::Crease, 0.0, 0)
        });
        let dimension = cells.tessellation.domain().dimension();
        let has_shapes = cells.shapes.is_some();
        Self {
            dimension,
            cause,
            grain,
            growth: None,
            works_without_short_lines: false,
            without_equilibrium,
            has_shapes,
            attempts,
        }
    }
}

impl FailedGrain {
    /// The smallest of the grains that a failure names, of all if it names none or if that is tiny; nothing if it is not about grains.
    pub(crate) fn of(cause: &NetworkError, cells: &Tessellated) -> Option<Self> {
        let named = cause.grains()?;
        let dimension = cells.tessellation.domain().dimension();
        let volumes = cells.volumes();
        let diameters: Vec<f64> = volumes.iter().map(|volume| dimension.ball_diameter(*volume)).collect();
        let mean = EquivalentDiameters::new(dimension, &diameters).mean;
        let sized = || (0u32..).zip(&diameters);
        let smallest = sized().min_by(|a, b| a.1.total_cmp(b.1))?;
        let of_named = sized().filter(|(grain, _)| named.iter().any(|other| other.0 == *grain));
        let of_named = of_named.min_by(|a, b| a.1.total_cmp(b.1));
        let told = |(grain, diameter): (u32, &f64), is_smallest: bool| Self {
            grain,
            seed: cells.grains.ids[grain as usize],
            diameter: *diameter,
            share: diameter / mean,
            is_smallest,
        };
        // What a tiny grain spoils may show at another.
        let smallest = told(smallest, of_named != Some(smallest));
        let named = of_named.filter(|_| !smallest.is_tiny()).map(|grain| told(grain, false));
        Some(named.unwrap_or(smallest))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use polycrystal::{Fault, Faults, GrainId};

    use super::*;
    use crate::error::failure::Growth;
    use crate::{Config, Error, Failure, SeedSource, tessellate};

    /// Slabs across x, of which the fourth is thin.
    const SLABS: &str =
        "0.1 0.5 0.5\n0.3 0.5 0.5\n0.5 0.5 0.5\n0.5005 0.5 0.5\n0.501 0.5 0.5\n0.7 0.5 0.5\n0.9 0.5 0.5\n";

    /// A run once failed over one tiny cell without saying how small it was, or what would help.
    #[test]
    fn failures_name_the_grain_its_size_and_a_remedy_that_takes_it_out() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("seeds.txt");
        std::fs::write(&path, SLABS).unwrap();
        let config = Config { seeds: SeedSource::File(path), ..Config::default() };
        let cells = tessellate(&config, &|_, _, _| ()).unwrap();
        let missed = |grain| NetworkError::VolumeNotRestored { grain: GrainId(grain), relative_error: 1e-3 };
        let said = |cause: NetworkError| Error::from(Failure::new(cause, Vec::new(), &cells)).to_string();
        // A slab of volume 5e-4.
        let thin = "grain 3 (SeedId 3), 1.66e-1 mean equivalent diameters wide (9.847e-2)";
        let remedy = "; merge such cells with --min-diameter 0.2";
        assert!(said(missed(3)).ends_with(&format!("; {thin}{remedy}")), "{}", said(missed(3)));
        let folded = said(NetworkError::Folded { count: 2, grains: Vec::new() });
        assert!(folded.ends_with(&format!("; the smallest is {thin}{remedy}")), "{folded}");
        assert!(!said(missed(0)).contains("--min-diameter"), "{}", said(missed(0)));
        // The diameter was told twice where a volume is missed, and not at all in other errors.
        let off = Fault::WrongVolume { grain: GrainId(3), diameter: 0.1, relative_error: 1e-3 };
        for error in [missed(3), NetworkError::Invalid(Faults(vec![off]))] {
            let said = said(error);
            assert_eq!(said.matches("equivalent diameter").count(), 1, "{said}");
        }
        assert!(!said(NetworkError::BadEdgeLength(0.0)).contains("grain"));
        // Where grains grow freely the message once named no seed.
        let vanished = NetworkError::GrainVanished { grain: GrainId(3), time: 0.01 };
        let grows = Failure::new(vanished, Vec::new(), &cells).with_growth(Growth::Until(0.005));
        assert!(grows.to_string().ends_with(&format!("; {thin}; --relax 0.005 works")), "{grows}");
        // A run of half a minute failed at a grain of 1.5e-5.
        let share = |share: f64| Failure {
            grain: Some(FailedGrain { grain: 3, seed: 3, diameter: share, share, is_smallest: false }),
            ..Failure::new(missed(3), Vec::new(), &cells)
        };
        let tiny = "too small beside the others; merge such cells with --min-diameter 0.01";
        assert!(share(1.5e-5).to_string().ends_with(tiny), "{}", share(1.5e-5));
        assert!(!share(0.1).to_string().contains("too small"), "{}", share(0.1));
        let merged = tessellate(&Config { min_diameter: 0.2, ..config }, &|_, _, _| ()).unwrap();
        assert_eq!(merged.merged_seeds, [3]);
        assert_eq!(merged.grains.ids, [0, 1, 2, 4, 5, 6]);
    }

    /// A grain of 5e-6 that spoiled others was not told of: failure 20261150:191 of the campaign.
    #[test]
    fn a_tiny_grain_is_named_wherever_it_shows() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("seeds.txt");
        std::fs::write(&path, SLABS.replace("0.5005 ", "0.50000000001 ").replace("0.501 ", "0.50000000002 "))
            .unwrap();
        let config = Config { seeds: SeedSource::File(path), ..Config::default() };
        let cells = tessellate(&config, &|_, _, _| ()).unwrap();
        let missed = NetworkError::VolumeNotRestored { grain: GrainId(0), relative_error: 1e-3 };
        let said = Failure::new(missed, Vec::new(), &cells).to_string();
        assert!(said.contains("; the smallest is grain 3 (SeedId 3), "), "{said}");
        assert!(
            said.ends_with(", too small beside the others; merge such cells with --min-diameter 0.01"),
            "{said}"
        );
    }
}
