//! How large grains are.

use std::fmt;

use serde::Serialize;
use voronoi::Dimension;

use super::spread::Spread;

/// The equivalent diameters of all grains: of the balls of the same volumes, (6V/pi)^(1/3); in the plane of the discs of the
/// same areas, 2 sqrt(A/pi). In the unit of the box.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EquivalentDiameters {
    #[serde(skip)]
    dimension: Dimension,
    /// Mean over the grains.
    pub mean: f64,
    /// Standard deviation over the grains.
    pub standard_deviation: f64,
}

impl EquivalentDiameters {
    /// Mean and spread of the diameters of some grains, of which there is at least one.
    pub fn new(dimension: Dimension, diameters: &[f64]) -> Self {
        let Spread { mean, standard_deviation } = Spread::of(diameters).expect("there are grains");
        Self { dimension, mean, standard_deviation }
    }
}

impl fmt::Display for EquivalentDiameters {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let formula = match self.dimension {
            Dimension::Two => "2 sqrt(A/pi)",
            Dimension::Three => "(6V/pi)^(1/3)",
        };
        let [mean, deviation] = [self.mean, self.standard_deviation].map(four_digits);
        write!(out, "{mean} +- {deviation} in the unit of the box, equivalent: {formula}")
    }
}

/// Four digits, with an exponent where the length is tiny or huge.
fn four_digits(length: f64) -> String {
    let rounded: f64 = format!("{length:.3e}").parse().expect("a number as it was written");
    format!("{rounded:?}")
}
