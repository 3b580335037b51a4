//! Volumes of grains (areas in the plane) and how they change with the points.

use glam::DVec3;
use rayon::prelude::*;
use voronoi::Dimension;

use crate::mesh::boundary_elements::BoundaryElements;
use crate::mesh::elements::normal;
use crate::mesh::level_points::LevelPoints;
use crate::{Boundary, GrainId, Surface};

/// Error of a volume, as a share of it, up to which it is restored.
pub(crate) const VOLUME_RESTORED: f64 = 1e-12;

/// Error that is accepted where rounding keeps it above that: small grains in large boxes.
pub(crate) const VOLUME_LIMIT: f64 = 1e-10;

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
pub(crate) fn boundary_cones(boundaries: &BoundaryElements<'_>, points: &LevelPoints<'_>) -> Vec<Cone> {
    let dimension = points.elements().dimension();
    let of_boundary = |boundary: usize| {
        let mut sum = ElementSum::default();
        for labelled in boundaries.labelled(boundary) {
            points.for_each_in(*labelled, |corners| {
                sum.add(corners);
            });
        }
        sum.cone(dimension)
    };
    (0..boundaries.boundary_count()).into_par_iter().map(of_boundary).collect()
}

/// The cone from the first point of some elements to them.
pub(crate) fn cone_of_boundary(surface: &Surface<'_>, elements: &[u32]) -> Cone {
    let mut sum = ElementSum::default();
    for element in elements {
        let corners = surface.elements.corners(*element);
        match *corners {
            [a, b, c] => sum.add(&[a, b, c].map(|vertex| surface.points[vertex as usize])),
            [a, b] => sum.add(&[a, b].map(|vertex| surface.points[vertex as usize])),
            _ => unreachable!("elements have two or three points"),
        };
    }
    sum.cone(surface.elements.dimension())
}

/// What elements of a boundary add up to, from the first point of the first.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ElementSum {
    apex: Option<DVec3>,
    volume: f64,
    /// Of all normals.
    normal: DVec3,
}

impl ElementSum {
    /// Adds the element with these corners, and gives its normal, as of [`Elements::normal`](crate::Elements::normal).
    #[inline(always)]
    pub(crate) fn add(&mut self, corners: &[DVec3]) -> DVec3 {
        let apex = *self.apex.get_or_insert(corners[0]);
        let normal = normal(corners);
        self.volume += match *corners {
            [a, b] => segment_area([a - apex, b - apex]),
            _ => (corners[0] - apex).dot(normal) / 6.0,
        };
        self.normal += normal;
        normal
    }

    /// The cone to them.
    pub(crate) fn cone(self, dimension: Dimension) -> Cone {
        let area = match dimension {
            Dimension::Two => self.normal,
            Dimension::Three => self.normal / 2.0,
        };
        Cone::new(self.apex.unwrap_or(DVec3::ZERO), self.volume, area, dimension)
    }
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

/// The largest of what some volumes lack, as a share of them, and whose it is.
///
/// # Panics
/// When there are none.
pub(crate) fn largest_relative_error(missing: &[f64], volumes: &[f64]) -> (GrainId, f64) {
    // What has vanished lacks nothing.
    let of = |(lack, volume): (&f64, &f64)| if *volume == 0.0 { lack.abs() } else { (lack / volume).abs() };
    let relative = missing.iter().zip(volumes).map(of);
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
    use voronoi::{Domain, Tessellation};

    use super::*;
    use crate::{BoundaryId, Elements, Junctions, Network, Side};

    #[test]
    fn volumes_of_a_level_follow_from_the_points_of_the_levels_before() {
        let seeds: Vec<DVec3> =
            (1..=12).map(|k| (DVec3::new(0.819, 0.671, 0.550) * f64::from(k)).fract()).collect();
        for domain in [Domain::unit_cube(), Domain::unit_cube().with_periods(glam::BVec3::TRUE)] {
            let cells = Tessellation::new(&domain, &seeds).expect("valid seeds");
            let (network, points) = Network::new(&cells, Junctions::Corner, 3).expect("a small network");
            for to in 0..=3 {
                for from in 0..=to {
                    let [given, finest] =
                        [from, to].map(|level| network.subdivide_between(0, level, &points));
                    let expected = network.grain_volumes(network.level(to), &finest);
                    let volumes = network
                        .volumes_of(network.level_from_before(to), &network.points_between(from, to, &given));
                    let far = |(a, b): (&f64, &f64)| (a / b - 1.0).abs() > 1e-13;
                    assert_eq!(volumes.iter().zip(&expected).position(far), None, "{from} to {to}");
                }
            }
        }
    }

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
        let surface = Surface { points: &points, elements, boundary_of: &boundary_of, sides: &sides };
        let cones = boundary_cones(
            &BoundaryElements::new(&surface),
            &LevelPoints::held(surface.elements, surface.points),
        );
        let boundaries = sides.map(|sides| Boundary { sides, wall: None, twin: None });
        let volume = volumes_of_grains(&boundaries, &cones, 1)[0];
        assert!((volume / (size.powi(3) / 6.0) - 1.0).abs() < 1e-15, "{volume}");
        let whole: f64 = cones.iter().map(|cone| cone.volume_from(corner)).sum();
        assert!((whole / volume - 1.0).abs() < 1e-15);
    }
}
