//! The linear system of one step: least energy under linear constraints. What its unknowns stand for it does not know.

use cancellation::check_cancelled;
use glam::{DMat3, DVec3};
use rayon::iter::repeat_n;
use rayon::prelude::*;

use crate::Freedom;
use crate::flow::pressure_response::{CHUNK, PressureResponse};
use crate::flow::volume_constraint::VolumeConstraint;
use crate::solver::rows::CsrRows;

/// Most iterations for a step; usual ones take some ten. Where they do not suffice, the step is shorter: each iteration lessens the energy of
/// the one before, and volumes are right in all of them.
const ITERATIONS: usize = 200;

/// Corrections of a step of free areas; each leaves about half of the error.
const CORRECTIONS: usize = 6;

/// Error of the pressures within the iteration, which works on what they leave.
const LOOSE: f64 = 0.1;

/// What a system is made of: unknown displacements, the energy around where they start, and how volumes follow.
pub(crate) struct Parts {
    /// The mass M of each unknown.
    pub(crate) masses: Vec<f64>,
    /// The gradient g of the energy.
    pub(crate) gradient: Vec<DVec3>,
    /// The stiffness K, as stiffness to other unknowns, softened: divided by the roots of the softness of both. In single precision: what comes
    /// of a step is sought to a hundredth, and its matrix has to come through the memory again and again. That of an element without length is
    /// the largest such number.
    pub(crate) stiffness: CsrRows<f32>,
    /// The root of how many times as soft each unknown is as in the cotangent Laplacian.
    pub(crate) softness_root: Vec<f64>,
    /// What walls leave to each unknown.
    pub(crate) freedoms: Vec<Freedom>,
    /// The gradients J of the volumes; nothing where they are free.
    pub(crate) volumes: Option<VolumeConstraint>,
    /// What the mass of some unknowns is less than isotropic.
    pub(crate) sliding: Vec<(usize, DMat3)>,
}

/// `(M + dt K) d = -dt g + J^T p` for displacements d, with K softened, and pressures p such that `J d` is given.
pub(crate) struct System {
    /// `dt`.
    time: f64,
    /// Share of its first residual at which it is solved.
    tolerance: f64,
    /// The diagonal of `M + dt K`.
    diagonal: Vec<f64>,
    /// What pressures do if there is only the diagonal.
    response: PressureResponse,
    sliding: Vec<(usize, DMat3)>,
    stiffness: CsrRows<f32>,
    /// `-dt g`.
    forces: Vec<DVec3>,
}

impl System {
    /// The system of a step of the given time, which is solved up to a share of its first residual.
    pub(crate) fn new(parts: Parts, time: f64, tolerance: f64) -> Self {
        let Parts { masses, gradient, stiffness, softness_root, freedoms, volumes, sliding } = parts;
        let diagonal = |(unknown, mass): (usize, &f64)| {
            let row = stiffness.row(unknown).iter();
            let softened: f64 =
                row.map(|(other, entry)| f64::from(*entry) * softness_root[*other as usize]).sum();
            mass + time * softened / softness_root[unknown]
        };
        let diagonal: Vec<f64> = masses.par_iter().with_min_len(CHUNK).enumerate().map(diagonal).collect();
        let response = PressureResponse::new(&diagonal, &freedoms, volumes);
        let mut forces = gradient;
        forces.par_iter_mut().with_min_len(CHUNK).for_each(|force| *force *= -time);
        Self { time, tolerance, diagonal, response, sliding, stiffness, forces }
    }

    /// The displacements that change volumes by `changes`, to first order, and are otherwise those of the flow; and the
    /// pressures times the time of the step (none where volumes are free).
    ///
    /// Solved by projected conjugate gradients. Their residual is freed of what pressures balance again and again, so that
    /// these need not be exact (Gould, Hribar and Nocedal 2001, section 5).
    pub(crate) fn displacement(&self, changes: &[f64]) -> (Vec<DVec3>, Vec<f64>) {
        self.solve(&self.forces, changes)
    }

