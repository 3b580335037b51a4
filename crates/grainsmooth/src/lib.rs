//! Virtual polycrystals with smooth, watertight grain boundaries.

mod error;
mod output;
pub mod vtk;

pub use error::Error;
pub use output::{Output, OutputFormat};
