//! How files are written, apart from their formats.

use std::num::NonZeroU32;

use clap::Args;
use serde::Serialize;
use voronoi::Dimension;

use super::spelling::{as_true, is_usual};
use super::volume_mesh::VolumeMeshOptions;
use crate::names::Names;
use crate::vtk::VtkEncoding;

/// How files are written, apart from their formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Args, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct FileOptions {
    /// Name and number the arrays as another program expects
    ///
    /// Example: --names dream3d
    #[arg(long, value_name = "TOOL", value_enum, default_value_t)]
    pub names: Names,

    /// Number of voxels along each axis, for formats of voxels; the third is not used in 2D.
    #[arg(skip)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub voxels: Option<[NonZeroU32; 3]>,

    /// How STL spells its numbers.
    #[arg(skip)]
    #[serde(rename = "ascii", skip_serializing_if = "is_usual", serialize_with = "as_true")]
    pub stl: StlEncoding,

    /// Add measured quantities to VTK files as arrays: curvatures, dihedral angles, areas, volumes, growth rates
    ///
    /// Example: --arrays -o grains.vtm
    #[arg(long)]
    #[serde(skip_serializing_if = "is_usual")]
    pub arrays: bool,

    /// How VTK's XML files hold their numbers.
    #[arg(skip)]
    #[serde(rename = "vtk-encoding", skip_serializing_if = "is_usual")]
    pub encoding: VtkEncoding,

    /// The tetrahedra that fill grains.
    #[command(flatten)]
    #[serde(flatten)]
    pub volume: VolumeMeshOptions,
}

impl FileOptions {
    /// Number of voxels that are asked for; 0 where none are.
    pub fn voxel_count(&self, dimension: Dimension) -> u128 {
        let axes = usize::from(dimension.axes());
        let counts = self.voxels.iter().flat_map(|counts| &counts[..axes]);
        counts.map(|count| u128::from(count.get())).reduce(|all, count| all * count).unwrap_or(0)
    }
}

/// How an STL file spells its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum StlEncoding {
    /// 50 bytes for each triangle.
    #[default]
    Binary,
    /// Text.
    Ascii,
}
