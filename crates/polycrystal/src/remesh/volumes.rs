//! Volumes of grains after remeshing: what chords of curved boundaries take, points get back.

use glam::DVec3;
use voronoi::Dimension;

use crate::mesh::volume::{VOLUME_RESTORED, largest_relative_error};
use crate::remesh::assembled::Assembled;
use crate::remesh::torus::Moved;
use crate::solver::least_motion::{MovingPoint, least_motion};
use crate::{Elements, Freedom, Network, WallSet};

/// Most corrections: each squares what is missing, until rounding is left.
const STEPS: usize = 8;

/// Moves points so that grains have the volumes of their cells. All move along the gradients of the volumes, in proportion to the area that stands on them; those on walls stay
/// in these. So points of small triangles hardly move. If all moved as far, those in narrow corners would cross what is near: of 20 networks of 200 grains cut at their box, 7 did.
pub(crate) fn restore(assembled: &mut Assembled) {
    let wanted = assembled.network.cell_volumes().to_vec();
    let volumes = |assembled: &Assembled| {
        assembled.network.grain_volumes(assembled.network.finest(), &assembled.points())
    };
    let move_by = |assembled: &mut Assembled, motions: Vec<DVec3>| {
        assembled.positions.iter_mut().zip(motions).for_each(|(place, by)| *place += by);
    };
    let is_sum_fixed = assembled.network.fills_domain();
    restore_by(assembled, (&wanted, is_sum_fixed), volumes, moving_points, move_by);
}

/// Moves points until volumes are those wanted, or as near as rounding allows; whether no motion changes their sum, because grains fill their domain. Returns the largest error, as a
/// share of a volume.
pub(crate) fn restore_by<Points>(
    points: &mut Points,
    (wanted, is_sum_fixed): (&[f64], bool),
    volumes: impl Fn(&Points) -> Vec<f64>,
    moving: impl Fn(&Points) -> Vec<MovingPoint>,
    move_by: impl Fn(&mut Points, Vec<DVec3>),
) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..STEPS {
        let mut missing: Vec<f64> =
            wanted.iter().zip(volumes(points)).map(|(wanted, is)| wanted - is).collect();
        let (_, error) = largest_relative_error(&missing, wanted);
        if error <= VOLUME_RESTORED || error >= least {
            return error;
        }
        least = error;
        if is_sum_fixed {
            // What rounding leaves of the sum has no answer. Each grain takes of it by its volume: an even share may be more than a small one has.
            let rest = missing.iter().sum::<f64>() / wanted.iter().sum::<f64>();
            missing.iter_mut().zip(wanted).for_each(|(missing, wanted)| *missing -= rest * wanted);
        }
        let motions = least_motion(&moving(points), &missing);
        move_by(points, motions);
    }
    least
}

/// Keeps points on the walls of all their copies.
pub(crate) fn hold_on_walls<'a>(
    network: &Network,
    moving: &mut [MovingPoint],
    copies: impl Iterator<Item = (&'a Moved<u32>, &'a WallSet)>,
) {
    let mut freedoms = vec![Freedom::Everywhere; moving.len()];
    for (moved, walls) in copies {
        let freedom = &mut freedoms[moved.original as usize];
        *freedom = freedom.and(network.freedom(*walls));
    }
    for (point, freedom) in moving.iter_mut().zip(freedoms) {
        point.gradients.values_mut().for_each(|gradient| *gradient = freedom.project(*gradient));
    }
}

fn moving_points(assembled: &Assembled) -> Vec<MovingPoint> {
    let (network, points) = (&assembled.network, assembled.points());
    let level = network.finest_level();
    let elements = Elements::from(&level.mesh);
    // A normal is twice as long as a triangle's area, of which each corner has a third; or as long as a segment.
    let share = match elements.dimension() {
        Dimension::Two => 1.0 / 2.0,
        Dimension::Three => 1.0 / 6.0,
    };
    let mut moving = vec![MovingPoint { weight: 1.0, ..MovingPoint::default() }; assembled.positions.len()];
    for (element, boundary) in (0u32..).zip(&level.boundary_of) {
        let normal = elements.normal(&points, element);
        for corner in elements.corners(element).iter() {
            let point = &mut moving[assembled.originals[*corner as usize].original as usize];
            for (grain, sign) in network.boundaries()[boundary.index()].signed_grains() {
                *point.gradients.entry(grain.0).or_default() += normal * (sign * share);
            }
        }
    }
    hold_on_walls(network, &mut moving, assembled.originals.iter().zip(&level.walls));
    moving
}
