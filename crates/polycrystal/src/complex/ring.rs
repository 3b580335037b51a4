//! Whether the outline of a face that is not plane can be filled.

use glam::DVec3;

use crate::mesh::fold::{LARGEST_FOLD, are_apart};

/// Share of the length of a short edge below which an edge is tiny.
const TINY: f64 = 0.01;

/// Cosine of the largest angle between a face and one of the triangles that join its edges to its centres (60 degrees).
pub(crate) const LARGEST_BEND: f64 = 0.5;

/// The triangles that join the edges of a ring to its centre.
struct Fan {
    /// Length of each edge, and twice the area of its triangle as a vector.
    triangles: Vec<(f64, DVec3)>,
    perimeter: f64,
    /// Twice the area of all as a vector.
    normal: DVec3,
}

impl Fan {
    fn new(ring: &[DVec3]) -> Self {
        let edges = || ring.iter().zip(ring.iter().cycle().skip(1)).filter(|(a, b)| a != b);
        let perimeter: f64 = edges().map(|(a, b)| a.distance(*b)).sum();
        let center: DVec3 = edges().map(|(a, b)| (*a + *b) * (0.5 * a.distance(*b) / perimeter)).sum();
        let triangle = |(a, b): (&DVec3, &DVec3)| (a.distance(*b), (*a - center).cross(*b - center));
        let triangles: Vec<(f64, DVec3)> = edges().map(triangle).collect();
        let normal = triangles.iter().map(|(_, triangle)| *triangle).sum();
        Self { triangles, perimeter, normal }
    }
}

/// Whether no triangle from the ring's centre to an edge turns its back to the others. Rings thinner than `short` may, and
/// tiny edges: they are about to go themselves.
pub(crate) fn is_star_shaped(ring: &[DVec3], short: f64) -> bool {
    let Fan { triangles, perimeter, normal } = Fan::new(ring);
    if 0.5 * normal.length() < 0.5 * short * perimeter {
        return true;
    }
    triangles
        .iter()
        .filter(|(length, _)| *length > TINY * short)
        .all(|(_, triangle)| triangle.dot(normal) > LARGEST_BEND * triangle.length() * normal.length())
}

/// Whether two neighbouring triangles from the ring's centre to its edges are bent by more than [`LARGEST_FOLD`] tells.
pub(crate) fn is_folded(ring: &[DVec3]) -> bool {
    let Fan { triangles, .. } = Fan::new(ring);
    let mut pairs = triangles.iter().zip(triangles.iter().cycle().skip(1));
    pairs.any(|((_, a), (_, b))| are_apart([*a, *b], LARGEST_FOLD))
}
