//! The tuned numbers of growth.

use crate::flow::boundary_flow::LEAST_GRAIN;

/// What growth is tuned by. Lengths are in units of the mean grain size at the time, the edge of a cube (in the plane, of a square) with the mean
/// volume (area) of the grains that are left; times in units of its square, volumes in units of that volume.
///
/// `cargo run --release -p grainsmooth-polycrystal --example growth` prints what becomes of a network with other numbers; docs/relaxation.md
/// has the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrowthTuning {
    /// Distance of points along boundaries in the plane. Half of it halves the errors of rates and doubles the work.
    pub spacing: f64,
    /// Largest difference of a grain's area in the plane after a step and after two of half its time. Steps are as long as this allows.
    pub largest_error_in_plane: f64,
    /// The same of its volume in space, where grains that are about to vanish are as many as those that last. With 3e-3, the rates of half of all grains are off
    /// the law of MacPherson and Srolovitz by more than 2.7 % instead of 0.8 %, and growth takes half as long.
    pub largest_error_in_space: f64,
    /// Length of an edge in the plane that shrinks, below which its ends switch neighbours.
    pub short: f64,
    /// Volume of a grain below which it vanishes.
    pub vanished: f64,
    /// Time for which the finer points of boundaries in space move in the end, at kept volumes.
    pub smoothing: f64,
}

impl Default for GrowthTuning {
    fn default() -> Self {
        Self {
            spacing: 0.1,
            largest_error_in_plane: 3e-3,
            largest_error_in_space: 8e-4,
            short: 0.05,
            vanished: LEAST_GRAIN,
            smoothing: 0.05,
        }
    }
}
