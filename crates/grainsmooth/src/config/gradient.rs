//! Where diameters that change along an axis are told.

use std::path::PathBuf;

/// Where diameters that change along an axis are told.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GradientSource {
    /// 0 for x, 1 for y, 2 for z.
    pub axis: usize,
    /// The file of a table: positions along the axis, and what diameters are multiplied by there.
    pub path: PathBuf,
}

impl GradientSource {
    /// As it is given: `z:FILE`.
    pub(crate) fn text(&self) -> String {
        format!("{}:{}", ["x", "y", "z"][self.axis], self.path.display())
    }
}
