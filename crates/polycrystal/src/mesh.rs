//! Boundaries between grains as meshes: elements, levels, walls, copies, and what is measured of them alone.

pub(crate) mod adjacency;
pub(crate) mod angles;
pub(crate) mod boundary;
pub(crate) mod boundary_elements;
pub(crate) mod connectivity;
pub(crate) mod disjoint_sets;
pub(crate) mod elements;
pub(crate) mod fold;
pub(crate) mod grouped;
pub(crate) mod id;
pub(crate) mod level;
pub(crate) mod level_points;
pub(crate) mod nearest_point;
pub(crate) mod node_type;
pub(crate) mod periodic;
pub(crate) mod quadratic_triangle;
pub(crate) mod rounding;
pub(crate) mod surface;
pub(crate) mod tetrahedron;
pub(crate) mod triangle_quality;
pub(crate) mod volume;
pub(crate) mod wall_set;
