//! Steps down to the least energy at kept areas.
//!
//! States with the right areas make up a smooth manifold, on which this is Newton's method within a region of trust (Absil, Baker
//! and Gallivan 2007): the quadratic model of the energy under the pressures is followed by projected conjugate gradients to the
//! rim of the region at most (Steihaug 1983), and areas are restored after it. The energy falls with each step.

use glam::DVec2;
use voronoi::FaceId;

use super::foam::{Foam, Tangent};
use crate::NetworkError;
use crate::relax::conjugate_gradients::dot;
use crate::volume::largest_relative_error;

/// Energy, as a share of all, that the first region lets a step cost if stiffness were all.
const FIRST_REGION: f64 = 0.03;

/// Share of the first residual at which conjugate gradients end, or the residual's own share of the energy if that is less: the
/// nearer to rest, the better a step is worth its price.
const LOOSE: f64 = 0.1;

/// Most iterations of conjugate gradients.
const ITERATIONS: usize = 500;

/// Share of its length that a step leaves to an arc's chord.
const KEPT_LENGTH: f64 = 0.25;

/// How often all chords are looked at for that, as they share ends.
const SWEEPS: usize = 4;

/// Share of a chord's direction in which an end is free, below which walls hold it.
const SMALLEST_SHARE: f64 = 0.1;

/// Most that an arc's turning changes in a step, in radians.
const LARGEST_TURN: f64 = 0.7;

/// Largest turning of an arc, in radians: no arc closes to a circle.
const LARGEST_TURNING: f64 = 5.0;

/// Energy of what is left to do, as a share of all, that is rest: angles are right to 1e-8 radians then.
const REST: f64 = 1e-16;

/// Energy that a step should save, as a share of all, below which rounding hides whether it did.
const HIDDEN: f64 = 1e-12;

/// Error of an area, as a share of it, that counts as none.
const AREA_TOLERANCE: f64 = 1e-13;

/// Error with which a step is still good; the next one mends it.
const AREA_LIMIT: f64 = 1e-10;

/// Most corrections of areas.
const CORRECTIONS: usize = 40;

/// A state on its way down.
pub(super) struct Descent {
    pub(super) state: Vec<f64>,
    /// Radius of the region of trust.
    radius: f64,
}

/// What a step did.
pub(super) struct Step {
    pub(super) is_at_rest: bool,
    /// Arcs that would have shrunk to nothing.
    pub(super) vanishing: Vec<FaceId>,
}

impl Descent {
    pub(super) fn new(foam: &Foam<'_>, state: Vec<f64>) -> Self {
        let radius = (FIRST_REGION * foam.energy(&state)).sqrt();
        Self { state, radius }
    }

    /// One step.
    ///
    /// # Errors
    /// [`NetworkError::VolumeNotRestored`].
    pub(super) fn step(&mut self, foam: &Foam<'_>) -> Result<Step, NetworkError> {
        self.restore(foam)?;
        let tangent = foam.tangent(&self.state);
        let energy = foam.energy(&self.state);
        let mut residual = tangent.gradient();
        let pressures = tangent.project(&mut residual);
        let left = dot(&residual, &tangent.soften(&residual));
        if left <= REST * energy {
            return Ok(Step { is_at_rest: true, vanishing: Vec::new() });
        }
        loop {
            let Model { mut motion, saved, is_at_rim } =
                self.model(&tangent, &pressures, residual.clone(), energy);
            let vanishing = hold_chords(foam, &self.state, &mut motion);
            let moved: Vec<f64> = self.state.iter().zip(&motion).map(|(x, by)| x + by).collect();
            let restored = restored(foam, &tangent, moved);
            let restored = restored.filter(|state| !turns_over(foam, &self.state, state));
            let gained = restored.as_ref().map(|state| energy - foam.energy(state));
            let share = gained.map_or(-1.0, |gained| gained / saved);
            let is_hidden = saved < HIDDEN * energy && gained.is_some();
            if share < 0.25 && !is_hidden {
                self.radius = 0.25 * self.radius.min(length(&tangent, &motion));
            } else if share > 0.75 && is_at_rim {
                self.radius *= 2.0;
            }
            if (share > 0.05 || is_hidden)
                && let Some(state) = restored
            {
                self.state = state;
                return Ok(Step { is_at_rest: false, vanishing });
            }
            // What is too short to move at all is at rest, or on its way to nothing.
            if self.radius * self.radius < REST * energy {
                return Ok(Step { is_at_rest: vanishing.is_empty(), vanishing });
            }
        }
    }

    /// Brings areas back that an event, or the start, has changed.
    fn restore(&mut self, foam: &Foam<'_>) -> Result<(), NetworkError> {
        for done in 0.. {
            let missing = foam.missing(&self.state);
            let (grain, relative_error) = largest_relative_error(&missing, foam.areas);
            if relative_error <= AREA_LIMIT {
                return Ok(());
            }
            if done == CORRECTIONS || !relative_error.is_finite() {
                return Err(NetworkError::VolumeNotRestored { grain, relative_error });
            }
            let tangent = foam.tangent(&self.state);
            let mut motion = tangent.soften(&tangent.force(&tangent.pressures(&missing)));
            hold_chords(foam, &self.state, &mut motion);
            add(&mut self.state, 1.0, &motion);
        }
        Ok(())
    }

