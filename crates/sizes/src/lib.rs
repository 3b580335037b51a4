//! Distributions of diameters.
//!
//! The crate knows nothing of grains, files or command lines, and draws nothing at random: [`Distribution::quantile`] takes the numbers.
//! Its results are the same bit for bit on every machine.
//!
//! ```
//! use sizes::Spec;
//!
//! let spec: Spec = "0.8*lognormal(mean=20, cv=0.3) + 0.2*normal(mean=60, sd=5), to=90, by=volume".parse()?;
//! let diameters = spec.distribution(3);
//! // A fifth of the volume is in the large ones, so few of a hundred are large.
//! assert!((diameters.cdf(50.0) - 0.988).abs() < 1e-3);
//! assert!((diameters.share_below(50.0, 3) - 0.8).abs() < 1e-2);
//! assert!((diameters.cdf(diameters.quantile(0.25)) - 0.25).abs() < 1e-12);
//! # Ok::<(), sizes::SpecError>(())
//! ```

mod distribution;
mod gamma;
mod law;
mod lognormal_fit;
mod spec;
mod table;

pub use distribution::{CutError, Distribution, Part};
pub use law::Law;
pub use lognormal_fit::LognormalFit;
pub use spec::{Spec, SpecError};
pub use table::{Table, TableError};
