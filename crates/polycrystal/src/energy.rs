//! The area that boundaries have by their tension, and how it changes with the points.

pub(crate) mod fans;
pub(crate) mod local_elements;
pub(crate) mod local_size;
pub(crate) mod patch;
pub(crate) mod patches;
pub(crate) mod shape;
pub(crate) mod sides;
pub(crate) mod stencils;
pub(crate) mod triangle;
pub(crate) mod unit;
pub(crate) mod volumes_kept;
