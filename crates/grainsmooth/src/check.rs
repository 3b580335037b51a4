//! What `grainsmooth check` says.

pub(crate) mod report;
