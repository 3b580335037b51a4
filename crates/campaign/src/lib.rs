//! Random runs of the `grainsmooth` program, each certified.
//!
//! A campaign draws command lines and input files in sensible and in nasty ranges, runs the program on each in a directory of its
//! own, and judges what it left: a result that `grainsmooth check` certifies and whose volumes are those of the cells, or a
//! refusal of one line that names the reason, with nothing left behind. Run `index` of a campaign follows from its seed and
//! the index alone.

mod case;
mod certify;
mod domain;
mod draw;
mod drawn_case;
mod drawn_map;
mod elements;
mod map;
mod mistake;
mod options;
mod outputs;
mod process;
mod record;
mod refusals;
mod run;
mod seeds;

pub use case::{AngleClass, Case, Limits, MapPromise};
pub use domain::Domain;
pub use draw::Draw;
pub use map::npy;
pub use options::Options;
pub use outputs::Promise;
pub use process::MOST_SECONDS;
pub use record::{Outcome, Record, Summary};
pub use refusals::{REFUSALS, refusal, without_numbers};
pub use run::{Slice, Subject, run_slice};
