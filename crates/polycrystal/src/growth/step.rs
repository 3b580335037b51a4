//! One step of curves that move by their curvature.
//!
//! Points are free to slide along curves, and do so until they are evenly spaced: only what they move across counts (Barrett, Garcke and
//! Nuernberg, "On the parametric approximation of curvature flow of networks", 2007). A step of time dt solves
//! `(M + dt K) d = -dt K x` for the displacement d of all points x, with M the mass across the curve, over the mobility, and K the
//! stiffness of segments, tension over length. Lengths are those at the end of the step, found by iteration: triple points then end where
//! tensions balance.

use glam::{DMat2, DVec2};
use rayon::prelude::*;

use crate::Freedom;
use crate::solver::conjugate_gradients::{Limits, SOLVED, solve};

/// Iterations for the lengths at the end of a step.
const LENGTHS: usize = 2;

/// Share of its length at the start of a step that a segment counts with at least.
const LEAST_LENGTH: f64 = 0.3;

/// Tension, in units of the mean, that keeps points apart where there is none.
const LEAST_TENSION: f64 = 1e-6;

/// Curves that one task works on.
const CURVES_PER_TASK: usize = 256;

/// A curve between two vertices.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    /// Its ends among the vertices, and by how much each is moved.
    pub(super) ends: [(usize, DVec2); 2],
    /// In units of the mean.
    pub(super) tension: f64,
    /// In units of the mean.
    pub(super) mobility: f64,
}

/// Curves and how their ends can move.
#[derive(Debug, Default)]
pub(super) struct CurveNetwork {
    pub(super) curves: Vec<Curve>,
    pub(super) freedoms: Vec<Freedom>,
    /// The length that each segment counts with at least: what is left of an edge that cannot go.
    pub(super) least_length: f64,
}

/// Where the points of curves are.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Positions {
    pub(super) vertices: Vec<DVec2>,
    /// Of each curve, the points between its ends.
    pub(super) inner: Vec<Vec<DVec2>>,
}

impl Positions {
    /// All points of a curve.
    pub(super) fn line(&self, curve: &Curve, number: usize) -> Vec<DVec2> {
        let [start, end] = curve.ends.map(|(vertex, translation)| self.vertices[vertex] + translation);
        let inner = self.inner[number].iter().copied();
        std::iter::once(start).chain(inner).chain([end]).collect()
    }

    /// Where two steps of half the time and one of the whole time lead together (Richardson).
    pub(super) fn extrapolated(&self, whole: &Self) -> Self {
        let beyond = |halves: &DVec2, whole: &DVec2| *halves + (*halves - *whole);
        let all =
            |halves: &[DVec2], whole: &[DVec2]| halves.iter().zip(whole).map(|(a, b)| beyond(a, b)).collect();
        Self {
            vertices: all(&self.vertices, &whole.vertices),
            inner: self.inner.iter().zip(&whole.inner).map(|(a, b)| all(a, b)).collect(),
        }
    }
}

impl CurveNetwork {
    /// Where all is after a step.
    pub(super) fn step(&self, start: &Positions, time: f64) -> Positions {
        let mut end = start.clone();
        for _ in 0..LENGTHS {
            let reduce = |(number, curve): (usize, &Curve)| {
                Reduced::new(
                    &start.line(curve, number),
                    &end.line(curve, number),
                    curve,
                    time,
                    self.least_length,
                )
            };
            let reduced: Vec<Reduced> =
                self.curves.par_iter().enumerate().with_min_len(CURVES_PER_TASK).map(reduce).collect();
            let moves = self.solve(&reduced);
            end.vertices = start.vertices.iter().zip(&moves).map(|(position, by)| *position + *by).collect();
            let inner = |((curve, reduced), inner): ((&Curve, &Reduced), &Vec<DVec2>)| {
                let by = reduced.moves(curve.ends.map(|(vertex, _)| moves[vertex]));
                inner.iter().zip(by).map(|(position, by)| *position + by).collect()
            };
            let curves = self.curves.par_iter().zip(&reduced).zip(&start.inner);
            end.inner = curves.with_min_len(CURVES_PER_TASK).map(inner).collect();
        }
        end
    }

