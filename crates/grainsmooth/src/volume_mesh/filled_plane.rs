//! Triangles that fill grains in the plane: how good they are, and their edges on curved boundaries.

use std::fmt;

use glam::DVec3;
use polycrystal::{CurvedBoundaries, Network, PlaneMesh};
use serde::Serialize;

use super::CurvedEdges;
use super::curved::{Measures, curve, least_and_mean};
use super::element_shape::TRIANGLE_EDGES;

/// Triangles that fill grains in the plane.
#[derive(Debug, Clone, PartialEq)]
pub struct FilledPlane {
    /// The triangles.
    pub mesh: PlaneMesh,
    /// What became of edges on boundaries, where elements are of second order.
    pub curved: Option<CurvedEdges>,
}

/// How good triangles are, by their shape: twice the radius of the circle within one divided by that of the circle around it, 1 of a regular one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PlaneQuality {
    /// Number of triangles.
    pub count: usize,
    /// The mean shape.
    pub mean_shape: f64,
    /// The least angle of all, in degrees.
    pub least_angle: f64,
    /// How many triangles have an angle below 25 degrees.
    pub narrow: usize,
    /// Where the narrowest one is.
    pub worst_place: [f64; 3],
    /// Its grain.
    pub worst_grain: u32,
}

/// The angle in degrees below which triangles are counted as narrow: refinement of Delaunay triangulations leaves none below but in narrower corners.
const NARROW: f64 = 25.0;

impl FilledPlane {
    /// Gives triangles second order, as of [`curve`].
    pub(crate) fn curved(mut mesh: PlaneMesh, network: &Network, boundaries: CurvedBoundaries) -> Self {
        let measures = Measures { size: doubled_area, jacobian_shares };
        let (middles, curved) =
            curve(network, boundaries, &mut mesh.points, &mesh.triangles, TRIANGLE_EDGES, &measures);
        mesh.middles = middles;
        Self { mesh, curved: Some(curved) }
    }

    /// How good the triangles are; nothing where there are none.
    pub fn quality(&self) -> Option<PlaneQuality> {
        let mesh = &self.mesh;
        let shapes = (0..mesh.triangles.len()).map(|triangle| angle_and_shape(mesh.corners(triangle)));
        let shapes: Vec<(f64, f64)> = shapes.collect();
        let (worst, (least_angle, _)) =
            shapes.iter().enumerate().min_by(|a, b| a.1.0.total_cmp(&b.1.0).then(a.0.cmp(&b.0)))?;
        Some(PlaneQuality {
            count: shapes.len(),
            mean_shape: shapes.iter().map(|(_, shape)| shape).sum::<f64>() / shapes.len() as f64,
            least_angle: *least_angle,
            narrow: shapes.iter().filter(|(angle, _)| *angle < NARROW).count(),
            worst_place: (mesh.corners(worst).iter().sum::<DVec3>() / 3.0).to_array(),
            worst_grain: mesh.grains[worst].0,
        })
    }
}

/// The least angle of a triangle in degrees, and its shape: eight times the product of the sines of half its angles.
fn angle_and_shape([a, b, c]: [DVec3; 3]) -> (f64, f64) {
    let angle = |at: DVec3, one: DVec3, other: DVec3| (one - at).angle_between(other - at);
    let angles = [angle(a, b, c), angle(b, c, a), angle(c, a, b)];
    let shape = 8.0 * angles.iter().map(|angle| (0.5 * angle).sin()).product::<f64>();
    (angles.into_iter().fold(f64::INFINITY, f64::min).to_degrees(), shape)
}

/// A lower bound of the Jacobian determinant of a triangle of second order, and its mean, which is that of the area, as shares of what they are with straight edges: the least of the Bernstein
/// coefficients of that quadratic polynomial, and their mean.
/// Middles are those of the edges 0 1, 1 2, 2 0.
pub(crate) fn jacobian_shares(corners: [DVec3; 3], middles: [DVec3; 3]) -> (f64, f64) {
    let middle = |a: usize, b: usize| match (a.min(b), a.max(b)) {
        (0, 1) => middles[0],
        (1, 2) => middles[1],
        _ => middles[2],
    };
    // The derivative by a barycentric coordinate, which is linear, at a corner.
    let derivative = |by: usize, at: usize| match by == at {
        true => corners[at] * 3.0,
        false => middle(by, at) * 4.0 - corners[by],
    };
    let columns = [0, 1, 2].map(|at| [1, 2].map(|by| derivative(by, at) - derivative(0, at)));
    let determinant = |i: usize, j: usize| columns[i][0].cross(columns[j][1]).z;
    let coefficient = |(i, j): (usize, usize)| 0.5 * (determinant(i, j) + determinant(j, i));
    let straight = doubled_area(corners);
    let all = (0..3).flat_map(|i| (i..3).map(move |j| (i, j)));
    least_and_mean(all.map(|at| coefficient(at) / straight))
}

fn doubled_area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).z
}

impl fmt::Display for PlaneQuality {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { count, mean_shape, least_angle, narrow, worst_place: [x, y, _], worst_grain } = self;
        write!(
            out,
            "{count} triangles, shape {mean_shape:.3} on the mean, {narrow} with angles below {NARROW} degrees, least {least_angle:.1} degrees in grain {worst_grain} at {x:.4} {y:.4}"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn the_jacobian_is_one_with_straight_edges_and_vanishes_with_a_middle_at_a_quarter() {
        let mut middles = [0, 1, 2].map(|k| CORNERS[k].midpoint(CORNERS[(k + 1) % 3]));
        let (least, mean) = jacobian_shares(CORNERS, middles);
        assert!((least - 1.0).abs() < 1e-15 && (mean - 1.0).abs() < 1e-15);
        // x = s + 4 s (1 - s) (m - 1/2) along the edge: dx/ds = 4 m - 1 at its start.
        middles[0].x = 0.25;
        assert!(jacobian_shares(CORNERS, middles).0.abs() < 1e-15);
        // At the corners beside it, a bulge into the triangle takes 4 times its height; of its area, two thirds of the bulge's length times its height.
        middles[0] = DVec3::new(0.5, 0.1, 0.0);
        let (least, mean) = jacobian_shares(CORNERS, middles);
        assert!((least - 0.6).abs() < 1e-12 && (mean - (1.0 - 2.0 * 0.1 * 2.0 / 3.0)).abs() < 1e-12);
    }

    #[test]
    fn regular_and_right_triangles_have_their_shapes() {
        let regular = [DVec3::ZERO, DVec3::X, DVec3::new(0.5, 0.75f64.sqrt(), 0.0)];
        let (angle, shape) = angle_and_shape(regular);
        assert!((angle - 60.0).abs() < 1e-12 && (shape - 1.0).abs() < 1e-12);
        // r = 1 - 1 / sqrt 2, R = 1 / sqrt 2.
        let (angle, shape) = angle_and_shape(CORNERS);
        assert!((angle - 45.0).abs() < 1e-12 && (shape - 2.0 * (2f64.sqrt() - 1.0)).abs() < 1e-12);
    }
}
