use glam::DVec3;

use crate::crease_uses::{CreaseUse, crease_uses};
use crate::{Level, Mesh, Network};

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
    let interior =
        |at: &CreaseUse| network.boundaries()[level.boundary_of[at.element as usize].index()].is_interior();
    let uses = crease_uses(level);
    let triple = uses.chunk_by(|a, b| a.place == b.place);
    let triple = triple.filter(|at| at.len() == 3 && at.iter().all(interior));
    // Sums of weight, weight * angle and weight * angle^2.
    let mut sums = [0.0; 3];
    for at in triple {
        let (weight, legs) = match &level.mesh {
            Mesh::Triangles(_) => legs_at_edge(level, points, at),
            Mesh::Segments(_) => legs_at_vertex(level, points, at),
        };
        for [a, b] in [[0, 1], [1, 2], [2, 0]] {
            let angle = legs[a].dot(legs[b]).clamp(-1.0, 1.0).acos().to_degrees();
            for (sum, power) in sums.iter_mut().zip([1.0, angle, angle * angle]) {
                *sum += weight * power;
            }
        }
    }
    let [weight, first, second] = sums;
    (weight > 0.0).then(|| {
        let mean = first / weight;
        AngleStatistics { mean, standard_deviation: (second / weight - mean * mean).max(0.0).sqrt() }
    })
}

/// The edge's length and the unit vectors from it into its three triangles, square to it.
fn legs_at_edge(level: &Level, points: &[DVec3], uses: &[CreaseUse]) -> (f64, [DVec3; 3]) {
    let Mesh::Triangles(mesh) = &level.mesh else { unreachable!("called for triangles") };
    let [start, end] = mesh.edge(uses[0].place).map(|vertex| points[vertex as usize]);
    let along = (end - start).normalize_or_zero();
    let leg = |at: &CreaseUse| {
        let apex = mesh.triangles()[at.element as usize][usize::from((at.corner + 2) % 3)];
        (points[apex as usize] - start).reject_from_normalized(along).normalize_or_zero()
    };
    (start.distance(end), [leg(&uses[0]), leg(&uses[1]), leg(&uses[2])])
}

/// The unit vectors from a triple point along its three segments; every point counts alike.
fn legs_at_vertex(level: &Level, points: &[DVec3], uses: &[CreaseUse]) -> (f64, [DVec3; 3]) {
    let Mesh::Segments(mesh) = &level.mesh else { unreachable!("called for segments") };
    let leg = |at: &CreaseUse| {
        let other = mesh.segments()[at.element as usize][usize::from(1 - at.corner)];
        (points[other as usize] - points[at.place as usize]).normalize_or_zero()
    };
    (1.0, [leg(&uses[0]), leg(&uses[1]), leg(&uses[2])])
}