    /// The moves of vertices, by conjugate gradients.
    fn solve(&self, reduced: &[Reduced]) -> Vec<DVec2> {
        let count = self.freedoms.len();
        let mut diagonal = vec![DMat2::ZERO; count];
        let mut forces = vec![DVec2::ZERO; count];
        for (curve, reduced) in self.curves.iter().zip(reduced) {
            for (end, (vertex, _)) in curve.ends.iter().enumerate() {
                diagonal[*vertex] += reduced.diagonal[end];
                forces[*vertex] += reduced.forces[end];
            }
        }
        let inverse: Vec<DMat2> = diagonal
            .iter()
            .map(|block| if block.determinant() > 0.0 { block.inverse() } else { DMat2::ZERO })
            .collect();
        let at = |values: &[f64], vertex: usize| DVec2::from_slice(&values[2 * vertex..]);
        let free = |vectors: Vec<DVec2>| -> Vec<f64> {
            let free =
                |(by, freedom): (DVec2, &Freedom)| freedom.project(by.extend(0.0)).truncate().to_array();
            vectors.into_iter().zip(&self.freedoms).flat_map(free).collect()
        };
        let precondition = |residual: &[f64]| {
            free(inverse.iter().enumerate().map(|(vertex, block)| *block * at(residual, vertex)).collect())
        };
        let apply = |direction: &[f64]| {
            let own = diagonal.iter().enumerate();
            let mut image: Vec<DVec2> = own.map(|(vertex, block)| *block * at(direction, vertex)).collect();
            for (curve, reduced) in self.curves.iter().zip(reduced) {
                let [start, end] = curve.ends.map(|(vertex, _)| vertex);
                image[end] += reduced.coupling * at(direction, start);
                image[start] += reduced.coupling.transpose() * at(direction, end);
            }
            free(image)
        };
        let moves = solve(apply, precondition, &free(forces), &Limits::of(2 * count, SOLVED));
        moves.chunks(2).map(DVec2::from_slice).collect()
    }
}

/// The system of a curve in terms of its ends: its points between them are eliminated.
struct Reduced {
    /// At the start and at the end.
    diagonal: [DMat2; 2],
    forces: [DVec2; 2],
    /// What the start does to the end.
    coupling: DMat2,
    /// Of each point between, what it takes to find it from the start and the point after it.
    eliminated: Vec<Eliminated>,
}

struct Eliminated {
    inverse: DMat2,
    force: DVec2,
    to_start: DMat2,
    to_next: f64,
}

impl Reduced {
    /// The line where a step starts, and where it ends as far as that is known.
    fn new(line: &[DVec2], end: &[DVec2], curve: &Curve, time: f64, least_length: f64) -> Self {
        let last = line.len() - 1;
        let stiffness: Vec<f64> = (0..last)
            .map(|segment| {
                let lengths = [line, end].map(|line| line[segment].distance(line[segment + 1]));
                let length = lengths[1].max(LEAST_LENGTH * lengths[0]).max(least_length);
                time * curve.tension.max(LEAST_TENSION) / length
            })
            .collect();
        let mass = |at: usize| {
            let (before, after) = (line[at.saturating_sub(1)], line[(at + 1).min(last)]);
            let length = line[at].distance(before) + line[at].distance(after);
            let across = (after - before).perp();
            let block = DMat2::from_cols(across * across.x, across * across.y);
            block * (0.5 / (curve.mobility * length.max(least_length)))
        };
        let pull = |segment: usize| (line[segment + 1] - line[segment]) * stiffness[segment];
        let block = |at: usize| {
            let before = if at > 0 { stiffness[at - 1] } else { 0.0 };
            let after = if at < last { stiffness[at] } else { 0.0 };
            mass(at) + DMat2::from_diagonal(DVec2::splat(before + after))
        };
        let mut diagonal = [block(0), block(last)];
        let mut forces = [pull(0), -pull(last - 1)];
        let mut to_start = DMat2::from_diagonal(DVec2::splat(-stiffness[0]));
        let mut eliminated = Vec::with_capacity(last - 1);
        let (mut own, mut force) = (DMat2::ZERO, DVec2::ZERO);
        for (at, to_next) in stiffness.iter().copied().enumerate().skip(1) {
            own += block(at);
            force += pull(at) - pull(at - 1);
            let inverse = own.inverse();
            diagonal[0] -= to_start.transpose() * inverse * to_start;
            forces[0] -= to_start.transpose() * (inverse * force);
            eliminated.push(Eliminated { inverse, force, to_start, to_next });
            to_start = inverse * to_start * to_next;
            own = inverse * -(to_next * to_next);
            force = inverse * force * to_next;
        }
        diagonal[1] += own;
        forces[1] += force;
        Self { diagonal, forces, coupling: to_start, eliminated }
    }

    /// The moves of the points between, given those of the ends.
    fn moves(&self, [start, end]: [DVec2; 2]) -> Vec<DVec2> {
        let mut next = end;
        let back = self.eliminated.iter().rev().map(|point| {
            next = point.inverse * (point.force + next * point.to_next - point.to_start * start);
            next
        });
        let mut moves: Vec<DVec2> = back.collect();
        moves.reverse();
        moves
    }
}
