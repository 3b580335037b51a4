//! One boundary as a finite element.
//!
//! The points of a boundary's subdivided surface depend on the control points of that boundary alone, for triple lines are
//! creases. So each boundary has its own small, dense matrices over its control points, made in parallel.

use glam::DVec3;

use crate::volume::{segment_area, triangle_volume};

/// The smallest cotangent that a triangle's angle counts with: obtuse triangles would otherwise push points apart.
const SMALLEST_COTANGENT: f64 = 0.05;

/// The largest: that of an angle of 11 degrees. Needles would otherwise glue their ends together.
const LARGEST_COTANGENT: f64 = 5.0;

/// A boundary's refined elements in terms of its control points.
#[derive(Debug)]
pub(super) struct Patch {
    /// The control points that the boundary depends on; all other fields count them from 0.
    pub(super) control_points: Vec<u32>,
    /// Row f of the refined points is `weights[starts[f]..starts[f + 1]]`.
    pub(super) starts: Vec<usize>,
    pub(super) weights: Vec<(u32, f64)>,
    pub(super) elements: PatchElements,
    /// The edges of the control mesh in the boundary.
    pub(super) control_edges: Vec<[u32; 2]>,
    /// Boundaries between grains have tension, those on walls have none.
    pub(super) has_tension: bool,
}

/// Refined triangles or segments of a patch, as numbers of its refined points.
#[derive(Debug)]
pub(super) enum PatchElements {
    Triangles(Vec<[u32; 3]>),
    Segments(Vec<[u32; 2]>),
}

/// The energy of a patch at given control points.
#[derive(Debug)]
pub(super) struct PatchTerms {
    /// Stiffness: row-major, one row per control point. `stiffness * points` is the gradient of area.
    pub(super) stiffness: Vec<f64>,
    /// Share of the area that each control point stands for.
    pub(super) mass: Vec<f64>,
}

impl Patch {
    fn row(&self, point: u32) -> &[(u32, f64)] {
        &self.weights[self.starts[point as usize]..self.starts[point as usize + 1]]
    }

    /// The refined points, relative to `origin`.
    fn refined(&self, points: &[DVec3], origin: DVec3) -> Vec<DVec3> {
        let local: Vec<DVec3> = self.control_points.iter().map(|p| points[*p as usize] - origin).collect();
        let point = |row: &[(u32, f64)]| row.iter().map(|(p, weight)| local[*p as usize] * *weight).sum();
        self.starts.windows(2).map(|ends| point(&self.weights[ends[0]..ends[1]])).collect()
    }

    /// Volume of the cone from the origin.
    pub(super) fn volume(&self, points: &[DVec3], origin: DVec3) -> f64 {
        let refined = self.refined(points, origin);
        let at = |point: u32| refined[point as usize];
        match &self.elements {
            PatchElements::Triangles(triangles) => {
                triangles.iter().map(|corners| triangle_volume(corners.map(at))).sum()
            }
            PatchElements::Segments(segments) => segments.iter().map(|ends| segment_area(ends.map(at))).sum(),
        }
    }

