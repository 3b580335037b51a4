//! How exact coordinates are, and what is measured on them.

use glam::DVec3;
use rayon::prelude::*;

/// By how much cosines of angles between normals may differ for rounding alone. Triangles with an edge of 1e-2 of others moved them by 1e-13.
pub(crate) const OF_COSINES: f64 = 1e-9;

/// A last place of the largest coordinate.
pub(crate) fn last_place(points: &[DVec3]) -> f64 {
    let largest = points.par_iter().map(|point| point.abs().max_element()).reduce(|| 0.0, f64::max);
    f64::EPSILON * largest
}

/// What a surface of some area sweeps where each coordinate of its points is off by so much.
pub(crate) fn swept_by_rounding(rounding: f64, area: f64) -> f64 {
    rounding * 3f64.sqrt() * area
}
