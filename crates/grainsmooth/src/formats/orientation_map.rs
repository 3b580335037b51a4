use std::io;

use texture::{CrystalSymmetry, Orientation};

use super::label_grid::LabelGrid;
use crate::Polycrystal;

/// What maps of orientations show: pixels of a 2D grid, each of a grain.
pub(super) struct OrientationMap<'a> {
    pub(super) grid: &'a LabelGrid<'a>,
    /// Of each grain.
    pub(super) orientations: &'a [Orientation],
    /// Index of each grain's phase.
    pub(super) phase_of: &'a [usize],
    /// The name of each phase and the symmetry of its crystals; files count phases from 1.
    pub(super) phases: &'a [(String, CrystalSymmetry)],
}

impl OrientationMap<'_> {
    /// What is done with the map of a polycrystal.
    pub(super) fn of(
        polycrystal: &Polycrystal,
        write: impl FnOnce(&OrientationMap<'_>) -> io::Result<()>,
    ) -> io::Result<()> {
        write(&OrientationMap {
            grid: &polycrystal.label_grid()?,
            orientations: &polycrystal.orientations().map_err(io::Error::other)?,
            phase_of: &polycrystal.grains().phase_of(),
            phases: &polycrystal.grains().named_symmetries(),
        })
    }
}
