//! The linear system of one step: least energy under the constraint of the grains' volumes.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::clusters::Numbering;
use super::patch::{Patch, PatchTerms};
use super::patches::Patches;
use super::rows::Rows;
use super::volume_constraint::{Compliance, VolumeConstraint};
use crate::{Freedom, Level, Network, Volumes};

/// Most iterations for a step.
const ITERATIONS: usize = 200;

/// Corrections of a step of free areas; each leaves about half of the error.
const CORRECTIONS: usize = 6;

/// Error of the pressures within the iteration, which works on what they leave.
const LOOSE: f64 = 0.1;

/// Error of the pressures that give the volumes.
const TIGHT: f64 = 1e-6;

/// Share of a junction's mass that resists in all directions: without, nothing would hold points along a triple line.
const ALONG_LINES: f64 = 0.01;

/// Unknowns that one task works on; fixed, so that no sum depends on the number of threads.
const CHUNK: usize = 4096;

/// `(M + dt K) d = -dt g + J^T p` for the displacements d of clusters, with pressures p such that `J d` is given.
pub(super) struct System {
    /// `dt`.
    time: f64,
    tolerance: f64,
    clusters: Numbering,
    /// The diagonal of `M + dt (K + S)`.
    diagonal: Vec<f64>,
    /// What the mass of some clusters is less than isotropic: only where volumes are free.
    sliding: Vec<(usize, DMat3)>,
    /// What is beside the diagonal, with the sign turned; columns may come more than once.
    springs: Rows<f64>,
    /// `-dt g`.
    forces: Vec<DVec3>,
    mobility: Vec<Mobility>,
    /// Nothing where volumes are free.
    constraint: Option<(VolumeConstraint, Compliance)>,
}

/// What a step is like.
pub(super) struct Step {
    pub(super) time: f64,
    pub(super) volumes: Volumes,
    /// Share of its first residual at which it is solved.
    pub(super) tolerance: f64,
}

impl System {
    /// The system of a step of the given time, from points with the given terms.
    pub(super) fn new(
        network: &Network,
        patches: &Patches,
        terms: &[PatchTerms],
        sizes: &[f64],
        clusters: Numbering,
        Step { time, volumes, tolerance }: Step,
        level: &Level,
    ) -> Self {
        let count = clusters.cluster_count();
        let points_of = |cluster| {
            patches.places_of_cluster(&clusters, cluster).map(|place| patches.point_of_place(place))
        };
        let row = |cluster: usize, entries: &mut Vec<(u32, f64)>| {
            for (patch, point) in points_of(cluster) {
                let Patch { control_points, links, .. } = &patches.patches[patch];
                for (end, edge) in links.row(point) {
                    let other = clusters.numbers()[control_points[*end as usize] as usize];
                    if other as usize != cluster {
                        entries.push((other, time * terms[patch].stiffness[*edge as usize]));
                    }
                }
            }
        };
        let springs = Rows::made_by(count, row);
        let diagonal = |cluster: usize| {
            let masses = points_of(cluster).map(|(patch, point)| {
                let size = sizes[patches.patches[patch].control_points[point] as usize];
                terms[patch].mass[point] / size.powi(2)
            });
            let mass: f64 = masses.sum();
            springs.row(cluster).iter().fold(mass, |sum, (_, spring)| sum + spring)
        };
        let diagonal: Vec<f64> = (0..count).into_par_iter().with_min_len(CHUNK).map(diagonal).collect();
        let forces = forces(patches, terms, &clusters, time);
        let sliding = match volumes {
            Volumes::Kept => Vec::new(),
            Volumes::Free => sliding_masses(patches, terms, &clusters, level),
        };
        let mobility = |(cluster, diagonal): (usize, &f64)| {
            let inverse = if *diagonal > 0.0 { 1.0 / diagonal } else { 0.0 };
            Mobility {
                inverse,
                freedom: clusters.freedom(cluster, |point| network.freedom(level.walls[point as usize])),
            }
        };
        let mobility: Vec<Mobility> =
            diagonal.par_iter().with_min_len(CHUNK).enumerate().map(mobility).collect();
        let constraint = (volumes == Volumes::Kept).then(|| {
            let constraint = VolumeConstraint::new(network, patches, terms, &clusters);
            let compliance = constraint.compliance(&mobility);
            (constraint, compliance)
        });
        Self { time, tolerance, clusters, diagonal, sliding, springs, forces, mobility, constraint }
    }

