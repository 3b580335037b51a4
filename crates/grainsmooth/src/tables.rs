//! Tables of cells and of what is measured, for other programs.

pub(crate) mod cell_table;
pub(crate) mod statistics;
pub(crate) mod table;
