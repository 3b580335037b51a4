//! The point of a triangle or a segment that is nearest to another point.

use glam::DVec3;

/// The point of a triangle nearest to another one, and its barycentric coordinates. Two corners may be one: then it is a segment.
///
/// Ericson, Real-Time Collision Detection (2005), 5.1.5.
pub(crate) fn nearest_in_triangle([a, b, c]: [DVec3; 3], point: DVec3) -> (DVec3, [f64; 3]) {
    let (ab, ac) = (b - a, c - a);
    let [from_a, from_b, from_c] = [a, b, c].map(|corner| {
        let to = point - corner;
        [ab.dot(to), ac.dot(to)]
    });
    let at = |weights: [f64; 3]| (a * weights[0] + b * weights[1] + c * weights[2], weights);
    if from_a[0] <= 0.0 && from_a[1] <= 0.0 {
        return (a, [1.0, 0.0, 0.0]);
    }
    if from_b[0] >= 0.0 && from_b[1] <= from_b[0] {
        return (b, [0.0, 1.0, 0.0]);
    }
    if from_c[1] >= 0.0 && from_c[0] <= from_c[1] {
        return (c, [0.0, 0.0, 1.0]);
    }
    let beyond_ab = from_a[0] * from_b[1] - from_b[0] * from_a[1];
    if beyond_ab <= 0.0 && from_a[0] >= 0.0 && from_b[0] <= 0.0 {
        let share = from_a[0] / (from_a[0] - from_b[0]);
        return at([1.0 - share, share, 0.0]);
    }
    let beyond_ac = from_c[0] * from_a[1] - from_a[0] * from_c[1];
    if beyond_ac <= 0.0 && from_a[1] >= 0.0 && from_c[1] <= 0.0 {
        let share = from_a[1] / (from_a[1] - from_c[1]);
        return at([1.0 - share, 0.0, share]);
    }
    let beyond_bc = from_b[0] * from_c[1] - from_c[0] * from_b[1];
    let [toward_b, toward_c] = [from_c[0] - from_c[1], from_b[1] - from_b[0]];
    if beyond_bc <= 0.0 && toward_c >= 0.0 && toward_b >= 0.0 {
        let share = toward_c / (toward_c + toward_b);
        return at([0.0, 1.0 - share, share]);
    }
    let sum = beyond_bc + beyond_ac + beyond_ab;
    at([beyond_bc / sum, beyond_ac / sum, beyond_ab / sum])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beside every corner and edge, and above and within the triangle, and a segment.
    #[test]
    fn the_nearest_point_of_a_triangle_is_nearer_than_all_others() {
        let end = DVec3::new(0.5, 1.5, 0.0);
        for corners in [[DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), end], [DVec3::ZERO, end, end]] {
            let grid = |step: u32| f64::from(step) / 4.0 - 1.0;
            for (i, j) in (0..17).flat_map(|i| (0..17).map(move |j| (i, j))) {
                let point = DVec3::new(grid(i), grid(j), 0.3);
                let (nearest, weights) = nearest_in_triangle(corners, point);
                assert!(weights.iter().all(|weight| (-1e-15..=1.0 + 1e-15).contains(weight)));
                for (u, v) in (0..=40).flat_map(|u| (0..=40 - u).map(move |v| (u, v))) {
                    let [u, v] = [u, v].map(|k| f64::from(k) / 40.0);
                    let other = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
                    assert!(nearest.distance(point) <= other.distance(point) + 1e-12, "{point}");
                }
            }
        }
    }
}
