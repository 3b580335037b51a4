//! Where seeds stand, and what they fill.

pub(crate) mod count;
pub(crate) mod domain;
pub(crate) mod lattice;
pub(crate) mod poisson_disc;
pub(crate) mod random;
