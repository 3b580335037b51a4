//! How to relax, and what comes of it.

use glam::DVec3;
use voronoi::Tessellation;

use crate::{Attempt, Network, NetworkError};

/// The usual relaxation time where the topology stays, in units of the mean grain size squared.
pub(crate) const TIME_OF_KEPT_TOPOLOGY: f64 = 0.3;

/// How to relax.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Relaxation {
    /// For a time under curvature flow with unit mobility, in units of the mean grain size squared; 0 leaves boundaries flat.
    Time(f64),
    /// Until a step of time 0.04 (in the plane: 0.3) lessens the area by no more than [`Relaxation::LEAST_GAIN`] of it, or the residual of
    /// Herring's condition has not fallen, by three hundredths, for three steps. The step at which it was least is the result.
    ///
    /// [`relax`](crate::relax()) lets no boundary vanish on the way and no neighbours switch, so this is the least area of this topology: where
    /// grains would rather switch neighbours, triple lines stay out of balance. [`relax_cells`](crate::relax_cells) lets them.
    Equilibrium,
}

impl Relaxation {
    /// Change of area with a step, as a share of the area, that counts as equilibrium.
    pub const LEAST_GAIN: f64 = 1e-6;

    /// The usual time where the topology may change: five steps with a look at what is short after each. The angles of random Voronoi
    /// grains spread by 4 degrees instead of 24, and one point in two hundred joins more than four.
    pub const USUAL: Self = Self::Time(1.2);

    /// The usual time where the topology stays, as of [`relax`](crate::relax()): the angles of random Voronoi grains spread by 7 degrees
    /// instead of 24.
    pub const KEPT_TOPOLOGY: Self = Self::Time(TIME_OF_KEPT_TOPOLOGY);

    pub(crate) fn check(self) -> Result<(), NetworkError> {
        match self {
            Self::Time(time) if !(time.is_finite() && time >= 0.0) => {
                Err(NetworkError::BadRelaxationTime(time))
            }
            Self::Time(_) | Self::Equilibrium => Ok(()),
        }
    }
}

/// Where a relaxation is after one of its steps.
#[derive(Clone, Copy)]
pub struct RelaxationStep<'a> {
    /// Steps done.
    pub done: usize,
    /// Steps in all.
    pub count: usize,
    /// Time passed under curvature flow with unit mobility, in units of the mean grain size squared. Levels follow each other:
    /// each finer one takes the whole time once more.
    pub time: f64,
    /// What moves now, and where it is.
    pub now: Moving<'a>,
}

/// What a step of a relaxation moves, where it is then.
#[derive(Clone, Copy)]
pub enum Moving<'a> {
    /// The points of one level of the network.
    Points {
        /// The level.
        level: usize,
        /// Where its points are.
        points: &'a [DVec3],
    },
    /// Cells while their topology changes. What this makes on demand are the cells, and where the control points of their network with
    /// [`FaceMesh::Fan`](crate::FaceMesh::Fan) are.
    Cells(&'a dyn Fn() -> (Tessellation, Vec<DVec3>)),
    /// Grains that grow and vanish. What this makes on demand are their network, and its control points.
    Grains(&'a dyn Fn() -> Result<(Network, Vec<DVec3>), NetworkError>),
}

/// What relaxation gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxed {
    /// The finest level whose points were moved by themselves; those of finer ones follow by subdivision.
    pub level: usize,
    /// The points of that level.
    pub points: Vec<DVec3>,
    /// Steps taken.
    pub steps: usize,
    /// Time passed, as of [`RelaxationStep::time`].
    pub time: f64,
    /// Why the points of the level after that one did not move too, where they should have: then these are the last that were good.
    pub given_up: Vec<Attempt>,
    /// Whether no point moved: boundaries are as flat as the cells, and finer points lie midway between coarser ones.
    pub is_flat: bool,
}

impl Relaxed {
    /// Points of a level that no step has moved yet.
    pub(crate) fn new(level: usize, points: Vec<DVec3>) -> Self {
        Self { level, points, steps: 0, time: 0.0, given_up: Vec::new(), is_flat: false }
    }

    /// The points of the network's finest level.
    ///
    /// # Panics
    /// When the network is not the one that was relaxed.
    pub fn finest_points(&self, network: &Network) -> Vec<DVec3> {
        if self.is_flat {
            return network.divide(&self.points);
        }
        network.subdivide_between(self.level, network.level_count(), &self.points)
    }
}
