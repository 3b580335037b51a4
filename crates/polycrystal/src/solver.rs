//! Sparse matrices, and linear systems with them. Nothing here knows of grains.

pub(crate) mod chebyshev;
pub(crate) mod conjugate_gradients;
pub(crate) mod dissection;
pub(crate) mod factors;
pub(crate) mod least_motion;
pub(crate) mod multigrid;
pub(crate) mod rows;
