//! Normals that are too far apart.

use glam::DVec3;

/// Cosine of the largest angle between neighbouring triangles of a boundary, and of the largest by which a step may turn one (75 degrees): neither
/// relaxation nor later levels must reach the 90 of a fold.
pub(crate) const LARGEST_FOLD: f64 = 0.26;

/// Whether two neighbours with these normals, of any length, are further apart than the angle whose cosine is given, or without area.
pub(crate) fn is_folded([a, b]: [DVec3; 2], cosine: f64) -> bool {
    are_apart([a, b], cosine) || a == DVec3::ZERO || b == DVec3::ZERO
}

/// Whether two normals, of any length, are further apart than the angle whose cosine is given; what is no number is.
pub(crate) fn are_apart([a, b]: [DVec3; 2], cosine: f64) -> bool {
    let dot = a.dot(b);
    // Nearly all pairs are told by this alone.
    if dot > 0.0 && cosine <= 0.0 {
        return false;
    }
    let margin = dot - cosine * (a.length() * b.length());
    margin.is_nan() || margin < 0.0
}
