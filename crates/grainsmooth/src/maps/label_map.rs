//! Labels of grains on a grid, as a file tells them and as they are used.

use glam::DVec3;

/// Labels of voxels, x fastest; in the plane of pixels, whose grid has one layer.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelMap {
    /// Number of voxels along each axis.
    pub shape: [usize; 3],
    /// Edges of a voxel.
    pub spacing: DVec3,
    /// The lower corner of the first voxel.
    pub origin: DVec3,
    /// The label of each voxel: as many as there are voxels.
    pub labels: Vec<i32>,
}

impl LabelMap {
    /// Whether the map is one of pixels.
    pub fn is_plane(&self) -> bool {
        self.shape[2] == 1
    }
}

/// What a file tells of a map. Labels stand x fastest; without spacing or origin the file tells none.
pub(super) struct FileMap {
    pub(super) shape: [usize; 3],
    pub(super) spacing: Option<DVec3>,
    pub(super) origin: Option<DVec3>,
    pub(super) labels: Vec<i32>,
}

/// What is known of measured grains.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredMap {
    /// The labels as cleaned: below 0 what is no grain, others from 0 on, with none left out.
    pub map: LabelMap,
    /// The label in the file of each grain.
    pub labels: Vec<u32>,
    /// Grains with fewer voxels than are asked for, which went to others, and their voxels.
    pub dropped: [u64; 2],
}
