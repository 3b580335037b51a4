//! The linear system of one step: least energy under the constraint of the grains' volumes.

use glam::DVec3;
use rayon::prelude::*;

use super::clusters::Numbering;
use super::patch::PatchTerms;
use super::patches::Patches;
use super::springs::add_springs;
use super::volume_constraint::{Compliance, VolumeConstraint};
use crate::{Network, Volumes, WallSet};

/// Share of its first residual at which a step is solved: a step is one of several, and the next one starts from where it ends.
const TOLERANCE: f64 = 1e-3;

/// Most iterations for a step.
const ITERATIONS: usize = 200;

/// `(M + dt (K + S)) d = -dt g + J^T p` for the displacements d of clusters, with pressures p such that `J d` is given.
pub(super) struct System<'a> {
    patches: &'a Patches,
    clusters: Numbering,
    masses: Vec<f64>,
    /// `dt (K + S)` of each patch: a spring constant for each of its edges.
    springs: Vec<Vec<f64>>,
    /// `-dt g`.
    forces: Vec<DVec3>,
    /// 1 over the diagonal of the matrix, 0 along axes that walls lock.
    mobility: Vec<DVec3>,
    /// Nothing where volumes are free.
    constraint: Option<(VolumeConstraint, Compliance)>,
}

impl<'a> System<'a> {
    /// The system of a step of the given time from the given points.
    pub(super) fn new(
        network: &Network,
        patches: &'a Patches,
        terms: &[PatchTerms],
        points: &[DVec3],
        clusters: Numbering,
        (time, feature_size): (f64, f64),
        walls: &[WallSet],
        volumes: Volumes,
    ) -> Self {
        let springs: Vec<Vec<f64>> = patches
            .patches
            .par_iter()
            .zip(terms)
            .map(|(patch, terms)| {
                let mut springs = terms.stiffness.clone();
                add_springs(&mut springs, patch, points, feature_size);
                springs.iter_mut().for_each(|spring| *spring *= time);
                springs
            })
            .collect();
        let count = clusters.cluster_count();
        let of_places: Vec<f64> = terms.iter().flat_map(|terms| terms.mass.iter().copied()).collect();
        let mass = |c| patches.places_of_cluster(&clusters, c).map(|place| of_places[place]).sum();
        let masses: Vec<f64> = (0..count).into_par_iter().map(mass).collect();
        let of_places: Vec<DVec3> = terms.iter().flat_map(|terms| terms.gradient.iter().copied()).collect();
        let force =
            |c| patches.places_of_cluster(&clusters, c).map(|place| of_places[place]).sum::<DVec3>() * -time;
        let forces: Vec<DVec3> = (0..count).into_par_iter().map(force).collect();
        let mobility = mobility(walls, patches, &clusters, &springs, &masses);
        let constraint = (volumes == Volumes::Kept).then(|| {
            let constraint = VolumeConstraint::new(network, patches, terms, &clusters);
            let compliance = constraint.compliance(&mobility);
            (constraint, compliance)
        });
        Self { patches, clusters, masses, springs, forces, mobility, constraint }
    }

    /// The displacement of every control point that changes the grains' volumes by `changes`, to first order, and is
    /// otherwise that of the flow. Solved by projected conjugate gradients (Gould, Hribar and Nocedal 2001).
    pub(super) fn displacement(&self, changes: &[f64]) -> Vec<DVec3> {
        let mut displacement = self.push(changes);
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
        self.of_points(&self.push(changes))
    }

    fn of_points(&self, of_clusters: &[DVec3]) -> Vec<DVec3> {
        self.clusters.numbers().iter().map(|number| of_clusters[*number as usize]).collect()
    }

    /// The preconditioned residual without its part that changes volumes.
    fn project(&self, residual: &[DVec3]) -> Vec<DVec3> {
        let mut moved: Vec<DVec3> =
            residual.iter().zip(&self.mobility).map(|(r, mobility)| *r * *mobility).collect();
        if let Some((constraint, _)) = &self.constraint {
            let pushed = self.push(&constraint.volume_change(&moved));
            moved.iter_mut().zip(pushed).for_each(|(moved, push)| *moved -= push);
        }
        moved
    }

    /// The displacement by pressures that changes volumes by `changes` if there were only the diagonal of the matrix; none
    /// where volumes are free.
    fn push(&self, changes: &[f64]) -> Vec<DVec3> {
        let Some((constraint, compliance)) = &self.constraint else {
            return vec![DVec3::ZERO; self.mobility.len()];
        };
        let pressures = compliance.pressures(changes);
        let force = |cluster: usize| self.mobility[cluster] * constraint.force(&pressures, cluster);
        (0..self.mobility.len()).into_par_iter().map(force).collect()
    }

    /// `(M + dt (K + S)) d`.
    fn apply(&self, displacement: &[DVec3], image: &mut [DVec3], at_places: &mut [DVec3]) {
        let slices = self.patches.split(at_places);
        slices.into_par_iter().zip(&self.patches.patches).zip(&self.springs).for_each(
            |((out, patch), springs)| {
                let cluster = |point: &u32| displacement[self.clusters.cluster_of(*point)];
                let local: Vec<DVec3> = patch.control_points.iter().map(cluster).collect();
                out.fill(DVec3::ZERO);
                for (ends, spring) in patch.edges.iter().zip(springs) {
                    let [a, b] = ends.map(|end| end as usize);
                    let pull = (local[a] - local[b]) * *spring;
                    out[a] += pull;
                    out[b] -= pull;
                }
            },
        );
        image.par_iter_mut().enumerate().for_each(|(cluster, image)| {
            *image = displacement[cluster] * self.masses[cluster] + self.sum_of_places(at_places, cluster);
        });
    }

    fn sum_of_places(&self, field: &[DVec3], cluster: usize) -> DVec3 {
        self.patches.places_of_cluster(&self.clusters, cluster).map(|place| field[place]).sum()
    }
}

/// 1 over the diagonal of `M + dt (K + S)`, 0 along the axes in which a point of the cluster is locked by a wall.
fn mobility(
    walls: &[WallSet],
    patches: &Patches,
    clusters: &Numbering,
    springs: &[Vec<f64>],
    masses: &[f64],
) -> Vec<DVec3> {
    let mut diagonal = masses.to_vec();
    for (springs, patch) in springs.iter().zip(&patches.patches) {
        for (ends, spring) in patch.edges.iter().zip(springs) {
            let [a, b] = ends.map(|end| clusters.cluster_of(patch.control_points[end as usize]));
            if a != b {
                diagonal[a] += spring;
                diagonal[b] += spring;
            }
        }
    }
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
