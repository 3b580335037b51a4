//! What a network is like near a state: slopes and curvatures, and the motions that forces and changes of area ask for.

use glam::{DMat2, DVec2, DVec3};
use rayon::prelude::*;

use crate::arcs::arc_network::{Arc, ArcNetwork, OWN};
use crate::arcs::chordal_arc::ChordalArc;
use crate::solver::factors::{ELEMENT, Element, LdlFactors};

/// Share of an arc's damping that holds its ends where they are, not only to each other. With all of it three networks of 294 no longer come to
/// rest; with none of it one of 588, a cluster of small grains.
const HELD: f64 = 0.1;

/// The same where an arc has no damping at all: whole networks on a torus would be free to move.
const LEAST_HELD: f64 = 1e-9;

/// What the network is like near a state.
pub(crate) struct KktSystem<'a> {
    network: &'a ArcNetwork<'a>,
    terms: Vec<ArcTerms>,
    factors: LdlFactors,
}

/// The first derivatives of an arc's length and areas by its own variables, and what the second ones follow from.
struct ArcTerms {
    length: [f64; OWN],
    areas: [[f64; OWN]; 2],
    chordal_arc: ChordalArc,
    along: DVec2,
    chord: f64,
    /// The difference of pressure from left to right.
    excess: f64,
    /// One over the stiffness against turning, which pressure may make negative; 0 for what stays straight.
    flexibility: f64,
}

/// A motion, and the pressures that hold areas on it: their force and that asked about together bring it about.
pub(crate) struct Answer {
    pub(crate) motion: Vec<f64>,
    pub(crate) pressures: Vec<f64>,
}

impl ArcTerms {
    fn new(network: &ArcNetwork<'_>, number: usize, state: &[f64], pressures: &[f64], damping: f64) -> Self {
        let arc = &network.arcs[number];
        let [start, end] = network.ends(arc, state);
        let chordal_arc = network.chordal_arc(number, state);
        let chord = start.distance(end).max(f64::MIN_POSITIVE);
        let along = (end - start) / chord;
        let pull = along * (arc.tension * chordal_arc.length[0]);
        let length = [-pull.x, -pull.y, pull.x, pull.y, arc.tension * chord * chordal_arc.length[1]];
        let swell = along * (2.0 * chord * chordal_arc.area[0]);
        let bulge = [-swell.x, -swell.y, swell.x, swell.y, chord * chord * chordal_arc.area[1]];
        let areas = [0, 1].map(|side| {
            let Some((_, offset)) = arc.beside[side] else { return [0.0; OWN] };
            let (a, b) = (0.5 * (start - offset), 0.5 * (end - offset));
            let triangle = [b.y, -b.x, -a.y, a.x, 0.0];
            let sign = if side == 0 { 1.0 } else { -1.0 };
            [0, 1, 2, 3, 4].map(|k| sign * (triangle[k] + bulge[k]))
        });
        let [left, right] = arc.beside.map(|beside| beside.map_or(0.0, |(cell, _)| pressures[cell]));
        let excess = left - right;
        let plain = arc.tension * chord * chordal_arc.length[2];
        let bending = plain * (1.0 + damping) - excess * chord * chord * chordal_arc.area[2];
        let is_straight = arc.chords == 1 || plain <= 0.0;
        let flexibility = if is_straight { 0.0 } else { 1.0 / bending };
        Self { length, areas, chordal_arc, along, chord, excess, flexibility }
    }

