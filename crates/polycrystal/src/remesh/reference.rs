//! A boundary as it is: the smooth surface that new points stay on.

use glam::DVec3;

use crate::check::box_tree::{Bounds, BoxTree};
use crate::mesh::id::id;
use crate::mesh::nearest_point::nearest_in_triangle;
use crate::remesh::gradation::Gradation;

/// Distance from a triangle, in units of the size of elements, of what lies in it: no other is nearer by more.
const ROUNDING: f64 = 1e-9;

/// The triangles of a boundary on the finest level, by numbers of their own.
pub(crate) struct Reference {
    pub(crate) points: Vec<DVec3>,
    pub(crate) normals: Vec<DVec3>,
    pub(crate) sizes: Vec<f64>,
    pub(crate) triangles: Vec<[u32; 3]>,
    gradation: Gradation,
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
    pub(crate) fn new(
        points: Vec<DVec3>,
        sizes: Vec<f64>,
        triangles: Vec<[u32; 3]>,
        gradation: Gradation,
    ) -> Self {
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
        Self { points, normals, sizes, triangles, gradation, tree }
    }

    /// The nearest point of the surface; `near` is a triangle not far from it.
    pub(crate) fn foot(&self, point: DVec3, near: u32) -> Foot {
        let squared = |triangle: u32| {
            let (place, _) = self.nearest_in(triangle, point);
            place.distance_squared(point)
        };
        let to_near = squared(near);
        let is_there = to_near <= (ROUNDING * self.gradation.most).powi(2);
        let triangle = if is_there { near } else { self.tree.nearest(point, (near, to_near), squared) };
        let (place, weights) = self.nearest_in(triangle, point);
        let corners = self.triangles[triangle as usize];
        let normals = corners.map(|corner| self.normals[corner as usize]);
        let normal = normals[0] * weights[0] + normals[1] * weights[1] + normals[2] * weights[2];
        let sizes = corners.map(|corner| (self.points[corner as usize], self.sizes[corner as usize]));
        let size = self.gradation.size(place, sizes);
        Foot { place, normal: normal.normalize_or_zero(), size, triangle }
    }

    fn nearest_in(&self, triangle: u32, point: DVec3) -> (DVec3, [f64; 3]) {
        nearest_in_triangle(
            self.triangles[triangle as usize].map(|corner| self.points[corner as usize]),
            point,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_foot_has_the_size_and_normal_of_its_place() {
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        let gradation = Gradation { growth: 1.0, most: 3.0 };
        let triangles = vec![[0, 1, 2], [0, 2, 3]];
        let reference = Reference::new(points, vec![1.0, 3.0, 3.0, 1.0], triangles, gradation);
        for near in 0..2 {
            let foot = reference.foot(DVec3::new(0.75, 0.5, 0.2), near);
            assert_eq!((foot.place, foot.normal), (DVec3::new(0.75, 0.5, 0.0), DVec3::Z));
            assert_eq!((foot.size, foot.triangle), (1.0 + foot.place.length(), 0));
        }
    }
}
