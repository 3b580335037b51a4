//! Arcs between vertices, weighted by tension, around cells of given areas.
//!
//! A state lists the coordinates of all vertices, two each, and then the turning of every arc.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use voronoi::FaceId;

use crate::arcs::chordal_arc::ChordalArc;
use crate::energy::sides::{boundary, cell_and_offset, freedom};
use crate::solver::dissection::Dissection;
use crate::{Boundary, CellComplex, Freedom};

/// Variables of an arc: its start, its end, and its turning.
pub(crate) const OWN: usize = 5;

/// The lengths and areas that a complex of the plane has if its edges are arcs.
pub(crate) struct ArcNetwork<'a> {
    pub(crate) arcs: Vec<Arc>,
    pub(crate) areas: &'a [f64],
    /// The largest cell. Its pressure is 0, as the same pressure everywhere moves nothing; its area is what the others leave, and with that
    /// all rounding.
    pub(crate) pinned: usize,
    pub(crate) freedoms: Vec<Freedom>,
    /// Of all arcs that have any.
    pub(crate) mean_tension: f64,
    /// In which to eliminate vertices and cells.
    pub(crate) order: Dissection,
}

/// An edge as an arc of equal chords.
pub(crate) struct Arc {
    pub(crate) face: FaceId,
    /// Vertices, and how far from their own places.
    pub(crate) ends: [(usize, DVec2); 2],
    /// The cells to the left and to the right, and where their areas are measured from; none beyond walls.
    pub(crate) beside: [Option<(usize, DVec2)>; 2],
    pub(crate) tension: f64,
    /// 1 where it stays straight: in walls, and where it has no tension.
    pub(crate) chords: u32,
}

impl<'a> ArcNetwork<'a> {
    /// The edges of a complex with so many chords each; areas are those wanted.
    pub(crate) fn new(
        complex: &CellComplex,
        areas: &'a [f64],
        tension: &dyn Fn(&Boundary) -> f64,
        chords: impl Fn(FaceId) -> u32,
    ) -> Self {
        let domain = complex.domain();
        // From a corner of its own: small cells would lose digits far from the origin.
        let mut positions = vec![DVec2::ZERO; areas.len()];
        for face in complex.faces() {
            let corner = complex.position(complex.corners(face)[0]).truncate();
            for side in complex.sides(face) {
                if let Some((cell, offset)) = cell_and_offset(side, domain) {
                    positions[cell.index()] = corner - offset.truncate();
                }
            }
        }
        let arc = |face: FaceId| {
            let boundary = boundary(complex.sides(face));
            let tension = tension(&boundary);
            let beside = complex.sides(face).map(|side| {
                let (cell, offset) = cell_and_offset(side, domain)?;
                Some((cell.index(), positions[cell.index()] + offset.truncate()))
            });
            let end = |end: usize| {
                let corner = complex.corners(face)[end];
                (corner.vertex as usize, corner.translation.vector(domain).truncate())
            };
            let is_straight = boundary.wall.is_some() || tension == 0.0;
            let chords = if is_straight { 1 } else { chords(face) };
            Arc { face, ends: [end(0), end(1)], beside, tension, chords }
        };
        let arcs: Vec<Arc> = complex.faces().into_iter().map(arc).collect();
        let tensions = || arcs.iter().map(|arc| arc.tension).filter(|tension| *tension > 0.0);
        let around = |arc: &Arc| (arc.ends.map(|(vertex, _)| vertex), arc.beside.map(|cell| Some(cell?.0)));
        let positions = complex.vertices.iter().map(|position| position.truncate()).collect();
        Self {
            order: Dissection::new(positions, areas.len(), arcs.iter().map(around)),
            mean_tension: tensions().sum::<f64>() / tensions().count().max(1) as f64,
            arcs,
            pinned: (0..areas.len()).max_by(|a, b| areas[*a].total_cmp(&areas[*b])).unwrap_or(0),
            areas,
            freedoms: (0u32..).take(complex.vertices.len()).map(|vertex| freedom(complex, vertex)).collect(),
        }
    }

    /// The ends of an arc.
    pub(crate) fn ends(&self, arc: &Arc, state: &[f64]) -> [DVec2; 2] {
        arc.ends
            .map(|(vertex, translation)| DVec2::new(state[2 * vertex], state[2 * vertex + 1]) + translation)
    }

    /// The turning of arc number k.
    pub(crate) fn turning(&self, arc: usize, state: &[f64]) -> f64 {
        state[2 * self.freedoms.len() + arc]
    }

    pub(crate) fn chordal_arc(&self, arc: usize, state: &[f64]) -> ChordalArc {
        ChordalArc::new(self.turning(arc, state), self.arcs[arc].chords)
    }

    /// Where an arc's own variables are in a state.
    pub(crate) fn own(&self, arc: usize) -> [usize; OWN] {
        let [(start, _), (end, _)] = self.arcs[arc].ends;
        [2 * start, 2 * start + 1, 2 * end, 2 * end + 1, 2 * self.freedoms.len() + arc]
    }

    /// The length of all arcs, times their tension.
    pub(crate) fn energy(&self, state: &[f64]) -> f64 {
        let of_arc = |(number, arc): (usize, &Arc)| {
            let [start, end] = self.ends(arc, state);
            arc.tension * start.distance(end) * self.chordal_arc(number, state).length[0]
        };
        self.arcs.iter().enumerate().map(of_arc).sum()
    }

    /// What the area of each cell lacks.
    pub(crate) fn missing(&self, state: &[f64]) -> Vec<f64> {
        let mut missing = self.areas.to_vec();
        let chordal_arcs =
            (0..self.arcs.len()).into_par_iter().map(|arc| self.chordal_arc(arc, state).area[0]);
        for (arc, chordal_arc) in self.arcs.iter().zip(chordal_arcs.collect::<Vec<f64>>()) {
            let [start, end] = self.ends(arc, state);
            let bulge = start.distance_squared(end) * chordal_arc;
            for (beside, sign) in arc.beside.iter().zip([1.0, -1.0]) {
                if let Some((cell, offset)) = beside {
                    missing[*cell] -= sign * (0.5 * (start - offset).perp_dot(end - offset) + bulge);
                }
            }
        }
        missing
    }

    /// What walls leave of a motion of an arc's ends.
    pub(crate) fn free_at_ends(&self, arc: &Arc, motion: DVec2) -> [DVec2; 2] {
        arc.ends.map(|(vertex, _)| self.freedoms[vertex].project(motion.extend(0.0)).truncate())
    }

    /// The part of a motion that walls and straight arcs leave.
    pub(crate) fn keep_free(&self, motion: &mut [f64]) {
        for (vertex, freedom) in self.freedoms.iter().enumerate() {
            let free = freedom.project(DVec3::new(motion[2 * vertex], motion[2 * vertex + 1], 0.0));
            (motion[2 * vertex], motion[2 * vertex + 1]) = (free.x, free.y);
        }
        for (arc, turning) in self.arcs.iter().zip(&mut motion[2 * self.freedoms.len()..]) {
            *turning = if arc.chords == 1 { 0.0 } else { *turning };
        }
    }
}
