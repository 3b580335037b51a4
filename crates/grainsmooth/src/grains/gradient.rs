//! Diameters that change along an axis.

use glam::DVec3;

use crate::config::gradient::GradientSource;
use crate::input::size_file::read_gradient_file;
use crate::{Config, Error};

/// Parts of the box in which the number of grains is summed up: its share in each is right to a millionth where the factor is tenfold.
const PARTS: usize = 4096;

/// What diameters are multiplied by along an axis of a box, in the frame in which grains are computed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Gradient {
    axis: usize,
    axes: i32,
    side: f64,
    /// Positions along the axis and factors; between them linear, beyond them constant.
    table: Vec<[f64; 2]>,
    /// The share of the grains that are below the end of each part of the box.
    shares: Vec<f64>,
    /// The mean of the volumes' factors over all grains.
    mean_volume_factor: f64,
}

impl Gradient {
    /// The gradient that a config asks for, if it does.
    ///
    /// # Errors
    /// [`Error::Unreadable`]; [`Error::BadLine`].
    pub(crate) fn of_config(config: &Config) -> Result<Option<Self>, Error> {
        let Some(GradientSource { axis, path }) = &config.sizes.gradient else { return Ok(None) };
        let stretch = config.stretch()[*axis];
        let mut table = read_gradient_file(path)?;
        table.iter_mut().for_each(|[position, _]| *position /= stretch);
        let axes = i32::from(config.dimension.axes());
        let side = config.box_size[*axis] / stretch;
        let mut gradient =
            Self { axis: *axis, axes, side, table, shares: Vec::new(), mean_volume_factor: 1.0 };
        // As many grains stand somewhere as there is room for.
        let part = |part: usize| gradient.factor((part as f64 + 0.5) * side / PARTS as f64).powi(-axes);
        let densities: Vec<f64> = (0..PARTS).map(part).collect();
        let total: f64 = densities.iter().sum();
        let mut sum = 0.0;
        gradient.shares = densities
            .iter()
            .map(|density| {
                sum += density;
                sum / total
            })
            .collect();
        gradient.mean_volume_factor = PARTS as f64 / total;
        Ok(Some(gradient))
    }

    /// The mean of what volumes are multiplied by, over all grains.
    pub(crate) fn mean_volume_factor(&self) -> f64 {
        self.mean_volume_factor
    }

    /// What the volume (in the plane: area) of a grain at a place is multiplied by.
    pub(crate) fn volume_factor(&self, place: DVec3) -> f64 {
        self.factor(place[self.axis]).powi(self.axes)
    }

    fn factor(&self, position: f64) -> f64 {
        let after = self.table.partition_point(|[start, _]| *start <= position);
        match (after.checked_sub(1).map(|before| self.table[before]), self.table.get(after)) {
            (Some([start, from]), Some([end, to])) => from + (to - from) * (position - start) / (end - start),
            (Some([_, factor]), None) | (None, Some(&[_, factor])) => factor,
            (None, None) => 1.0,
        }
    }

    /// Moves a place along the axis so that places that were even become as dense as there is room for grains.
    pub(crate) fn moved(&self, mut place: DVec3) -> DVec3 {
        let share = place[self.axis] / self.side;
        let part = self.shares.partition_point(|end| *end < share).min(PARTS - 1);
        let start = if part == 0 { 0.0 } else { self.shares[part - 1] };
        let within = (share - start) / (self.shares[part] - start);
        place[self.axis] = ((part as f64 + within) / PARTS as f64).clamp(0.0, 1.0) * self.side;
        place
    }
}
