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
//! let relaxed = relax(&network, &flat, &Relaxation::default(), |_, _| ())?;
//! let smooth = relaxed.finest_points(&network);
//!
//! let volumes = network.grain_volumes(network.finest(), &smooth);
//! let cells = tessellation.cell_measures();
//! assert!(volumes.iter().zip(&cells).all(|(grain, cell)| (grain / cell.volume - 1.0).abs() < 1e-9));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod angles;
mod boundary;
mod box_cut;
mod box_tree;
mod certificate;
mod closing;
mod contact;
mod control_mesh;
mod error;
mod face_mesh;
mod fan;
mod fans;
mod fault;
mod folds;
mod grain_mesh;
mod grouped;
mod intersections;
mod labelled_mesh;
mod level;
mod measures;
mod network;
mod node_type;
mod orientation;
mod periodic;
mod projection;
mod regular_cells;
mod relax;
mod seams;
mod surface;
mod tension;
mod triangle_quality;
mod validate;
mod volume;
mod wall_set;

pub use angles::{AngleStatistics, WeightedAngle, angles_between_boundaries, dihedral_angles};
pub use boundary::{Boundary, BoundaryId, GrainId, Side, Twin};
pub use box_cut::BoxCut;
pub use certificate::{Certificate, Claims, Faults, certify};
pub use control_mesh::JunctionCounts;
pub use error::{Attempt, NetworkError};
pub use face_mesh::{FaceMesh, MeshSize};
pub use fault::{Fault, Place};
pub use folds::folded_edges;
pub use level::{Level, Mesh};
pub use measures::{
    BoundaryMeasures, GrainMeasures, HerringResidual, Measures, PlaneBoundaryMeasures, PlaneGrainMeasures,
    PlaneMeasures, PointCurvature, QuadruplePointMeasures, SpaceMeasures, TripleLineMeasures,
    TriplePointMeasures, herring_residual, measure, measure_network, point_curvatures, point_dihedral_angles,
};
pub use network::{Junctions, Network};
pub use node_type::NodeType;
pub use orientation::outward_sides;
pub use periodic::PeriodicCopies;
#[doc(hidden)]
pub use regular_cells::regular_cells_tuned;
pub use regular_cells::{RegularCells, regular_cells};
pub use relax::{
    Balance, Moving, NetworkRecipe, Reconnections, Relaxation, RelaxationStep, Relaxed, RelaxedCells,
    Volumes, relax, relax_cells, relax_watched,
};
#[doc(hidden)]
pub use relax::{Tuning, relax_cells_tuned, relax_tuned};
pub use surface::{Elements, Surface};
pub use triangle_quality::TriangleQuality;
pub use validate::validate;
pub use wall_set::{Freedom, WallSet, WallSets};