    /// What the arc adds to the matrix: of its ends and of the pressures beside it, after its turning is eliminated.
    fn element(&self, network: &ArcNetwork<'_>, arc: &Arc, damping: f64) -> Element {
        let Self { chordal_arc, along, chord, excess, flexibility, .. } = *self;
        let pull = arc.tension * chordal_arc.length[0] / chord;
        // Edges without tension count, too: short ones are not to turn over with a step.
        let stiffness = if arc.tension > 0.0 { pull } else { network.mean_tension / chord };
        let normal = along.perp();
        let transverse = outer(normal, normal) * pull
            + DMat2::from_diagonal(DVec2::splat(damping * stiffness - 2.0 * chordal_arc.area[0] * excess));
        let held = DMat2::from_diagonal(DVec2::splat(HELD.mul_add(damping, LEAST_HELD) * stiffness));
        // The triangle to the arc's ends has half the product of these two.
        let turned = DMat2::from_cols(DVec2::Y, DVec2::NEG_X) * (0.5 * excess);
        let free = arc.ends.map(|(vertex, _)| {
            let [x, y] = [DVec3::X, DVec3::Y].map(|axis| network.freedoms[vertex].project(axis).truncate());
            DMat2::from_cols(x, y)
        });
        // What turns with each end and with each pressure.
        let wind = self.winding(arc);
        let mut turns = [0.0; ELEMENT];
        let mut matrix = [[0.0; ELEMENT]; ELEMENT];
        for (row, column, block) in [
            (0, 0, transverse + held),
            (0, 1, turned - transverse),
            (1, 0, -turned - transverse),
            (1, 1, transverse + held),
        ] {
            let mut block = free[row] * block * free[column];
            if row == column {
                // Where walls hold, nothing else acts.
                block += (DMat2::IDENTITY - free[row]) * stiffness;
            }
            for (x, values) in block.to_cols_array_2d().into_iter().enumerate() {
                (0..2).for_each(|y| matrix[2 * row + y][2 * column + x] = values[y]);
            }
        }
        for (end, wind) in [-wind, wind].into_iter().enumerate() {
            let free = free[end] * wind;
            (turns[2 * end], turns[2 * end + 1]) = (free.x, free.y);
        }
        let mut unknowns = [0; ELEMENT];
        for (end, (vertex, _)) in arc.ends.into_iter().enumerate() {
            let index = network.order.vertex(vertex).expect("the arc ends there");
            (unknowns[2 * end], unknowns[2 * end + 1]) = (index, index + 1);
        }
        let beside = arc.beside.map(|beside| Some(beside?.0));
        let some = beside[0].or(beside[1]).expect("there is a cell beside each edge");
        for (side, cell) in beside.into_iter().enumerate() {
            unknowns[4 + side] = network.order.cell(cell.unwrap_or(some));
            match cell {
                None => continue,
                Some(cell) if cell == network.pinned => {
                    matrix[4 + side][4 + side] = -1.0;
                    continue;
                }
                Some(_) => {}
            }
            let own = self.areas[side];
            for end in [0, 1] {
                let slope = free[end] * DVec2::new(own[2 * end], own[2 * end + 1]);
                for axis in [0, 1] {
                    matrix[4 + side][2 * end + axis] = slope[axis];
                    matrix[2 * end + axis][4 + side] = slope[axis];
                }
            }
            turns[4 + side] = own[4];
        }
        for (row, own) in matrix.iter_mut().zip(&turns) {
            row.iter_mut().zip(&turns).for_each(|(entry, other)| *entry -= own * other * flexibility);
        }
        Element { unknowns, matrix }
    }

    /// The force on the end per turning; that on the start is the opposite.
    fn winding(&self, arc: &Arc) -> DVec2 {
        self.along
            * (arc.tension * self.chordal_arc.length[1]
                - 2.0 * self.chord * self.chordal_arc.area[1] * self.excess)
    }
}

fn outer(a: DVec2, b: DVec2) -> DMat2 {
    DMat2::from_cols(a * b.x, a * b.y)
}

impl<'a> KktSystem<'a> {
    /// That of a network at a state under pressures, with a damping for each arc.
    pub(crate) fn new(
        network: &'a ArcNetwork<'a>,
        state: &[f64],
        pressures: &[f64],
        dampings: &[f64],
    ) -> Self {
        let of_arc = |number: usize| {
            let arc = &network.arcs[number];
            let damping = dampings[arc.face.index()];
            let terms = ArcTerms::new(network, number, state, pressures, damping);
            let element = terms.element(network, arc, damping);
            (terms, element)
        };
        let (terms, elements): (Vec<ArcTerms>, Vec<Element>) =
            (0..network.arcs.len()).into_par_iter().map(of_arc).unzip();
        Self { network, terms, factors: LdlFactors::new(&network.order, &elements) }
    }

    /// Whether the energy has a least value on all motions that keep areas.
    pub(crate) fn is_stable(&self) -> bool {
        // A turning that is eliminated counts as it would in the whole matrix (Haynsworth 1968).
        let soft = self.terms.iter().filter(|terms| terms.flexibility < 0.0).count();
        self.factors.negative_count() + soft == self.network.areas.len()
    }

    /// The gradient of the energy.
    pub(crate) fn gradient(&self) -> Vec<f64> {
        let mut gradient = self.zero();
        for (number, terms) in self.terms.iter().enumerate() {
            let own = self.network.own(number).into_iter().zip(terms.length);
            own.for_each(|(variable, slope)| gradient[variable] += slope);
        }
        self.network.keep_free(&mut gradient);
        gradient
    }

