//! Which cells make up which grain.

use std::sync::Arc;

use crate::CellId;

/// The grains that cells make up.
#[derive(Debug, PartialEq)]
pub(crate) struct Grains {
    /// Of each cell.
    of_cell: Vec<u32>,
    count: usize,
}

impl Grains {
    /// Each cell is a grain.
    pub(crate) fn of_single_cells(count: usize) -> Arc<Self> {
        // There are no more cells than ids; what is made of more is refused where seeds are looked at.
        Arc::new(Self { of_cell: (0u32..).take(count).collect(), count })
    }

    /// Grains of several cells, by the grain of each.
    pub(crate) fn of_cells(of_cell: Vec<u32>, count: usize) -> Arc<Self> {
        Arc::new(Self { of_cell, count })
    }

    /// The number of grains.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The grain of a cell.
    pub(crate) fn of(&self, cell: CellId) -> u32 {
        self.of_cell[cell.index()]
    }

    /// The grain of each cell.
    pub(crate) fn of_each_cell(&self) -> &[u32] {
        &self.of_cell
    }

    /// The sums over the cells of each grain.
    pub(crate) fn sums(&self, of_cells: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut sums = vec![0.0; self.count];
        self.of_cell.iter().zip(of_cells).for_each(|(grain, value)| sums[*grain as usize] += value);
        sums
    }

    /// Weights of cells, each with what its grain adds.
    pub(crate) fn shifted(&self, weights: &[f64], shift: impl Fn(usize) -> f64) -> Vec<f64> {
        let cells = weights.iter().zip(&self.of_cell);
        cells.map(|(weight, grain)| weight + shift(*grain as usize)).collect()
    }
}
