use glam::DVec3;

/// The smallest angles of triangles, in degrees: solvers and statistics suffer from small ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleQuality {
    /// That of the thinnest triangle.
    pub least: f64,
    /// That which a hundredth of the triangles is below.
    pub first_percentile: f64,
    /// How many triangles are thin: their smallest angles are below [`TriangleQuality::BOUND`].
    pub thin: usize,
}

impl TriangleQuality {
    /// The smallest angle, in degrees, of a triangle that is not thin. Relaxation in space leaves no thin triangle where one can
    /// be helped by its corners moving along boundaries and lines. Flat boundaries are what their cells are.
    pub const BOUND: f64 = 1.5;
}

/// The quality of triangles by the squared sines of their smallest angles; nothing where there are none.
pub(crate) fn triangle_quality(mut smallest: Vec<f64>) -> Option<TriangleQuality> {
    let place = smallest.len() / 100;
    let (below, at, _) =
        (!smallest.is_empty()).then(|| smallest.select_nth_unstable_by(place, f64::total_cmp))?;
    let least = below.iter().copied().fold(*at, f64::min);
    let [least, first_percentile] = [least, *at].map(|squared| squared.sqrt().asin().to_degrees());
    let bound = TriangleQuality::BOUND.to_radians().sin().powi(2);
    let thin = smallest.iter().filter(|squared| **squared < bound).count();
    Some(TriangleQuality { least, first_percentile, thin })
}

/// The square of the sine of a triangle's smallest angle, which is across from its shortest side; 0 where two corners are one.
pub(crate) fn squared_sine([a, b, c]: [DVec3; 3]) -> f64 {
    let sides = [b - a, c - b, a - c].map(DVec3::length_squared);
    let product: f64 = sides.iter().product();
    let shortest = sides.into_iter().fold(f64::INFINITY, f64::min);
    if product == 0.0 { 0.0 } else { (b - a).cross(c - a).length_squared() * shortest / product }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_thin_triangle_of_many_is_the_least_but_not_the_percentile() {
        let mut sines = vec![squared_sine([DVec3::ZERO, DVec3::X, DVec3::Y]); 150];
        sines[70] = squared_sine([DVec3::ZERO, DVec3::X, DVec3::new(1.0, 0.1, 0.0)]);
        let quality = triangle_quality(sines).expect("triangles");
        assert!((quality.least - 0.1f64.atan().to_degrees()).abs() < 1e-12);
        assert!((quality.first_percentile - 45.0).abs() < 1e-12);
        assert_eq!(triangle_quality(Vec::new()), None);
    }
}
