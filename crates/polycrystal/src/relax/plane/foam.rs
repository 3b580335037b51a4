//! Arcs between vertices, weighted by tension, around cells of given areas.
//!
//! A state lists the coordinates of all vertices, two each, and then the turning of every arc.

use glam::{DVec2, DVec3};
use voronoi::{CellComplex, FaceId};

use super::bow::Bow;
use crate::relax::local_area::{boundary, cell_and_offset, freedom};
use crate::relax::rows::Rows;
use crate::relax::volume_constraint::Compliance;
use crate::{Boundary, Freedom};

/// Error of the pressures, as a share.
const TIGHT: f64 = 1e-12;

/// The same within conjugate gradients, which work on what they leave.
const LOOSE: f64 = 1e-2;

/// Variables of an arc: its start, its end, and its turning.
const OWN: usize = 5;

/// The lengths and areas that a complex of the plane has if its edges are arcs.
pub(super) struct Foam<'a> {
    pub(super) arcs: Vec<Arc>,
    pub(super) areas: &'a [f64],
    freedoms: Vec<Freedom>,
    /// Of all arcs that have any.
    mean_tension: f64,
}

/// An edge as an arc of equal chords.
pub(super) struct Arc {
    pub(super) face: FaceId,
    /// Vertices, and how far from their own places.
    ends: [(usize, DVec2); 2],
    /// The cells to the left and to the right, and where their areas are measured from; none beyond walls.
    beside: [Option<(usize, DVec2)>; 2],
    tension: f64,
    /// 1 where it stays straight: in walls, and where it has no tension.
    pub(super) chords: u32,
}

/// The first derivatives of an arc's length and areas by its own variables, and what the second ones follow from.
struct ArcTerms {
    length: [f64; OWN],
    areas: [[f64; OWN]; 2],
    bow: Bow,
    along: DVec2,
    chord: f64,
}

/// What the foam is like near a state.
pub(super) struct Tangent<'a> {
    foam: &'a Foam<'a>,
    terms: Vec<ArcTerms>,
    /// Stiffness of each variable by itself: the unit of steps.
    pub(super) stiffness: Vec<f64>,
    compliance: Compliance,
}

impl<'a> Foam<'a> {
    /// The edges of a complex with so many chords each; areas are those wanted.
    pub(super) fn new(
        complex: &CellComplex,
        areas: &'a [f64],
        tension: &dyn Fn(&Boundary) -> f64,
        chords: impl Fn(FaceId) -> u32,
    ) -> Self {
        let domain = complex.domain();
        // From a corner of its own: small cells would lose digits far from the origin.
        let mut places = vec![DVec2::ZERO; areas.len()];
        for face in complex.faces() {
            let corner = complex.position(complex.corners(face)[0]).truncate();
            for side in complex.sides(face) {
                if let Some((cell, offset)) = cell_and_offset(side, domain) {
                    places[cell.index()] = corner - offset.truncate();
                }
            }
        }
        let arc = |face: FaceId| {
            let boundary = boundary(complex.sides(face));
            let tension = tension(&boundary);
            let beside = complex.sides(face).map(|side| {
                let (cell, offset) = cell_and_offset(side, domain)?;
                Some((cell.index(), places[cell.index()] + offset.truncate()))
            });
            let end = |end: usize| {
                let corner = complex.corners(face)[end];
                (corner.vertex as usize, corner.shift.vector(domain).truncate())
            };
            let is_straight = boundary.wall.is_some() || tension == 0.0;
            let chords = if is_straight { 1 } else { chords(face) };
            Arc { face, ends: [end(0), end(1)], beside, tension, chords }
        };
        let arcs: Vec<Arc> = complex.faces().into_iter().map(arc).collect();
        let tensions = || arcs.iter().map(|arc| arc.tension).filter(|tension| *tension > 0.0);
        Self {
            mean_tension: tensions().sum::<f64>() / tensions().count().max(1) as f64,
            arcs,
            areas,
            freedoms: (0u32..).take(complex.vertices.len()).map(|vertex| freedom(complex, vertex)).collect(),
        }
    }

