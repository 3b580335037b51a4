//! Measures of each grain and boundary of a surface in space.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use crate::angles::{leg, place_length};
use crate::seams::{Seams, Use};
use crate::{Elements, GrainId, Side, Surface};

/// What a network in space is like. Lengths are in the surface's unit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Measures {
    /// Every grain, in order of the numbers.
    pub grains: Vec<GrainMeasures>,
    /// Every boundary, by number.
    pub boundaries: Vec<BoundaryMeasures>,
}

/// What a grain is like.
#[derive(Debug, Clone, PartialEq)]
pub struct GrainMeasures {
    /// The grain.
    pub grain: GrainId,
    /// Volume.
    pub volume: f64,
    /// Area of its whole surface.
    pub area: f64,
    /// Centre of mass.
    pub centroid: DVec3,
    /// Inertia about the centroid at density 1: the integral of `r^2 I - r r^T`.
    pub inertia: DMat3,
    /// Area of the ball of the same volume over the grain's: 1 for a ball.
    pub sphericity: f64,
    /// Diameter of the ball of the same volume.
    pub equivalent_diameter: f64,
    /// Grains beyond its boundaries, in order; the exterior is none.
    pub neighbors: Vec<GrainId>,
    /// Number of its boundaries.
    pub face_count: usize,
    /// Mean width: that of a ball is its diameter, that of a cube 1.5 times its edge.
    pub mean_width: f64,
    /// Integral of the mean curvature (the mean of the two principal ones, positive where convex) over the surface, edges
    /// between boundaries counted with half their exterior angle: 2 pi times the mean width.
    pub integral_mean_curvature: f64,
    /// Length of its edges where three or more grains meet, none of them the exterior.
    pub triple_line_length: f64,
    /// Rate of volume under curvature flow with unit mobility and tension: `-2 pi (2 w - l / 6)` with the mean width w and the
    /// length l of triple lines (MacPherson and Srolovitz 2007, whose L is 2 w). Nothing at the exterior, where it does not
    /// hold.
    pub growth_rate: Option<f64>,
}

/// What a boundary is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryMeasures {
    /// Its two sides.
    pub sides: [Side; 2],
    /// Area.
    pub area: f64,
    /// Mean over its area of the mean curvature, positive where the first side is convex.
    pub mean_curvature: f64,
}

/// The measures of a surface in space; nothing of lines in the plane.
///
/// The grains must be closed, as [`certify`](crate::certify) finds out. The mean width of a polyhedron is the sum over its edges
/// of length times exterior angle, over 4 pi; concave edges have negative angles (Hadwiger 1957).
///
/// # Panics
/// When elements refer to points or boundaries that there are not.
pub fn measure(surface: &Surface<'_>) -> Measures {
    let Elements::Triangles(triangles) = surface.elements else { return Measures::default() };
    let origin = surface.points.first().copied().unwrap_or(DVec3::ZERO);
    let mut sums = vec![Sums::default(); surface.sides.len()];
    for (triangle, boundary) in triangles.iter().zip(surface.boundary_of) {
        let corners = triangle.map(|corner| surface.points[corner as usize] - origin);
        sums[boundary.index()].add_triangle(corners);
    }
    let seams = Seams::of_elements(surface.elements, surface.boundary_of);
    for pair in &seams.inner {
        let boundary = surface.boundary_of[pair[0] as usize];
        sums[boundary.index()].edges += bend(surface, *pair, &triangles[pair[0] as usize]);
    }
    let boundaries = surface.sides.iter().zip(&sums).map(|(sides, sums)| BoundaryMeasures {
        sides: *sides,
        area: sums.area,
        // An edge has half its angle as the integral of mean curvature across it.
        mean_curvature: if sums.area > 0.0 { 0.5 * sums.edges / sums.area } else { 0.0 },
    });
    let boundaries = boundaries.collect();
    let mut grains: BTreeMap<GrainId, GrainSums> = BTreeMap::new();
    for (sides, sums) in surface.sides.iter().zip(&sums).filter(|(_, sums)| sums.area > 0.0) {
        for (side, beyond, sign) in [(sides[0], sides[1], 1.0), (sides[1], sides[0], -1.0)] {
            if let Side::Grain(grain) = side {
                grains.entry(grain).or_default().add_boundary(sums, beyond, sign);
            }
        }
    }
    for at in seams.places() {
        add_edge(surface, at, &mut grains);
    }
    Measures {
        grains: grains.into_iter().map(|(grain, sums)| sums.measures(grain, origin)).collect(),
        boundaries,
    }
}

/// Integrals over a boundary, and over the cone from the origin to it: positive where its first side is.
#[derive(Debug, Clone, Copy)]
struct Sums {
    area: f64,
    volume: f64,
    first_moment: DVec3,
    second_moment: DMat3,
    /// Lengths of edges times their exterior angles.
    edges: f64,
}

impl Default for Sums {
    /// Nothing yet. What glam calls the default of a matrix is the identity.
    fn default() -> Self {
        Self { area: 0.0, volume: 0.0, first_moment: DVec3::ZERO, second_moment: DMat3::ZERO, edges: 0.0 }
    }
}

