//! The tuned numbers of relaxation in space.

use crate::network::build::FINEST_MOVED;

/// What relaxation in space is tuned by. Lengths are in units of the feature size (the mean grain size, or a box's shorter side),
/// times in units of the mean grain size squared.
///
/// Each number was chosen by `cargo run --release -p grainsmooth-polycrystal --example ablation`, which prints what becomes of forty networks
/// with and without it; docs/relaxation.md has the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tuning {
    /// Longest time of a step in which cells come together and part. Short lines would shrink to nothing in less: what is left of them is still
    /// there, as a step lets none turn over. How near to equilibrium all comes depends on the number of steps more than on the time. With 0.15
    /// angles spread by 4.0 degrees instead of 4.5, and 20 000 grains take a fifth longer; with 0.3 more points join five grains or more.
    pub cell_step_time: f64,
    /// How many times as soft as in the cotangent Laplacian points are that three boundaries or more share. Area resists motion across a boundary
    /// alone, where the Laplacian resists in all directions alike: lines where three meet at 120 degrees resist half as much, quadruple points
    /// a third as much. With 3, one network of forty folds; with 1 angles spread by 8.1 degrees instead of 4.5, and a flow to rest takes a quarter longer.
    pub junction_softness: f64,
    /// Steps that the relaxation time is divided into on the control mesh; those to rest are as long. With five, networks of measured maps stay further from rest; ten leave
    /// angles as they are, and triangles thinner.
    pub coarse_steps: usize,
    /// Steps that the same time is divided into once more on the next level, where less is left to do. With three, a honeycomb with points out
    /// of place does not become one again.
    pub fine_steps: usize,
    /// The same where grains have come together and parted before, and lines are nearly where they belong: on the finest level that moves, or before
    /// a flow to rest on the level before it. How long they are does not matter.
    /// Each one more takes a tenth of the whole time: angles spread by 4.5 degrees with two, 4.1 with three, 3.9 with four, 3.6 with six.
    pub settled_steps: usize,
    /// Steps of the forecast that tells which edges become short; 0 for none, which leaves a hundred thin triangles. Ten bring no more.
    pub forecast_steps: usize,
    /// Factor by which lines that the forecast has shortened may be longer than others to collapse. With 1 thin triangles stay, 3 takes out
    /// what lattices need.
    pub forecast_factor: f64,
    /// Share of its first residual at which a step is solved: a step is one of several, and the next one starts from where it ends. With 1e-1
    /// or 1e-2 all is as good, and takes as long.
    pub tolerance: f64,
    /// Length below which a control edge no longer changes in a flow of a given time. 0 leaves some thin triangles and folds in the plane, twice as
    /// much spoils angles.
    pub rigid_length: f64,
    /// Size of a grain, as a share of the mean, below which the flow around is as slow as in its own units of length. 0 lets all flow as fast;
    /// dense crowds of small grains then fold.
    pub small_grain: f64,
    /// Share of its way to the centre of the triangles around that a point inside a boundary goes in a step of a flow of a given time. Where
    /// the topology stays, with 0 a hundredth of the triangles is below 10 degrees instead of 12.
    pub centering: f64,
    /// The largest cotangent that an angle counts with: that of 1 degree. With that of 11 degrees the matrix of a step is less stiff there than the
    /// area itself, so that points swing to and fro from step to step on the way to rest, farther each time.
    pub largest_cotangent: f64,
    /// Times that widening what is still thin in the end may look at as many triangles as there are: some places are hopeless, and must not
    /// take longer than the flow. 0 leaves all as it is.
    pub widening: f64,
    /// The finest level whose points move by themselves for a time. One level of the control mesh has a single point inside a face,
    /// which bounds how well angles at its edges can fit; the next has ten.
    pub finest_moved: usize,
    /// The same for equilibrium, which is worth more time: forty points inside a face.
    pub finest_balanced: usize,
    /// Length below which lines that are left where the topology changes are drawn together into points of higher order. 0 leaves some thin
    /// triangles, twice as much makes three times as many such points, and hardly better triangles.
    pub merged_length: f64,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            cell_step_time: 0.24,
            junction_softness: 2.0,
            coarse_steps: 7,
            fine_steps: 4,
            settled_steps: 2,
            forecast_steps: 5,
            forecast_factor: 2.0,
            tolerance: 3e-2,
            rigid_length: 0.04,
            small_grain: 0.5,
            centering: 0.3,
            largest_cotangent: 50.0,
            widening: 10.0,
            finest_moved: 1,
            finest_balanced: FINEST_MOVED,
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
