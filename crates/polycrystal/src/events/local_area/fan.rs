//! A polygon as a fan of triangles.

use glam::DVec3;

/// A polygon where its points are: triangles from its centre to each two corners in a row.
pub(super) struct Fan<'a> {
    pub(super) ring: &'a [DVec3],
    pub(super) center: DVec3,
}

/// Of a fan six times the volume of the cone from the origin, and its normal, twice as long as its area.
///
/// From an origin that is off by o, the cone has `o normal` less.
pub(super) struct VolumeGradient {
    pub(super) volume: f64,
    pub(super) normal: DVec3,
}

impl Fan<'_> {
    pub(super) fn area(&self) -> f64 {
        let ends = self.ring.iter().zip(self.ring.iter().cycle().skip(1));
        ends.map(|(a, b)| 0.5 * (*a - self.center).cross(*b - self.center).length()).sum()
    }

    pub(super) fn volume_gradient(&self) -> VolumeGradient {
        let ends = self.ring.iter().zip(self.ring.iter().cycle().skip(1));
        let normal: DVec3 = ends.map(|(a, b)| (*a - self.center).cross(*b - self.center)).sum();
        // All triangles end at the centre.
        VolumeGradient { volume: self.center.dot(normal), normal }
    }
}
