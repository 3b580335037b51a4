use texture::{CrystalSymmetry, Orientation};

use super::LabelGrid;

/// What maps of orientations show: pixels of a 2D grid, each of a grain.
pub(crate) struct OrientationMap<'a> {
    pub(crate) grid: &'a LabelGrid<'a>,
    /// Of each grain.
    pub(crate) orientations: &'a [Orientation],
    /// Index of each grain's phase.
    pub(crate) phase_of: &'a [usize],
    /// The name of each phase and the symmetry of its crystals; files count phases from 1.
    pub(crate) phases: &'a [(String, CrystalSymmetry)],
}
