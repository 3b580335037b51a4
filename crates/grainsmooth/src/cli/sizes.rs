//! Options about the sizes of grains.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use crate::{Error, SizeSource};
use clap::Args;
use glam::DVec3;
use voronoi::Dimension;

use super::usage;

/// Lengths in proportion: grains a hundred times as long as wide are fibers that no network of boundaries shows.
const PROPORTIONS: RangeInclusive<f64> = 0.01..=100.0;

/// Sizes and elongation of grains.
#[derive(Debug, Args)]
#[command(next_help_heading = "Sizes")]
pub struct SizeArguments {
    /// Give the grains exact sizes: equivalent diameters from a distribution or a file, in the unit of --box
    ///
    /// Distributions are lognormal(mean=20, cv=0.35), normal(mean=20, sd=5), uniform(10, 30), weibull(shape=2.8, scale=20),
    /// gamma(mean=20, cv=0.35), equal(20), and sums of these weighted by number: '0.8*lognormal(mean=20, cv=0.3) +
    /// 0.2*equal(60)'. Cut-offs, and weights by volume, follow after commas: ', from=5, to=80, by=volume'. A file (.csv,
    /// .txt) holds a list, a histogram or a cumulative distribution. There are as many grains as fill the domain; with
    /// --seeds N, diameters are scaled to fill it.
    ///
    /// Example: --diameters 'lognormal(mean=20, cv=0.35)' --box 100 100 100
    #[arg(long, value_name = "SPEC|FILE", value_parser = parse_diameters, conflicts_with = "lattice")]
    diameters: Option<SizeSource>,

    /// Give each grain its own volume (area in 2D), scaled to fill the domain: a text file with one volume on each line
    ///
    /// Example: --volumes volumes.csv
    #[arg(long, value_name = "FILE", conflicts_with_all = ["diameters", "lattice", "seeds"])]
    volumes: Option<PathBuf>,

    /// Elongate the grains along the axes, in these proportions: 3 1 1 for rolled, 1 1 4 for columnar grains (X Y in 2D)
    ///
    /// Grains are made and relaxed with equal axes, so triple lines have angles of 120 degrees at first, and then stretched.
    /// The final box is that of --box, and volumes stay exact.
    ///
    /// Example: --aspect-ratio 3 1 1
    #[arg(long, value_names = ["X", "Y", "Z"], num_args = 2.., value_parser = parse_proportion, conflicts_with_all = ["lattice", "domain", "half_spaces", "series"], allow_negative_numbers = true)]
    aspect_ratio: Option<Vec<f64>>,
}

impl SizeArguments {
    /// How long grains are along each axis, in proportion; 1 along z in 2D.
    pub(super) fn aspect_ratio(&self, dimension: Dimension) -> Result<DVec3, Error> {
        let ratio = match (self.aspect_ratio.as_deref(), dimension) {
            (None, _) => DVec3::ONE,
            (Some(&[x, y]), Dimension::Two) => DVec3::new(x, y, 1.0),
            (Some(&[x, y, z]), Dimension::Three) => DVec3::new(x, y, z),
            (Some(_), Dimension::Two) => {
                return Err(usage("--aspect-ratio takes two numbers, X Y, with --dim 2"));
            }
            (Some(_), Dimension::Three) => {
                return Err(usage("--aspect-ratio takes three numbers, X Y Z, without --dim 2"));
            }
        };
        // Equal lengths are no stretch.
        let is_equal = ratio.x == ratio.y && (dimension == Dimension::Two || ratio.x == ratio.z);
        Ok(if is_equal { DVec3::ONE } else { ratio })
    }

    /// Where sizes come from.
    pub(super) fn source(&self) -> Option<SizeSource> {
        self.diameters.clone().or_else(|| self.volumes.clone().map(SizeSource::VolumeFile))
    }
}

fn parse_proportion(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| PROPORTIONS.contains(number));
    number.ok_or_else(|| {
        format!("a length in proportion is a number from {} to {}", PROPORTIONS.start(), PROPORTIONS.end())
    })
}

fn parse_diameters(text: &str) -> Result<SizeSource, String> {
    SizeSource::diameters(text).map_err(|error| error.to_string())
}
