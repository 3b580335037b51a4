//! Arrays of points, faces and grains on their way through a command: which keep a meaning.

use subzero::StencilTable;

use super::file::MeshFile;
use crate::names::{GENERATION, VOLUMES};
use crate::vtk::{DataArray, DataNumbers};

/// Unit normals of points or faces, which change with them.
pub(super) const NORMALS: &str = "Normals";

/// What is measured of a surface and of the grains in it (`grainsmooth --arrays`, `Volumes`), and is no longer true of another shape.
const OF_SHAPE: [&str; 13] = [
    VOLUMES,
    "MeanCurvature",
    "GaussianCurvature",
    "SmallestDihedralAngle",
    "LargestDihedralAngle",
    "BoundaryArea",
    "BoundaryLength",
    "BoundaryMeanCurvature",
    "GrainVolumes",
    "GrainAreas",
    "GrainGrowthRates",
    "Area",
    "Length",
];

/// Whether an array of this name is measured of a shape.
pub(super) fn is_of_shape(name: &str) -> bool {
    OF_SHAPE.contains(&name)
}

/// The array at the points that stencils make: means, where numbers have them.
pub(super) fn averaged(array: &DataArray, stencils: &StencilTable) -> Option<DataArray> {
    let DataNumbers::Float64(numbers) = &array.numbers else { return None };
    let width = array.components;
    let columns: Vec<Vec<f64>> = (0..width)
        .map(|column| {
            stencils.apply(&numbers.iter().skip(column).step_by(width).copied().collect::<Vec<_>>())
        })
        .collect();
    let count = columns.first().map_or(0, Vec::len);
    let numbers = (0..count).flat_map(|row| columns.iter().map(move |column| column[row])).collect();
    Some(DataArray { numbers: DataNumbers::Float64(numbers), ..array.clone() })
}

/// Adds tuples for new points, each the mean of two before it; whether that is possible.
pub(super) fn extend_by_means(array: &mut DataArray, pairs: &[[u32; 2]]) -> bool {
    let DataNumbers::Float64(numbers) = &mut array.numbers else { return false };
    for pair in pairs {
        for component in 0..array.components {
            let [a, b] = pair.map(|point| numbers[point as usize * array.components + component]);
            numbers.push(0.5 * a + 0.5 * b);
        }
    }
    true
}

impl MeshFile {
    /// Leaves out what is measured of the shape, which changes, and normals.
    pub(crate) fn drop_data_of_shape(&mut self) {
        for arrays in [&mut self.point_data, &mut self.face_data, &mut self.line_data] {
            arrays.retain(|array| !is_of_shape(&array.name));
        }
        self.field.retain(|entry| !is_of_shape(entry.name));
        self.drop_normals();
    }

    /// The level of subdivision at which each point was born, where the file tells.
    pub(crate) fn generations(&self) -> Option<Vec<i8>> {
        self.point_data.iter().find_map(|array| match &array.numbers {
            DataNumbers::Int8(levels) if array.name == GENERATION && array.components == 1 => {
                Some(levels.clone())
            }
            _ => None,
        })
    }

    /// Leaves normals out.
    pub(super) fn drop_normals(&mut self) {
        for arrays in [&mut self.point_data, &mut self.face_data] {
            arrays.retain(|array| array.name != NORMALS);
        }
    }

    /// The names of all arrays and entries.
    pub fn data_names(&self) -> Vec<String> {
        let arrays = self.point_data.iter().chain(&self.face_data).chain(&self.line_data);
        let names = arrays.map(|array| array.name.clone());
        let mut names: Vec<String> =
            names.chain(self.field.iter().map(|entry| entry.name.to_owned())).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Why an array of this file is not in what was made of it.
    pub fn why_dropped(&self, name: &str) -> &'static str {
        if self.left_behind.iter().any(|left| left == name) {
            "not numbers, or not a tuple for each"
        } else if is_of_shape(name) {
            "the shape changes"
        } else if name == NORMALS {
            "they change"
        } else if self.point_data.iter().any(|array| array.name == name) {
            "whole numbers have no means at new points"
        } else {
            "new faces come from several"
        }
    }
}
