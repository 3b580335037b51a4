use glam::DVec3;

use crate::mesh::adjacency::Incidence;
use crate::{Elements, Side, Surface};

/// Mean and spread of the angles between boundaries, in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngleStatistics {
    /// Mean; 120 degrees wherever three boundaries meet.
    pub mean: f64,
    /// Standard deviation.
    pub standard_deviation: f64,
}

impl AngleStatistics {
    /// Those of some angles; nothing where all weights are 0.
    pub fn of(angles: impl IntoIterator<Item = WeightedAngle>) -> Option<Self> {
        // Sums of weight, weight * angle and weight * angle^2.
        let mut sums = [0.0; 3];
        for WeightedAngle { degrees, weight } in angles {
            for (sum, power) in sums.iter_mut().zip([1.0, degrees, degrees * degrees]) {
                *sum += weight * power;
            }
        }
        let [weight, first, second] = sums;
        (weight > 0.0).then(|| {
            let mean = first / weight;
            Self { mean, standard_deviation: (second / weight - mean * mean).max(0.0).sqrt() }
        })
    }
}

/// An angle between two boundaries at a triple line, in the plane at a triple point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedAngle {
    /// The angle that the grain between them fills, from 0 to 360 degrees.
    pub degrees: f64,
    /// The length of the line over which it holds; in the plane 1.
    pub weight: f64,
}

/// The angles of the grains that meet at those of these places where three do, and not the exterior. Boundaries have these sides.
pub(crate) fn angles<'a>(
    surface: &Surface<'a>,
    sides: &[[Side; 2]],
    places: impl Iterator<Item = &'a [Incidence]>,
) -> impl Iterator<Item = WeightedAngle> {
    let is_interior = |at: &Incidence| !sides[surface.boundary(at.element).index()].contains(&Side::Exterior);
    let triple = places.filter(move |at| at.len() == 3 && at.iter().all(is_interior));
    triple.flat_map(move |at| {
        let weight = edge_length(surface, at);
        dihedral_sectors(surface, sides, at)
            .into_iter()
            .map(move |dihedral_sector| WeightedAngle { degrees: dihedral_sector.angle.to_degrees(), weight })
    })
}

/// A sector around a place where boundaries meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DihedralSector {
    /// What fills it.
    pub(crate) side: Side,
    /// Between the boundaries that bound it, in radians.
    pub(crate) angle: f64,
}

/// The sectors into which boundaries, which have these sides, divide what surrounds a place, in order around it.
pub(crate) fn dihedral_sectors(
    surface: &Surface<'_>,
    sides: &[[Side; 2]],
    at: &[Incidence],
) -> Vec<DihedralSector> {
    let first = EdgePoints::of(surface, &at[0]);
    let axis = match surface.elements {
        Elements::Triangles(_) | Elements::Refined(_) => first.along(),
        Elements::Segments(_) => DVec3::Z,
    };
    let zero = first.leg();
    let quarter = axis.cross(zero);
    let mut directions: Vec<(f64, Side)> = at
        .iter()
        .map(|at| {
            let [first, second] = sides[surface.boundary(at.element).index()];
            let points = EdgePoints::of(surface, at);
            // A triangle that runs along the axis has its second side counter-clockwise of it.
            let is_along = match surface.elements {
                Elements::Triangles(_) | Elements::Refined(_) => (points.end - points.start).dot(axis) > 0.0,
                // A segment that starts here has its first side on the left.
                Elements::Segments(_) => at.corner == 1,
            };
            let leg = points.leg();
            (leg.dot(quarter).atan2(leg.dot(zero)), if is_along { second } else { first })
        })
        .collect();
    directions.sort_by(|a, b| a.0.total_cmp(&b.0));
    let next = directions[1..].iter().map(|(angle, _)| *angle);
    let ends = next.chain([directions[0].0 + std::f64::consts::TAU]);
    directions
        .iter()
        .zip(ends)
        .map(|(&(start, side), end)| DihedralSector { side, angle: end - start })
        .collect()
}

/// The length of an edge; in the plane every point counts alike.
pub(crate) fn edge_length(surface: &Surface<'_>, at: &[Incidence]) -> f64 {
    match surface.elements {
        Elements::Triangles(_) | Elements::Refined(_) => {
            let [start, end] = at[0].ends(surface.elements).map(|end| surface.points[end as usize]);
            start.distance(end)
        }
        Elements::Segments(_) => 1.0,
    }
}

/// The unit vector from an edge into its triangle, square to the edge; in the plane, from a point along its segment.
pub(crate) fn leg(surface: &Surface<'_>, at: &Incidence) -> DVec3 {
    EdgePoints::of(surface, at).leg()
}

/// The ends of an edge as its triangle runs along it, and the triangle's other corner; in the plane, a point twice, and the other end of its segment.
struct EdgePoints {
    start: DVec3,
    end: DVec3,
    other: DVec3,
}

impl EdgePoints {
    #[inline]
    fn of(surface: &Surface<'_>, at: &Incidence) -> Self {
        let corners = surface.elements.corners(at.element);
        let corner = usize::from(at.corner);
        let [start, end, other] = match surface.elements {
            Elements::Triangles(_) | Elements::Refined(_) => [corner, (corner + 1) % 3, (corner + 2) % 3],
            Elements::Segments(_) => [corner, corner, 1 - corner],
        }
        .map(|corner| surface.points[corners[corner] as usize]);
        Self { start, end, other }
    }

    /// The direction of the edge.
    fn along(&self) -> DVec3 {
        (self.end - self.start).normalize_or_zero()
    }

    fn leg(&self) -> DVec3 {
        // A point has no direction.
        (self.other - self.start).reject_from_normalized(self.along()).normalize_or_zero()
    }
}
