//! Triangles with a node in the middle of each edge.

use glam::DVec3;

/// Points of a rule that integrates polynomials of degree 4 over a triangle exactly, by their barycentric coordinates: each of these stands for three, with the first coordinate
/// at each corner and the second at the others; and the share of the area of each. D. A. Dunavant, International Journal for Numerical Methods in Engineering 21 (1985) 1129.
const ABSCISSAS: [[f64; 3]; 2] = [
    [0.108_103_018_168_070_23, 0.445_948_490_915_964_9, 0.223_381_589_678_011_47],
    [0.816_847_572_980_458_5, 0.091_576_213_509_770_74, 0.109_951_743_655_321_87],
];

/// A triangle whose edges are parabolas.
#[derive(Debug, Clone, Copy)]
pub(crate) struct QuadraticTriangle {
    pub(crate) corners: [DVec3; 3],
    /// Of the edges from each corner to the next.
    pub(crate) middles: [DVec3; 3],
}

impl QuadraticTriangle {
    /// Points by which integrals over the triangle are sums: the barycentric coordinates of each, where it is, and the normal there, as long as its share of the area.
    pub(crate) fn at_abscissas(&self) -> impl Iterator<Item = ([f64; 3], DVec3, DVec3)> {
        ABSCISSAS.into_iter().flat_map(move |[at_corner, at_others, share]| {
            (0..3).map(move |corner| {
                let mut weights = [at_others; 3];
                weights[corner] = at_corner;
                let [toward_0, toward_1, toward_2] = self.derivatives(weights);
                let normal = (toward_1 - toward_0).cross(toward_2 - toward_0) * (0.5 * share);
                (weights, self.place(weights), normal)
            })
        })
    }

    fn place(&self, weights: [f64; 3]) -> DVec3 {
        let of = |k: usize| {
            self.corners[k] * (weights[k] * (2.0 * weights[k] - 1.0))
                + self.middles[k] * (4.0 * weights[k] * weights[(k + 1) % 3])
        };
        of(0) + of(1) + of(2)
    }

    /// The derivatives by the barycentric coordinates.
    fn derivatives(&self, weights: [f64; 3]) -> [DVec3; 3] {
        [0, 1, 2].map(|k| {
            let (next, last) = ((k + 1) % 3, (k + 2) % 3);
            self.corners[k] * (4.0 * weights[k] - 1.0)
                + self.middles[k] * (4.0 * weights[next])
                + self.middles[last] * (4.0 * weights[last])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// z = x^2 over the triangle below x + y = 1: the volume under it is 1/12, the vector of its area that of its projection and its rim.
    #[test]
    fn a_parabola_has_its_volume_and_area() {
        let at = |x: f64, y: f64| DVec3::new(x, y, x * x);
        let triangle = QuadraticTriangle {
            corners: [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)],
            middles: [at(0.5, 0.0), at(0.5, 0.5), at(0.0, 0.5)],
        };
        let (mut volume, mut area) = (0.0, DVec3::ZERO);
        for (weights, place, normal) in triangle.at_abscissas() {
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            assert!((place.z - place.x * place.x).abs() < 1e-15);
            volume += place.z * normal.z;
            area += normal;
        }
        assert!((volume - 1.0 / 12.0).abs() < 1e-15, "{volume}");
        // Normals are (-2 x, 0, 1) by area of the projection, whose centroid is at a third.
        assert!(area.distance(DVec3::new(-1.0 / 3.0, 0.0, 0.5)) < 1e-15, "{area}");
    }

    /// The rule is exact up to degree 4: the integral of x^4 over that triangle is 4! / 6!.
    #[test]
    fn the_rule_has_degree_four() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let middles = [0, 1, 2].map(|k| corners[k].midpoint(corners[(k + 1) % 3]));
        let fourth: f64 = QuadraticTriangle { corners, middles }
            .at_abscissas()
            .map(|(_, at, normal)| at.x.powi(4) * normal.z)
            .sum();
        assert!((fourth - 1.0 / 30.0).abs() < 1e-16, "{fourth}");
    }
}
