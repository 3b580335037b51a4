//! What exact decisions know of a domain.

use std::sync::Arc;

use glam::{BVec3, DVec3};

use crate::{Wall, WallPlane};

/// The box of a domain, the axes along which it repeats, and the walls of one that is no box.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Frame {
    pub(crate) lower: DVec3,
    pub(crate) upper: DVec3,
    /// Number of axes along which the domain extends.
    pub(crate) axes: usize,
    pub(crate) periodic: BVec3,
    /// None where the box is all.
    pub(crate) facets: Option<Arc<Facets>>,
}

/// The walls of a polyhedron.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Facets {
    pub(crate) planes: Vec<WallPlane>,
    /// Outward, of length 1 up to rounding.
    pub(crate) normals: Vec<DVec3>,
}

impl Frame {
    /// What does not repeat.
    pub(crate) fn new(lower: DVec3, upper: DVec3, axes: usize, facets: Option<Arc<Facets>>) -> Self {
        Self { lower, upper, axes, periodic: BVec3::FALSE, facets }
    }

    /// Side lengths of the box.
    pub(crate) fn size(&self) -> DVec3 {
        self.upper - self.lower
    }

    /// The walls of a polyhedron, by number; none for a box.
    pub(crate) fn wall_planes(&self) -> &[WallPlane] {
        self.facets.as_ref().map_or(&[], |facets| &facets.planes)
    }

    /// The outward normals of these, of length 1.
    pub(crate) fn unit_normals(&self) -> &[DVec3] {
        self.facets.as_ref().map_or(&[], |facets| &facets.normals)
    }

    /// Where cells begin before anything cuts them: coordinate of a side of the box, of one thrice as large around a polyhedron.
    pub(crate) fn side_coordinate(&self, side: Wall) -> f64 {
        let axis = side.axis();
        let (lower, upper) = (self.lower[axis], self.upper[axis]);
        let room = if self.facets.is_none() { 0.0 } else { upper - lower };
        if side.is_upper() { upper + room } else { lower - room }
    }
}