    /// Change of the grains' volumes with each control point, as far as this patch brings it about.
    ///
    /// A closed surface's gradient does not depend on the origin, and every patch at a control point takes that point
    /// itself: then each patch's share is of the order of its area there, and nothing large has to cancel.
    pub(super) fn volume_gradient(&self, points: &[DVec3]) -> Vec<DVec3> {
        let origin = points[self.control_points[0] as usize];
        let refined = self.refined(points, origin);
        let at = |point: u32| refined[point as usize];
        // With b, c the other corners: (b - o) x (c - o) = b x c - o x (c - b).
        let mut products = vec![DVec3::ZERO; self.control_points.len()];
        let mut differences = products.clone();
        let mut add = |point: u32, product: DVec3, difference: DVec3| {
            for (p, weight) in self.row(point) {
                products[*p as usize] += product * *weight;
                differences[*p as usize] += difference * *weight;
            }
        };
        match &self.elements {
            PatchElements::Triangles(triangles) => {
                for &[a, b, c] in triangles {
                    for [apex, from, to] in [[a, b, c], [b, c, a], [c, a, b]] {
                        add(apex, at(from).cross(at(to)) / 6.0, (at(to) - at(from)) / 6.0);
                    }
                }
            }
            PatchElements::Segments(segments) => {
                for &[a, b] in segments {
                    add(a, at(b).cross(DVec3::Z) / 2.0, DVec3::Z / 2.0);
                    add(b, DVec3::Z.cross(at(a)) / 2.0, -DVec3::Z / 2.0);
                }
            }
        }
        let own_origin = self.control_points.iter().map(|p| points[*p as usize] - origin);
        let shares = products.iter().zip(&differences).zip(own_origin);
        shares.map(|((product, difference), origin)| *product - origin.cross(*difference)).collect()
    }

    /// The energy at the given control points.
    pub(super) fn terms(&self, points: &[DVec3]) -> PatchTerms {
        let count = self.control_points.len();
        let mut terms = PatchTerms { stiffness: vec![0.0; count * count], mass: vec![0.0; count] };
        if !self.has_tension {
            return terms;
        }
        let refined = self.refined(points, points[self.control_points[0] as usize]);
        let mut rows = vec![0.0; refined.len() * count];
        let at = |point: u32| refined[point as usize];
        match &self.elements {
            PatchElements::Triangles(triangles) => {
                for &corners in triangles {
                    let [a, b, c] = corners.map(at);
                    let doubled_area = (b - a).cross(c - a).length();
                    for k in 0..3 {
                        let [apex, from, to] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
                        let cosine = (at(from) - at(apex)).dot(at(to) - at(apex));
                        // A triangle without area has no cotangent: the upper limit stands in.
                        let cotangent = (cosine / doubled_area.max(f64::MIN_POSITIVE))
                            .clamp(SMALLEST_COTANGENT, LARGEST_COTANGENT);
                        self.add_spring(&mut rows, from, to, 0.5 * cotangent);
                        self.add_mass(&mut terms.mass, apex, doubled_area / 6.0);
                    }
                }
            }
            PatchElements::Segments(segments) => {
                for &[from, to] in segments {
                    let length = at(from).distance(at(to)).max(f64::MIN_POSITIVE);
                    self.add_spring(&mut rows, from, to, 1.0 / length);
                    self.add_mass(&mut terms.mass, from, 0.5 * length);
                    self.add_mass(&mut terms.mass, to, 0.5 * length);
                }
            }
        }
        terms.stiffness = self.pull_back(&rows);
        terms
    }

    /// Adds the spring between two refined points to the rows of the refined points.
    fn add_spring(&self, rows: &mut [f64], from: u32, to: u32, constant: f64) {
        let count = self.control_points.len();
        for (near, far) in [(from, to), (to, from)] {
            let row = &mut rows[near as usize * count..][..count];
            for (p, weight) in self.row(near) {
                row[*p as usize] += constant * weight;
            }
            for (p, weight) in self.row(far) {
                row[*p as usize] -= constant * weight;
            }
        }
    }

    /// From forces on the refined points, row by row, to forces on the control points.
    fn pull_back(&self, rows: &[f64]) -> Vec<f64> {
        let count = self.control_points.len();
        let mut stiffness = vec![0.0; count * count];
        for (point, row) in (0u32..).zip(rows.chunks_exact(count)) {
            for (p, weight) in self.row(point) {
                let into = &mut stiffness[*p as usize * count..][..count];
                into.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        stiffness
    }

    fn add_mass(&self, mass: &mut [f64], point: u32, area: f64) {
        for (p, weight) in self.row(point) {
            mass[*p as usize] += weight * area;
        }
    }
}
