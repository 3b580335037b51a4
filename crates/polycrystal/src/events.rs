//! Where the topology of cells changes.

pub(crate) mod event;
pub(crate) mod local_area;
pub(crate) mod merged_lines;
pub(crate) mod reconnection;
