//! Short-edge removal: edges that are too short to be told from points, or shorter than is wanted, become vertices.

pub(crate) mod regularize;
mod resolution;
mod ring;
