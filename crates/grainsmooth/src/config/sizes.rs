//! What is asked of the grains' sizes.

use std::fmt;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde::{Serialize, Serializer};
use sizes::{Spec, SpecError};

use super::gradient::GradientSource;
use super::spelling::{as_text_if_given, is_usual};
use super::table_file::is_table_file;

/// Diameters where packed seeds are asked for and nothing is said of sizes: those of recrystallised metals.
pub(crate) const USUAL_DIAMETERS: &str = "lognormal(mean=1, cv=0.35)";

/// What is asked of the grains' sizes.
#[derive(Debug, Clone, PartialEq, Default, Args, Serialize)]
#[command(next_help_heading = "Sizes")]
pub struct SizeOptions {
    /// Where they come from; nothing for what the cells of the seeds have.
    #[arg(skip)]
    #[serde(flatten)]
    pub source: Option<SizeSource>,

    /// Take the diameters at equally spaced quantiles of the distribution (quantiles), or draw each independently (random)
    ///
    /// Example: --diameters 'lognormal(mean=20, cv=0.35)' --draw random
    #[arg(long, value_name = "HOW", value_enum, default_value_t, conflicts_with_all = ["volumes", "lattice"])]
    #[serde(skip_serializing_if = "is_usual")]
    pub draw: SizeDraw,

    /// Vary the diameters along an axis of the box: a table of positions and of the factors by which diameters are
    /// multiplied there
    ///
    /// Example: --diameters 'lognormal(mean=20, cv=0.35)' --gradient z:factors.csv
    #[arg(long, value_name = "AXIS:FILE", conflicts_with_all = ["volumes", "lattice", "domain", "half_spaces"])]
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "as_text_if_given")]
    pub gradient: Option<GradientSource>,
}

/// Where sizes come from.
#[derive(Debug, Clone, PartialEq)]
pub enum SizeSource {
    /// A distribution of equivalent diameters in words.
    Diameters(Spec),
    /// A file with a distribution of them.
    DiameterFile(PathBuf),
    /// A file with the volume of each grain (in the plane: area).
    VolumeFile(PathBuf),
}

/// How sizes are drawn from a distribution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SizeDraw {
    /// The middles of equal shares, in random order: as near the distribution as so many grains can be.
    #[default]
    Quantiles,
    /// Each by itself.
    Random,
}

impl SizeSource {
    /// A distribution of diameters: a file where one has this name, or the name ends as those of tables do; else words.
    ///
    /// # Errors
    /// What is wrong with the words.
    pub fn diameters(text: &str) -> Result<Self, SpecError> {
        let path = Path::new(text);
        if is_table_file(path) {
            return Ok(Self::DiameterFile(path.to_owned()));
        }
        text.parse().map(Self::Diameters)
    }
}

/// As it is given.
impl fmt::Display for SizeSource {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Diameters(spec) => out.write_str(spec.text()),
            Self::DiameterFile(path) | Self::VolumeFile(path) => path.display().fmt(out),
        }
    }
}

/// By the option that asks for it.
impl Serialize for SizeSource {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let option = if matches!(self, Self::VolumeFile(_)) { "volumes" } else { "diameters" };
        serializer.collect_map([(option, self.to_string())])
    }
}
