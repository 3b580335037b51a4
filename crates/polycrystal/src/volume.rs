//! Volumes of grains (areas in the plane) and how they change with the points.

use glam::DVec3;
use rayon::prelude::*;

use crate::{Boundary, Elements, GrainId, Surface};

/// The volume of the tetrahedron that a triangle spans with the origin.
pub(crate) fn triangle_volume(corners: [DVec3; 3]) -> f64 {
    corners[0].dot(corners[1].cross(corners[2])) / 6.0
}

/// The area between a segment in the plane and the origin, positive when counter-clockwise.
pub(crate) fn segment_area(ends: [DVec3; 2]) -> f64 {
    0.5 * ends[0].truncate().perp_dot(ends[1].truncate())
}

/// Per boundary, the volume of the cone from the origin; positive where the origin lies on its first side.
pub(crate) fn boundary_volumes(surface: &Surface<'_>, origin: DVec3) -> Vec<f64> {
    let at = |vertex: u32| surface.points[vertex as usize] - origin;
    let of_elements: Vec<f64> = match surface.elements {
        Elements::Triangles(triangles) => {
            triangles.par_iter().map(|corners| triangle_volume(corners.map(at))).collect()
        }
        Elements::Segments(segments) => segments.par_iter().map(|ends| segment_area(ends.map(at))).collect(),
    };
    // One thread sums, for the order of a sum decides its last digit.
    let mut volumes = vec![0.0; surface.sides.len()];
    for (volume, boundary) in of_elements.iter().zip(surface.boundary_of) {
        volumes[boundary.index()] += volume;
    }
    volumes
}

/// The largest of what some volumes lack, as a share of them, and whose it is.
///
/// # Panics
/// When there are none.
pub(crate) fn largest_relative_error(missing: &[f64], volumes: &[f64]) -> (GrainId, f64) {
    let relative = missing.iter().zip(volumes).map(|(lack, volume)| (lack / volume).abs());
    let errors = (0u32..).map(GrainId).zip(relative);
    errors.max_by(|a, b| a.1.total_cmp(&b.1)).expect("a network has grains")
}

/// Sums over the boundaries of each grain, outward counted positive.
pub(crate) fn sum_over_grains(boundaries: &[Boundary], values: &[f64], grain_count: usize) -> Vec<f64> {
    let mut sums = vec![0.0; grain_count];
    for (boundary, value) in boundaries.iter().zip(values) {
        for (grain, sign) in boundary.signed_grains() {
            sums[grain.index()] += sign * value;
        }
    }
    sums
}
