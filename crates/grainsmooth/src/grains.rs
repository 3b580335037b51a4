//! What each grain is to be, and became: sizes, phases, shapes, orientations, parts, and the law of its boundaries.

pub(crate) mod assigned;
pub(crate) mod attributes;
pub(crate) mod boundary_law;
pub(crate) mod cells;
pub(crate) mod gradient;
pub(crate) mod inner;
pub(crate) mod phases;
pub(crate) mod placed;
pub(crate) mod quantiles;
pub(crate) mod shapes;
pub(crate) mod sizes;
pub(crate) mod texture;
pub(crate) mod wanted_shapes;
pub(crate) mod wanted_sizes;
pub(crate) mod wanted_textures;