    /// The displacement of every control point that changes the grains' volumes by `changes`, to first order, and is
    /// otherwise that of the flow; and the pressures of all grains times the time of the step (none where volumes are free).
    ///
    /// Solved by projected conjugate gradients. Their residual is freed of what pressures balance again and again, so that
    /// these need not be exact (Gould, Hribar and Nocedal 2001, section 5).
    pub(super) fn displacement(&self, changes: &[f64]) -> (Vec<DVec3>, Vec<f64>) {
        let (displacement, pressures) = self.solve(&self.forces, changes);
        (self.of_points(&displacement), pressures)
    }

    /// The displacement of every control point by the flow of free areas in the plane, with the area's gradient as it is in the end; `terms_at` has the
    /// terms of the patches after a displacement.
    ///
    /// The matrix is stiff along boundaries too, where their length is not. That holds triple points up, the more the shorter edges are: by a
    /// tenth of their way in usual steps. What is left of the forces after a step so has a step of its own, some times.
    pub(super) fn implicit_displacement(
        &self,
        patches: &Patches,
        terms_at: impl Fn(&[DVec3]) -> Vec<PatchTerms>,
    ) -> Vec<DVec3> {
        let (mut displacement, _) = self.solve(&self.forces, &[]);
        for _ in 0..CORRECTIONS {
            let terms = terms_at(&self.of_points(&displacement));
            let mut left = forces(patches, &terms, &self.clusters, self.time);
            // Of the matrix the mass alone counts: the gradient after the displacement has all of the stiffness.
            add(&mut left, -1.0, &self.apply(&displacement));
            add(&mut left, 1.0, &self.stiff(&displacement));
            let (correction, _) = self.solve(&left, &[]);
            add(&mut displacement, 1.0, &correction);
        }
        self.of_points(&displacement)
    }

    /// `dt K d`.
    fn stiff(&self, displacement: &[DVec3]) -> Vec<DVec3> {
        let row = |cluster: usize| {
            let springs = self.springs.row(cluster).iter();
            springs
                .map(|(other, spring)| (displacement[cluster] - displacement[*other as usize]) * *spring)
                .sum()
        };
        (0..displacement.len()).into_par_iter().with_min_len(CHUNK).map(row).collect()
    }

    /// The displacement of clusters under some forces, and pressures, as of [`Self::displacement`].
    fn solve(&self, forces: &[DVec3], changes: &[f64]) -> (Vec<DVec3>, Vec<f64>) {
        let mut pressures = vec![0.0; changes.len()];
        let mut displacement = self.push(changes);
        let mut residual = forces.to_vec();
        add(&mut residual, -1.0, &self.apply(&displacement));
        let mut direction = self.project(&mut residual, &mut pressures);
        let mut size = dot(&residual, &direction);
        let enough = size * self.tolerance * self.tolerance;
        for _ in 0..ITERATIONS {
            if size <= enough || size <= 0.0 {
                break;
            }
            let image = self.apply(&direction);
            let stiffness = dot(&direction, &image);
            if stiffness.is_nan() || stiffness <= 0.0 {
                break;
            }
            let step = size / stiffness;
            add(&mut displacement, step, &direction);
            add(&mut residual, -step, &image);
            let mut projected = self.project(&mut residual, &mut pressures);
            let next = dot(&residual, &projected);
            add(&mut projected, next / size, &direction);
            direction = projected;
            size = next;
        }
        if let Some((constraint, _)) = &self.constraint {
            let change = constraint.volume_change(&displacement);
            let left: Vec<f64> =
                changes.iter().zip(&change).map(|(wanted, change)| wanted - change).collect();
            add(&mut displacement, 1.0, &self.push(&left));
        }
        (displacement, pressures)
    }

    /// The least motion by area of the control points that changes the grains' volumes by `changes`, to first order,
    /// for a system of time 0.
    pub(super) fn volume_correction(&self, changes: &[f64]) -> Vec<DVec3> {
        self.of_points(&self.push(changes))
    }

    fn of_points(&self, of_clusters: &[DVec3]) -> Vec<DVec3> {
        self.clusters.numbers().iter().map(|number| of_clusters[*number as usize]).collect()
    }

    /// Takes out of a residual what pressures balance, takes these from `sum`, and gives the displacement under the rest if there were only the
    /// diagonal of the matrix.
    fn project(&self, residual: &mut [DVec3], sum: &mut [f64]) -> Vec<DVec3> {
        let moved: Vec<DVec3> =
            residual.iter().zip(&self.mobility).map(|(r, mobility)| mobility.of(*r)).collect();
        let Some((constraint, compliance)) = &self.constraint else { return moved };
        let pressures = compliance.pressures(&constraint.volume_change(&moved), LOOSE);
        sum.iter_mut().zip(&pressures).for_each(|(sum, pressure)| *sum -= *pressure);
        let project = |(cluster, residual): (usize, &mut DVec3)| {
            *residual -= constraint.force(&pressures, cluster);
            self.mobility[cluster].of(*residual)
        };
        residual.par_iter_mut().with_min_len(CHUNK).enumerate().map(project).collect()
    }

