//! The `grainsmooth` program.
fn main() {}
