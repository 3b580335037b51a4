//! What `grainsmooth measure` reads and says.

pub(crate) mod report;
pub(crate) mod sample;
