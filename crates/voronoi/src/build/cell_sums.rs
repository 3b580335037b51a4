//! Sums over the faces of cells, gathered from tiles.

use glam::DVec3;
use rayon::prelude::*;

use crate::build::tile::Tile;
use crate::diagram::cell_sum::{CellSum, KeptMeasures};

/// What the faces of every cell add up to, gathered from tiles.
pub(crate) struct CellSums {
    sums: Vec<CellSum>,
    /// What tiles add to cells of others.
    beyond: Vec<(u32, CellSum)>,
}

impl CellSums {
    pub(crate) fn new(cell_count: usize) -> Self {
        Self { sums: Vec::with_capacity(cell_count), beyond: Vec::new() }
    }

    /// Adds the next tile.
    pub(crate) fn push_tile(&mut self, tile: &Tile) {
        self.sums.extend_from_slice(&tile.sums);
        self.beyond.extend_from_slice(&tile.sums_beyond);
    }

    /// The sums of all cells.
    pub(crate) fn whole(mut self) -> Vec<CellSum> {
        for (seed, sum) in &self.beyond {
            self.sums[*seed as usize].add(sum);
        }
        self.sums
    }
}

/// The measures of the cells of all seeds, of which the indices in the order of the sums are given.
pub(crate) fn measures(sums: &[CellSum], indices: &[u32], seeds: &[DVec3]) -> KeptMeasures {
    let measure = |(index, seed): (&u32, &DVec3)| sums[*index as usize].measure(*seed);
    KeptMeasures(Some(indices.par_iter().zip(seeds).map(measure).collect()))
}
