//! A polygon as a fan of triangles.

use glam::DVec3;

/// A polygon where its points are: triangles from its centre to each two corners in a row.
pub(super) struct Fan<'a> {
    pub(super) ring: &'a [DVec3],
    pub(super) center: DVec3,
}

impl Fan<'_> {
    pub(super) fn area(&self) -> f64 {
        self.normals().map(|normal| 0.5 * normal.length()).sum()
    }

    /// The normals of the triangles, twice as long as their areas.
    pub(super) fn normals(&self) -> impl Iterator<Item = DVec3> {
        let ends = self.ring.iter().zip(self.ring.iter().cycle().skip(1));
        ends.map(|(a, b)| (*a - self.center).cross(*b - self.center))
    }
}
