//! Planes of cells, and exact decisions among them.

pub(crate) mod accurate_sum;
pub(crate) mod big_integer;
pub(crate) mod face_end;
pub(crate) mod fixed_width;
pub(crate) mod frame;
pub(crate) mod generator;
pub(crate) mod half_space;
pub(crate) mod image;
pub(crate) mod input;
pub(crate) mod plane;
pub(crate) mod predicate;
pub(crate) mod translation;
pub(crate) mod wall;
