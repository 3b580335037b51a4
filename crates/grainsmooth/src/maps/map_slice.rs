//! Layers of a map, to be shown.

use super::label_map::LabelMap;

/// The labels of a layer of voxels, seen along an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct MapSlice {
    /// The axis across the layer; 2 in the plane.
    pub across: usize,
    /// Where the middle of the layer is along that axis.
    pub place: f64,
    /// The axes to the right and upward.
    pub axes: [usize; 2],
    /// Number of voxels along these.
    pub size: [usize; 2],
    /// The lower corner of the first voxel, along these.
    pub lower: [f64; 2],
    /// The edges of a voxel, along these.
    pub spacing: [f64; 2],
    /// As in the map, the first axis fastest.
    pub labels: Vec<i32>,
}

impl LabelMap {
    /// The layers in the middle of the map, across z, y and x; in the plane the map itself.
    pub fn middle_slices(&self) -> Vec<MapSlice> {
        let axes: &[usize] = if self.is_plane() { &[2] } else { &[2, 1, 0] };
        axes.iter().map(|across| self.middle_slice(*across)).collect()
    }

    fn middle_slice(&self, across: usize) -> MapSlice {
        let axes = [[1, 2], [0, 2], [0, 1]][across];
        let [nx, ny, _] = self.shape;
        let steps = [1, nx, nx * ny];
        let layer = self.shape[across] / 2;
        let [right, up] = axes;
        let of_row = |row: usize| {
            let first = layer * steps[across] + row * steps[up];
            (0..self.shape[right]).map(move |column| first + column * steps[right])
        };
        let place = self.origin[across] + (layer as f64 + 0.5) * self.spacing[across];
        MapSlice {
            across,
            place: if self.is_plane() { 0.0 } else { place },
            axes,
            size: axes.map(|axis| self.shape[axis]),
            lower: axes.map(|axis| self.origin[axis]),
            spacing: axes.map(|axis| self.spacing[axis]),
            labels: (0..self.shape[up]).flat_map(of_row).map(|voxel| self.labels[voxel]).collect(),
        }
    }
}
