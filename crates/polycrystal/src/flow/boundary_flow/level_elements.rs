//! How the elements of a level meet.

use cancellation::check_cancelled;
use glam::DVec3;

use crate::check::folds::folded_neighbors;
use crate::flow::dihedral_sectors::DihedralSectors;
use crate::mesh::adjacency::Adjacency;
use crate::mesh::boundary_elements::{BoundaryElements, BoundaryNeighbors};
use crate::{LevelView, Network, Surface};

/// The elements of each boundary on a level, and which of them are neighbours.
pub(super) struct LevelElements<'a> {
    pub(super) level: LevelView<'a>,
    pub(super) boundaries: BoundaryElements<'a>,
    pub(super) neighbors: BoundaryNeighbors<'a>,
}

impl<'a> LevelElements<'a> {
    pub(super) fn new(network: &'a Network, level: usize, adjacency: &Adjacency<'a>) -> Self {
        let level = network.level(level);
        let boundaries = BoundaryElements::of_level(level, network.boundaries().len());
        let neighbors = BoundaryNeighbors::new(level.labels(), &boundaries, adjacency);
        Self { level, boundaries, neighbors }
    }
}

/// How the elements of a level meet.
pub(super) struct LevelSectors<'a> {
    elements: LevelElements<'a>,
    dihedral_sectors: DihedralSectors,
}

impl<'a> LevelSectors<'a> {
    pub(super) fn new(network: &'a Network, level: usize) -> Self {
        let sides = network.sides();
        let adjacency = Adjacency::of_level(network.level(level));
        check_cancelled();
        let surface = Surface::of_level(network.level(level), &[], &sides);
        let dihedral_sectors = DihedralSectors::new(&surface, &adjacency);
        check_cancelled();
        Self { elements: LevelElements::new(network, level, &adjacency), dihedral_sectors }
    }

    /// Pairs of elements that are folded, or have passed each other.
    pub(super) fn folds(&self, points: &[DVec3]) -> Vec<[u32; 2]> {
        let LevelElements { level, boundaries, neighbors } = &self.elements;
        let mut folds = folded_neighbors(points, boundaries, neighbors, 0.0);
        folds.extend(self.dihedral_sectors.turned(level.elements(), points));
        folds
    }
}
