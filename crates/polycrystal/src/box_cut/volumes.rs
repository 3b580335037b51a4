//! Volumes after points have moved: what grains lack, they get back along their boundaries away from the planes of the box.

use glam::DVec3;

use crate::box_cut::Piece;
use crate::box_cut::pieces::Pieces;
use crate::check::certificate::VOLUME_TOLERANCE;
use crate::mesh::volume::VOLUME_RESTORED;
use crate::solver::least_motion::{MovingPoint, least_motion};
use crate::{Freedom, GrainId, NetworkError, Side};

/// Most corrections: each gains several digits, for points hardly move.
const STEPS: usize = 12;

/// Moves points so that grains have the given volumes.
///
/// # Errors
/// [`NetworkError::VolumeNotRestored`] where the certificate would refuse a volume.
pub(crate) fn restore(pieces: &mut Pieces, caps: &[Piece], volumes: &[f64]) -> Result<(), NetworkError> {
    let mut steps = 0;
    loop {
        let is = measured(pieces, caps, volumes.len());
        // Grains that have vanished have no volume.
        let error = |is: f64, wanted: f64| if wanted > 0.0 { (is - wanted).abs() / wanted } else { 0.0 };
        let errors = is.iter().zip(volumes).map(|(is, wanted)| error(*is, *wanted));
        let (grain, relative_error) =
            (0..).zip(errors).max_by(|a, b| a.1.total_cmp(&b.1)).expect("a network has grains");
        if relative_error <= VOLUME_RESTORED || steps == STEPS && relative_error <= VOLUME_TOLERANCE {
            return Ok(());
        }
        if steps == STEPS {
            return Err(NetworkError::VolumeNotRestored { grain: GrainId(grain), relative_error });
        }
        let missing: Vec<f64> = volumes.iter().zip(is).map(|(wanted, is)| wanted - is).collect();
        correct(pieces, &missing);
        steps += 1;
    }
}

/// The volume of each grain, from a corner of it.
fn measured(pieces: &Pieces, caps: &[Piece], count: usize) -> Vec<f64> {
    let mut volumes = vec![0.0; count];
    let mut apexes = vec![None; count];
    for piece in pieces.pieces.iter().chain(caps) {
        let corners = [0, 1, 2].map(|k| pieces.position(piece.corners[k]));
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
    let mut points = vec![MovingPoint::default(); pieces.positions.len()];
    for piece in &pieces.pieces {
        let [a, b, c] = [0, 1, 2].map(|k| pieces.position(piece.corners[k]));
        let normal = (b - a).cross(c - a);
        for corner in &piece.corners {
            let point = &mut points[corner.vertex as usize];
            point.weight += normal.length() / 6.0;
            for (side, sign) in piece.sides.iter().zip([1.0, -1.0]) {
                if let Side::Grain(grain) = side {
                    *point.gradients.entry(grain.0).or_default() += normal * (sign / 6.0);
                }
            }
        }
    }
    for (number, point) in points.iter_mut().enumerate() {
        let freedom = freedom(pieces, number);
        point.gradients.values_mut().for_each(|gradient| *gradient = freedom.project(*gradient));
    }
    let motions = least_motion(&points, missing);
    pieces.positions.iter_mut().zip(motions).for_each(|(position, by)| *position += by);
}

/// Points in planes of the box stay; those on walls stay in these.
fn freedom(pieces: &Pieces, point: usize) -> Freedom {
    if pieces.planes[point].contains(&true) {
        return Freedom::Nowhere;
    }
    let (domain, position) = (&pieces.domain, pieces.positions[point]);
    let walls = (0..3).filter(|axis| {
        !domain.periodic().test(*axis)
            && [domain.lower()[*axis], domain.upper()[*axis]].contains(&position[*axis])
    });
    walls.fold(Freedom::Everywhere, |freedom, axis| freedom.and(Freedom::InPlane(DVec3::AXES[axis])))
}
