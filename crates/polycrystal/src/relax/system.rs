//! The linear system of one step: least energy under the constraint of the grains' volumes.

use glam::DVec3;
use rayon::prelude::*;

use super::clusters::Numbering;
use super::patch::PatchTerms;
use super::patches::Patches;
use super::springs::add_springs;
use super::volume_constraint::{Compliance, VolumeConstraint};
use crate::Network;

/// Share of its first residual at which a step is solved: a step is one of several, and the next one starts from where it ends.
const TOLERANCE: f64 = 1e-3;

/// Most iterations for a step.
const ITERATIONS: usize = 200;

/// `(M + dt (K + S)) d = -dt K x + J^T p` for the displacements d of clusters, with pressures p such that `J d` is given.
pub(super) struct System<'a> {
    patches: &'a Patches,
    clusters: Numbering,
    masses: Vec<f64>,
    /// `dt (K + S)` of each patch.
    matrices: Vec<Vec<f64>>,
    /// `-dt K x`.
    forces: Vec<DVec3>,
    /// 1 over the diagonal of the matrix, 0 along axes that walls lock.
    mobility: Vec<DVec3>,
    constraint: VolumeConstraint,
    compliance: Compliance,
}

impl<'a> System<'a> {
    /// The system of a step of the given time from the given points.
    pub(super) fn new(
        network: &Network,
        patches: &'a Patches,
        terms: &[PatchTerms],
        points: &[DVec3],
        clusters: Numbering,
        time: f64,
    ) -> Self {
        let matrices: Vec<Vec<f64>> = patches
            .patches
            .par_iter()
            .zip(terms)
            .map(|(patch, terms)| {
                let mut matrix = terms.stiffness.clone();
                add_springs(&mut matrix, patch, points, network.feature_size());
                matrix.iter_mut().for_each(|entry| *entry *= time);
                matrix
            })
            .collect();
        let of_places: Vec<f64> = terms.iter().flat_map(|terms| terms.mass.iter().copied()).collect();
        let mass = |c| patches.places_of_cluster(&clusters, c).map(|place| of_places[place]).sum();
        let masses: Vec<f64> = (0..clusters.cluster_count()).map(mass).collect();
        let mobility = mobility(network, patches, &clusters, &matrices, &masses);
        let constraint = VolumeConstraint::new(network, patches, points, &clusters);
        let compliance = constraint.compliance(&mobility);
        let forces = Vec::new();
        let mut system =
            Self { patches, clusters, masses, matrices, forces, mobility, constraint, compliance };
        let stiffness: Vec<&[f64]> = terms.iter().map(|terms| terms.stiffness.as_slice()).collect();
        let mut at_places = vec![DVec3::ZERO; patches.place_count()];
        system.multiply(&stiffness, |point| points[point as usize], &mut at_places);
        let force = |c| -time * system.sum_of_places(&at_places, c);
        system.forces = (0..system.clusters.cluster_count()).map(force).collect();
        system
    }

    /// The displacement of every control point that changes the grains' volumes by `changes`, to first order, and is
    /// otherwise that of the flow. Solved by projected conjugate gradients (Gould, Hribar and Nocedal 2001).
    pub(super) fn displacement(&self, changes: &[f64]) -> Vec<DVec3> {
        let pressures = self.compliance.pressures(changes);
        let mut displacement = self.push(&pressures);
        let mut at_places = vec![DVec3::ZERO; self.patches.place_count()];
        let mut image = vec![DVec3::ZERO; displacement.len()];
        self.apply(&displacement, &mut image, &mut at_places);
        let mut residual: Vec<DVec3> =
            self.forces.iter().zip(&image).map(|(force, image)| *force - *image).collect();
        let mut direction = self.project(&residual);
        let mut size = dot(&residual, &direction);
        let enough = size * TOLERANCE * TOLERANCE;
        for _ in 0..ITERATIONS {
            if size <= enough || size <= 0.0 {
                break;
            }
            self.apply(&direction, &mut image, &mut at_places);
            let step = size / dot(&direction, &image);
            displacement.iter_mut().zip(&direction).for_each(|(d, p)| *d += *p * step);
            residual.iter_mut().zip(&image).for_each(|(r, q)| *r -= *q * step);
            let projected = self.project(&residual);
            let next = dot(&residual, &projected);
            let growth = next / size;
            direction.iter_mut().zip(&projected).for_each(|(p, v)| *p = *v + *p * growth);
            size = next;
        }
        self.of_points(&displacement)
    }

