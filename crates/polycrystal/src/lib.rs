//! The grain-boundary network of a polycrystal: junctions, relaxation, subdivision, measures, validation.
//!
//! A [`Network`] is the connectivity of all grain boundaries on every level of subdivision; positions live beside it as
//! slices of control points. Three steps lead from cells to smooth grains:
//!
//! ```
//! use polycrystal::{Junctions, Network, Relaxation, relax};
//! use voronoi::{Domain, Tessellation};
//! # use glam::DVec3;
//!
//! let seeds = [DVec3::new(0.3, 0.4, 0.5), DVec3::new(0.7, 0.3, 0.2), DVec3::new(0.6, 0.8, 0.9)];
//! let tessellation = Tessellation::new(&Domain::unit_cube(), &seeds)?;
//! let (network, flat) = Network::new(&tessellation, Junctions::Crease, 2)?;
//! let relaxed = relax(&network, &flat, &Relaxation::KEPT_TOPOLOGY, |_, _| ())?;
//! let smooth = relaxed.finest_points(&network);
//!
//! let volumes = network.grain_volumes(network.finest(), &smooth);
//! let cells = tessellation.cell_measures();
//! assert!(volumes.iter().zip(&cells).all(|(grain, cell)| (grain / cell.volume - 1.0).abs() < 1e-9));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arcs;
mod box_cut;
mod check;
mod complex;
mod energy;
mod events;
mod flow;
mod growth;
mod measures;
mod mesh;
mod network;
mod relax;
mod remesh;
mod solver;
mod validate;
mod voxels;

pub use box_cut::BoxCut;
pub use check::certificate::{Certificate, Expected, Faults, certify};
pub use check::fault::{Fault, Place};
pub use check::folds::folded_edges;
pub use check::orientation::outward_sides;
pub use complex::{
    CellComplex, Collapsed, ComplexEdge, OutgoingHalfEdge, Snapshot, Star, remove_edges_that_shorten,
    remove_short_edges,
};
pub use energy::volumes_kept::Volumes;
pub use events::reconnection::Reconnections;
pub use flow::balance::Balance;
pub use flow::recipe::{Certified, NetworkRecipe, RelaxedCells};
pub use flow::relaxation::{Moving, Relaxation, RelaxationStep, Relaxed};
#[doc(hidden)]
pub use flow::tuning::Tuning;
#[doc(hidden)]
pub use growth::grow_cells_tuned;
#[doc(hidden)]
pub use growth::tuning::GrowthTuning;
pub use growth::{GrownCells, GrowthRecipe, Vanished, grow_cells};
pub use measures::{
    BoundaryDistances, BoundaryMeasures, GrainMeasures, HerringResidual, Measures, PlaneBoundaryMeasures,
    PlaneGrainMeasures, PlaneMeasures, PointCurvature, QuadruplePointMeasures, SpaceMeasures,
    TripleLineMeasures, TriplePointMeasures, angles_between_boundaries, angles_between_cells,
    dihedral_angles, herring_residual, measure, measure_network, point_curvatures, point_dihedral_angles,
};
pub use mesh::angles::{AngleStatistics, WeightedAngle};
pub use mesh::boundary::{Boundary, BoundaryId, GrainId, Side, Twin};
pub use mesh::connectivity::Mesh;
pub use mesh::elements::{Corners, Elements};
pub use mesh::level::{Level, LevelView, RefinedLevel};
pub use mesh::node_type::NodeType;
pub use mesh::periodic::PeriodicCopies;
pub use mesh::surface::Surface;
pub use mesh::tetrahedron::tetrahedron_gamma;
pub use mesh::triangle_quality::TriangleQuality;
pub use mesh::wall_set::{Freedom, WallSet, WallSets};
pub use network::Network;
pub use network::control_mesh::JunctionCounts;
pub use network::error::{Attempt, NetworkError};
pub use network::face_mesh::{FaceMesh, MeshSize};
pub use network::grain_complex::GrainPart;
pub use network::junctions::Junctions;
pub use relax::cells::relax_cells;
#[doc(hidden)]
pub use relax::cells::relax_cells_tuned;
pub use relax::fitted_levels::Subdivided;
#[doc(hidden)]
pub use relax::regular_cells::regular_cells_tuned;
pub use relax::regular_cells::{RegularCells, regular_cells};
#[doc(hidden)]
pub use relax::relax_tuned;
pub use relax::{relax, relax_certified, relax_watched};
#[doc(hidden)]
pub use remesh::RemeshTuning;
pub use remesh::narrow_triangles::NarrowTriangles;
pub use remesh::{CurvedBoundaries, ElementSize, MergedLine, PlaneMesh, Remeshed};
pub use validate::validate;
pub use voxels::{SmoothedVoxels, VoxelLabel, VoxelOptions, Voxels, smooth_voxels};
#[doc(hidden)]
pub use voxels::{VoxelTuning, smooth_voxels_tuned};
