//! Which cells make up which grain.

use std::sync::Arc;

use crate::diagram::measures::face_area_and_centroid;
use crate::{CellId, Side, Tessellation, Translation};

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

/// Of each cell, one that stands for the piece of its grain that it is in: cells hang together where they stand once they are moved by `moves`, by faces
/// that are no mere necks. Those have an area below `least_neck` faces of a cube (in the plane: sides of a square) as large as the smaller
/// cell.
pub(super) fn pieces_of_cells(
    tessellation: &Tessellation,
    grains: &Grains,
    moves: &[Translation],
    least_neck: f64,
) -> Vec<usize> {
    let mut roots: Vec<usize> = (0..tessellation.cell_count()).collect();
    let dimension = tessellation.domain().dimension();
    let measures = tessellation.cell_measures();
    for face in tessellation.faces() {
        let [Some((a, _)), Some((b, image))] = tessellation.face_sides(face).map(Side::cell) else {
            continue;
        };
        if grains.of(a) != grains.of(b) || moves[b.index()] - moves[a.index()] != image {
            continue;
        }
        let size = measures[a.index()].volume.min(measures[b.index()].volume);
        let least = least_neck * dimension.cube_edge(size).powi(i32::from(dimension.axes()) - 1);
        if face_area_and_centroid(tessellation, face).0 >= least {
            let [a, b] = [a, b].map(|cell| root(&mut roots, cell.index()));
            roots[a.max(b)] = a.min(b);
        }
    }
    (0..roots.len()).map(|cell| root(&mut roots, cell)).collect()
}

/// The root of a cell in a forest of cells.
fn root(roots: &mut [usize], mut cell: usize) -> usize {
    while roots[cell] != cell {
        roots[cell] = roots[roots[cell]];
        cell = roots[cell];
    }
    cell
}
