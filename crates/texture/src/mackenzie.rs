//! Disorientations between crystals that stand at random.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::CrystalSymmetry;

/// Directions, along a spiral of equal areas, in which the zone of least rotations is measured; with these, shares err by less than 2e-6.
const DIRECTIONS: u32 = 300_000;

/// The distribution of disorientation angles between crystals that stand at random: of cubic ones Mackenzie's.
///
/// Rotations that are the least of their equivalents form a zone around the identity. Along a direction n it ends where
/// |n . a| tan(w/2) = tan(t/4) for the nearest rotation by t around an axis a of the group. Random rotations have angles of density (1 - cos w) / pi.
///
/// ```
/// use texture::{CrystalSymmetry, RandomDisorientations};
///
/// let cubic = RandomDisorientations::new(CrystalSymmetry::Octahedral);
/// assert!((cubic.mean() - 40.74).abs() < 0.01);
/// assert!((cubic.largest() - 62.80).abs() < 0.05);
/// ```
#[derive(Debug, Clone)]
pub struct RandomDisorientations {
    /// Radians at which the zone ends, sorted; one a direction.
    ends: Vec<f64>,
    /// Sum of end - sin(end) of all before.
    sums: Vec<f64>,
    /// The order of the group by the number of directions.
    factor: f64,
}

impl RandomDisorientations {
    /// The distribution for two crystals of one symmetry.
    pub fn new(symmetry: CrystalSymmetry) -> Self {
        let axes: Vec<(DVec3, f64)> =
            symmetry.axes().into_iter().map(|(axis, angle)| (axis, (angle / 4.0).tan())).collect();
        let mut ends = Vec::new();
        let golden = TAU * (1.5 - 1.25_f64.sqrt());
        for index in 0..DIRECTIONS {
            let z = (f64::from(index) + 0.5) / f64::from(DIRECTIONS);
            let (sine, cosine) = (golden * f64::from(index)).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            let direction = DVec3::new(radius * cosine, radius * sine, z);
            let reaches = axes.iter().map(|(axis, tangent)| tangent / axis.dot(direction).abs());
            ends.push(2.0 * reaches.fold(f64::INFINITY, f64::min).atan());
        }
        ends.sort_unstable_by(f64::total_cmp);
        let mut sums = vec![0.0];
        for end in &ends {
            sums.push(sums[sums.len() - 1] + end - end.sin());
        }
        let order = symmetry.order() as f64;
        Self { ends, sums, factor: order / f64::from(DIRECTIONS) }
    }

    /// Share of the disorientations below an angle in degrees.
    pub fn share_below(&self, angle: f64) -> f64 {
        let angle = angle.clamp(0.0, 180.0).to_radians();
        let ended = self.ends.partition_point(|end| *end < angle);
        let share = self.sums[ended] + self.going_on(ended) * (angle - angle.sin());
        (self.factor * share / PI).min(1.0)
    }

    /// Density at an angle in degrees, per degree.
    pub fn density(&self, angle: f64) -> f64 {
        let radians = angle.clamp(0.0, 180.0).to_radians();
        let ended = self.ends.partition_point(|end| *end < radians);
        self.factor * self.going_on(ended) * (1.0 - radians.cos()) / 180.0
    }

    /// The mean angle in degrees.
    pub fn mean(&self) -> f64 {
        let moment = |end: &f64| 0.5 * end * end - end * end.sin() - end.cos() + 1.0;
        (self.factor * self.ends.iter().map(moment).sum::<f64>() / PI).to_degrees()
    }

    /// The largest angle in degrees, to some hundredths.
    pub fn largest(&self) -> f64 {
        self.ends[self.ends.len() - 1].to_degrees()
    }

    /// Number of directions along which the zone goes on, where it has ended along some.
    fn going_on(&self, ended: usize) -> f64 {
        (self.ends.len() - ended) as f64
    }
}
