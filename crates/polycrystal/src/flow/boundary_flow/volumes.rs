//! How a flow gives grains the volumes of their cells.

use std::cell::LazyCell;

use cancellation::check_cancelled;
use glam::DVec3;

use crate::flow::assembly::pressure_response;
use crate::flow::boundary_flow::{Flow, TiedPoints, dot};
use crate::mesh::level_points::LevelPoints;
use crate::mesh::rounding::{last_place, swept_by_rounding};
use crate::mesh::volume::{VOLUME_LIMIT, VOLUME_RESTORED, largest_relative_error};
use crate::{GrainId, Network, NetworkError, Volumes};

/// Most by which a volume correction is larger than its gradient asks for, or one over it smaller.
const LARGEST_GAIN: f64 = 2.0;

/// Most Newton steps on the volumes; each gains about a digit, for its gradient is that of a coarser level.
const VOLUME_STEPS: usize = 40;

impl<'a> Flow<'a> {
    /// Makes volumes right where that is asked for; gives the points of the finest level.
    pub(crate) fn restored(&self, points: &mut [DVec3]) -> Result<LevelPoints<'a>, NetworkError> {
        match self.volumes {
            Volumes::Kept => self.restore_volumes(points),
            Volumes::Free => Ok(self.finest_points(points)),
        }
    }

    /// Moves points so that the grains of the finest level have the volumes of their cells; gives the points of that level.
    ///
    /// Where short edges that are rigid leave some grain no way to change its volume, nothing is rigid.
    pub(crate) fn restore_volumes(&self, points: &mut [DVec3]) -> Result<LevelPoints<'a>, NetworkError> {
        let start = points.to_vec();
        let mut attempts = Vec::new();
        match self.restore_with(&self.with_short_edges(&self.copies, points), &start, points) {
            Err(error) if error.is_tangle() => {
                error.give_up("restoring volumes, short edges rigid", &mut attempts);
            }
            result => return result,
        }
        points.copy_from_slice(&start);
        self.restore_with(&self.copies, &start, points).map_err(|error| error.after(attempts))
    }

    /// The same for groups of points that move as one; `start` is where the points are.
    fn restore_with(
        &self,
        groups: &TiedPoints,
        start: &[DVec3],
        points: &mut [DVec3],
    ) -> Result<LevelPoints<'a>, NetworkError> {
        // Where volumes are right already, nothing is asked of it.
        let response = LazyCell::new(|| {
            let groups = groups.number();
            let terms = self.patches.terms(start);
            let response =
                pressure_response(self.network, &self.patches, terms, &self.unknowns(start, &groups));
            (groups, response)
        });
        let mut last: Option<Vec<f64>> = None;
        // The gradient is that of a coarser level: what is too small or large in it is measured and made up for.
        let mut gain = 1.0;
        let mut step = 0;
        loop {
            check_cancelled();
            let surface = self.finest_points(points);
            let missing = self.missing(&volumes_at_end(self.network, &surface));
            let (grain, relative_error) = self.largest_error(&missing);
            let mut stalled = false;
            if let Some(last) = &last {
                let left = dot(&missing, last) / dot(last, last);
                stalled = relative_error > 0.5 * self.largest_error(last).1;
                gain = (gain / (1.0 - left)).clamp(1.0 / LARGEST_GAIN, LARGEST_GAIN);
            }
            let is_right = relative_error <= VOLUME_RESTORED
                || stalled && is_rounding(self.network, &missing, self.level, points);
            if is_right {
                return Ok(surface);
            }
            // What corrections are made of takes as much memory.
            drop(surface);
            let (groups, response) = &*response;
            // A correction that makes things worse (NaN included) would only be followed by others, and what moves as a whole stays as wrong as it is.
            let is_hopeless = relative_error.is_nan() || relative_error >= 1.0 || !response.can_change(grain);
            if step == VOLUME_STEPS || is_hopeless {
                return Err(NetworkError::volume_not_restored(grain, relative_error));
            }
            let wanted: Vec<f64> = missing.iter().map(|lack| gain * lack).collect();
            let moves = groups.of_points(&response.displacement(&wanted));
            points.iter_mut().zip(&moves).for_each(|(point, by)| *point += *by);
            last = Some(missing);
            step += 1;
        }
    }

    /// What each grain's volume lacks.
    pub(crate) fn missing(&self, volumes: &[f64]) -> Vec<f64> {
        missing_volumes(self.network, volumes)
    }

    fn largest_error(&self, missing: &[f64]) -> (GrainId, f64) {
        largest_relative_error(missing, self.network.cell_volumes())
    }
}

/// Whether grains have the volumes of their cells on the finest level, up to rounding, for the points of a level.
pub(crate) fn has_kept_volumes(network: &Network, level: usize, points: &[DVec3]) -> bool {
    let surface = network.points_between(level, network.level_count(), points);
    let missing = missing_volumes(network, &volumes_at_end(network, &surface));
    let (_, relative_error) = largest_relative_error(&missing, network.cell_volumes());
    relative_error <= VOLUME_LIMIT || is_rounding(network, &missing, level, points)
}

/// The volumes of grains on the finest level, which has these points.
fn volumes_at_end(network: &Network, surface: &LevelPoints<'_>) -> Vec<f64> {
    network.volumes_of(network.level_from_before(network.level_count()), surface)
}

/// What each grain's volume lacks.
fn missing_volumes(network: &Network, volumes: &[f64]) -> Vec<f64> {
    network.cell_volumes().iter().zip(volumes).map(|(cell, grain)| cell - grain).collect()
}

/// Whether rounding may be all that volumes lack: that of the points themselves, and what else is accepted.
fn is_rounding(network: &Network, missing: &[f64], level: usize, points: &[DVec3]) -> bool {
    let surface = network.subdivide_between(level, network.level_count(), points);
    let areas = network.grain_areas(network.finest(), &surface);
    let rounding = last_place(&surface);
    let mut grains = missing.iter().zip(network.cell_volumes().iter().zip(areas));
    grains
        .all(|(lack, (volume, area))| lack.abs() <= VOLUME_LIMIT * volume + swept_by_rounding(rounding, area))
}