    /// The motion that saves most energy within the region.
    fn model(&self, tangent: &Tangent<'_>, pressures: &[f64], mut residual: Vec<f64>, energy: f64) -> Model {
        let mut motion = vec![0.0; residual.len()];
        let mut image = motion.clone();
        let gradient = residual.clone();
        let mut direction: Vec<f64> = tangent.soften(&residual).iter().map(|x| -x).collect();
        let mut size = -dot(&residual, &direction);
        let loose = LOOSE.min((size / energy).sqrt());
        let enough = size * loose * loose;
        let mut is_at_rim = false;
        for _ in 0..ITERATIONS {
            let bent = tangent.curvature(pressures, &direction);
            let curvature = dot(&direction, &bent);
            let whole = size / curvature;
            let to_rim = distance_to_rim(tangent, &motion, &direction, self.radius);
            is_at_rim = curvature <= 0.0 || whole >= to_rim;
            let by = if is_at_rim { to_rim } else { whole };
            add(&mut motion, by, &direction);
            add(&mut image, by, &bent);
            if is_at_rim {
                break;
            }
            add(&mut residual, by, &bent);
            tangent.project_loosely(&mut residual);
            let soft = tangent.soften(&residual);
            let next = dot(&residual, &soft);
            if next <= enough {
                break;
            }
            let share = next / size;
            direction
                .iter_mut()
                .zip(&soft)
                .for_each(|(direction, soft)| *direction = *direction * share - soft);
            size = next;
        }
        let saved = -dot(&gradient, &motion) - 0.5 * dot(&motion, &image);
        Model { motion, saved, is_at_rim }
    }
}

/// A motion and what it would save if the energy were quadratic.
struct Model {
    motion: Vec<f64>,
    saved: f64,
    is_at_rim: bool,
}

/// A state with its areas restored along the gradients of another one nearby; nothing where that does not lead there.
fn restored(foam: &Foam<'_>, tangent: &Tangent<'_>, mut state: Vec<f64>) -> Option<Vec<f64>> {
    let mut last = f64::INFINITY;
    for _ in 0..CORRECTIONS {
        let missing = foam.missing(&state);
        let (_, error) = largest_relative_error(&missing, foam.areas);
        if error <= AREA_TOLERANCE || (error <= AREA_LIMIT && error > 0.5 * last) {
            return Some(state);
        }
        if error.is_nan() || error > last {
            return None;
        }
        last = error;
        add(&mut state, 1.0, &tangent.soften(&tangent.force(&tangent.pressures(&missing))));
    }
    None
}

/// Lets no motion take most of an arc's chord, or turn an arc too far; gives the arcs whose chords would vanish.
fn hold_chords(foam: &Foam<'_>, state: &[f64], motion: &mut [f64]) -> Vec<FaceId> {
    let mut vanishing = Vec::new();
    for sweep in 0..SWEEPS {
        for (number, arc) in foam.arcs.iter().enumerate() {
            let [start, end] = foam.ends(arc, state);
            let chord = start.distance(end).max(f64::MIN_POSITIVE);
            let along = (end - start) / chord;
            let own = foam.own(number);
            let stretch = DVec2::new(motion[own[2]] - motion[own[0]], motion[own[3]] - motion[own[1]]);
            let lack = (KEPT_LENGTH - 1.0) * chord - along.dot(stretch);
            if lack <= 0.0 {
                continue;
            }
            if sweep == 0 {
                vanishing.push(arc.face);
            }
            // Walls may leave it to one end.
            let free = foam.free_at_ends(arc, along);
            let share = lack / (free[0] + free[1]).dot(along).max(SMALLEST_SHARE);
            for (end, sign) in [(0, -share), (1, share)] {
                motion[own[2 * end]] += sign * free[end].x;
                motion[own[2 * end + 1]] += sign * free[end].y;
            }
        }
    }
    for number in 0..foam.arcs.len() {
        let place = foam.own(number)[4];
        let turning = state[place];
        let turned = turning + motion[place].clamp(-LARGEST_TURN, LARGEST_TURN);
        motion[place] = turned.clamp(-LARGEST_TURNING, LARGEST_TURNING) - turning;
    }
    vanishing
}

/// Whether an arc has turned over.
fn turns_over(foam: &Foam<'_>, before: &[f64], after: &[f64]) -> bool {
    let mut arcs = foam.arcs.iter();
    arcs.any(|arc| {
        let [before, after] =
            [before, after].map(|state| foam.ends(arc, state)).map(|[start, end]| end - start);
        before.dot(after) <= 0.0
    })
}

/// How far along a direction the rim of the region is.
fn distance_to_rim(tangent: &Tangent<'_>, motion: &[f64], direction: &[f64], radius: f64) -> f64 {
    let product = |a: &[f64], b: &[f64]| -> f64 {
        a.iter().zip(b).zip(&tangent.stiffness).map(|((a, b), stiffness)| a * b * stiffness).sum()
    };
    let [a, b] = [product(direction, direction), product(direction, motion)];
    let c = radius * radius - product(motion, motion);
    ((b * b + a * c.max(0.0)).sqrt() - b) / a
}

/// The length of a motion, as the region has it.
fn length(tangent: &Tangent<'_>, motion: &[f64]) -> f64 {
    motion.iter().zip(&tangent.stiffness).map(|(x, stiffness)| x * x * stiffness).sum::<f64>().sqrt()
}

/// Adds a multiple of a vector to another one.
fn add(to: &mut [f64], factor: f64, what: &[f64]) {
    to.iter_mut().zip(what).for_each(|(to, what)| *to += factor * what);
}
