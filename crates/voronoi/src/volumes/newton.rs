//! Newton's method for weights, with steps that leave no cell empty.

use std::sync::Arc;

use cancellation::check_cancelled;
use glam::DVec3;

use super::grains::Grains;
use super::laplacian::Laplacian;
use super::{TOLERANCE, VolumesError};
use crate::{CellMeasure, Dimension, Domain, Tessellation, VoronoiError};

/// Steps at most: 20 000 grains of cv 1 take 18, 5000 of 1:30 take 21.
const MOST_STEPS: usize = 100;

/// How often a step is halved: what is left then is no progress.
const MOST_HALVINGS: i32 = 20;

/// The same where rounding may be all that is left, beneath [`NEAR`].
const MOST_HALVINGS_NEAR: i32 = 3;

/// The relative error below which the largest one must fall with each step, and not the sum of squares, of which rounding leaves no
/// digits there.
const NEAR: f64 = 1e-8;

/// The part of its volume, or of its target if that is less, that a step must leave every cell.
const LEAST_KEPT: f64 = 0.1;

/// Bounds of the relative residual that linear systems are solved to; between them a tenth of the relative error of volumes.
const RESIDUALS: [f64; 2] = [1e-10, 1e-3];

/// How far weights follow moved seeds: to first order only, so more digits mean nothing.
pub(super) const MOVED_RESIDUAL: f64 = 1e-3;

/// Cells, what they were clipped with, and their measures.
pub(super) struct Clipped {
    pub(super) tessellation: Tessellation,
    pub(super) weights: Vec<f64>,
    pub(super) grains: Arc<Grains>,
    measures: Vec<CellMeasure>,
    /// Of grains.
    volumes: Vec<f64>,
}

impl Clipped {
    /// Clips cells with weights of which what they have in common is taken off.
    pub(super) fn new(
        domain: &Domain,
        seeds: &[DVec3],
        mut weights: Vec<f64>,
        grains: Arc<Grains>,
    ) -> Result<Self, VoronoiError> {
        // Equal weights become exactly 0.
        let first = weights[0];
        weights.iter_mut().for_each(|weight| *weight -= first);
        let mean = weights.iter().sum::<f64>() / weights.len() as f64;
        weights.iter_mut().for_each(|weight| *weight -= mean);
        Ok(Self::of(Tessellation::power(domain, seeds, &weights)?, weights, grains))
    }

    pub(super) fn of(tessellation: Tessellation, weights: Vec<f64>, grains: Arc<Grains>) -> Self {
        let measures = tessellation.cell_measures();
        let volumes = grains.sums(measures.iter().map(|cell| cell.volume));
        Self { tessellation, weights, grains, measures, volumes }
    }

    /// Of grains.
    pub(super) fn volumes(&self) -> impl Iterator<Item = f64> {
        self.volumes.iter().copied()
    }

    pub(super) fn has_empty(&self) -> bool {
        self.volumes().any(|volume| volume <= 0.0)
    }

    /// The cells of seeds that moved by a fraction of the way to their centroids, with weights that go along to first order.
    pub(super) fn moved(&self, fraction: f64) -> Result<Self, VoronoiError> {
        let goals: Vec<DVec3> = self
            .tessellation
            .seeds
            .iter()
            .zip(&self.measures)
            .map(|(seed, cell)| seed.lerp(cell.centroid, fraction))
            .collect();
        let laplacian = Laplacian::new(&self.tessellation, &self.grains);
        let mut weights = self.weights.clone();
        laplacian.solve(&laplacian.right_side_of_moved(&goals, |_| 0.0), &mut weights, MOVED_RESIDUAL);
        let seeds = self.tessellation.toward_centroids(&self.measures, fraction);
        Self::new(self.tessellation.domain(), &seeds, weights, Arc::clone(&self.grains))
    }

