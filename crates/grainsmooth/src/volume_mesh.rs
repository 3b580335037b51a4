//! Tetrahedra that fill grains, in the plane triangles, and how good they are.

pub(crate) mod cohesive;
pub(crate) mod curved;
pub(crate) mod element_faces;
pub(crate) mod element_nodes;
pub(crate) mod element_shape;
pub(crate) mod filled_plane;
pub(crate) mod quality;
pub(crate) mod repair;
pub(crate) mod search;
pub(crate) mod sliding;

use std::collections::BTreeMap;
use std::fmt;

use glam::DVec3;
use polycrystal::GrainId;
use serde::Serialize;

/// Tetrahedra that fill grains.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct VolumeMesh {
    /// The points of the network, by the same numbers, then those inside grains.
    pub points: Vec<DVec3>,
    /// Number of points of the network.
    pub surface_points: usize,
    /// Grain by grain; seen from the last corner, the others go round clockwise.
    pub tetrahedra: Vec<[u32; 4]>,
    /// The grain of each.
    pub grains: Vec<GrainId>,
    /// How many points of the network slid along its boundaries, to where tetrahedra beside them are better.
    pub slid: usize,
    /// The middles of edges that may bend, by their ends, the smaller number first.
    pub middles: BTreeMap<[u32; 2], DVec3>,
    /// What became of these, where elements are of second order.
    pub curved: Option<CurvedEdges>,
}

impl VolumeMesh {
    /// The corners of a tetrahedron.
    pub(crate) fn corners(&self, tetrahedron: usize) -> [DVec3; 4] {
        self.tetrahedra[tetrahedron].map(|corner| self.points[corner as usize])
    }

    /// Volume of each of so many grains.
    pub fn grain_volumes(&self, count: usize) -> Vec<f64> {
        let mut volumes = vec![0.0; count];
        for (tetrahedron, grain) in self.grains.iter().enumerate() {
            volumes[grain.index()] += volume(self.corners(tetrahedron));
        }
        volumes
    }
}

/// The volume of a tetrahedron, negative where it is turned inside out.
pub(crate) fn volume([a, b, c, d]: [DVec3; 4]) -> f64 {
    (b - a).cross(c - a).dot(d - a) / 6.0
}

/// What became of the edges on boundaries of elements of second order.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CurvedEdges {
    /// Number of edges whose middles lie on the smooth surface.
    pub curved: usize,
    /// Number of those that were made straight, as elements would have come near to turning inside out.
    pub straight: usize,
    /// Lower bound of the Jacobian determinant in all elements, as a share of what it is with straight edges.
    pub least_jacobian: f64,
    /// Largest error of the volume of a grain, as a share of it.
    pub largest_volume_error: f64,
}

impl fmt::Display for CurvedEdges {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { curved, straight, least_jacobian, largest_volume_error } = self;
        write!(
            out,
            "{curved} edges on the smooth surface, {straight} straight; Jacobian at least {least_jacobian:.2} of the straight element's; volumes to {largest_volume_error:.1e}"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corner_of_a_cube_has_a_sixth_of_its_volume() {
        assert!((volume([DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z]) - 1.0 / 6.0).abs() < 1e-15);
    }
}
