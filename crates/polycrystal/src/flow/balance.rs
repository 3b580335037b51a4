//! How near to rest a network is.

use glam::DVec3;

use crate::events::reconnection::SHORT;
use crate::measures::Complex;
use crate::measures::lines::{Line, Lines};
use crate::{Network, Surface};

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
        let sides = network.sides();
        let level = network.finest();
        let complex = Complex::of_level(network, level, &Surface::of_level(level, points, &sides));
        let lines = Lines::of(&complex).lines;
        let is_short = |line: &Line<'_>| !line.is_closed && line.length(&complex.surface) < short;
        let lines = lines.iter().filter(|line| line.boundaries.len() >= 3);
        Self::of_lines(
            lines.map(|line| (is_short(line) || line.boundaries.len() > 3, complex.residual_of_line(line))),
        )
    }
}
