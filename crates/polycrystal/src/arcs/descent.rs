//! Steps down to the least energy at kept areas.
//!
//! Each is one of Newton's method on energy and areas together, with damping (Levenberg 1944, Marquardt
//! 1963): as strong as the energy needs to fall about as its quadratic model says, and where an arc would turn over, that one alone.
//! So what happens at one place takes nothing from a step elsewhere, and the number of steps does not grow with the network.

use std::f64::consts::TAU;

use cancellation::check_cancelled;
use glam::DVec2;
use voronoi::FaceId;

use crate::NetworkError;
use crate::arcs::arc_network::{Arc, ArcNetwork};
use crate::arcs::kkt_system::{Answer, KktSystem};
use crate::mesh::volume::{VOLUME_LIMIT, largest_relative_error};
use crate::solver::conjugate_gradients::dot;

/// Damping of an arc at first, in units of its stiffness.
const FIRST_DAMPING: f64 = 1.0;

/// What the damping of arcs is multiplied by after a step that went as the model says ...
const LOOSENED: f64 = 0.1;

/// ... and before another try where one did not. With 10, one over the other, of the networks that end otherwise three fifths are longer.
const STIFFENED: f64 = 8.0;

/// Least damping after that. With none a twentieth more systems are solved; with 1 of the networks that end otherwise three fifths are longer.
const LEAST_STIFFENED: f64 = 0.3;

/// Damping with which nothing moves.
const LARGEST_DAMPING: f64 = 1e8;

/// Share of its length that a step leaves to an arc's chord. With 0.5 of the networks that end otherwise five sixths are shorter, but one cluster of small
/// grains in 40 no longer comes to rest; with 0.1 three quarters are longer, and a quarter more systems are solved.
const KEPT_LENGTH: f64 = 0.25;

/// How often all chords are looked at for that, as they share ends. With one look, four of 20 clusters of small grains no longer come to rest.
const SWEEPS: usize = 4;

/// Most that an arc's turning changes in a step, in radians. Without a bound three fifths of the networks that end otherwise are longer.
const LARGEST_TURN: f64 = 0.7;

/// Largest turning of an arc, in radians: no arc closes to a circle.
const LARGEST_TURNING: f64 = 5.0;

/// Energy of what is left to do, as a share of all, that is rest: angles are right to 1e-6 radians then.
const REST: f64 = 1e-13;

/// Energy that a step should save, as a share of all, below which rounding hides whether it did.
const HIDDEN: f64 = 1e-12;

/// Error of an area, as a share of it, that counts as none.
const AREA_TOLERANCE: f64 = 1e-13;

/// The same after a step as a share of what that saves of all energy; the next one mends it ...
const AREA_SHARE: f64 = 1e-2;

/// ... and at most. Without this bound one of 1176 networks ends with boundaries that cross.
const LOOSE_AREA: f64 = 1e-4;

/// Most corrections of areas. Without a limit one of 1176 networks takes a hundred times as long. Giving up where the error does not halve instead lets five
/// more come to rest, but solves a twelfth more systems, and of the networks that end otherwise 70 are longer and 54 shorter.
const CORRECTIONS: usize = 40;

/// A state on its way down.
pub(crate) struct Descent {
    pub(crate) state: Vec<f64>,
    pressures: Vec<f64>,
    /// The damping of each edge by number, in units of its stiffness.
    dampings: Vec<f64>,
}

/// What a step did.
pub(crate) struct Step {
    pub(crate) is_at_rest: bool,
    /// Arcs that would have shrunk to nothing.
    pub(crate) vanishing: Vec<FaceId>,
}

impl Descent {
    pub(crate) fn new(network: &ArcNetwork<'_>, state: Vec<f64>) -> Self {
        let mut descent =
            Self { state: Vec::new(), pressures: vec![0.0; network.areas.len()], dampings: Vec::new() };
        descent.go_on(network, state);
        descent
    }

    /// Goes on from another state, of a network with other edges or segments.
    pub(crate) fn go_on(&mut self, network: &ArcNetwork<'_>, state: Vec<f64>) {
        self.state = state;
        let last = network.arcs.iter().map(|arc| arc.face.index()).max();
        let count = last.map_or(0, |last| last + 1).max(self.dampings.len());
        self.dampings.resize(count, FIRST_DAMPING);
    }