    /// The displacements by the flow of free areas in the plane, with the energy's gradient as it is in the end: `gradient_after` has it
    /// after displacements.
    ///
    /// The matrix is stiff along boundaries too, where their length is not. That holds triple points up, the more the shorter edges are: by a
    /// tenth of their way in usual steps. What is left of the forces after a step so has a step of its own, some times.
    pub(crate) fn implicit_displacement(
        &self,
        gradient_after: impl Fn(&[DVec3]) -> Vec<DVec3>,
    ) -> Vec<DVec3> {
        let (mut displacement, _) = self.solve(&self.forces, &[]);
        for _ in 0..CORRECTIONS {
            let gradient = gradient_after(&displacement);
            let mut left: Vec<DVec3> = gradient.iter().map(|gradient| *gradient * -self.time).collect();
            // Of the matrix the mass alone counts: the gradient after the displacement has all of the stiffness.
            let mut image = zeros(left.len());
            self.apply(&displacement, &mut image);
            add(&mut left, -1.0, &image);
            add(&mut left, 1.0, &self.stiff(&displacement));
            let (correction, _) = self.solve(&left, &[]);
            add(&mut displacement, 1.0, &correction);
        }
        displacement
    }

    /// `dt K d`.
    fn stiff(&self, displacement: &[DVec3]) -> Vec<DVec3> {
        let row = |unknown: usize| {
            let stiffness = self.stiffness.row(unknown).iter();
            let pulls = stiffness.map(|(other, entry)| {
                (displacement[unknown] - displacement[*other as usize]) * f64::from(*entry)
            });
            pulls.sum::<DVec3>() * self.time
        };
        (0..displacement.len()).into_par_iter().with_min_len(CHUNK).map(row).collect()
    }

    /// The displacements under some forces, and pressures, as of [`Self::displacement`].
    fn solve(&self, forces: &[DVec3], changes: &[f64]) -> (Vec<DVec3>, Vec<f64>) {
        let mut pressures = vec![0.0; changes.len()];
        let mut displacement = self.response.displacement(changes);
        let mut residual = copy(forces);
        self.response.hold(&mut residual);
        let (mut image, mut projected) = (zeros(residual.len()), zeros(residual.len()));
        self.apply(&displacement, &mut image);
        add(&mut residual, -1.0, &image);
        let mut size = self.project(&mut residual, &mut projected, &mut pressures);
        let mut direction = copy(&projected);
        let enough = size * self.tolerance * self.tolerance;
        for _ in 0..ITERATIONS {
            check_cancelled();
            if size <= enough || size <= 0.0 {
                break;
            }
            let stiffness = self.apply(&direction, &mut image);
            // Rounding alone is left, or a direction that nothing resists: what was found so far is the step.
            if stiffness.is_nan() || stiffness <= 0.0 {
                break;
            }
            let step = size / stiffness;
            let moved = displacement.par_iter_mut().zip(&direction).with_min_len(CHUNK);
            let left = residual.par_iter_mut().zip(&image);
            moved.zip(left).for_each(|((displacement, direction), (residual, image))| {
                *displacement += *direction * step;
                *residual -= *image * step;
            });
            let next = self.project(&mut residual, &mut projected, &mut pressures);
            let growth = next / size;
            let directions = direction.par_iter_mut().with_min_len(CHUNK).zip(&projected);
            directions.for_each(|(direction, projected)| *direction = *projected + *direction * growth);
            size = next;
        }
        if let Some((constraint, _)) = &self.response.constraint {
            pressures = constraint.of_grains(&pressures);
            let change = constraint.of_grains(&constraint.volume_change(|unknown| displacement[unknown]));
            let left: Vec<f64> =
                changes.iter().zip(&change).map(|(wanted, change)| wanted - change).collect();
            add(&mut displacement, 1.0, &self.response.displacement(&left));
        }
        // What rounding of large forces leaves of them would carry points off their walls.
        self.response.hold(&mut displacement);
        (displacement, pressures)
    }

