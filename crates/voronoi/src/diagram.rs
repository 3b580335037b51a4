//! What comes out: the cell complex, its numbers and measures.

pub(crate) mod cell_faces;
pub(crate) mod cell_sum;
pub(crate) mod edges;
pub(crate) mod ids;
pub(crate) mod measures;
pub(crate) mod periodic_vertex;
pub(crate) mod planar_measures;
pub(crate) mod polygon;
pub(crate) mod side;
pub(crate) mod tessellation;
pub(crate) mod torus;
pub(crate) mod united_vertices;
pub(crate) mod whole_cells;
