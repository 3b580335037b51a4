//! Cells, cut plane by plane or along their edges.

pub(crate) mod convex_cell;
pub(crate) mod convex_polygon;
pub(crate) mod cutting;
pub(crate) mod end_search;
pub(crate) mod first_vertex;
pub(crate) mod vertices;
