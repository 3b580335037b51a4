//! Volumes of grains (areas in the plane) and how they change with the points.

use glam::DVec3;
use rayon::prelude::*;
use voronoi::Dimension;

use crate::{Boundary, BoundaryId, Elements, GrainId, Surface};

/// The volume of the tetrahedron that a triangle spans with the origin.
pub(crate) fn triangle_volume(corners: [DVec3; 3]) -> f64 {
    corners[0].dot(corners[1].cross(corners[2])) / 6.0
}

/// The area between a segment in the plane and the origin, positive when counter-clockwise.
pub(crate) fn segment_area(ends: [DVec3; 2]) -> f64 {
    0.5 * ends[0].truncate().perp_dot(ends[1].truncate())
}

/// The cone (in the plane: the triangle) from an apex to a boundary, positive where the apex lies on its first side.
///
/// A grain is the sum of the cones from one apex to its boundaries. The nearer that is, the more digits they keep.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Cone {
    apex: DVec3,
    volume: f64,
    /// What the cone gains per length by which its apex moves back.
    slope: DVec3,
}

impl Cone {
    /// A cone of some volume to elements with this sum of normals, each as long as the area (in the plane: the length).
    pub(crate) fn new(apex: DVec3, volume: f64, area: DVec3, dimension: Dimension) -> Self {
        let slope = match dimension {
            Dimension::Two => area / 2.0,
            Dimension::Three => area / 3.0,
        };
        Self { apex, volume, slope }
    }

    /// The volume of the cone from another apex to the same boundary.
    pub(crate) fn volume_from(&self, apex: DVec3) -> f64 {
        self.volume + self.slope.dot(self.apex - apex)
    }
}

/// Per boundary, the cone from a point of it.
pub(crate) fn boundary_cones(surface: &Surface<'_>) -> Vec<Cone> {
    let mut apexes = vec![None; surface.sides.len()];
    for (element, boundary) in (0u32..).zip(surface.boundary_of) {
        let first = || surface.points[surface.elements.corners(element)[0] as usize];
        apexes[boundary.index()].get_or_insert_with(first);
    }
    let from_apex = |vertex: u32, boundary: &BoundaryId| {
        surface.points[vertex as usize] - apexes[boundary.index()].unwrap_or_default()
    };
    let of_elements: Vec<(f64, DVec3)> = match surface.elements {
        Elements::Triangles(triangles) => {
            let measure = |(corners, boundary): (&[u32; 3], _)| {
                let [a, b, c] = corners.map(|corner| from_apex(corner, boundary));
                (triangle_volume([a, b, c]), (b - a).cross(c - a) / 2.0)
            };
            triangles.par_iter().zip(surface.boundary_of).map(measure).collect()
        }
        Elements::Segments(segments) => {
            let measure = |(ends, boundary): (&[u32; 2], _)| {
                let [a, b] = ends.map(|end| from_apex(end, boundary));
                (segment_area([a, b]), (b - a).cross(DVec3::Z))
            };
            segments.par_iter().zip(surface.boundary_of).map(measure).collect()
        }
    };
    let dimension = surface.elements.dimension();
    // One thread sums, for the order of a sum decides its last digit.
    let mut sums = vec![(0.0, DVec3::ZERO); surface.sides.len()];
    for ((volume, area), boundary) in of_elements.iter().zip(surface.boundary_of) {
        sums[boundary.index()].0 += volume;
        sums[boundary.index()].1 += *area;
    }
    let cone = |(apex, (volume, area)): (Option<DVec3>, (f64, DVec3))| {
        Cone::new(apex.unwrap_or_default(), volume, area, dimension)
    };
    apexes.into_iter().zip(sums).map(cone).collect()
}

/// A volume that cones add up to, all from the apex of the first.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ConeSum {
    apex: Option<DVec3>,
    pub(crate) volume: f64,
}

impl ConeSum {
    pub(crate) fn add(&mut self, cone: &Cone, sign: f64) {
        let apex = *self.apex.get_or_insert(cone.apex);
        self.volume += sign * cone.volume_from(apex);
    }
}

/// A last place of the largest coordinate.
pub(crate) fn last_place(points: &[DVec3]) -> f64 {
    let largest = points.par_iter().map(|point| point.abs().max_element()).reduce(|| 0.0, f64::max);
    f64::EPSILON * largest
}

/// What a surface of some area sweeps where each coordinate of its points is off by so much.
pub(crate) fn swept_by_rounding(rounding: f64, area: f64) -> f64 {
    rounding * 3f64.sqrt() * area
}

/// The largest of what some volumes lack, as a share of them, and whose it is.
///
/// # Panics
/// When there are none.
pub(crate) fn largest_relative_error(missing: &[f64], volumes: &[f64]) -> (GrainId, f64) {
    let relative = missing.iter().zip(volumes).map(|(lack, volume)| (lack / volume).abs());
    let errors = (0u32..).map(GrainId).zip(relative);
    errors.max_by(|a, b| a.1.total_cmp(&b.1)).expect("a network has grains")
}

/// The volume of each grain (in the plane: its area), measured from a point of it.
pub(crate) fn volumes_of_grains(boundaries: &[Boundary], cones: &[Cone], grain_count: usize) -> Vec<f64> {
    let mut sums = vec![ConeSum::default(); grain_count];
    for (boundary, cone) in boundaries.iter().zip(cones) {
        for (grain, sign) in boundary.signed_grains() {
            sums[grain.index()].add(cone, sign);
        }
    }
    sums.into_iter().map(|sum| sum.volume).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Side;

    /// From the origin of coordinates, a volume of 1e-21 at a distance of 1 would drown in rounding.
    #[test]
    fn a_small_grain_far_from_the_origin_keeps_its_digits() {
        let size = 2f64.powi(-23);
        let corner = DVec3::new(1.0, 1.0, 0.5);
        let points = [corner, corner + DVec3::X * size, corner + DVec3::Y * size, corner + DVec3::Z * size];
        let triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let boundary_of = [0, 1, 2, 3].map(BoundaryId);
        let sides = [[Side::Grain(GrainId(0)), Side::Exterior]; 4];
        let elements = Elements::Triangles(&triangles);
        let cones =
            boundary_cones(&Surface { points: &points, elements, boundary_of: &boundary_of, sides: &sides });
        let boundaries = sides.map(|sides| Boundary { sides, wall: None, twin: None });
        let volume = volumes_of_grains(&boundaries, &cones, 1)[0];
        assert!((volume / (size.powi(3) / 6.0) - 1.0).abs() < 1e-15, "{volume}");
        let whole: f64 = cones.iter().map(|cone| cone.volume_from(corner)).sum();
        assert!((whole / volume - 1.0).abs() < 1e-15);
    }
}
