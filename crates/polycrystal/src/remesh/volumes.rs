//! Volumes of grains after remeshing: what chords of curved boundaries take, points get back.

use crate::Freedom;
use crate::Mesh;
use crate::mesh::volume::largest_relative_error;
use crate::remesh::assembled::Assembled;
use crate::solver::least_motion::{MovingPoint, least_motion};

/// What a volume may lack in the end, as a share of it.
pub(crate) const TOLERANCE: f64 = 1e-12;

/// Most corrections: each squares what is missing, until rounding is left.
pub(crate) const STEPS: usize = 8;

/// Moves points so that grains have the volumes of their cells. All move along the gradients of the volumes, the less the more area stands on them; those on walls stay
/// in these.
pub(crate) fn restore(assembled: &mut Assembled) {
    let wanted = assembled.network.cell_volumes().to_vec();
    let mut least = f64::INFINITY;
    for _ in 0..STEPS {
        let points = assembled.points();
        let network = &assembled.network;
        let volumes = network.grain_volumes(network.finest(), &points);
        let mut missing: Vec<f64> = wanted.iter().zip(&volumes).map(|(wanted, is)| wanted - is).collect();
        let (_, error) = largest_relative_error(&missing, &wanted);
        if error <= TOLERANCE || error >= least {
            return;
        }
        least = error;
        // No motion changes the sum, so what rounding leaves of it has no answer.
        let rest = missing.iter().sum::<f64>() / missing.len() as f64;
        missing.iter_mut().for_each(|missing| *missing -= rest);
        let motions = least_motion(&moving_points(assembled, &points), &missing);
        assembled.positions.iter_mut().zip(motions).for_each(|(place, by)| *place += by);
    }
}

fn moving_points(assembled: &Assembled, points: &[glam::DVec3]) -> Vec<MovingPoint> {
    let network = &assembled.network;
    let level = network.finest_level();
    let Mesh::Triangles(mesh) = &level.mesh else { return Vec::new() };
    let mut moving = vec![MovingPoint::default(); assembled.positions.len()];
    for (corners, boundary) in mesh.triangles().iter().zip(&level.boundary_of) {
        let [a, b, c] = corners.map(|corner| points[corner as usize]);
        let normal = (b - a).cross(c - a);
        for corner in corners {
            let point = &mut moving[assembled.originals[*corner as usize].original as usize];
            point.weight += normal.length() / 6.0;
            for (grain, sign) in network.boundaries()[boundary.index()].signed_grains() {
                *point.gradients.entry(grain.0).or_default() += normal * (sign / 6.0);
            }
        }
    }
    let mut freedoms = vec![Freedom::Everywhere; moving.len()];
    for (moved, walls) in assembled.originals.iter().zip(&level.walls) {
        let freedom = &mut freedoms[moved.original as usize];
        *freedom = freedom.and(network.freedom(*walls));
    }
    for (point, freedom) in moving.iter_mut().zip(freedoms) {
        point.gradients.values_mut().for_each(|gradient| *gradient = freedom.project(*gradient));
    }
    moving
}