impl Sums {
    fn add_triangle(&mut self, [a, b, c]: [DVec3; 3]) {
        let volume = a.dot(b.cross(c)) / 6.0;
        let sum = a + b + c;
        let square = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
        self.area += 0.5 * (b - a).cross(c - a).length();
        self.volume += volume;
        // A tetrahedron's integrals of r and of r r^T, one corner being the origin.
        self.first_moment += sum * (volume / 4.0);
        self.second_moment += (square(a) + square(b) + square(c) + square(sum)) * (volume / 20.0);
    }
}

/// Length times exterior angle of the edge between two triangles of a boundary, positive where its first side is convex.
fn bend(surface: &Surface<'_>, [a, b]: [u32; 2], corners: &[u32; 3]) -> f64 {
    let others = surface.elements.corners(b);
    let Some(apex) = (0..3).find(|k| !others.contains(&corners[*k])) else { return 0.0 };
    let at = |corner: u32| surface.points[corner as usize];
    let [start, end] = [corners[(apex + 1) % 3], corners[(apex + 2) % 3]];
    let Some(beyond) = others.iter().find(|corner| **corner != start && **corner != end) else { return 0.0 };
    let to_beyond = at(*beyond) - at(start);
    at(start).distance(at(end)) * exterior_angle(normal(surface, a), normal(surface, b), to_beyond)
}

/// The angle between outward normals, positive where the body is convex: where what lies beyond the edge is below the first.
fn exterior_angle(normal: DVec3, other: DVec3, beyond: DVec3) -> f64 {
    // The arc cosine would lose the small angles within a boundary.
    let angle = normal.cross(other).length().atan2(normal.dot(other));
    if normal.dot(beyond) > 0.0 { -angle } else { angle }
}

fn normal(surface: &Surface<'_>, element: u32) -> DVec3 {
    let corners = surface.elements.corners(element);
    let [a, b, c] = [0, 1, 2].map(|k| surface.points[corners[k] as usize]);
    (b - a).cross(c - a)
}

/// Adds an edge between boundaries to the grains that have a corner there.
fn add_edge(surface: &Surface<'_>, at: &[Use], grains: &mut BTreeMap<GrainId, GrainSums>) {
    let length = place_length(surface, at);
    let mut sides: Vec<(Side, u32, f64)> = Vec::with_capacity(2 * at.len());
    for (place, at) in (0u32..).zip(at) {
        let [first, second] = surface.sides_of(at.element);
        sides.extend([(first, place, 1.0), (second, place, -1.0)]);
    }
    sides.sort_by_key(|(side, place, _)| (*side, *place));
    let is_inside = sides.iter().all(|(side, ..)| *side != Side::Exterior);
    for pair in sides.chunk_by(|a, b| a.0 == b.0) {
        let (Side::Grain(grain), [one, other]) = (pair[0].0, pair) else { continue };
        let sums = grains.entry(grain).or_default();
        let [one, other] = [one, other].map(|(_, place, sign)| (&at[*place as usize], *sign));
        let outward = |(at, sign): (&Use, f64)| normal(surface, at.element) * sign;
        sums.edges += length * exterior_angle(outward(one), outward(other), leg(surface, other.0));
        if is_inside && at.len() >= 3 {
            sums.triple_line_length += length;
        }
    }
}

#[derive(Debug, Default)]
struct GrainSums {
    sums: Sums,
    edges: f64,
    triple_line_length: f64,
    /// The sides beyond its boundaries.
    beyond: Vec<Side>,
}

impl GrainSums {
    fn add_boundary(&mut self, boundary: &Sums, beyond: Side, sign: f64) {
        self.sums.area += boundary.area;
        self.sums.volume += sign * boundary.volume;
        self.sums.first_moment += sign * boundary.first_moment;
        self.sums.second_moment += boundary.second_moment * sign;
        self.edges += sign * boundary.edges;
        self.beyond.push(beyond);
    }

    fn measures(self, grain: GrainId, origin: DVec3) -> GrainMeasures {
        let Sums { area, volume, first_moment, second_moment, .. } = self.sums;
        let centroid = first_moment / volume;
        let square = DMat3::from_cols(centroid * centroid.x, centroid * centroid.y, centroid * centroid.z);
        let central = second_moment - square * volume;
        let trace = central.x_axis.x + central.y_axis.y + central.z_axis.z;
        let equivalent_diameter = (6.0 * volume / PI).cbrt();
        let mean_width = self.edges / (4.0 * PI);
        let touches_exterior = self.beyond.contains(&Side::Exterior);
        let mut neighbors: Vec<GrainId> = self.beyond.iter().filter_map(|side| side.grain()).collect();
        neighbors.sort_unstable();
        neighbors.dedup();
        let growth_rate = -2.0 * PI * (2.0 * mean_width - self.triple_line_length / 6.0);
        GrainMeasures {
            grain,
            volume,
            area,
            centroid: origin + centroid,
            inertia: DMat3::from_diagonal(DVec3::splat(trace)) - central,
            sphericity: PI * equivalent_diameter.powi(2) / area,
            equivalent_diameter,
            neighbors,
            face_count: self.beyond.len(),
            mean_width,
            integral_mean_curvature: 2.0 * PI * mean_width,
            triple_line_length: self.triple_line_length,
            growth_rate: (!touches_exterior).then_some(growth_rate),
        }
    }
}
