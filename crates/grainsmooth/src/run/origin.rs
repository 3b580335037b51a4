//! Where grains come from.

use glam::BVec3;
use polycrystal::{AngleStatistics, Collapsed, Relaxed, Vanished, WeightedAngle};

use super::fitted_cells::CellFit;
use super::regularization::{Reconnected, Regularization};
use super::tessellated::Tessellated;
use crate::{Config, FileOptions, GrainAttributes, MapSlice, PointCounts};

/// Where a network comes from.
#[derive(Debug, Clone)]
pub enum Origin {
    /// From cells that a config describes.
    Synthetic(Box<Synthesis>),
    /// From a measured map, or a network that was there.
    Measured(Box<Measurement>),
}

/// How a network came from cells.
#[derive(Debug, Clone)]
pub struct Synthesis {
    /// What was asked for.
    pub config: Config,
    /// The flat cells that the grains come from.
    pub cells: Tessellated,
    /// What relaxation gave, before the last subdivisions: points to move by hand, of whole grains.
    pub relaxed: Relaxed,
    /// How far the cells were regularised.
    pub regularization: Regularization,
    /// What regularisation took out, or was drawn together where the topology changed.
    pub collapsed: Collapsed,
    /// How relaxation changed the topology; nothing where that stayed.
    pub reconnected: Option<Reconnected>,
    /// The grains that vanished while grains grew. Others keep their numbers.
    pub vanished: Vec<Vanished>,
    /// Angles between boundaries of the flat network, before relaxation.
    pub flat_angles: Vec<WeightedAngle>,
    /// Their statistics, if boundaries meet inside the domain.
    pub angles_before: Option<AngleStatistics>,
}

/// How a network came from what was measured.
#[derive(Debug, Clone)]
pub struct Measurement {
    /// The command that made it.
    pub command_line: String,
    /// How files of it are written.
    pub file: FileOptions,
    /// What is known of each grain.
    pub grains: GrainAttributes,
    /// The map that it was smoothed from; nothing where the network itself was given.
    pub map: Option<SmoothedMap>,
    /// The axes along which the network repeats, and is cut at its box.
    pub cut: BVec3,
}

/// A map, and what was changed of it.
#[derive(Debug, Clone)]
pub struct SmoothedMap {
    /// Number of voxels along each axis.
    pub shape: [usize; 3],
    /// Grains that were too small, and their voxels, which went to neighbours.
    pub dropped: [u64; 2],
    /// How points became grains, where the map is one of orientations.
    pub points: Option<PointCounts>,
    /// Number of voxels that got another label, because a grain touched itself there.
    pub relabelled: usize,
    /// Layers in the middle of the map, as it was smoothed.
    pub slices: Vec<MapSlice>,
    /// How cells agree with the map, where they were fitted to it.
    pub fit: Option<CellFit>,
}