    /// Largest relative error of any grain, and its number.
    fn largest_error(&self, targets: &[f64]) -> (f64, usize) {
        let errors = self.volumes().zip(targets).map(|(volume, target)| (volume / target - 1.0).abs());
        errors
            .enumerate()
            .fold((0.0, 0), |worst, (grain, error)| if error > worst.0 { (error, grain) } else { worst })
    }

    /// Sum of squared errors of the roots of volumes.
    fn root_error(&self, targets: &[f64]) -> f64 {
        let dimension = self.tessellation.domain().dimension();
        let error =
            |(volume, target): (f64, &f64)| dimension.cube_edge(volume) - dimension.cube_edge(*target);
        self.volumes().zip(targets).map(|pair| error(pair).powi(2)).sum()
    }

    /// What Newton's method on roots asks of volumes: `b_i = n u_i (target_i^(1/n) - V_i^(1/n)) - c u_i` in n dimensions, with
    /// `u_i = V_i^(1 - 1/n)` and c such that the sum is 0.
    fn wanted_changes(&self, targets: &[f64]) -> Vec<f64> {
        let dimension = self.tessellation.domain().dimension();
        let (axes, power) = match dimension {
            Dimension::Two => (2.0, 1),
            Dimension::Three => (3.0, 2),
        };
        let slopes: Vec<f64> = self.volumes().map(|volume| dimension.cube_edge(volume).powi(power)).collect();
        let pairs = self.volumes().zip(targets).zip(&slopes);
        let mut changes: Vec<f64> = pairs
            .map(|((volume, target), slope)| {
                axes * slope * (dimension.cube_edge(*target) - dimension.cube_edge(volume))
            })
            .collect();
        let constant = changes.iter().sum::<f64>() / slopes.iter().sum::<f64>();
        changes.iter_mut().zip(&slopes).for_each(|(change, slope)| *change -= constant * slope);
        changes
    }

    /// Whether a step that led to these cells from others is a good one.
    fn is_progress_from(&self, before: &Self, targets: &[f64], error: f64) -> bool {
        let mut cells = self.volumes().zip(before.volumes()).zip(targets);
        let keeps_all = cells
            .all(|((volume, before), target)| volume > 0.0 && volume >= LEAST_KEPT * before.min(*target));
        keeps_all
            && if error < NEAR {
                self.largest_error(targets).0 < error
            } else {
                self.root_error(targets) < before.root_error(targets)
            }
    }
}

/// Changes weights until no relative error of volumes is above a goal, or, where rounding does not let them come so near, above
/// [`TOLERANCE`]. Returns how many steps that took.
pub(super) fn approach(state: &mut Clipped, targets: &[f64], goal: f64) -> Result<usize, VolumesError> {
    let mut steps = 0;
    while steps < MOST_STEPS {
        check_cancelled();
        let (error, _) = state.largest_error(targets);
        if error <= goal {
            return Ok(steps);
        }
        let mut direction = vec![0.0; targets.len()];
        let residual = (0.1 * error).clamp(RESIDUALS[0], RESIDUALS[1]);
        let laplacian = Laplacian::new(&state.tessellation, &state.grains);
        laplacian.solve(&state.wanted_changes(targets), &mut direction, residual);
        let most = if error < NEAR { MOST_HALVINGS_NEAR } else { MOST_HALVINGS };
        let mut next = None;
        for length in (0..most).map(|halvings| 0.5f64.powi(halvings)) {
            let weights = state.grains.shifted(&state.weights, |grain| length * direction[grain]);
            let (domain, seeds) = (state.tessellation.domain(), state.tessellation.seeds());
            let tried = Clipped::new(domain, seeds, weights, Arc::clone(&state.grains))?;
            if tried.is_progress_from(state, targets, error) {
                next = Some(tried);
                break;
            }
        }
        let Some(next) = next else { break };
        *state = next;
        steps += 1;
    }
    match state.largest_error(targets) {
        (error, _) if error <= goal.max(TOLERANCE) => Ok(steps),
        (_, grain) => {
            Err(VolumesError::NotReached { grain, target: targets[grain], reached: state.volumes[grain] })
        }
    }
}
