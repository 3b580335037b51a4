//! Grains of orientation maps.

pub(super) mod grains;
mod grid;
mod segmentation;
mod stack;
