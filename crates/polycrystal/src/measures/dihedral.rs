use glam::DVec3;

use crate::measures::complex::Complex;
use crate::mesh::angles::{AngleStatistics, WeightedAngle};
use crate::{LevelView, Network, Surface};

/// The angles between the three boundaries at triple lines inside the domain, weighted by length; in the plane, at triple
/// points. Nothing when there is no such edge. In a periodic network every edge counts once.
///
/// Random Voronoi grains have 120 +- 23.8 degrees, equilibrium has 120 +- 0.
pub fn dihedral_angles<'a>(
    network: &Network,
    level: impl Into<LevelView<'a>>,
    points: &[DVec3],
) -> Option<AngleStatistics> {
    let (level, sides) = (level.into(), network.sides());
    AngleStatistics::of(Complex::of_level(network, level, &Surface::of_level(level, points, &sides)).angles())
}

/// All angles that [`dihedral_angles`] takes the statistics of: three at each edge of a triple line.
pub fn angles_between_boundaries<'a>(
    network: &Network,
    level: impl Into<LevelView<'a>>,
    points: &[DVec3],
) -> Vec<WeightedAngle> {
    let (level, sides) = (level.into(), network.sides());
    Complex::of_level(network, level, &Surface::of_level(level, points, &sides)).angles().collect()
}
