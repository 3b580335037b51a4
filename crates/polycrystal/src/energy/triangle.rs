//! A triangle of a boundary: how its area and the volume that it sweeps change with its corners.
//!
//! With N the normal, twice as long as the area, the area's gradient at a corner is `1/2 N/|N| x s`, where s is the side across from it, run
//! through as the triangle winds. Per displacement of each of its corners the triangle sweeps the volume `N / 6`.

use glam::DVec3;

pub(crate) struct Triangle {
    corners: [DVec3; 3],
    /// Twice as long as the area.
    pub(crate) normal: DVec3,
    pub(crate) doubled_area: f64,
}

impl Triangle {
    pub(crate) fn new(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        Self { corners, normal, doubled_area: normal.length() }
    }

    /// The gradient of area times tension at each corner, given the unit normal times half the tension.
    pub(crate) fn gradients(&self, half_pull: DVec3) -> [DVec3; 3] {
        let [a, b, c] = self.corners;
        [c - b, a - c, b - a].map(|across| half_pull.cross(across))
    }

    /// The volume swept per displacement of each corner.
    pub(crate) fn volume_gradient(&self) -> DVec3 {
        self.normal / 6.0
    }

    /// The cotangent of the angle at each corner, from 0 to the largest that counts.
    ///
    /// A triangle without area has no cotangents: the upper limit stands in. Obtuse angles would push points apart.
    pub(crate) fn cotangents(&self, largest: f64) -> [f64; 3] {
        [0, 1, 2].map(|k| {
            let [apex, from, to] = [0, 1, 2].map(|step| self.corners[(k + step) % 3]);
            let cotangent = (from - apex).dot(to - apex) / self.doubled_area.max(f64::MIN_POSITIVE);
            cotangent.clamp(0.0, largest)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_are_those_of_the_area() {
        let corners = [DVec3::new(0.1, 0.2, -0.3), DVec3::new(1.1, 0.0, 0.2), DVec3::new(0.4, 0.9, 0.7)];
        let area = |corners| 0.5 * Triangle::new(corners).doubled_area;
        let triangle = Triangle::new(corners);
        let gradients = triangle.gradients(0.5 * triangle.normal.normalize());
        for (k, gradient) in gradients.iter().enumerate() {
            for axis in 0..3 {
                let [before, after] = [-1e-6, 1e-6].map(|by| {
                    let mut moved = corners;
                    moved[k][axis] += by;
                    area(moved)
                });
                assert!(((after - before) / 2e-6 - gradient[axis]).abs() < 1e-9, "{k} {axis}");
            }
        }
    }

    #[test]
    fn cotangents_are_those_of_the_angles() {
        let right = Triangle::new([DVec3::ZERO, DVec3::X, 3f64.sqrt() * DVec3::Y]);
        let expected = [0.0, 1.0 / 3f64.sqrt(), 3f64.sqrt()];
        assert!(
            right.cotangents(9.0).iter().zip(expected).all(|(found, angle)| (found - angle).abs() < 1e-15)
        );
        assert_eq!(right.cotangents(1.0)[2], 1.0);
        assert_eq!(Triangle::new([DVec3::ZERO, DVec3::X, 2.0 * DVec3::X]).cotangents(9.0), [9.0, 0.0, 9.0]);
    }
}
