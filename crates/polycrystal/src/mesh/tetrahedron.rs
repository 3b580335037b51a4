//! How regular a tetrahedron is.

use glam::DVec3;

/// Three times the radius of the ball within a tetrahedron, divided by that of the ball around it (gamma): 1 of a regular one, 0 of a flat one,
/// negative where it is turned inside out.
///
/// ```
/// use glam::DVec3;
/// use polycrystal::tetrahedron_gamma;
///
/// let regular = [DVec3::new(1.0, 1.0, 1.0), DVec3::new(1.0, -1.0, -1.0), DVec3::new(-1.0, 1.0, -1.0), DVec3::new(-1.0, -1.0, 1.0)];
/// assert!((tetrahedron_gamma(regular).abs() - 1.0).abs() < 1e-12);
/// ```
pub fn tetrahedron_gamma([a, b, c, d]: [DVec3; 4]) -> f64 {
    let (u, v, w) = (b - a, c - a, d - a);
    let six_volumes = u.cross(v).dot(w);
    let areas =
        u.cross(v).length() + v.cross(w).length() + w.cross(u).length() + (v - u).cross(w - u).length();
    // The edge lengths' products of opposite edges, as sides of a triangle whose area is 6 V R.
    let products =
        [u.length() * (w - v).length(), v.length() * (w - u).length(), w.length() * (v - u).length()];
    let [p, q, r] = products;
    let sixteen_squares = (p + q + r) * (-p + q + r) * (p - q + r) * (p + q - r);
    let around = sixteen_squares.max(0.0).sqrt();
    if areas * around == 0.0 {
        return 0.0;
    }
    // r_in = six_volumes / areas, for areas are twice the faces'; R = around / (4 six_volumes).
    12.0 * six_volumes * six_volumes.abs() / (areas * around)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_regular_tetrahedron_has_gamma_one_and_a_flat_one_none() {
        let [a, b, c, d] =
            [[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]].map(DVec3::from);
        assert!((tetrahedron_gamma([a, b, c, d]) - 1.0).abs() < 1e-12);
        assert!((tetrahedron_gamma([b, a, c, d]) + 1.0).abs() < 1e-12);
        // The corner of a cube: r = 1 / (3 + sqrt 3), R = sqrt(3) / 2.
        let corner = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let expected = 6.0 / (3f64.sqrt() * (3.0 + 3f64.sqrt()));
        assert!((tetrahedron_gamma(corner) - expected).abs() < 1e-12);
        assert_eq!(tetrahedron_gamma([DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE.with_z(0.0)]), 0.0);
    }
}
