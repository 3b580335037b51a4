use rayon::prelude::*;

use crate::{Elements, Surface};

/// The smallest angles of triangles, in degrees: solvers and statistics suffer from small ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleQuality {
    /// That of the thinnest triangle.
    pub least: f64,
    /// That which a hundredth of the triangles is below.
    pub first_percentile: f64,
}

/// The quality of a surface's triangles; nothing in the plane, and where there are none.
pub(crate) fn triangle_quality(surface: &Surface<'_>) -> Option<TriangleQuality> {
    let Elements::Triangles(triangles) = surface.elements else { return None };
    let of_triangle = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| surface.points[corner as usize]);
        let angles =
            [[b - a, c - a], [c - b, a - b], [a - c, b - c]].map(|[one, other]| one.angle_between(other));
        angles.into_iter().fold(f64::INFINITY, f64::min).to_degrees()
    };
    let mut smallest: Vec<f64> = triangles.par_iter().map(of_triangle).collect();
    let place = smallest.len() / 100;
    let (below, at, _) =
        (!smallest.is_empty()).then(|| smallest.select_nth_unstable_by(place, f64::total_cmp))?;
    let least = below.iter().copied().fold(*at, f64::min);
    Some(TriangleQuality { least, first_percentile: *at })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::{BoundaryId, Side};

    #[test]
    fn one_thin_triangle_of_many_is_the_least_but_not_the_percentile() {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 0.1, 0.0)];
        let mut triangles = vec![[0, 1, 2]; 150];
        triangles[70] = [0, 1, 3];
        let boundary_of = vec![BoundaryId(0); triangles.len()];
        let surface = Surface {
            points: &points,
            elements: Elements::Triangles(&triangles),
            boundary_of: &boundary_of,
            sides: &[[Side::Exterior; 2]],
        };
        let quality = triangle_quality(&surface).expect("triangles");
        assert!((quality.least - 0.1f64.atan().to_degrees()).abs() < 1e-12);
        assert!((quality.first_percentile - 45.0).abs() < 1e-12);
        let none = Surface { elements: Elements::Triangles(&[]), boundary_of: &[], ..surface };
        assert_eq!(triangle_quality(&none), None);
    }
}
