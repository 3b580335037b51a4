use crate::{Config, SeedSource};

/// The number of seeds, where it is known beforehand.
pub(crate) fn seed_count(config: &Config) -> Option<usize> {
    match &config.seeds {
        SeedSource::File(_) => None,
        SeedSource::Random { count } | SeedSource::PoissonDisc { count } | SeedSource::Packed { count } => {
            Some(*count)
        }
        SeedSource::Lattice { .. } => config.lattice_fit().map(|fit| fit.seed_count()),
    }
}
