//! Options about the sizes of grains.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use grainsmooth::{SizeDraw, SizeOptions, SizeSource};

/// How large grains are.
#[derive(Debug, Args)]
#[command(next_help_heading = "Sizes")]
pub struct SizeArguments {
    /// Give grains exact sizes: equivalent diameters of a distribution, in words or from a file, in the unit of --box
    ///
    /// Words are lognormal(mean=20, cv=0.35), normal(mean=20, sd=5), uniform(10, 30), weibull(shape=2.8, scale=20), gamma(mean=20, cv=0.35),
    /// equal(20), and sums of these with weights by number: '0.8*lognormal(mean=20, cv=0.3) + 0.2*equal(60)'. Behind them may stand
    /// cut-offs, and that weights are by volume: ', from=5, to=80, by=volume'. A file (.csv, .txt) holds a list, a histogram or a
    /// distribution function. As many grains are made as fill the domain; with --seeds N, diameters are scaled to fill it.
    ///
    /// Example: --diameters 'lognormal(mean=20, cv=0.35)' --box 100 100 100
    #[arg(long, value_name = "SPEC|FILE", value_parser = parse_diameters, conflicts_with = "lattice")]
    diameters: Option<SizeSource>,

    /// Give each grain a volume of its own (in 2D an area), scaled to fill the domain: one on each line of a text file
    ///
    /// Example: --volumes volumes.csv
    #[arg(long, value_name = "FILE", conflicts_with_all = ["diameters", "lattice", "seeds"])]
    volumes: Option<PathBuf>,

    /// Draw diameters as the middles of equal shares of the distribution (quantiles), or each by itself (random)
    ///
    /// Example: --diameters 'lognormal(mean=20, cv=0.35)' --draw random
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Draw::Quantiles, conflicts_with_all = ["volumes", "lattice"])]
    draw: Draw,
}

/// `--draw` as it is spelled.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Draw {
    Quantiles,
    Random,
}

impl SizeArguments {
    /// What is asked for.
    pub fn options(&self) -> SizeOptions {
        let volumes = || self.volumes.clone().map(SizeSource::VolumeFile);
        let draw = match self.draw {
            Draw::Quantiles => SizeDraw::Quantiles,
            Draw::Random => SizeDraw::Random,
        };
        SizeOptions { source: self.diameters.clone().or_else(volumes), draw }
    }
}

fn parse_diameters(text: &str) -> Result<SizeSource, String> {
    SizeSource::diameters(text).map_err(|error| error.to_string())
}
