//! Orientations as users of the library meet them.

#[path = "../common/mod.rs"]
mod common;
mod distributions;
mod misorientations;
mod reference;
mod specs;