    /// The ends of an arc.
    pub(super) fn ends(&self, arc: &Arc, state: &[f64]) -> [DVec2; 2] {
        arc.ends.map(|(vertex, shift)| DVec2::new(state[2 * vertex], state[2 * vertex + 1]) + shift)
    }

    /// The turning of arc number k.
    pub(super) fn turning(&self, arc: usize, state: &[f64]) -> f64 {
        state[2 * self.freedoms.len() + arc]
    }

    fn bow(&self, arc: usize, state: &[f64]) -> Bow {
        Bow::new(self.turning(arc, state), self.arcs[arc].chords)
    }

    /// Where an arc's own variables are in a state.
    pub(super) fn own(&self, arc: usize) -> [usize; OWN] {
        let [(start, _), (end, _)] = self.arcs[arc].ends;
        [2 * start, 2 * start + 1, 2 * end, 2 * end + 1, 2 * self.freedoms.len() + arc]
    }

    /// The length of all arcs, times their tension.
    pub(super) fn energy(&self, state: &[f64]) -> f64 {
        let of_arc = |(number, arc): (usize, &Arc)| {
            let [start, end] = self.ends(arc, state);
            arc.tension * start.distance(end) * self.bow(number, state).length[0]
        };
        self.arcs.iter().enumerate().map(of_arc).sum()
    }

    /// What the area of each cell lacks.
    pub(super) fn missing(&self, state: &[f64]) -> Vec<f64> {
        let mut missing = self.areas.to_vec();
        for (number, arc) in self.arcs.iter().enumerate() {
            let [start, end] = self.ends(arc, state);
            let bulge = start.distance_squared(end) * self.bow(number, state).area[0];
            for (beside, sign) in arc.beside.iter().zip([1.0, -1.0]) {
                if let Some((cell, offset)) = beside {
                    missing[*cell] -= sign * (0.5 * (start - offset).perp_dot(end - offset) + bulge);
                }
            }
        }
        missing
    }

    /// What walls leave of a motion of an arc's ends.
    pub(super) fn free_at_ends(&self, arc: &Arc, motion: DVec2) -> [DVec2; 2] {
        arc.ends.map(|(vertex, _)| self.freedoms[vertex].project(motion.extend(0.0)).truncate())
    }

    /// The part of a motion that walls and straight arcs leave.
    pub(super) fn keep_free(&self, motion: &mut [f64]) {
        for (vertex, freedom) in self.freedoms.iter().enumerate() {
            let free = freedom.project(DVec3::new(motion[2 * vertex], motion[2 * vertex + 1], 0.0));
            (motion[2 * vertex], motion[2 * vertex + 1]) = (free.x, free.y);
        }
        for (arc, turning) in self.arcs.iter().zip(&mut motion[2 * self.freedoms.len()..]) {
            *turning = if arc.chords == 1 { 0.0 } else { *turning };
        }
    }

    fn terms(&self, number: usize, state: &[f64]) -> ArcTerms {
        let arc = &self.arcs[number];
        let [start, end] = self.ends(arc, state);
        let bow = self.bow(number, state);
        let chord = start.distance(end).max(f64::MIN_POSITIVE);
        let along = (end - start) / chord;
        let pull = along * (arc.tension * bow.length[0]);
        let length = [-pull.x, -pull.y, pull.x, pull.y, arc.tension * chord * bow.length[1]];
        let swell = along * (2.0 * chord * bow.area[0]);
        let bulge = [-swell.x, -swell.y, swell.x, swell.y, chord * chord * bow.area[1]];
        let areas = [0, 1].map(|side| {
            let Some((_, offset)) = arc.beside[side] else { return [0.0; OWN] };
            let (a, b) = (0.5 * (start - offset), 0.5 * (end - offset));
            let triangle = [b.y, -b.x, -a.y, a.x, 0.0];
            let sign = if side == 0 { 1.0 } else { -1.0 };
            [0, 1, 2, 3, 4].map(|k| sign * (triangle[k] + bulge[k]))
        });
        ArcTerms { length, areas, bow, along, chord }
    }

