//! What goes with a level of subdivision of a file's arrays.

use super::data::{NORMALS, is_of_shape};
use super::file::MeshFile;
use super::subdivide::Level;
use crate::names::GENERATION;
use crate::vtk::{DataArray, FieldEntry};

/// What goes with a level: the arrays of its points and cells, and what is said of all.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CarriedData {
    /// Arrays of points.
    pub of_points: Vec<DataArray>,
    /// Arrays of cells.
    pub of_cells: Vec<DataArray>,
    /// What is said of the file.
    pub field: Vec<FieldEntry>,
}

impl CarriedData {
    /// The data of a level of a file, whose cells have `arrays`, without what another shape makes untrue if the shape changes.
    pub fn new(file: &MeshFile, level: &Level, arrays: &[DataArray], shape_changes: bool) -> Self {
        let stays = |name: &str| name != NORMALS && !(shape_changes && is_of_shape(name));
        let of_cells = level.cell_of.as_ref().map_or_else(Vec::new, |cells| {
            let kept = arrays.iter().filter(|array| stays(&array.name));
            kept.map(|array| array.at(cells.iter().map(|cell| *cell as usize))).collect()
        });
        Self {
            of_points: level.point_data.iter().filter(|array| stays(&array.name)).cloned().collect(),
            of_cells,
            field: file.field.iter().filter(|entry| stays(entry.name)).cloned().collect(),
        }
    }

    /// The names of all that is written with it.
    pub fn names(&self, has_normals: bool) -> Vec<String> {
        let arrays = self.of_points.iter().chain(&self.of_cells).map(|array| array.name.clone());
        let names = arrays.chain(self.field.iter().map(|entry| entry.name.to_owned()));
        names.chain([GENERATION.to_owned()]).chain(has_normals.then(|| NORMALS.to_owned())).collect()
    }
}
