//! Options about seeds.

use std::path::PathBuf;

use crate::spelling::{nearest, whole_number};
use crate::{Error, Lattice, SeedSource};
use clap::{Args, ValueEnum};
use voronoi::Dimension;

use super::usage;

/// Grains where nothing is said.
const USUAL_SEEDS: u32 = 200;

/// Where seeds come from.
#[derive(Debug, Args)]
#[command(next_help_heading = "Seeds")]
pub struct SeedArguments {
    /// Number of grains [default: 200, or what --diameters or --volumes ask for]
    ///
    /// Example: --seeds 5000
    #[arg(long, value_name = "N", value_parser = whole_number(1..=4_000_000_000_u32), allow_negative_numbers = true)]
    seeds: Option<u32>,

    /// How seeds are placed: as centres of spheres that do not overlap, for grains of exact, realistic sizes (packed);
    /// uniformly at random (random); or at random but at least 0.75 mean spacings apart (poisson-disc)
    ///
    /// Packed grains have lognormal diameters with a coefficient of variation of 0.35, unless --diameters or --volumes ask
    /// for others. Random seeds give Poisson-Voronoi cells, whose statistics are known.
    ///
    /// Example: --seeding random
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Seeding::Packed)]
    seeding: Seeding,

    /// Place seeds on a lattice instead: sc, bcc, fcc or hcp (square or hex in 2D), with N unit cells along the shortest
    /// side
    ///
    /// Example: --lattice bcc 4
    #[arg(long, value_names = ["LATTICE", "N"], num_args = 2, value_parser = parse_lattice, allow_negative_numbers = true, conflicts_with_all = ["seeds", "random_seed", "seeding"])]
    lattice: Option<Vec<LatticeValue>>,

    /// Read seeds from a file instead: text with x, y, z on each line (x, y in 2D), or with column names in the first line,
    /// where radius, diameter or weight makes power cells; .xyz; .json; or Neper's .tess, which also defines the box
    ///
    /// Example: --seeds-file seeds.csv
    #[arg(long, value_name = "FILE", conflicts_with_all = ["seeds", "random_seed", "seeding", "lattice"])]
    pub seeds_file: Option<PathBuf>,
}

/// `--seeding` as it is spelled.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Seeding {
    Random,
    PoissonDisc,
    Packed,
}

/// One of the two values of `--lattice`.
#[derive(Debug, Clone, Copy)]
enum LatticeValue {
    Kind(Lattice),
    Cells(u32),
}

impl SeedArguments {
    /// Whether the number of grains is left open.
    pub(super) fn is_count_open(&self) -> bool {
        self.seeds.is_none() && self.seeds_file.is_none() && self.lattice.is_none()
    }

    /// Where seeds of a dimension come from.
    pub(super) fn source(&self, dimension: Dimension) -> Result<SeedSource, Error> {
        if let Some(path) = &self.seeds_file {
            return Ok(SeedSource::File(path.clone()));
        }
        let count = self.seeds.unwrap_or(USUAL_SEEDS) as usize;
        match (self.lattice.as_deref(), self.seeding) {
            (None, Seeding::Random) => Ok(SeedSource::Random { count }),
            (None, Seeding::PoissonDisc) => Ok(SeedSource::PoissonDisc { count }),
            (None, Seeding::Packed) => Ok(SeedSource::Packed { count }),
            (Some(&[LatticeValue::Kind(lattice), LatticeValue::Cells(cells)]), _) => {
                match (lattice.dimension(), dimension) {
                    (Dimension::Three, Dimension::Two) => {
                        Err(usage("--dim 2 has the lattices square and hex"))
                    }
                    (Dimension::Two, Dimension::Three) => {
                        Err(usage("the lattices square and hex are for --dim 2; give sc, bcc, fcc or hcp"))
                    }
                    _ => Ok(SeedSource::Lattice { lattice, cells }),
                }
            }
            (Some(_), _) => {
                Err(usage("--lattice takes a lattice and the number of its cells, such as bcc 4"))
            }
        }
    }
}

fn parse_lattice(text: &str) -> Result<LatticeValue, String> {
    if let Some((lattice, _)) = Lattice::ALL.into_iter().find(|(_, name)| *name == text) {
        return Ok(LatticeValue::Kind(lattice));
    }
    // A cube of so many cells has as many seeds as ids can name.
    let cells = whole_number(1..=1600_u32)(text).map(LatticeValue::Cells);
    cells.map_err(|remedy| {
        let meant = nearest(text, Lattice::ALL.map(|(_, name)| name));
        let hint = meant.map_or(String::new(), |name| format!("did you mean {name}? "));
        format!("{hint}the lattices are sc, bcc, fcc and hcp, and square and hex in 2D; then {remedy}")
    })
}
