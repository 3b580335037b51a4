//! The boundaries of voxels while they are made.

use glam::{BVec3, DVec3};
use rayon::prelude::*;
use voronoi::PeriodicVertex;

use crate::voxels::elements::CutFaces;
use crate::voxels::labels::Voxels;
use crate::voxels::lattice::Place;
use crate::voxels::staircase::Kind;

/// Points of the lattice in units of voxels, and elements between them and their copies.
pub(super) struct VoxelSurface {
    pub(super) points: Vec<DVec3>,
    /// The place of the staircase that each point belongs to.
    pub(super) places: Vec<Place>,
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
    pub(super) fn in_domain(&self, voxels: &Voxels) -> Vec<DVec3> {
        let (lower, upper, spacing) = (voxels.domain().lower(), voxels.domain().upper(), voxels.spacing());
        let of_point = |(point, place): (&DVec3, &Place)| {
            let inside = lower + *point * spacing;
            let is_upper = BVec3::from_array(std::array::from_fn(|axis| place[axis] == voxels.shape()[axis]));
            DVec3::select(is_upper, upper, inside)
        };
        self.points.par_iter().zip(&self.places).map(of_point).collect()
    }
}
