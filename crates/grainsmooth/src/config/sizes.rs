//! What is asked of the grains' sizes.

use std::path::{Path, PathBuf};

use sizes::{Spec, SpecError};

use super::gradient::GradientSource;
use super::table_file::is_table_file;

/// Diameters where packed seeds are asked for and nothing is said of sizes: those of recrystallised metals.
pub(crate) const USUAL_DIAMETERS: &str = "lognormal(mean=1, cv=0.35)";

/// What is asked of the grains' sizes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SizeOptions {
    /// Where they come from; nothing for what the cells of the seeds have.
    pub source: Option<SizeSource>,
    /// How they are drawn from a distribution.
    pub draw: SizeDraw,
    /// How diameters change along an axis, for boxes.
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SizeDraw {
    /// The middles of equal shares, in random order: as near the distribution as so many grains can be.
    #[default]
    Quantiles,
    /// Each by itself.
    Random,
}

impl SizeDraw {
    /// As the command line spells it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quantiles => "quantiles",
            Self::Random => "random",
        }
    }
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

    /// The option that asks for it, and its value.
    pub(crate) fn setting(&self) -> (&'static str, String) {
        match self {
            Self::Diameters(spec) => ("diameters", spec.text().to_owned()),
            Self::DiameterFile(path) => ("diameters", path.display().to_string()),
            Self::VolumeFile(path) => ("volumes", path.display().to_string()),
        }
    }
}
