//! What keeps small features from deforming faster than they can be followed.

use glam::DVec3;

use super::patch::Patch;

/// Length, in units of the feature size, of a control edge whose spring is as stiff as the surface's own tension.
const SMALL_LENGTH: f64 = 0.06;

/// How fast the spring stiffens as the edge gets shorter. Tension pulls on an edge of length l with a force that does not
/// shrink with l, so the strain stays bounded for exponents above one.
const EXPONENT: i32 = 4;

/// Stiffest spring. Edges that would need a stiffer one are rigid anyhow, and far larger numbers would drown the others
/// where rigid edges cancel.
const STIFFEST: f64 = 10.0;

/// Spring of the longest edges: it only makes points without tension (those inside walls) follow their neighbours.
const FOLLOW: f64 = 1e-3;

/// Adds to the stiffness of a patch's edges their springs on displacement, in units of the time step.
///
/// `feature_size` is that of the control mesh, which has shorter edges on higher levels.
pub(super) fn add_springs(stiffness: &mut [f64], patch: &Patch, points: &[DVec3], feature_size: f64) {
    for ([a, b], stiffness) in patch.edges.iter().zip(stiffness) {
        let [start, end] = [a, b].map(|local| points[patch.control_points[*local as usize] as usize]);
        let ratio = SMALL_LENGTH * feature_size / start.distance(end).max(f64::MIN_POSITIVE);
        *stiffness += FOLLOW + ratio.powi(EXPONENT).min(STIFFEST);
    }
}
