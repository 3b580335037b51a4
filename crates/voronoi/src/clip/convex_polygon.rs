//! One cell in the plane, cut line by line from the rectangle.

use glam::DVec2;

use crate::Wall;
use crate::clip::clipping::Clipping;
use crate::exact::generator::{Generator, PLANE};
use crate::exact::half_space::HalfSpace;
use crate::exact::input::ExactInput;

/// Bound on the rounding errors of a corner and of its distance to a line, in units of the sums of absolute products:
/// some twenty roundings of 1.1e-16, with a margin of two.
const ROUNDING_ERROR: f64 = 48.0 * f64::EPSILON / 2.0;

/// Relative error bound above which a corner's coordinates are computed exactly.
const LOOSE: f64 = 2e-13;

/// A closed half-plane `normal . y <= offset`, y relative to the cell's seed.
#[derive(Debug, Clone, Copy)]
struct Line {
    generator: Generator,
    normal: DVec2,
    offset: f64,
    /// The offset's terms without their signs: what its rounding error is relative to.
    offset_size: f64,
}

impl Line {
    fn new(seed: u32, generator: Generator, input: ExactInput) -> Self {
        let HalfSpace { normal, offset, offset_size, .. } = HalfSpace::new(seed, generator, input);
        Self { generator, normal: normal.truncate(), offset, offset_size }
    }
}

#[derive(Debug, Clone, Copy)]
struct Corner {
    position: DVec2,
    /// Bound on the error of each coordinate.
    error: f64,
}

/// A convex polygon: line k carries the edge from corner k to corner k + 1, counter-clockwise.
#[derive(Debug)]
pub(crate) struct ConvexPolygon {
    seed: u32,
    lines: Vec<Line>,
    corners: Vec<Corner>,
}

impl ConvexPolygon {
    /// The cell of `seed` among its own images: the whole rectangle, where there are none.
    pub(crate) fn new(seed: u32, input: ExactInput) -> Self {
        let mut polygon = Self { seed, lines: Vec::new(), corners: Vec::new() };
        // y0, x1, y1, x0: counter-clockwise from the lower left corner.
        for wall in [2, 1, 3, 0].map(|index| Wall::ALL[index]) {
            polygon.lines.push(Line::new(seed, input.outermost(seed, wall), input));
        }
        for k in 0..4 {
            polygon.corners.push(intersect(seed, polygon.lines[(k + 3) % 4], polygon.lines[k], input));
        }
        polygon
    }

    /// The corners, counter-clockwise and relative to the seed, with what lies beyond the edges that end and that start there.
    pub(crate) fn corners(&self) -> impl Iterator<Item = ([Generator; 2], DVec2)> {
        let before = self.lines.iter().cycle().skip(self.lines.len().saturating_sub(1));
        let lines = before.zip(&self.lines).map(|(before, after)| [before.generator, after.generator]);
        lines.zip(self.corners.iter().map(|corner| corner.position))
    }

    fn is_beyond(&self, corner: usize, line: &Line, input: ExactInput) -> bool {
        let Corner { position, error } = self.corners[corner];
        let value = line.normal.dot(position) - line.offset;
        let sum = line.normal.x.abs() + line.normal.y.abs();
        let largest = position.abs().max_element();
        let bound = sum * (error + ROUNDING_ERROR * largest) + ROUNDING_ERROR * line.offset_size;
        if value.abs() > bound {
            return value > 0.0;
        }
        input.decide(self.seed, self.corner_planes(corner), line.generator).beyond
    }

    /// The planes that meet in a corner, in positive orientation.
    fn corner_planes(&self, corner: usize) -> [Generator; 3] {
        let count = self.lines.len();
        let incoming = self.lines[(corner + count - 1) % count].generator;
        [incoming, self.lines[corner].generator, Generator::side(PLANE)]
    }
}

impl Clipping for ConvexPolygon {
    fn radius(&self) -> f64 {
        let distance = |corner: &Corner| corner.position.length() + 2.0 * corner.error;
        self.corners.iter().map(distance).fold(-1.0, f64::max)
    }

    fn cut(&mut self, generator: Generator, input: ExactInput) {
        let line = Line::new(self.seed, generator, input);
        let count = self.corners.len();
        let beyond: Vec<bool> = (0..count).map(|k| self.is_beyond(k, &line, input)).collect();
        let Some(first) = (0..count).find(|k| beyond[*k] && !beyond[(k + count - 1) % count]) else {
            if beyond.contains(&true) {
                self.lines.clear();
                self.corners.clear();
            }
            return;
        };
        let removed = (0..count).take_while(|k| beyond[(first + k) % count]).count();
        // From the edge that leaves the removed corners round to the edge that enters them.
        self.lines.rotate_left(first);
        self.corners.rotate_left(first);
        self.lines.drain(..removed - 1);
        self.corners.drain(..removed);
        let (leaving, entering) = (self.lines[0], self.lines[self.lines.len() - 1]);
        self.corners.insert(0, intersect(self.seed, line, leaving, input));
        self.corners.push(intersect(self.seed, entering, line, input));
        self.lines.push(line);
    }

    fn nearest_vertex(&self) -> Option<[Generator; 3]> {
        let squared = |corner: &usize| self.corners[*corner].position.length_squared();
        let nearest = (0..self.corners.len()).min_by(|a, b| squared(a).total_cmp(&squared(b)))?;
        Some(self.corner_planes(nearest))
    }

    fn vertices(&self) -> Vec<[Generator; 3]> {
        (0..self.corners.len()).map(|corner| self.corner_planes(corner)).collect()
    }
}

/// The centre, relative to a seed, of the circle through it and two others, the three being in counter-clockwise order.
pub(crate) fn circumcentre(seed: u32, others: [u32; 2], input: ExactInput) -> DVec2 {
    let [a, b] = others.map(|other| (input.seeds[other as usize] - input.seeds[seed as usize]).truncate());
    let (a_squared, b_squared) = (a.length_squared(), b.length_squared());
    let determinant = a.perp_dot(b);
    let centre = (a.perp() * b_squared - b.perp() * a_squared) / (2.0 * determinant);
    // As for the corner of two lines.
    let lengths = (a_squared * b_squared).sqrt();
    let numerators = lengths * (a_squared.sqrt() + b_squared.sqrt());
    let error = ROUNDING_ERROR * (numerators + centre.abs().max_element() * lengths)
        / (determinant - ROUNDING_ERROR * lengths);
    if error >= 0.0 && error <= LOOSE * centre.length() {
        return centre;
    }
    let [a, b] = others.map(Generator::site);
    input.vertex(seed, [a, b, Generator::side(PLANE)]).truncate()
}

fn intersect(seed: u32, incoming: Line, outgoing: Line, input: ExactInput) -> Corner {
    let determinant = incoming.normal.perp_dot(outgoing.normal);
    let position =
        (incoming.normal.perp() * outgoing.offset - outgoing.normal.perp() * incoming.offset) / determinant;
    let lengths = incoming.normal.length() * outgoing.normal.length();
    let numerators =
        outgoing.offset_size * incoming.normal.length() + incoming.offset_size * outgoing.normal.length();
    let size = position.abs().max_element();
    let error = ROUNDING_ERROR * (numerators + size * lengths) / (determinant - ROUNDING_ERROR * lengths);
    if error >= 0.0 && error <= LOOSE * position.length() {
        return Corner { position, error };
    }
    let planes = [incoming.generator, outgoing.generator, Generator::side(PLANE)];
    let position = input.vertex(seed, planes).truncate();
    Corner { position, error: 2.0 * f64::EPSILON * position.abs().max_element() }
}
