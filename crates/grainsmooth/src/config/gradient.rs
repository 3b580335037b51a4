//! Where diameters that change along an axis are told.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// Where diameters that change along an axis are told.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GradientSource {
    /// 0 for x, 1 for y, 2 for z.
    pub axis: usize,
    /// The file of a table: positions along the axis, and what diameters are multiplied by there.
    pub path: PathBuf,
}

/// The names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];

/// As it is given: `z:FILE`.
impl fmt::Display for GradientSource {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}:{}", AXES[self.axis], self.path.display())
    }
}

impl FromStr for GradientSource {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, &'static str> {
        let (axis, path) = text.split_once(':').unwrap_or((text, ""));
        match AXES.iter().position(|name| *name == axis) {
            Some(axis) if !path.is_empty() => Ok(Self { axis, path: path.into() }),
            _ => Err("give an axis and a file, such as z:factors.csv"),
        }
    }
}
