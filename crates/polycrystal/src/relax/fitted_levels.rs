//! Levels of subdivision whose points stay near those that are there.

use glam::DVec3;

use crate::check::box_tree::{Bounds, BoxTree};
use crate::check::certificate::Faults;
use crate::flow::boundary_flow::{Flow, has_kept_volumes};
use crate::mesh::id::id;
use crate::validate::certificate;
use crate::{Certificate, Fault, Network, NetworkError, Surface, Tuning, Volumes};

/// Rounds of the fit.
const ROUNDS: usize = 5;

/// Attempts, each with wider places flat around faults of the one before; in the last one all is flat.
const ATTEMPTS: usize = 6;

/// How far around a fault all stays flat at first, in units of the edge of a cube as large as the mean grain; each further attempt doubles it.
const FLAT_AROUND: f64 = 0.1;

/// A network on the finest level alone, its points, and what it is like.
#[derive(Debug, Clone)]
pub struct Subdivided {
    /// The network; only its finest level is there.
    pub network: Network,
    /// The points of that level.
    pub points: Vec<DVec3>,
    /// What it is like. Its only faults are folds.
    pub certificate: Certificate,
}

impl Network {
    /// The network refined `level_count` times more, whose grains have their volumes. The points of the finest level that there is now, which are given, stay nearly where they are.
    ///
    /// Subdivision alone would take boundaries further inward where they are curved. So control points go outward by as much, several times (progressive interpolation: Cheng and others,
    /// Loop subdivision surface based progressive interpolation, 2009). Where boundaries then cross, or more elements fold than before, new points go onto the old elements.
    ///
    /// # Errors
    /// [`NetworkError::TooLarge`]; [`NetworkError::Invalid`] where the given points have faults other than folds.
    ///
    /// # Panics
    /// When there is not one point per vertex.
    pub fn subdivided(&self, points: &[DVec3], level_count: usize) -> Result<Subdivided, NetworkError> {
        let divided = self.divided(level_count)?;
        let flat = divided.divide(points);
        let fitted = fitted(&divided, points);
        let network = divided.with_level(divided.finest_level().into_owned());
        drop(divided);
        let folds = certificate(self, points, self.cell_volumes()).faults.0.len();
        let flow = Flow::new(&network, 0, Volumes::Kept, network.mean_tension(), Tuning::default());
        let edge = FLAT_AROUND * self.mean_grain_size();
        let mut is_flat = vec![false; flat.len()];
        for attempt in 0..ATTEMPTS {
            let is_last = attempt + 1 == ATTEMPTS;
            if is_last {
                is_flat.fill(true);
            }
            let places = flat.iter().zip(&fitted).zip(&is_flat);
            let mut points: Vec<DVec3> =
                places.map(|((flat, fitted), is_flat)| if *is_flat { *flat } else { *fitted }).collect();
            if !has_kept_volumes(&network, 0, &points) && flow.restore_volumes(&mut points).is_err() {
                // No single place is at fault.
                is_flat.fill(true);
                continue;
            }
            let certificate = certificate(&network, &points, network.cell_volumes());
            let is_fold = |fault: &Fault| matches!(fault, Fault::Folded { .. });
            let Faults(faults) = &certificate.faults;
            if faults.iter().all(is_fold) && (faults.len() <= folds || is_last) {
                return Ok(Subdivided { network, points, certificate });
            }
            if is_last {
                return Err(NetworkError::Invalid(certificate.faults));
            }
            let sides = network.sides();
            let surface = Surface::of_level(network.finest(), &points, &sides);
            let within = edge * 2.0_f64.powi(i32::try_from(attempt).expect("attempts are few"));
            flatten(&mut is_flat, &surface, faults, within);
        }
        unreachable!("the last attempt returns")
    }
}

/// The finest points for control points that subdivision takes to those that are given.
fn fitted(divided: &Network, points: &[DVec3]) -> Vec<DVec3> {
    let mut control_points = points.to_vec();
    let mut reached = divided.subdivide(&control_points);
    for _ in 0..ROUNDS {
        // The first points of each level are those of the level before.
        let missed = points.iter().zip(&reached).map(|(point, reached)| *point - *reached);
        control_points.iter_mut().zip(missed).for_each(|(control, missed)| *control += missed);
        reached = divided.subdivide(&control_points);
    }
    reached
}

/// Marks all points so far around faults, and of copies of a fault in the box.
fn flatten(is_flat: &mut [bool], surface: &Surface<'_>, faults: &[Fault], within: f64) {
    let positions: Vec<DVec3> = faults.iter().filter_map(|fault| fault.position(surface)).collect();
    let Some(first) = positions.first() else { return is_flat.fill(true) };
    let around = |position: u32| Bounds::around([positions[position as usize]]);
    let tree = BoxTree::new((0..id(positions.len())).collect(), around);
    for (point, is_flat) in surface.points.iter().zip(is_flat) {
        let squared = |position: u32| positions[position as usize].distance_squared(*point);
        let nearest = tree.nearest(*point, (0, first.distance_squared(*point)), squared);
        *is_flat |= squared(nearest) < within * within;
    }
}
