//! Crystal orientations, their symmetry, and distributions of them.
//!
//! The crate knows nothing of grains, files or command lines. Where something is drawn, the caller brings the random generator.
//!
//! Conventions are those of Bunge: an [`Orientation`] takes components along the axes of the sample to components along those of the
//! crystal. Angles are in degrees.
//!
//! ```
//! use rand_chacha::ChaCha8Rng;
//! use rand_chacha::rand_core::SeedableRng;
//! use texture::{CrystalSymmetry, Texture};
//!
//! let texture: Texture = "goss(10)*0.3 + random*0.7".parse()?;
//! let volumes = [1.0; 1000];
//! let drawn = texture.draw(&volumes, &mut ChaCha8Rng::seed_from_u64(1))?;
//! assert_eq!(drawn.components.iter().filter(|component| **component == 0).count(), 300);
//!
//! let [a, b] = [drawn.orientations[0], drawn.orientations[1]];
//! assert!(CrystalSymmetry::Octahedral.disorientation(a, b).angle <= 62.8);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod apportionment;
mod beta;
mod component;
mod disorientation;
mod draw;
mod index;
mod inverse_pole_figure;
mod kernel;
mod mackenzie;
mod mean;
mod miller;
mod misorientation;
mod orientation;
mod pole_figure;
mod sample_symmetry;
mod sector;
mod spec;
mod symmetry;
mod texture;

pub use apportionment::Apportionment;
pub use component::Component;
pub use disorientation::Disorientation;
pub use draw::{DrawError, Drawn};
pub use index::texture_index;
pub use inverse_pole_figure::IpfKey;
pub use kernel::{FiberKernel, HalfwidthError, Kernel};
pub use mackenzie::RandomDisorientations;
pub use mean::mean_orientation;
pub use misorientation::{AngleHistogram, HistogramError, Pair};
pub use orientation::Orientation;
pub use pole_figure::{PoleFigure, Projection};
pub use sample_symmetry::SampleSymmetry;
pub use sector::Sector;
pub use spec::{SpecError, ideal_orientations};
pub use symmetry::{CrystalSymmetry, SymmetryError};
pub use texture::Texture;
