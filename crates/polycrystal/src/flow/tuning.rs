//! The tuned numbers of relaxation in space.

use crate::complex::ring::LARGEST_FOLD;
use crate::energy::triangle::LARGEST_COTANGENT;

/// What relaxation in space is tuned by. Lengths are in units of the feature size (the mean grain size, or a box's shorter side),
/// times in units of the mean grain size squared.
///
/// Each number was chosen by `cargo run --release -p grainsmooth-polycrystal --example ablation`, which prints what becomes of forty networks
/// with and without it; docs/relaxation.md has the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tuning {
    /// Steps that the relaxation time is divided into on the control mesh. Five leave angles a tenth of a degree worse, on the control
    /// mesh alone a whole degree; twenty make triangles thinner.
    pub coarse_steps: usize,
    /// Steps that the same time is divided into once more on the next level, where less is left to do. Three leave angles a degree
    /// worse; twelve make triangles thinner.
    pub fine_steps: usize,
    /// Steps of the forecast that tells which edges become short; 0 for none, which leaves a hundred thin triangles. Five make angles
    /// and triangles a little worse.
    pub forecast_steps: usize,
    /// Factor by which lines that the forecast has shortened may be longer than others to collapse. With 1 thin triangles stay, 3 takes out
    /// what lattices need.
    pub forecast_factor: f64,
    /// Share of its first residual at which a step is solved: a step is one of several, and the next one starts from where it ends.
    pub tolerance: f64,
    /// Length below which a control edge no longer changes in a flow of a given time. 0 leaves some thin triangles and folds in the plane, twice as
    /// much spoils angles.
    pub rigid_length: f64,
    /// Size of a grain, as a share of the mean, below which the flow around is as slow as in its own units of length. 0 lets all flow as fast;
    /// dense crowds of small grains then fold.
    pub small_grain: f64,
    /// Share of its way to the centre of the triangles around that a point inside a boundary goes in a step of a flow of a given time. Where
    /// the topology stays, with 0 a hundredth of the triangles is below 11 degrees instead of 13.
    pub centering: f64,
    /// The largest cotangent that an angle counts with in a flow of a given time: that of 11 degrees. Needles would otherwise glue
    /// their ends together.
    pub largest_cotangent: f64,
    /// Cosine of the largest angle that an element may turn by within a step (60 degrees); -1 for any.
    pub largest_turn: f64,
    /// Cosine of the largest angle between neighbouring elements after a step (75 degrees), so that later subdivision has room
    /// before the 90 degrees of a fold; -1 for any.
    pub largest_bend: f64,
    /// Times that widening what is still thin in the end may look at as many triangles as there are: some places are hopeless, and must not
    /// take longer than the flow. 0 leaves all as it is.
    pub widening: f64,
    /// The finest level whose points move by themselves for a time. One level of the control mesh has a single point inside a face,
    /// which bounds how well angles at its edges can fit; the next has ten.
    pub finest_moved: usize,
    /// The same for equilibrium, which is worth more time: forty points inside a face.
    pub finest_balanced: usize,
    /// The largest cotangent in a flow to rest: that of 1 degree. Where the matrix is less stiff than the area itself is, points swing
    /// to and fro from step to step, farther each time.
    pub largest_cotangent_to_rest: f64,
    /// Length below which lines that are left where the topology changes are drawn together into points of higher order. 0 leaves some thin
    /// triangles, twice as much makes three times as many such points, and hardly better triangles.
    pub merged_length: f64,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            coarse_steps: 10,
            fine_steps: 6,
            forecast_steps: 10,
            forecast_factor: 2.0,
            tolerance: 1e-2,
            rigid_length: 0.04,
            small_grain: 0.5,
            centering: 0.2,
            largest_cotangent: LARGEST_COTANGENT,
            largest_turn: 0.5,
            largest_bend: LARGEST_FOLD,
            widening: 10.0,
            finest_moved: 1,
            finest_balanced: 2,
            largest_cotangent_to_rest: 50.0,
            merged_length: 0.06,
        }
    }
}

impl Tuning {
    /// These numbers in a flow to rest: points have time to part, so nothing that is short has to be held, and triangles are good by themselves.
    /// With centres that move, angles at equilibrium spread by 1.53 degrees instead of 1.39, and 128 triangles of 24 networks are thin instead of 8.
    pub(crate) fn to_rest(self) -> Self {
        Self { rigid_length: 0.0, centering: 0.0, ..self }
    }
}
