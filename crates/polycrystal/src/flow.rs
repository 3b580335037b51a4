//! Steps toward less energy: one system for the points of a level and for the fans of cells.

pub(crate) mod adaptive_steps;
pub(crate) mod assembly;
pub(crate) mod balance;
pub(crate) mod boundary_flow;
pub(crate) mod dihedral_sectors;
pub(crate) mod fan_flow;
pub(crate) mod giving_way;
pub(crate) mod growth_law;
pub(crate) mod pressure_response;
pub(crate) mod recipe;
pub(crate) mod relaxation;
pub(crate) mod settling;
pub(crate) mod system;
pub(crate) mod tangential;
pub(crate) mod thin_triangles;
pub(crate) mod tied_points;
pub(crate) mod tuning;
pub(crate) mod volume_constraint;
