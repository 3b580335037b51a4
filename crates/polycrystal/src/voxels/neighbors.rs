//! How elements between voxels meet, and where they should not.

use glam::DVec3;
use rayon::prelude::*;

use crate::check::folds::is_folded;
use crate::check::intersections::{boundary_boxes, crossing_elements};
use crate::mesh::adjacency::{Adjacency, Inner};
use crate::mesh::boundary_elements::BoundaryElements;
use crate::voxels::volumes::VolumeSearch;

/// How the elements of a surface meet, wherever its points are.
pub(super) struct Neighbors<'a> {
    search: &'a VolumeSearch<'a>,
    adjacency: Adjacency<'a>,
    boundaries: BoundaryElements<'a>,
}

impl<'a> Neighbors<'a> {
    pub(super) fn new(search: &'a VolumeSearch<'a>) -> Self {
        let surface = search.surface(&[]);
        let adjacency = Adjacency::of_elements(surface.elements, surface.boundary_of);
        Self { search, adjacency, boundaries: BoundaryElements::new(&surface) }
    }

    /// Pairs of elements of one boundary that are folded.
    pub(super) fn folds(&self, points: &[DVec3]) -> Vec<[u32; 2]> {
        let Inner::Listed(pairs) = &self.adjacency.inner else {
            unreachable!("the adjacency of loose elements is a list")
        };
        let points = self.search.cut.copies.with_copies(points);
        let elements = self.search.cut.elements();
        // Three times the arithmetic of a list of all normals, which would take a seventh of the memory of all else.
        let normals = |pair: &[u32; 2]| pair.map(|element| elements.normal(&points, element));
        pairs.par_iter().filter(|pair| is_folded(normals(pair), 0.0)).copied().collect()
    }

    /// Pairs of elements that meet other than in points and edges that they share.
    pub(super) fn crossings(&self, points: &[DVec3]) -> Vec<[u32; 2]> {
        let with_copies = self.search.cut.copies.with_copies(points);
        let surface = self.search.surface(&with_copies);
        let boxes = boundary_boxes(&surface, &self.boundaries);
        crossing_elements(&surface, &self.adjacency, &self.boundaries, &boxes)
    }
}
