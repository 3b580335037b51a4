//! The boundaries of voxels while they are made.

use glam::{BVec3, DVec3};
use rayon::prelude::*;

use crate::voxels::elements::CutFaces;
use crate::voxels::labels::Voxels;
use crate::voxels::lattice::Place;
use crate::{Side, Surface};

/// Points in units of voxels, and elements between them.
pub(super) struct VoxelSurface {
    pub(super) points: Vec<DVec3>,
    /// The place of the staircase that each point belongs to.
    pub(super) places: Vec<Place>,
    pub(super) cut: CutFaces,
}

impl VoxelSurface {
    /// As any surface, by the sides of each kind of face.
    pub(super) fn as_surface<'a>(&'a self, sides: &'a [[Side; 2]]) -> Surface<'a> {
        Surface { points: &self.points, elements: self.cut.elements(), boundary_of: &self.cut.kind_of, sides }
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
