//! How far the normals of a boundary turn.

use glam::DVec3;

/// A cone around the normals of some triangles.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct NormalCone {
    /// The direction of the sum of all normals; 0 where there is none.
    axis: DVec3,
    /// The least cosine of the angles between the axis and the normals.
    cosine: f64,
    /// The length of the shortest normal.
    shortest: f64,
}

/// How much a cosine of [`NormalCone::least_along`] can be too large for rounding: a sine that follows from a cosine near 1 is right to some 3e-8.
const SLACK: f64 = 1e-6;

impl NormalCone {
    /// That of some normals, which are as long as twice the areas of their triangles.
    pub(crate) fn of(normals: &[DVec3]) -> Self {
        let axis = normals.iter().sum::<DVec3>().normalize_or_zero();
        let mut cone = Self { axis, cosine: 1.0, shortest: f64::INFINITY };
        for normal in normals {
            let length = normal.length();
            cone.shortest = cone.shortest.min(length);
            // No number where there is no length, which then counts alone.
            cone.cosine = cone.cosine.min(axis.dot(*normal) / length);
        }
        cone
    }

    /// The direction of the sum of all normals; 0 where there is none.
    pub(crate) fn axis(&self) -> DVec3 {
        self.axis
    }

    /// A length that no normal falls short of along a direction; negative where none is known.
    pub(crate) fn least_along(&self, direction: DVec3) -> f64 {
        let along = self.axis.dot(direction);
        if along <= 0.0 || self.cosine <= 0.0 {
            return -1.0;
        }
        let sine = |cosine: f64| (1.0 - cosine * cosine).max(0.0).sqrt();
        self.shortest * (along * self.cosine - sine(along) * sine(self.cosine) - SLACK)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_normal_is_shorter_along_a_direction_than_its_cone_says() {
        let direction =
            |k: f64| DVec3::new((1.3 * k).sin(), (2.1 * k).cos(), (0.7 * k).sin() + 0.4).normalize();
        let mut known = 0;
        for spread in [0.0, 1e-9, 1e-4, 0.1, 0.5, 0.9, 2.0] {
            for k in (0u8..200).map(f64::from) {
                let turned = |j: f64| (direction(k) + spread * direction(17.0 * k + j)) * (1.0 + j);
                let normals: Vec<DVec3> = (0u8..9).map(f64::from).map(turned).collect();
                let cone = NormalCone::of(&normals);
                let along = (direction(k) + direction(3.7 * k)).normalize();
                let least = normals.iter().map(|normal| normal.dot(along)).fold(f64::INFINITY, f64::min);
                let bound = cone.least_along(along);
                assert!(bound <= least || bound < 0.0, "{bound} for {least}");
                known += i32::from(bound > 0.0);
            }
        }
        assert!(known > 300, "{known}");
    }

    #[test]
    fn a_triangle_without_area_leaves_nothing_known() {
        assert!(NormalCone::of(&[DVec3::X, DVec3::ZERO]).least_along(DVec3::X) <= 0.0);
        assert!(NormalCone::of(&[]).least_along(DVec3::X) < 0.0);
    }
}
