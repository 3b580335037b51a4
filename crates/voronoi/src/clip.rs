//! Cells. In space each edge is followed from one end to the other (`edge_tracing`), from a first vertex (`first_vertex`) on, which a cell cut plane by plane finds
//! (`convex_cell`). In the plane only cells at walls are cut, edge by edge (`convex_polygon`).

pub(crate) mod clipping;
pub(crate) mod convex_cell;
pub(crate) mod convex_polygon;
pub(crate) mod edge_tracing;
pub(crate) mod first_vertex;
pub(crate) mod vertices;
