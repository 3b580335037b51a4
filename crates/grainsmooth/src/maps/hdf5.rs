//! Maps in HDF5: of DREAM.3D and DREAM3D-NX, of LabDCT, and orientations of Oxford, EDAX and Bruker; and the surface meshes of DREAM.3D.

mod dream3d_points;
mod file;
mod geometry;
mod labels;
mod points;
mod triangles;

use super::label_map::MapContent;
use super::options::MapOptions;
use super::stored_numbers::Source;
use crate::error::map_file::MapProblem;
use crate::mesh::file::vtk::labelled::LabelledCells;
pub(crate) use dream3d_points::laue_group_number;
use file::Hdf5;

/// Reads labels, where the file has an array of them, else orientations.
///
/// # Errors
/// [`MapProblem`] where the file is damaged, or holds neither.
pub(super) fn read(source: &Source<'_>, options: &MapOptions) -> Result<MapContent, MapProblem> {
    let file = Hdf5::open(source.bytes)?;
    if options.label_array.is_none() && !labels::are_in(&file) {
        if let Some(found) = points::read(&file)? {
            return Ok(MapContent::Points(found));
        }
        if let Some(found) = dream3d_points::read(&file)? {
            return Ok(MapContent::Points(found));
        }
    }
    labels::read(&file, options).map(MapContent::Labels)
}

/// Reads boundaries of triangles with two labels each; nothing where the file has none.
///
/// # Errors
/// [`MapProblem::Damaged`].
pub(crate) fn read_triangles(bytes: &[u8]) -> Result<Option<LabelledCells>, MapProblem> {
    triangles::read(&Hdf5::open(bytes)?)
}

/// Whether a file has such boundaries, and no labels of voxels.
pub(crate) fn is_network(bytes: &[u8]) -> bool {
    Hdf5::open(bytes).is_ok_and(|file| triangles::are_in(&file) && !labels::are_in(&file))
}
