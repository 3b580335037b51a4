//! Voxels as hexahedra, in the plane as squares, whose corners are nodes.

use voronoi::Dimension;

use glam::DVec3;

use super::label_grid::LabelGrid;

/// The voxels of a grid that are in grains. Voxels outside the domain, and nodes that no voxel has, are left out: numbers are as of the whole grid.
pub(super) struct Hexahedra<'a> {
    grid: &'a LabelGrid<'a>,
    pub(super) dimension: Dimension,
    /// Of each voxel; nothing outside the domain.
    pub(super) grains: Vec<Option<u32>>,
}

impl<'a> Hexahedra<'a> {
    pub(super) fn new(grid: &'a LabelGrid<'a>, dimension: Dimension) -> Self {
        let grains = grid.labels().into_iter().map(|label| label.grain().map(|grain| grain.0)).collect();
        Self { grid, dimension, grains }
    }

    fn is_plane(&self) -> bool {
        self.dimension == Dimension::Two
    }

    /// Number of nodes along each axis.
    fn node_counts(&self) -> [usize; 3] {
        let [x, y, z] = self.grid.size;
        [x + 1, y + 1, if self.is_plane() { 1 } else { z + 1 }]
    }

    /// Number of voxels along an axis.
    pub(super) fn voxels_along(&self, axis: usize) -> usize {
        self.grid.size[axis]
    }

    /// The voxels in grains.
    pub(super) fn voxels(&self) -> impl Iterator<Item = usize> + Clone + '_ {
        (0..self.grains.len()).filter(|voxel| self.grains[*voxel].is_some())
    }

    /// The nodes of a voxel, in the order of Abaqus and VTK: counter-clockwise seen from above, the lower ones first.
    pub(super) fn nodes_of(&self, voxel: usize) -> Vec<usize> {
        let [nx, ny, _] = self.grid.size;
        let [i, j, k] = [voxel % nx, voxel / nx % ny, voxel / (nx * ny)];
        let [x, y, _] = self.node_counts();
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
        let layers = if self.is_plane() { 0..=0 } else { 0..=1 };
        let node = |k: usize, [di, dj]: [usize; 2]| i + di + x * (j + dj + y * k);
        layers.flat_map(|dk| corners.map(|corner| node(k + dk, corner))).collect()
    }

    /// The nodes of voxels in grains.
    pub(super) fn nodes(&self) -> Vec<usize> {
        let mut is_used = vec![false; self.node_counts().iter().product()];
        self.voxels().flat_map(|voxel| self.nodes_of(voxel)).for_each(|node| is_used[node] = true);
        (0..is_used.len()).filter(|node| is_used[*node]).collect()
    }

    /// The steps of a node along each axis.
    pub(super) fn steps(&self, node: usize) -> [usize; 3] {
        let [x, y, _] = self.node_counts();
        [node % x, node / x % y, node / (x * y)]
    }

    /// Where a node is.
    pub(super) fn place(&self, node: usize) -> DVec3 {
        let steps = DVec3::from_array(self.steps(node).map(|step| step as f64));
        let place = self.grid.origin + steps * self.grid.spacing;
        if self.is_plane() { place.with_z(0.0) } else { place }
    }
}
