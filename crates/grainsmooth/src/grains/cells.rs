//! The cells that make up grains.

use polycrystal::GrainId;
use voronoi::{Side, Tessellation};

/// The grain of each cell, where grains are of several cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GrainCells {
    of_cell: Vec<GrainId>,
    count: usize,
}

impl GrainCells {
    /// So many grains, by the number of each cell's.
    pub(crate) fn new(of_cell: &[u32], count: usize) -> Self {
        Self { of_cell: of_cell.iter().copied().map(GrainId).collect(), count }
    }

    /// The grain of each cell.
    pub fn of_cell(&self) -> &[GrainId] {
        &self.of_cell
    }

    /// Number of grains.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The sums over the cells of each grain.
    pub(crate) fn sums<T: Copy + Default + std::ops::AddAssign>(
        &self,
        of_cells: impl Iterator<Item = T>,
    ) -> Vec<T> {
        let mut sums = vec![T::default(); self.count];
        self.of_cell.iter().zip(of_cells).for_each(|(grain, value)| sums[grain.index()] += value);
        sums
    }

    /// Number of faces of each grain: two grains that touch in several places have as many in the network, and one here.
    pub(crate) fn face_counts(&self, tessellation: &Tessellation) -> Vec<usize> {
        let mut pairs = Vec::new();
        for face in tessellation.faces() {
            let sides = tessellation.face_sides(face).map(|side| match side {
                Side::Cell(cell) => Ok(self.of_cell[cell.index()]),
                other => Err(other),
            });
            if sides[0] != sides[1] {
                pairs.extend([sides, [sides[1], sides[0]]]);
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut counts = vec![0; self.count];
        pairs.iter().filter_map(|[side, _]| side.ok()).for_each(|grain| counts[grain.index()] += 1);
        counts
    }
}
