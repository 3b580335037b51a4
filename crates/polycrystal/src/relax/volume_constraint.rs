//! Grain volumes as linear constraints on the displacement of clusters.

use glam::DVec3;
use rayon::prelude::*;

use super::clusters::Numbering;
use super::conjugate_gradients::{Limits, solve};
use super::multigrid::Multigrid;
use super::patch::PatchTerms;
use super::patches::Patches;
use super::rows::Rows;
use super::system::Mobility;
use crate::Network;

/// Most iterations. Without rounding as many as there are grains are enough; where rigid parts leave a grain no way to
/// change its volume there is no solution, and going on would only blow up what rounding leaves.
const ITERATIONS: usize = 2000;

/// How the volumes of grains change when clusters move: a sparse matrix J with a vector for each cluster and grain.
pub(super) struct VolumeConstraint {
    /// Of each cluster, its grains and the gradients of their volumes.
    by_cluster: Rows<DVec3>,
    /// Of each grain, its clusters and the gradients of its volume.
    by_grain: Rows<DVec3>,
}

impl VolumeConstraint {
    pub(super) fn new(
        network: &Network,
        patches: &Patches,
        terms: &[PatchTerms],
        clusters: &Numbering,
    ) -> Self {
        let gradients: Vec<DVec3> = terms.iter().flat_map(|terms| terms.sweep.iter().copied()).collect();
        let row = |cluster: usize| {
            let mut row: Vec<(u32, DVec3)> = Vec::new();
            for place in patches.places_of_cluster(clusters, cluster) {
                let boundary = &network.boundaries()[patches.patch_of_place(place)];
                // Walls do not move, so what lies on them changes no volume.
                for (grain, sign) in boundary.signed_grains().filter(|_| boundary.wall.is_none()) {
                    let gradient = gradients[place] * sign;
                    match row.iter_mut().find(|(known, _)| *known == grain.0) {
                        Some((_, sum)) => *sum += gradient,
                        None => row.push((grain.0, gradient)),
                    }
                }
            }
            row
        };
        let rows: Vec<_> = (0..clusters.cluster_count()).into_par_iter().map(row).collect();
        let mut columns: Vec<Vec<(u32, DVec3)>> = vec![Vec::new(); network.grain_count()];
        for (cluster, row) in (0u32..).zip(&rows) {
            for (grain, gradient) in row {
                columns[*grain as usize].push((cluster, *gradient));
            }
        }
        Self { by_cluster: Rows::new(rows), by_grain: Rows::new(columns) }
    }

    /// The change of each grain's volume under a displacement: `J d`.
    pub(super) fn volume_change(&self, displacement: &[DVec3]) -> Vec<f64> {
        let change = |grain: usize| {
            let row = self.by_grain.row(grain).iter();
            row.map(|(cluster, gradient)| gradient.dot(displacement[*cluster as usize])).sum()
        };
        (0..self.by_grain.len()).into_par_iter().map(change).collect()
    }

    /// The force of the grains' pressures on a cluster: a row of `J^T p`.
    pub(super) fn force(&self, pressures: &[f64], cluster: usize) -> DVec3 {
        let row = self.by_cluster.row(cluster).iter();
        row.map(|(grain, gradient)| *gradient * pressures[*grain as usize]).sum()
    }

    /// `J D J^T` for the mobility D of the clusters.
    pub(super) fn compliance(&self, mobility: &[Mobility]) -> Compliance {
        let row = |grain: usize| {
            let mut row: Vec<(u32, f64)> = Vec::new();
            for (cluster, gradient) in self.by_grain.row(grain) {
                let moved = mobility[*cluster as usize].of(*gradient);
                for (other, gradient) in self.by_cluster.row(*cluster as usize) {
                    let change = moved.dot(*gradient);
                    match row.iter_mut().find(|(known, _)| known == other) {
                        Some((_, sum)) => *sum += change,
                        None => row.push((*other, change)),
                    }
                }
            }
            row
        };
        let rows: Vec<_> = (0..self.by_grain.len()).into_par_iter().map(row).collect();
        Compliance { grids: Multigrid::new(Rows::new(rows)) }
    }
}

/// How the volumes of grains answer to pressures: a symmetric matrix over the grains.
pub(super) struct Compliance {
    grids: Multigrid,
}

impl Compliance {
    /// The pressures that bring about the given changes of volume, up to an error of this share.
    pub(super) fn pressures(&self, changes: &[f64], tolerance: f64) -> Vec<f64> {
        // The same pressure everywhere moves nothing, as the walls hold: a total other than zero, which rounding leaves,
        // has no answer and would grow without bound.
        let mean = changes.iter().sum::<f64>() / changes.len() as f64;
        let balanced: Vec<f64> = changes.iter().map(|change| change - mean).collect();
        let limits = Limits { tolerance, steps: ITERATIONS.min(2 * changes.len() + 20) };
        let precondition = |residual: &[f64]| self.grids.precondition(residual);
        solve(|vector| self.grids.apply(vector), precondition, &balanced, &limits)
    }
}