    /// What the foam is like near a state.
    pub(super) fn tangent(&'a self, state: &[f64]) -> Tangent<'a> {
        let terms: Vec<ArcTerms> = (0..self.arcs.len()).map(|arc| self.terms(arc, state)).collect();
        let mut stiffness = vec![0.0; state.len()];
        for (number, (arc, terms)) in self.arcs.iter().zip(&terms).enumerate() {
            let own = self.own(number);
            // Edges without tension count, too: short ones are not to turn over with a step.
            let tension = if arc.tension > 0.0 { arc.tension } else { self.mean_tension };
            for variable in &own[..4] {
                stiffness[*variable] += tension * terms.bow.length[0] / terms.chord;
            }
            stiffness[own[4]] = arc.tension * terms.chord * terms.bow.length[2];
        }
        // Walls that hold a vertex make its motion smaller, and that is all.
        let mut gradients: Vec<Vec<(usize, f64)>> = vec![Vec::new(); state.len()];
        for (number, (arc, terms)) in self.arcs.iter().zip(&terms).enumerate() {
            for (beside, area) in arc.beside.iter().zip(&terms.areas) {
                let Some((cell, _)) = beside else { continue };
                for (variable, change) in self.own(number).into_iter().zip(area) {
                    match gradients[variable].iter_mut().find(|(known, _)| known == cell) {
                        Some((_, sum)) => *sum += change,
                        None => gradients[variable].push((*cell, *change)),
                    }
                }
            }
        }
        let compliance = self.compliance(&gradients, &stiffness);
        Tangent { foam: self, terms, stiffness, compliance }
    }

    /// How areas answer to pressures where each variable has the given stiffness.
    fn compliance(&self, gradients: &[Vec<(usize, f64)>], stiffness: &[f64]) -> Compliance {
        let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); self.areas.len()];
        let mut add = |a: &(usize, DVec3), b: &(usize, DVec3), mobility: f64| {
            let column = u32::try_from(b.0).expect("cells have 32-bit numbers");
            rows[a.0].push((column, mobility * a.1.dot(b.1)));
        };
        let count = 2 * self.freedoms.len();
        for (vertex, freedom) in self.freedoms.iter().enumerate() {
            let [x, y] = [&gradients[2 * vertex], &gradients[2 * vertex + 1]];
            // Both list the same cells in the same order.
            let moved =
                x.iter().zip(y).map(|((cell, x), (_, y))| (*cell, freedom.project(DVec3::new(*x, *y, 0.0))));
            let moved: Vec<(usize, DVec3)> = moved.collect();
            let mobility = inverse(stiffness[2 * vertex]);
            moved.iter().for_each(|a| moved.iter().for_each(|b| add(a, b, mobility)));
        }
        for ((arc, gradients), stiffness) in
            self.arcs.iter().zip(&gradients[count..]).zip(&stiffness[count..])
        {
            let moved: Vec<(usize, DVec3)> =
                gradients.iter().map(|(cell, change)| (*cell, DVec3::X * *change)).collect();
            let mobility = if arc.chords == 1 { 0.0 } else { inverse(*stiffness) };
            moved.iter().for_each(|a| moved.iter().for_each(|b| add(a, b, mobility)));
        }
        for row in &mut rows {
            row.sort_by_key(|(column, _)| *column);
            let same = row.chunk_by(|a, b| a.0 == b.0);
            *row = same.map(|same| (same[0].0, same.iter().map(|(_, value)| value).sum())).collect();
        }
        Compliance::new(Rows::new(rows))
    }
}

