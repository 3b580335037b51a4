//! A boundary as it is: the smooth surface that new points stay on.

use glam::DVec3;

use crate::check::box_tree::{Bounds, BoxTree};
use crate::mesh::id::id;

/// The triangles of a boundary on the finest level, by numbers of their own.
pub(crate) struct Reference {
    pub(crate) points: Vec<DVec3>,
    pub(crate) normals: Vec<DVec3>,
    pub(crate) sizes: Vec<f64>,
    pub(crate) triangles: Vec<[u32; 3]>,
    tree: BoxTree,
}

/// A point of the smooth surface, and what is there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Foot {
    pub(crate) place: DVec3,
    /// Of the surface.
    pub(crate) normal: DVec3,
    /// That edges are to have.
    pub(crate) size: f64,
    /// The triangle that it is in: a start for the next search near here.
    pub(crate) triangle: u32,
}

impl Reference {
    pub(crate) fn new(points: Vec<DVec3>, sizes: Vec<f64>, triangles: Vec<[u32; 3]>) -> Self {
        let mut normals = vec![DVec3::ZERO; points.len()];
        for corners in &triangles {
            let [a, b, c] = corners.map(|corner| points[corner as usize]);
            let normal = (b - a).cross(c - a);
            corners.iter().for_each(|corner| normals[*corner as usize] += normal);
        }
        normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
        let bounds = |triangle: u32| {
            Bounds::around(triangles[triangle as usize].map(|corner| points[corner as usize]))
        };
        let tree = BoxTree::new((0..id(triangles.len())).collect(), bounds);
        Self { points, normals, sizes, triangles, tree }
    }

    /// The nearest point of the surface; `near` is a triangle not far from it.
    pub(crate) fn foot(&self, point: DVec3, near: u32) -> Foot {
        let squared = |triangle: u32| {
            let (place, _) = self.nearest_in(triangle, point);
            place.distance_squared(point)
        };
        let triangle = self.tree.nearest(point, (near, squared(near)), squared);
        let (place, weights) = self.nearest_in(triangle, point);
        let corners = self.triangles[triangle as usize];
        let mean = |of: [f64; 3]| weights[0] * of[0] + weights[1] * of[1] + weights[2] * of[2];
        let normals = corners.map(|corner| self.normals[corner as usize]);
        let normal = normals[0] * weights[0] + normals[1] * weights[1] + normals[2] * weights[2];
        let size = mean(corners.map(|corner| self.sizes[corner as usize]));
        Foot { place, normal: normal.normalize_or_zero(), size, triangle }
    }

    fn nearest_in(&self, triangle: u32, point: DVec3) -> (DVec3, [f64; 3]) {
        nearest_in_triangle(
            self.triangles[triangle as usize].map(|corner| self.points[corner as usize]),
            point,
        )
    }
}

/// The point of a triangle nearest to another one, and its barycentric coordinates. Ericson, Real-Time Collision Detection (2005), 5.1.5.
fn nearest_in_triangle([a, b, c]: [DVec3; 3], point: DVec3) -> (DVec3, [f64; 3]) {
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

    /// Beside every corner and edge, and above and within the triangle.
    #[test]
    fn the_nearest_point_of_a_triangle_is_nearer_than_all_others() {
        let corners = [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.5, 1.5, 0.0)];
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

    #[test]
    fn a_foot_has_the_size_and_normal_of_its_place() {
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        let reference = Reference::new(points, vec![1.0, 3.0, 3.0, 1.0], vec![[0, 1, 2], [0, 2, 3]]);
        for near in 0..2 {
            let foot = reference.foot(DVec3::new(0.75, 0.5, 0.2), near);
            assert_eq!((foot.place, foot.normal), (DVec3::new(0.75, 0.5, 0.0), DVec3::Z));
            assert_eq!((foot.size, foot.triangle), (2.5, 0));
        }
    }
}