    /// Takes out of a residual what pressures balance, and the pressures from `sum`; `projected` becomes the displacement under the rest if
    /// there were only the diagonal of the matrix. Gives the product of the two.
    fn project(&self, residual: &mut [DVec3], projected: &mut [DVec3], sum: &mut [f64]) -> f64 {
        let PressureResponse { mobility, constraint, .. } = &self.response;
        let pressures = constraint.as_ref().map(|(constraint, compliance)| {
            let moved = constraint.volume_change(|unknown| residual[unknown] * mobility[unknown]);
            let pressures = compliance.pressures(&moved, LOOSE);
            sum.iter_mut().zip(&pressures).for_each(|(sum, pressure)| *sum -= *pressure);
            (constraint, pressures)
        });
        let project = |(unknown, (residual, projected)): (usize, (&mut DVec3, &mut DVec3))| {
            if let Some((constraint, pressures)) = &pressures {
                *residual -= constraint.force(pressures, unknown);
            }
            *projected = *residual * mobility[unknown];
            residual.dot(*projected)
        };
        sum_by_chunks(residual.par_iter_mut().zip(projected).enumerate().map(project))
    }

    /// `image` becomes `(M + dt K) d`, as far as walls leave it; gives its product with the displacement d.
    ///
    /// What walls hold is large at rest, where the rest is rounding: left in, it would grow from one iteration to the next.
    fn apply(&self, displacement: &[DVec3], image: &mut [DVec3]) -> f64 {
        let row = |(unknown, image): (usize, &mut DVec3)| {
            let stiffness = self.stiffness.row(unknown).iter();
            let pull: DVec3 =
                stiffness.map(|(other, entry)| displacement[*other as usize] * f64::from(*entry)).sum();
            *image = displacement[unknown] * self.diagonal[unknown] - pull * self.time;
            image.dot(displacement[unknown])
        };
        let mut product = sum_by_chunks(image.par_iter_mut().enumerate().map(row));
        for (unknown, mass) in &self.sliding {
            let by = *mass * displacement[*unknown];
            image[*unknown] -= by;
            product -= by.dot(displacement[*unknown]);
        }
        self.response.hold(image);
        product
    }
}

/// Entries of the stiffness of [`Parts`], made of its row, its column and what it is in the cotangent Laplacian.
#[expect(clippy::cast_possible_truncation, reason = "rounding")]
pub(crate) fn softened(softness_root: &[f64]) -> impl Fn(usize, u32, f64) -> f32 {
    |row, column, stiffness| {
        let softened = stiffness / (softness_root[row] * softness_root[column as usize]);
        softened.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
    }
}

/// A copy that all threads make: the system hands fresh memory out page by page, and takes its time.
fn copy(vector: &[DVec3]) -> Vec<DVec3> {
    vector.par_iter().with_min_len(CHUNK).copied().collect()
}

/// The same of a vector of nothing.
fn zeros(len: usize) -> Vec<DVec3> {
    repeat_n(DVec3::ZERO, len).with_min_len(CHUNK).collect()
}

/// Adds a multiple of a vector to another one.
fn add(to: &mut [DVec3], factor: f64, what: &[DVec3]) {
    let pairs = to.par_iter_mut().with_min_len(CHUNK).zip(what);
    pairs.for_each(|(to, what)| *to += *what * factor);
}

/// A sum whose order is that of the chunks, whichever thread adds them up.
fn sum_by_chunks(values: impl IndexedParallelIterator<Item = f64>) -> f64 {
    let sums: Vec<f64> = values.fold_chunks(CHUNK, || 0.0, |sum, value| sum + value).collect();
    sums.iter().sum()
}
