//! What `grainsmooth check` says.

pub(crate) mod report;
pub(crate) mod volume;
