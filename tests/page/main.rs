//! `grainsmooth view` and `grainsmooth edit`, as a browser and as those who should not be there meet them.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod browser;
mod edit;
mod grains;
#[path = "../common/programs.rs"]
mod programs;
mod refusals;
#[allow(dead_code, reason = "the bench uses the rest")]
mod served;
