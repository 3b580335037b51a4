//! Figures that are reported of a run, and how they are spelled.

pub(crate) mod asked;
pub(crate) mod counted;
pub(crate) mod direction_frame;
pub(crate) mod equivalent_diameters;
pub(crate) mod significant;
pub(crate) mod spread;
pub(crate) mod triangle_angles;