    /// The least motion by area of the control points that changes the grains' volumes by `changes`, to first order,
    /// for a system of time 0.
    pub(super) fn volume_correction(&self, changes: &[f64]) -> Vec<DVec3> {
        self.of_points(&self.push(&self.compliance.pressures(changes)))
    }

    fn of_points(&self, of_clusters: &[DVec3]) -> Vec<DVec3> {
        self.clusters.numbers().iter().map(|number| of_clusters[*number as usize]).collect()
    }

    /// The preconditioned residual without its part that changes volumes.
    fn project(&self, residual: &[DVec3]) -> Vec<DVec3> {
        let mut moved: Vec<DVec3> =
            residual.iter().zip(&self.mobility).map(|(r, mobility)| *r * *mobility).collect();
        let pressures = self.compliance.pressures(&self.constraint.volume_change(&moved));
        moved.iter_mut().zip(self.push(&pressures)).for_each(|(moved, push)| *moved -= push);
        moved
    }

    /// The displacement under pressures of the grains if there were only the diagonal of the matrix.
    fn push(&self, pressures: &[f64]) -> Vec<DVec3> {
        let force = |cluster: usize| self.mobility[cluster] * self.constraint.force(pressures, cluster);
        (0..self.mobility.len()).into_par_iter().map(force).collect()
    }

    /// `(M + dt (K + S)) d`.
    fn apply(&self, displacement: &[DVec3], image: &mut [DVec3], at_places: &mut [DVec3]) {
        let matrices: Vec<&[f64]> = self.matrices.iter().map(Vec::as_slice).collect();
        self.multiply(&matrices, |point| displacement[self.clusters.cluster_of(point)], at_places);
        image.par_iter_mut().enumerate().for_each(|(cluster, image)| {
            *image = displacement[cluster] * self.masses[cluster] + self.sum_of_places(at_places, cluster);
        });
    }

    /// Multiplies each patch's matrix with a field over its control points.
    fn multiply(&self, matrices: &[&[f64]], field: impl Fn(u32) -> DVec3 + Sync, at_places: &mut [DVec3]) {
        let slices = self.patches.split(at_places);
        slices.into_par_iter().zip(&self.patches.patches).zip(matrices).for_each(|((out, patch), matrix)| {
            let local: Vec<DVec3> = patch.control_points.iter().map(|point| field(*point)).collect();
            for (out, row) in out.iter_mut().zip(matrix.chunks_exact(local.len())) {
                *out = row.iter().zip(&local).map(|(entry, value)| *value * *entry).sum();
            }
        });
    }

    fn sum_of_places(&self, field: &[DVec3], cluster: usize) -> DVec3 {
        self.patches.places_of_cluster(&self.clusters, cluster).map(|place| field[place]).sum()
    }
}

/// 1 over the diagonal of `M + dt (K + S)`, 0 along the axes in which a point of the cluster is locked by a wall.
fn mobility(
    network: &Network,
    patches: &Patches,
    clusters: &Numbering,
    matrices: &[Vec<f64>],
    masses: &[f64],
) -> Vec<DVec3> {
    let mut diagonal = masses.to_vec();
    for (matrix, patch) in matrices.iter().zip(&patches.patches) {
        let numbers: Vec<usize> = patch.control_points.iter().map(|p| clusters.cluster_of(*p)).collect();
        for (own, row) in numbers.iter().zip(matrix.chunks_exact(numbers.len())) {
            let within = row.iter().zip(&numbers).filter(|(_, number)| *number == own);
            diagonal[*own] += within.map(|(entry, _)| entry).sum::<f64>();
        }
    }
    let walls = &network.control_mesh().walls;
    let of_cluster = |(cluster, diagonal): (usize, &f64)| {
        let free = clusters.members(cluster).iter().map(|point| walls[*point as usize].free_axes());
        let free = free.fold(glam::BVec3::TRUE, |all, free| all & free);
        let inverse = if *diagonal > 0.0 { 1.0 / diagonal } else { 0.0 };
        DVec3::select(free, DVec3::splat(inverse), DVec3::ZERO)
    };
    diagonal.iter().enumerate().map(of_cluster).collect()
}

/// Clusters that one task sums over; fixed, so that no result depends on the number of threads.
const SUM_CHUNK: usize = 4096;

/// A sum whose order is that of the chunks, whichever thread adds them up.
fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    let chunks = a.par_chunks(SUM_CHUNK).zip(b.par_chunks(SUM_CHUNK));
    let sums: Vec<f64> = chunks.map(|(a, b)| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()).collect();
    sums.iter().sum()
}