    /// The displacement under the pressures that change volumes by `changes`, if there were only the diagonal of the matrix;
    /// none where volumes are free.
    fn push(&self, changes: &[f64]) -> Vec<DVec3> {
        let Some((constraint, compliance)) = &self.constraint else {
            return vec![DVec3::ZERO; self.mobility.len()];
        };
        let pressures = compliance.pressures(changes, TIGHT);
        let force = |cluster: usize| self.mobility[cluster].of(constraint.force(&pressures, cluster));
        (0..self.mobility.len()).into_par_iter().with_min_len(CHUNK).map(force).collect()
    }

    /// `(M + dt K) d`.
    fn apply(&self, displacement: &[DVec3]) -> Vec<DVec3> {
        let row = |cluster: usize| {
            let springs = self.springs.row(cluster).iter();
            let own = displacement[cluster] * self.diagonal[cluster];
            springs.fold(own, |sum, (other, spring)| sum - displacement[*other as usize] * *spring)
        };
        let mut image: Vec<DVec3> =
            (0..displacement.len()).into_par_iter().with_min_len(CHUNK).map(row).collect();
        for (cluster, mass) in &self.sliding {
            image[*cluster] -= *mass * displacement[*cluster];
        }
        image
    }
}

/// `-dt g` for all clusters.
fn forces(patches: &Patches, terms: &[PatchTerms], clusters: &Numbering, time: f64) -> Vec<DVec3> {
    let force = |cluster: usize| {
        let places = patches.places_of_cluster(clusters, cluster).map(|place| patches.point_of_place(place));
        places.map(|(patch, point)| terms[patch].gradient[point]).sum::<DVec3>() * -time
    };
    (0..clusters.cluster_count()).into_par_iter().with_min_len(CHUNK).map(force).collect()
}

/// How a cluster answers to a force if there were only the diagonal of the matrix.
pub(super) struct Mobility {
    /// 1 over the diagonal.
    inverse: f64,
    /// What the walls leave to all points of the cluster.
    freedom: Freedom,
}

impl Mobility {
    /// The displacement under a force.
    pub(super) fn of(&self, force: DVec3) -> DVec3 {
        self.freedom.project(force) * self.inverse
    }
}

/// Adds a multiple of a vector to another one.
fn add(to: &mut [DVec3], factor: f64, what: &[DVec3]) {
    let pairs = to.par_iter_mut().with_min_len(CHUNK).zip(what);
    pairs.for_each(|(to, what)| *to += *what * factor);
}

/// A sum whose order is that of the chunks, whichever thread adds them up.
fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    let chunks = a.par_chunks(CHUNK).zip(b.par_chunks(CHUNK));
    let sums: Vec<f64> = chunks.map(|(a, b)| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()).collect();
    sums.iter().sum()
}

/// The part of the mass of junctions that does not resist their motion.
///
/// Boundaries resist to be moved along their normals only, and junctions have no drag of their own: a boundary of mass m and
/// normal n has the mass matrix `m n n^T`. So polygons in the plane shrink and grow by the law of von Neumann and Mullins
/// exactly, to first order in their angles, whatever the lengths of the segments that meet: with force `sum of a n`, a the
/// angle by which a segment of length h is off equilibrium, the velocity v has `h/2 n v = a + c` with the same c for all
/// three, and the area that two of them sweep is the difference of their a.
///
/// Curvature flow of kept volumes leads to equilibrium with any masses.
fn sliding_masses(
    patches: &Patches,
    terms: &[PatchTerms],
    clusters: &Numbering,
    level: &Level,
) -> Vec<(usize, DMat3)> {
    let is_junction = |point: &u32| {
        let point = *point as usize;
        level.node_types[point].side_count() - i8::from(!level.walls[point].is_empty()) >= 3
    };
    let of_cluster = |cluster: usize| {
        clusters.members(cluster).iter().any(is_junction).then(|| {
            let places = patches.places_of_cluster(clusters, cluster);
            let sliding = places.map(|place| {
                let (patch, point) = patches.point_of_place(place);
                let normal = terms[patch].sweep[point].normalize_or_zero();
                (DMat3::IDENTITY - DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z))
                    * terms[patch].mass[point]
            });
            (cluster, sliding.sum::<DMat3>() * (1.0 - ALONG_LINES))
        })
    };
    (0..clusters.cluster_count()).into_par_iter().filter_map(of_cluster).collect()
}
