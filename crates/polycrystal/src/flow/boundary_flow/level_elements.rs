//! How the elements of a level meet.

use cancellation::check_cancelled;

use crate::check::folds::folded_neighbors;
use crate::flow::dihedral_sectors::DihedralSectors;
use crate::mesh::adjacency::Adjacency;
use crate::mesh::boundary_elements::{BoundaryElements, BoundaryNeighbors};
use crate::mesh::level_points::LevelPoints;
use crate::{Network, Surface};

/// The elements of each boundary on a level, and which of them are neighbours.
pub(super) struct LevelElements<'a> {
    pub(super) boundaries: BoundaryElements<'a>,
    pub(super) neighbors: BoundaryNeighbors<'a>,
}

impl<'a> LevelElements<'a> {
    /// Those of a level, as of [`Network::level_from_before`]; elements that hold their labels meet so.
    pub(super) fn new(network: &'a Network, level: usize, adjacency: &Adjacency<'a>) -> Self {
        let level = network.level_from_before(level);
        let boundaries = BoundaryElements::of_level(level, network.boundaries().len());
        let neighbors = BoundaryNeighbors::new(level.labels(), &boundaries, adjacency);
        Self { boundaries, neighbors }
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
        let held = network.level_from_before(level).held();
        let adjacency = Adjacency::of_level(held);
        check_cancelled();
        let surface = Surface::of_level(held, &[], &sides);
        let dihedral_sectors = DihedralSectors::new(&surface, &adjacency);
        check_cancelled();
        Self { elements: LevelElements::new(network, level, &adjacency), dihedral_sectors }
    }

    /// Pairs of elements that are folded, or have passed each other.
    pub(super) fn folds(&self, points: &LevelPoints<'_>) -> Vec<[u32; 2]> {
        let LevelElements { boundaries, neighbors } = &self.elements;
        let mut folds = folded_neighbors(points, boundaries, neighbors, 0.0);
        folds.extend(self.dihedral_sectors.turned(points));
        folds
    }
}