    /// The motion that changes areas so, to first order, with the least stiffness in its way.
    pub(crate) fn change_areas(&self, changes: &[f64]) -> Vec<f64> {
        self.answer(&self.zero(), changes).motion
    }

    fn zero(&self) -> Vec<f64> {
        vec![0.0; 2 * self.network.freedoms.len() + self.network.arcs.len()]
    }

    /// The motion that a force and changes of area lead to, to first order.
    pub(crate) fn answer(&self, force: &[f64], changes: &[f64]) -> Answer {
        let ArcNetwork { arcs, order, freedoms, .. } = self.network;
        let (forces, torques) = force.split_at(2 * freedoms.len());
        let positions = || (0..freedoms.len()).filter_map(|vertex| Some((vertex, order.vertex(vertex)?)));
        let mut values = vec![0.0; order.len()];
        for (vertex, index) in positions() {
            values[index..index + 2].copy_from_slice(&forces[2 * vertex..2 * vertex + 2]);
        }
        for (cell, change) in changes.iter().enumerate() {
            values[order.cell(cell)] += change;
        }
        for ((arc, terms), torque) in arcs.iter().zip(&self.terms).zip(torques) {
            let wound = terms.winding(arc) * (torque * terms.flexibility);
            for ((vertex, _), wound) in arc.ends.iter().zip([-wound, wound]) {
                let index = order.vertex(*vertex).expect("the arc ends there");
                let free = freedoms[*vertex].project(wound.extend(0.0));
                values[index] -= free.x;
                values[index + 1] -= free.y;
            }
            for (beside, area) in arc.beside.iter().zip(&terms.areas) {
                if let Some((cell, _)) = beside {
                    values[order.cell(*cell)] -= area[4] * torque * terms.flexibility;
                }
            }
        }
        values[order.cell(self.network.pinned)] = 0.0;
        self.factors.solve(&mut values);
        let pressures: Vec<f64> = (0..changes.len()).map(|cell| -values[order.cell(cell)]).collect();
        let mut motion = self.zero();
        for (vertex, index) in positions() {
            motion[2 * vertex..2 * vertex + 2].copy_from_slice(&values[index..index + 2]);
        }
        self.network.keep_free(&mut motion);
        let (positions, turns) = motion.split_at_mut(2 * freedoms.len());
        for (((arc, terms), torque), turn) in arcs.iter().zip(&self.terms).zip(torques).zip(turns) {
            let [start, end] =
                arc.ends.map(|(vertex, _)| DVec2::new(positions[2 * vertex], positions[2 * vertex + 1]));
            let beside = arc.beside.iter().zip(&terms.areas);
            let pressed =
                beside.map(|(beside, area)| beside.map_or(0.0, |(cell, _)| area[4] * pressures[cell]));
            let wound = terms.winding(arc).dot(end - start);
            *turn = (torque + pressed.sum::<f64>() - wound) * terms.flexibility;
        }
        Answer { motion, pressures }
    }

    /// The second derivative of the energy under the pressures, times a motion.
    pub(crate) fn curvature(&self, motion: &[f64]) -> Vec<f64> {
        let mut image = vec![0.0; motion.len()];
        for (number, (arc, terms)) in self.network.arcs.iter().zip(&self.terms).enumerate() {
            let ArcTerms { chordal_arc, along, chord, excess, .. } = terms;
            let own = self.network.own(number);
            let [start, end] =
                [[own[0], own[1]], [own[2], own[3]]].map(|[x, y]| DVec2::new(motion[x], motion[y]));
            let (stretch, turn) = (end - start, motion[own[4]]);
            let longer = along.dot(stretch);
            let across = stretch - along * longer;
            let pull = across * (arc.tension * chordal_arc.length[0] / chord)
                + along * (arc.tension * chordal_arc.length[1] * turn)
                - (stretch * (2.0 * chordal_arc.area[0])
                    + along * (2.0 * chord * chordal_arc.area[1] * turn))
                    * excess;
            let wind = (arc.tension * chordal_arc.length[1] - excess * 2.0 * chord * chordal_arc.area[1])
                * longer
                + (arc.tension * chord * chordal_arc.length[2]
                    - excess * chord * chord * chordal_arc.area[2])
                    * turn;
            // The triangle to the arc's ends has half the product of these two.
            let [at_start, at_end] =
                [-pull + end.perp() * (0.5 * excess), pull - start.perp() * (0.5 * excess)];
            for (variable, value) in own.into_iter().zip([at_start.x, at_start.y, at_end.x, at_end.y, wind]) {
                image[variable] += value;
            }
        }
        self.network.keep_free(&mut image);
        image
    }
}