impl Tangent<'_> {
    /// The gradient of the energy.
    pub(super) fn gradient(&self) -> Vec<f64> {
        let mut gradient = vec![0.0; self.stiffness.len()];
        for (number, terms) in self.terms.iter().enumerate() {
            let own = self.foam.own(number).into_iter().zip(terms.length);
            own.for_each(|(variable, slope)| gradient[variable] += slope);
        }
        self.foam.keep_free(&mut gradient);
        gradient
    }

    /// How a motion changes the area of each cell, to first order.
    pub(super) fn change_of_areas(&self, motion: &[f64]) -> Vec<f64> {
        let mut change = vec![0.0; self.foam.areas.len()];
        for (number, (arc, terms)) in self.foam.arcs.iter().zip(&self.terms).enumerate() {
            for (beside, area) in arc.beside.iter().zip(&terms.areas) {
                if let Some((cell, _)) = beside {
                    let own = self.foam.own(number).into_iter().zip(area);
                    change[*cell] += own.map(|(variable, slope)| slope * motion[variable]).sum::<f64>();
                }
            }
        }
        change
    }

    /// The force of pressures on each variable.
    pub(super) fn force(&self, pressures: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; self.stiffness.len()];
        for (number, (arc, terms)) in self.foam.arcs.iter().zip(&self.terms).enumerate() {
            for (beside, area) in arc.beside.iter().zip(&terms.areas) {
                if let Some((cell, _)) = beside {
                    let own = self.foam.own(number).into_iter().zip(area);
                    own.for_each(|(variable, slope)| force[variable] += slope * pressures[*cell]);
                }
            }
        }
        self.foam.keep_free(&mut force);
        force
    }

    /// The motion under a force if there were only the stiffness of each variable by itself.
    pub(super) fn soften(&self, force: &[f64]) -> Vec<f64> {
        force.iter().zip(&self.stiffness).map(|(force, stiffness)| force * inverse(*stiffness)).collect()
    }

    /// The pressures whose motion, in this sense, changes areas so.
    pub(super) fn pressures(&self, changes: &[f64]) -> Vec<f64> {
        self.compliance.pressures(changes, TIGHT)
    }

    /// Takes out of a force what pressures balance, and gives these.
    pub(super) fn project(&self, force: &mut [f64]) -> Vec<f64> {
        self.project_up_to(force, TIGHT)
    }

    /// Takes most of what pressures balance out of a force.
    pub(super) fn project_loosely(&self, force: &mut [f64]) {
        self.project_up_to(force, LOOSE);
    }

    fn project_up_to(&self, force: &mut [f64], tolerance: f64) -> Vec<f64> {
        let changes = self.change_of_areas(&self.soften(force));
        let pressures = self.compliance.pressures(&changes, tolerance);
        force.iter_mut().zip(self.force(&pressures)).for_each(|(force, balanced)| *force -= balanced);
        pressures
    }

    /// The second derivative of the energy under pressures, times a motion.
    pub(super) fn curvature(&self, pressures: &[f64], motion: &[f64]) -> Vec<f64> {
        let mut image = vec![0.0; motion.len()];
        for (number, (arc, terms)) in self.foam.arcs.iter().zip(&self.terms).enumerate() {
            let ArcTerms { bow, along, chord, .. } = terms;
            let [left, right] = arc.beside.map(|beside| beside.map_or(0.0, |(cell, _)| pressures[cell]));
            let excess = left - right;
            let own = self.foam.own(number);
            let [start, end] =
                [[own[0], own[1]], [own[2], own[3]]].map(|[x, y]| DVec2::new(motion[x], motion[y]));
            let (stretch, turn) = (end - start, motion[own[4]]);
            let longer = along.dot(stretch);
            let across = stretch - along * longer;
            let pull = across * (arc.tension * bow.length[0] / chord)
                + along * (arc.tension * bow.length[1] * turn)
                - (stretch * (2.0 * bow.area[0]) + along * (2.0 * chord * bow.area[1] * turn)) * excess;
            let wind = (arc.tension * bow.length[1] - excess * 2.0 * chord * bow.area[1]) * longer
                + (arc.tension * chord * bow.length[2] - excess * chord * chord * bow.area[2]) * turn;
            // The triangle to the arc's ends has half the product of these two.
            let [at_start, at_end] =
                [-pull + end.perp() * (0.5 * excess), pull - start.perp() * (0.5 * excess)];
            for (variable, value) in own.into_iter().zip([at_start.x, at_start.y, at_end.x, at_end.y, wind]) {
                image[variable] += value;
            }
        }
        self.foam.keep_free(&mut image);
        image
    }
}

/// 1 over a stiffness; nothing moves what has none.
fn inverse(stiffness: f64) -> f64 {
    if stiffness > 0.0 { 1.0 / stiffness } else { 0.0 }
}
