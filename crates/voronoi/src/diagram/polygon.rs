//! Polygons and their measures.

use glam::DVec3;

/// What both cells of a face need of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FaceMeasure {
    /// Normal toward the second side, as long as twice the area.
    pub(crate) normal: DVec3,
    pub(crate) doubled_area: f64,
    pub(crate) centroid: DVec3,
    pub(crate) corner_count: u32,
}

/// A plane polygon, corner by corner. Its triangles from the first corner on count by their area along the normal.
pub(crate) struct Polygon {
    first: DVec3,
    /// Relative to the first corner, for a face far from the origin would lose digits.
    last: DVec3,
    /// Its largest coordinate is 1.
    normal: DVec3,
    /// Twice the area, times the length of the normal.
    weight: f64,
    moment: DVec3,
}

impl Polygon {
    /// From the first corner on. The normal may have any length.
    #[inline]
    pub(crate) fn from(first: DVec3, normal: DVec3) -> Self {
        // The square of the length of a normal between seeds that nearly coincide can be too small for a number.
        let size = normal.abs().max_element();
        let normal = if size > 0.0 { normal / size } else { DVec3::ZERO };
        Self { first, last: DVec3::ZERO, normal, weight: 0.0, moment: DVec3::ZERO }
    }

    #[inline]
    pub(crate) fn go_to(&mut self, corner: DVec3) {
        let next = corner - self.first;
        let triangle = self.last.cross(next).dot(self.normal);
        self.weight += triangle;
        self.moment += (self.last + next) * triangle;
        self.last = next;
    }

    #[inline]
    pub(crate) fn measure(&self, corner_count: u32) -> FaceMeasure {
        if self.weight == 0.0 {
            return FaceMeasure {
                normal: DVec3::ZERO,
                doubled_area: 0.0,
                centroid: self.first,
                corner_count,
            };
        }
        let squared_length = self.normal.length_squared();
        let normal = self.normal * (self.weight / squared_length);
        let doubled_area = self.weight.abs() / squared_length.sqrt();
        FaceMeasure {
            normal,
            doubled_area,
            centroid: self.first + self.moment / (3.0 * self.weight),
            corner_count,
        }
    }
}
