//! The page of `view` and `edit`: a server for one user's browser. Geometry stays here; the page draws, and asks.

mod answer;
mod assets;
mod document;
mod edit;
mod grains;
mod guard;
mod packed;
mod refusal;
mod server;

pub(crate) use assets::{PAGE_STYLE, THREE, report_scripts};
pub use document::{EditContent, PageDocument};
pub(crate) use grains::{Column, ShownNetwork, Values, columns_of_shape, network_alone};
pub use server::{PageLinks, PageServer, PageStop};
