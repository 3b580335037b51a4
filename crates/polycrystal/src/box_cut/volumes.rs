//! Volumes after points have moved: what grains lack, they get back along their boundaries away from the planes of the box.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::box_cut::Piece;
use crate::box_cut::pieces::Pieces;
use crate::solver::conjugate_gradients::{Limits, solve};
use crate::{Freedom, Side};

/// What a volume may lack in the end, as a share of it.
const TOLERANCE: f64 = 1e-12;

/// Most corrections: each gains several digits, for points hardly move.
const STEPS: usize = 12;

/// Residual of the pressures, as a share of what volumes lack.
const SOLVED: f64 = 1e-6;

/// Moves points so that grains have the given volumes.
pub(crate) fn restore(pieces: &mut Pieces, caps: &[Piece], volumes: &[f64]) {
    for _ in 0..STEPS {
        let missing: Vec<f64> = measured(pieces, caps, volumes.len())
            .iter()
            .zip(volumes)
            .map(|(is, wanted)| wanted - is)
            .collect();
        if missing.iter().zip(volumes).all(|(lack, volume)| lack.abs() <= TOLERANCE * volume) {
            return;
        }
        correct(pieces, &missing);
    }
}

/// The volume of each grain, from a corner of it.
fn measured(pieces: &Pieces, caps: &[Piece], count: usize) -> Vec<f64> {
    let mut volumes = vec![0.0; count];
    let mut apexes = vec![None; count];
    for piece in pieces.pieces.iter().chain(caps) {
        let corners = [0, 1, 2].map(|k| pieces.place(piece.corners[k]));
        for (side, sign) in piece.sides.iter().zip([1.0, -1.0]) {
            if let Side::Grain(grain) = side {
                let apex = *apexes[grain.index()].get_or_insert(corners[0]);
                volumes[grain.index()] +=
                    sign * crate::mesh::volume::triangle_volume(corners.map(|corner| corner - apex));
            }
        }
    }
    volumes
}

/// Moves points along the gradients of the grains' volumes, each by the pressure of its grains: a point per area less, where more
/// surface stands on it.
fn correct(pieces: &mut Pieces, missing: &[f64]) {
    // Of each point, its share of the area, and the gradients of the volumes of its grains.
    let mut points: Vec<(f64, BTreeMap<u32, DVec3>)> = vec![(0.0, BTreeMap::new()); pieces.places.len()];
    for piece in &pieces.pieces {
        let [a, b, c] = [0, 1, 2].map(|k| pieces.place(piece.corners[k]));
        let normal = (b - a).cross(c - a);
        for corner in &piece.corners {
            let (area, gradients) = &mut points[corner.point as usize];
            *area += normal.length() / 6.0;
            for (side, sign) in piece.sides.iter().zip([1.0, -1.0]) {
                if let Side::Grain(grain) = side {
                    *gradients.entry(grain.0).or_default() += normal * (sign / 6.0);
                }
            }
        }
    }
    for (point, (_, gradients)) in points.iter_mut().enumerate() {
        let freedom = freedom(pieces, point);
        gradients.values_mut().for_each(|gradient| *gradient = freedom.project(*gradient));
    }
    let mut matrix: Vec<BTreeMap<u32, f64>> = vec![BTreeMap::new(); missing.len()];
    for (area, gradients) in points.iter().filter(|(area, _)| *area > 0.0) {
        for (grain, gradient) in gradients {
            for (other, along) in gradients {
                *matrix[*grain as usize].entry(*other).or_default() += gradient.dot(*along) / area;
            }
        }
    }
    let apply = |pressures: &[f64]| -> Vec<f64> {
        let row = |row: &BTreeMap<u32, f64>| {
            row.iter().map(|(grain, value)| value * pressures[*grain as usize]).sum()
        };
        matrix.iter().map(row).collect()
    };
    let diagonal: Vec<f64> =
        (0u32..).zip(&matrix).map(|(grain, row)| row.get(&grain).copied().unwrap_or(0.0)).collect();
    let precondition = |residual: &[f64]| -> Vec<f64> {
        let entry = |(value, diagonal): (&f64, &f64)| if *diagonal > 0.0 { value / diagonal } else { 0.0 };
        residual.iter().zip(&diagonal).map(entry).collect()
    };
    let limits = Limits { tolerance: SOLVED, steps: 2 * missing.len() + 20 };
    let pressures = solve(apply, precondition, missing, &limits);
    for (place, (area, gradients)) in pieces.places.iter_mut().zip(&points) {
        if *area > 0.0 {
            let by: DVec3 =
                gradients.iter().map(|(grain, gradient)| *gradient * pressures[*grain as usize]).sum();
            *place += by / *area;
        }
    }
}

/// Points in planes of the box stay; those on walls stay in these.
fn freedom(pieces: &Pieces, point: usize) -> Freedom {
    if pieces.planes[point].contains(&true) {
        return Freedom::Nowhere;
    }
    let (domain, place) = (&pieces.domain, pieces.places[point]);
    let walls = (0..3).filter(|axis| {
        !domain.periodic().test(*axis)
            && [domain.lower()[*axis], domain.upper()[*axis]].contains(&place[*axis])
    });
    walls.fold(Freedom::Everywhere, |freedom, axis| freedom.and(Freedom::InPlane(DVec3::AXES[axis])))
}
