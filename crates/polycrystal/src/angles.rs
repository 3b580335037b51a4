use glam::DVec3;

use crate::seams::{Seams, Use};
use crate::{Elements, Level, Network, Side, Surface};

/// Mean and spread of the angles between boundaries, in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngleStatistics {
    /// Mean; 120 degrees wherever three boundaries meet.
    pub mean: f64,
    /// Standard deviation.
    pub standard_deviation: f64,
}

/// The angles between the three boundaries at triple lines inside the domain, weighted by length; in the plane, at triple
/// points. Nothing when there is no such place.
///
/// Random Voronoi grains have 120 +- 23.8 degrees, equilibrium has 120 +- 0.
pub fn dihedral_angles(network: &Network, level: &Level, points: &[DVec3]) -> Option<AngleStatistics> {
    let sides = network.sides();
    angle_statistics(&Surface::of_level(level, points, &sides), &Seams::of_level(level))
}

/// An angle between two boundaries at a triple line, in the plane at a triple point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedAngle {
    /// The angle, from 0 to 180 degrees.
    pub degrees: f64,
    /// The length of the line over which it holds; in the plane 1.
    pub weight: f64,
}

/// All angles that [`dihedral_angles`] takes the statistics of: three at each edge of a triple line.
pub fn angles_between_boundaries(network: &Network, level: &Level, points: &[DVec3]) -> Vec<WeightedAngle> {
    let sides = network.sides();
    angles(&Surface::of_level(level, points, &sides), &Seams::of_level(level)).collect()
}

fn angles(surface: &Surface<'_>, seams: &Seams) -> impl Iterator<Item = WeightedAngle> {
    let is_interior = |at: &Use| !surface.sides_of(at.element).contains(&Side::Exterior);
    let triple = seams.places().filter(move |at| at.len() == 3 && at.iter().all(is_interior));
    triple.flat_map(|at| {
        let weight = place_length(surface, at);
        let legs = [0, 1, 2].map(|k| leg(surface, &at[k]));
        [[0, 1], [1, 2], [2, 0]].map(|[a, b]| {
            let degrees = legs[a].dot(legs[b]).clamp(-1.0, 1.0).acos().to_degrees();
            WeightedAngle { degrees, weight }
        })
    })
}

/// The same of any surface.
pub(crate) fn angle_statistics(surface: &Surface<'_>, seams: &Seams) -> Option<AngleStatistics> {
    // Sums of weight, weight * angle and weight * angle^2.
    let mut sums = [0.0; 3];
    for WeightedAngle { degrees, weight } in angles(surface, seams) {
        for (sum, power) in sums.iter_mut().zip([1.0, degrees, degrees * degrees]) {
            *sum += weight * power;
        }
    }
    let [weight, first, second] = sums;
    (weight > 0.0).then(|| {
        let mean = first / weight;
        AngleStatistics { mean, standard_deviation: (second / weight - mean * mean).max(0.0).sqrt() }
    })
}

/// The length of an edge; in the plane every point counts alike.
pub(crate) fn place_length(surface: &Surface<'_>, at: &[Use]) -> f64 {
    match surface.elements {
        Elements::Triangles(_) => {
            let [start, end] = at[0].ends(surface.elements).map(|end| surface.points[end as usize]);
            start.distance(end)
        }
        Elements::Segments(_) => 1.0,
    }
}

/// The unit vector from an edge into its triangle, square to the edge; in the plane, from a point along its segment.
pub(crate) fn leg(surface: &Surface<'_>, at: &Use) -> DVec3 {
    let corners = surface.elements.corners(at.element);
    let [start, end] = at.ends(surface.elements).map(|end| surface.points[end as usize]);
    match surface.elements {
        Elements::Triangles(_) => {
            let apex = surface.points[corners[usize::from((at.corner + 2) % 3)] as usize];
            let along = (end - start).normalize_or_zero();
            (apex - start).reject_from_normalized(along).normalize_or_zero()
        }
        Elements::Segments(_) => {
            let other = surface.points[corners[usize::from(1 - at.corner)] as usize];
            (other - start).normalize_or_zero()
        }
    }
}
