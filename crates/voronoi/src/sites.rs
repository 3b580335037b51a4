//! Seeds, their images and their weights, and what of them is near.

pub(crate) mod bisectors;
pub(crate) mod candidates;
pub(crate) mod columns;
pub(crate) mod deepest;
pub(crate) mod grid;
pub(crate) mod near;
pub(crate) mod planes;
pub(crate) mod search;
pub(crate) mod site_tree;
