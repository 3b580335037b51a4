//! The grid that the numbers of an array stand on.

use glam::DVec3;

use super::file::{Hdf5, parent, within};
use crate::error::map_file::MapProblem;

/// What a file tells of a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Geometry {
    /// Number of voxels along each axis, where that is told beside the array.
    pub(super) shape: Option<[usize; 3]>,
    pub(super) spacing: DVec3,
    /// The lower corner of the first voxel.
    pub(super) origin: DVec3,
}

impl Geometry {
    /// The grid of an array: that of the nearest group around it that tells of one.
    ///
    /// # Errors
    /// [`MapProblem::Damaged`] where numbers cannot be read.
    pub(super) fn of(file: &Hdf5, array: &str) -> Result<Option<Self>, MapProblem> {
        let mut group = parent(array);
        loop {
            let found = match Self::of_simplnx(file, group) {
                None => match Self::of_dream3d(file, group)? {
                    None => Self::of_lab_dct(file, group)?,
                    found => found,
                },
                found => found,
            };
            if found.is_some() || group.is_empty() {
                return Ok(found);
            }
            group = parent(group);
        }
    }

    /// DREAM3D-NX: attributes of the geometry's group.
    fn of_simplnx(file: &Hdf5, group: &str) -> Option<Self> {
        let vector = |name: &str| file.attribute(group, name).and_then(three);
        let counts = vector("_DIMENSIONS")?;
        let spacing = vector("_SPACING").unwrap_or(DVec3::ONE);
        Some(Self { shape: shape(counts), spacing, origin: vector("_ORIGIN").unwrap_or(DVec3::ZERO) })
    }

    /// DREAM.3D 6: arrays in a group of the container.
    fn of_dream3d(file: &Hdf5, group: &str) -> Result<Option<Self>, MapProblem> {
        let group = within(group, "_SIMPL_GEOMETRY");
        let vector = |name: &str| Ok(file.numbers(&within(&group, name))?.and_then(three));
        let Some(counts) = vector("DIMENSIONS")? else { return Ok(None) };
        // Until 6.3 by another name.
        let spacing = vector("SPACING")?.or(vector("RESOLUTION")?).unwrap_or(DVec3::ONE);
        let origin = vector("ORIGIN")?.unwrap_or(DVec3::ZERO);
        Ok(Some(Self { shape: shape(counts), spacing, origin }))
    }

    /// LabDCT: the size of voxels and the middle of the map.
    fn of_lab_dct(file: &Hdf5, group: &str) -> Result<Option<Self>, MapProblem> {
        let vector = |name: &str| Ok::<_, MapProblem>(file.numbers(&within(group, name))?.and_then(three));
        let Some(spacing) = vector("Spacing")? else { return Ok(None) };
        let extent = vector("Extent")?.unwrap_or(DVec3::ZERO);
        let origin = vector("Center")?.unwrap_or(DVec3::ZERO) - 0.5 * extent;
        Ok(Some(Self { shape: None, spacing, origin }))
    }
}

fn three(numbers: Vec<f64>) -> Option<DVec3> {
    Some(DVec3::from_array(numbers.try_into().ok()?))
}

fn shape(counts: DVec3) -> Option<[usize; 3]> {
    let is_count = |count: f64| count.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&count);
    // Checked to fit.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    counts.to_array().into_iter().all(is_count).then(|| counts.to_array().map(|count| count as usize))
}
