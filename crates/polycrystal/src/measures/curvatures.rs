use std::f64::consts::TAU;

use glam::DVec3;

use crate::measures::plane;
use crate::mesh::adjacency::Adjacency;
use crate::{Elements, Surface};

/// How a boundary is curved at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointCurvature {
    /// The mean of the two principal curvatures, positive where the first side is convex; in the plane the curvature.
    /// 1 / length.
    pub mean: f64,
    /// Their product; in the plane 0. 1 / length^2.
    pub gaussian: f64,
}

impl PointCurvature {
    /// At points where several boundaries meet, or one ends, both are NaN.
    pub const NOT_DEFINED: Self = Self { mean: f64::NAN, gaussian: f64::NAN };
}

/// The curvatures at each point of a surface that lies inside a boundary; [`PointCurvature::NOT_DEFINED`] elsewhere.
///
/// In space by the gradient of area and by the angle that a point lacks, over the area that is nearest to the point (Meyer,
/// Desbrun, Schröder and Barr 2003).
///
/// # Panics
/// When elements refer to points or boundaries that there are not.
pub fn point_curvatures(surface: &Surface<'_>) -> Vec<PointCurvature> {
    let adjacency = Adjacency::of_elements(surface.elements, surface.boundary_of);
    match surface.elements {
        Elements::Triangles(triangles) => in_space(surface, triangles, &adjacency),
        Elements::Refined(mesh) => in_space(surface, &mesh.triangles(), &adjacency),
        Elements::Segments(segments) => plane::curvatures(surface.points, segments, &adjacency.inner.pairs())
            .into_iter()
            .map(|mean| PointCurvature { mean, gaussian: if mean.is_nan() { mean } else { 0.0 } })
            .collect(),
    }
}

/// What the triangles around a point add up to.
#[derive(Debug, Clone, Copy, Default)]
struct Ring {
    angle: f64,
    area: f64,
    /// The gradient of area with the point.
    gradient: DVec3,
    normal: DVec3,
}

fn in_space(surface: &Surface<'_>, triangles: &[[u32; 3]], adjacency: &Adjacency) -> Vec<PointCurvature> {
    let mut rings = vec![Ring::default(); surface.points.len()];
    for triangle in triangles {
        let corners = triangle.map(|corner| surface.points[corner as usize]);
        for k in 0..3 {
            rings[triangle[k] as usize].add([0, 1, 2].map(|turn| corners[(k + turn) % 3]));
        }
    }
    let mut is_inside: Vec<bool> = rings.iter().map(|ring| ring.area > 0.0).collect();
    for at in &adjacency.incidences {
        at.ends(surface.elements).iter().for_each(|end| is_inside[*end as usize] = false);
    }
    let curvature = |(ring, is_inside): (&Ring, bool)| {
        if !is_inside {
            return PointCurvature::NOT_DEFINED;
        }
        // The gradient of area is twice the mean curvature times the area along the normal.
        let mean = 0.5 * ring.gradient.dot(ring.normal.normalize_or_zero()) / ring.area;
        PointCurvature { mean, gaussian: (TAU - ring.angle) / ring.area }
    };
    rings.iter().zip(is_inside).map(curvature).collect()
}

impl Ring {
    /// Adds a triangle with the point as its first corner.
    fn add(&mut self, [at, b, c]: [DVec3; 3]) {
        let (to_b, to_c, across) = (b - at, c - at, c - b);
        let normal = to_b.cross(to_c);
        let double_area = normal.length();
        if double_area == 0.0 {
            return;
        }
        let cotangent = |one: DVec3, other: DVec3| one.dot(other) / double_area;
        let at_corners = [cotangent(to_b, to_c), cotangent(-to_b, across), cotangent(-to_c, -across)];
        self.angle += double_area.atan2(to_b.dot(to_c));
        self.normal += normal;
        self.gradient -= 0.5 * (at_corners[2] * to_b + at_corners[1] * to_c);
        // The part of the triangle that is nearest to the point, or a fixed share where the angles are obtuse.
        self.area += match at_corners.iter().position(|cotangent| *cotangent < 0.0) {
            None => (at_corners[2] * to_b.length_squared() + at_corners[1] * to_c.length_squared()) / 8.0,
            Some(0) => double_area / 4.0,
            Some(_) => double_area / 8.0,
        };
    }
}
