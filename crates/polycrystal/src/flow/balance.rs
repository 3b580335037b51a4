//! How near to rest a network is.

use glam::DVec3;

use crate::events::reconnection::SHORT;
use crate::{Network, SpaceMeasures, TripleLineMeasures, measure_network};

/// How near to equilibrium a network is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    /// Places that are not at rest: triple lines, shorter than 0.12 of the mean grain size, that no event takes away, lines where more
    /// than three boundaries meet (in the plane, such points), and those whose residual is above [`Balance::LARGEST_RESIDUAL`].
    pub flagged_lines: usize,
    /// The largest residual of Herring's condition, as of [`HerringResidual`](crate::HerringResidual), of any line that is not flagged.
    pub largest_residual: f64,
}

impl Balance {
    /// Residual of a line above which it is not at rest: that of one of three equal boundaries that is off by 14 degrees. Of random
    /// grains at rest, the worst of some 3000 lines has two thirds of it.
    pub const LARGEST_RESIDUAL: f64 = 0.07;

    /// That of lines of which some are flagged anyway, with their residuals.
    pub(crate) fn of_lines(lines: impl Iterator<Item = (bool, Option<f64>)>) -> Self {
        let mut balance = Self { flagged_lines: 0, largest_residual: 0.0 };
        for (is_flagged, residual) in lines {
            let residual = residual.unwrap_or(0.0);
            if is_flagged || residual > Self::LARGEST_RESIDUAL {
                balance.flagged_lines += 1;
            } else {
                balance.largest_residual = balance.largest_residual.max(residual);
            }
        }
        balance
    }

    /// That of a network in space.
    pub(crate) fn in_space(network: &Network, points: &[DVec3]) -> Self {
        let short = SHORT * network.feature_size();
        let measures = measure_network(network, points).in_space();
        let SpaceMeasures { triple_lines, .. } = measures.expect("a network in space");
        let is_short = |line: &TripleLineMeasures| !line.is_closed && line.length < short;
        let lines = triple_lines.iter();
        Self::of_lines(lines.map(|line| (is_short(line) || line.boundaries.len() > 3, line.residual)))
    }
}
