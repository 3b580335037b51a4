//! The boundaries of voxels while they are made.

use glam::{DVec3, UVec3};
use rayon::prelude::*;
use voronoi::PeriodicVertex;

use crate::mesh::id::id;
use crate::voxels::elements::CutFaces;
use crate::voxels::labels::Grid;
use crate::voxels::staircase::Kind;

/// Points of the lattice in units of voxels, and elements between them and their copies.
pub(super) struct VoxelSurface {
    pub(super) points: Vec<DVec3>,
    /// The place of the staircase that each point belongs to.
    pub(super) places: Vec<UVec3>,
    pub(super) cut: CutFaces,
}

impl VoxelSurface {
    /// The elements that are there once on the torus, with their sides as cells have them.
    pub(super) fn torus_faces(
        &self,
        kinds: &[Kind],
    ) -> impl Iterator<Item = ([voronoi::Side; 2], Vec<PeriodicVertex>)> {
        let elements = self.cut.elements();
        // Those of copies follow.
        let once = (0u32..).zip(&self.cut.kind_of).take_while(|(_, kind)| kind.index() < kinds.len());
        once.map(move |(element, kind)| {
            let corners = elements.corners(element);
            let corners = corners.iter().map(|corner| self.cut.copies.vertex(*corner)).collect();
            (kinds[kind.index()].cell_sides(), corners)
        })
    }

    /// The points in the unit of the domain: exactly on its walls where they were on those of the lattice.
    pub(super) fn in_domain(&self, grid: &Grid) -> Vec<DVec3> {
        let (lower, upper, spacing) = (grid.domain.lower(), grid.domain.upper(), grid.spacing());
        let last = UVec3::from_array(grid.shape.map(id));
        let of_point = |(point, place): (&DVec3, &UVec3)| {
            DVec3::select(place.cmpeq(last), upper, lower + *point * spacing)
        };
        self.points.par_iter().zip(&self.places).map(of_point).collect()
    }
}