    /// One step.
    ///
    /// # Errors
    /// [`NetworkError::VolumeNotRestored`].
    pub(crate) fn step(&mut self, network: &ArcNetwork<'_>) -> Result<Step, NetworkError> {
        let energy = network.energy(&self.state);
        let missing = network.missing(&self.state);
        let (grain, relative_error) = largest_relative_error(&missing, network.areas);
        let mut vanishing = Vec::new();
        // Share of what areas lack that is made up for: after an event, all may be too much for one step.
        let mut mended = 1.0;
        while self.dampings.iter().all(|damping| *damping < LARGEST_DAMPING) {
            check_cancelled();
            let tangent = KktSystem::new(network, &self.state, &self.pressures, &self.dampings);
            if !tangent.is_stable() {
                self.stiffen_all();
                continue;
            }
            let gradient = tangent.gradient();
            let wanted: Vec<f64> = missing.iter().map(|lack| mended * lack).collect();
            let down: Vec<f64> = gradient.iter().map(|slope| -slope).collect();
            let Answer { mut motion, pressures } = tangent.answer(&down, &wanted);
            let fall = dot(&pressures, &wanted) - dot(&gradient, &motion);
            if fall <= REST * energy && relative_error <= VOLUME_LIMIT {
                let left = vec![0.0; missing.len()];
                if let Some(state) = restored(network, &tangent, self.state.clone(), &left, AREA_TOLERANCE) {
                    self.state = state;
                }
                return Ok(Step { is_at_rest: true, vanishing });
            }
            let saved = fall - 0.5 * dot(&motion, &tangent.curvature(&motion));
            vanishing = hold_chords(network, &self.state, &mut motion);
            let moved = self.state.iter().zip(&motion).map(|(x, by)| x + by).collect();
            let enough = (AREA_SHARE * saved / energy).clamp(AREA_TOLERANCE, LOOSE_AREA);
            let left: Vec<f64> = missing.iter().zip(&wanted).map(|(lack, wanted)| lack - wanted).collect();
            let Some(state) = restored(network, &tangent, moved, &left, enough) else {
                self.stiffen_all();
                mended *= LOOSENED;
                continue;
            };
            let turned = turned_over(network, &self.state, &state);
            if !turned.is_empty() {
                // What is stiff itself is turned by chords beside it that are held.
                let is_stiff = turned.iter().any(|face| self.dampings[face.index()] >= FIRST_DAMPING);
                let held = if is_stiff { &vanishing[..] } else { &[] };
                self.stiffen(turned.iter().chain(held).map(|face| face.index()));
                continue;
            }
            // What areas still lack, or no longer do, is worth its pressure.
            let paid = dot(&pressures, &missing) - dot(&pressures, &network.missing(&state));
            let share = (energy - network.energy(&state) + paid) / saved;
            let is_hidden = saved < HIDDEN * energy;
            // Loosened at three quarters and stiffened below one, as is usual: with one threshold, 0.5 or 0.25, a twelfth more systems are solved.
            if share > 0.75 || is_hidden {
                self.dampings.iter_mut().for_each(|damping| *damping *= LOOSENED);
            } else if share < 0.25 {
                self.stiffen_all();
            }
            if share > 0.0 || is_hidden {
                self.state = state;
                self.pressures = pressures;
                return Ok(Step { is_at_rest: false, vanishing });
            }
        }
        if relative_error > VOLUME_LIMIT {
            return Err(NetworkError::volume_not_restored(grain, relative_error));
        }
        // What is too short to move at all is at rest, or on its way to nothing.
        Ok(Step { is_at_rest: vanishing.is_empty(), vanishing })
    }

    fn stiffen_all(&mut self) {
        self.stiffen(0..self.dampings.len());
    }

    fn stiffen(&mut self, edges: impl Iterator<Item = usize>) {
        for edge in edges {
            self.dampings[edge] = (STIFFENED * self.dampings[edge]).max(LEAST_STIFFENED);
        }
    }
}

/// A state with its areas restored, but for what is left for later, up to an error along the gradients of another one nearby; nothing
/// where that does not lead there.
fn restored(
    network: &ArcNetwork<'_>,
    tangent: &KktSystem<'_>,
    mut state: Vec<f64>,
    left: &[f64],
    enough: f64,
) -> Option<Vec<f64>> {
    let mut last = f64::INFINITY;
    for _ in 0..CORRECTIONS {
        // More than a circle is no arc, and would cost time for each of its turns.
        if (0..network.arcs.len()).any(|arc| network.turning(arc, &state).abs() > TAU) {
            return None;
        }
        let missing: Vec<f64> =
            network.missing(&state).iter().zip(left).map(|(lack, left)| lack - left).collect();
        let (_, error) = largest_relative_error(&missing, network.areas);
        if error <= enough || (error <= VOLUME_LIMIT && error > 0.5 * last) {
            return Some(state);
        }
        if error.is_nan() || error > last {
            return None;
        }
        last = error;
        add(&mut state, &tangent.change_areas(&missing));
    }
    None
}

/// Lets no motion take most of an arc's chord, or turn an arc too far; gives the arcs whose chords would vanish.
fn hold_chords(network: &ArcNetwork<'_>, state: &[f64], motion: &mut [f64]) -> Vec<FaceId> {
    let mut vanishing = Vec::new();
    for sweep in 0..SWEEPS {
        for (number, arc) in network.arcs.iter().enumerate() {
            let [start, end] = network.ends(arc, state);
            let chord = start.distance(end).max(f64::MIN_POSITIVE);
            let along = (end - start) / chord;
            let own = network.own(number);
            let stretch = DVec2::new(motion[own[2]] - motion[own[0]], motion[own[3]] - motion[own[1]]);
            let lack = (KEPT_LENGTH - 1.0) * chord - along.dot(stretch);
            if lack <= 0.0 {
                continue;
            }
            if sweep == 0 {
                vanishing.push(arc.face);
            }
            // Walls may leave it to one end; where they hold both, nothing is lacking.
            let free = network.free_at_ends(arc, along);
            let share = lack / (free[0] + free[1]).dot(along);
            for (end, sign) in [(0, -share), (1, share)] {
                motion[own[2 * end]] += sign * free[end].x;
                motion[own[2 * end + 1]] += sign * free[end].y;
            }
        }
    }
    for number in 0..network.arcs.len() {
        let index = network.own(number)[4];
        let turning = state[index];
        let turned = turning + motion[index].clamp(-LARGEST_TURN, LARGEST_TURN);
        motion[index] = turned.clamp(-LARGEST_TURNING, LARGEST_TURNING) - turning;
    }
    vanishing
}

/// The arcs that have turned over.
fn turned_over(network: &ArcNetwork<'_>, before: &[f64], after: &[f64]) -> Vec<FaceId> {
    let has_turned = |arc: &&Arc| {
        let [before, after] =
            [before, after].map(|state| network.ends(arc, state)).map(|[start, end]| end - start);
        before.dot(after) <= 0.0
    };
    network.arcs.iter().filter(has_turned).map(|arc| arc.face).collect()
}

fn add(to: &mut [f64], what: &[f64]) {
    to.iter_mut().zip(what).for_each(|(to, what)| *to += what);
}
