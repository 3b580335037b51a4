//! Virtual polycrystals with smooth, watertight grain boundaries.

mod error;
pub mod memory;
mod output;
mod seed_file;
mod seeding;
pub mod vtk;

pub use error::Error;
pub use output::{Output, OutputFormat};
pub use seed_file::{FileSeed, SeedLineProblem, read_seed_file};
pub use seeding::random_seeds;
