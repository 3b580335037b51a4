//! The cells that make up grains.

use std::collections::BTreeSet;

use polycrystal::{GrainId, GrainPart};
use voronoi::{CellId, Side, Tessellation, Translation};

/// The grain that each cell is part of, where grains are of several cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GrainCells {
    parts: Vec<GrainPart>,
    count: usize,
}

impl GrainCells {
    /// So many grains, by the number of each cell's and by how much the cell has to be moved to stand with it.
    pub(crate) fn new(of_cell: &[u32], moves: &[Translation], count: usize) -> Self {
        let part = |(grain, moved): (&u32, &Translation)| GrainPart { grain: GrainId(*grain), moved: *moved };
        Self { parts: of_cell.iter().zip(moves).map(part).collect(), count }
    }

    /// The grain that each cell is part of.
    pub fn parts(&self) -> &[GrainPart] {
        &self.parts
    }

    /// The grain of a cell.
    pub(crate) fn grain(&self, cell: CellId) -> GrainId {
        self.parts[cell.index()].grain
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
        self.parts.iter().zip(of_cells).for_each(|(part, value)| sums[part.grain.index()] += value);
        sums
    }

    /// Number of faces of each grain: two grains that touch in several places have as many in the network, and one here.
    pub(crate) fn face_counts(&self, tessellation: &Tessellation) -> Vec<usize> {
        let mut beside: Vec<BTreeSet<Side>> = vec![BTreeSet::new(); self.count];
        for face in tessellation.faces() {
            let sides = tessellation.face_sides(face);
            let [first, second] = sides.map(|side| GrainPart::beside(&self.parts, side));
            if first == second {
                continue;
            }
            for (own, other) in [(first, second), (second, first)] {
                let Some((grain, translation)) = own.cell() else { continue };
                beside[grain.index()].insert(other.moved(Translation::ZERO - translation));
            }
        }
        beside.iter().map(BTreeSet::len).collect()
    }
}
