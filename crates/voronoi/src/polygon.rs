//! One cell in the plane, cut line by line from the rectangle.

use glam::DVec2;

use crate::Wall;
use crate::generator::Generator;
use crate::near_seeds::Cutting;
use crate::predicate::ExactInput;

/// Bound on the rounding errors of a corner and of its distance to a line, in units of the sums of absolute products:
/// some twenty roundings of 1.1e-16, with a margin of two.
const ROUNDING_ERROR: f64 = 48.0 * f64::EPSILON / 2.0;

/// Relative error bound above which a corner's coordinates are computed exactly.
const LOOSE: f64 = 2e-13;

/// The plane z = 0 as a third plane through every corner, so that decisions in the plane are decisions in space.
const PLANE: Wall = Wall::ALL[5];

/// A closed half-plane `normal . y <= offset`, y relative to the cell's seed.
#[derive(Debug, Clone, Copy)]
struct Line {
    generator: Generator,
    normal: DVec2,
    offset: f64,
    /// The offset's terms without their signs: what its rounding error is relative to.
    offset_size: f64,
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
    has_ties: bool,
}

impl ConvexPolygon {
    pub(crate) fn new() -> Self {
        Self { seed: 0, lines: Vec::new(), corners: Vec::new(), has_ties: false }
    }

    fn is_beyond(&mut self, corner: usize, line: &Line, input: ExactInput) -> bool {
        let Corner { position, error } = self.corners[corner];
        let value = line.normal.dot(position) - line.offset;
        let sum = line.normal.x.abs() + line.normal.y.abs();
        let largest = position.abs().max_element();
        let bound = sum * (error + ROUNDING_ERROR * largest) + ROUNDING_ERROR * line.offset_size;
        if value.abs() > bound {
            return value > 0.0;
        }
        let decision = input.decide(self.seed, self.corner_planes(corner), line.generator);
        self.has_ties |= decision.tie;
        decision.beyond
    }

    fn intersect(&self, incoming: Line, outgoing: Line, input: ExactInput) -> Corner {
        let determinant = incoming.normal.perp_dot(outgoing.normal);
        let position = (incoming.normal.perp() * outgoing.offset - outgoing.normal.perp() * incoming.offset)
            / determinant;
        let lengths = incoming.normal.length() * outgoing.normal.length();
        let numerators =
            outgoing.offset_size * incoming.normal.length() + incoming.offset_size * outgoing.normal.length();
        let size = position.abs().max_element();
        let error = ROUNDING_ERROR * (numerators + size * lengths) / (determinant - ROUNDING_ERROR * lengths);
        if error >= 0.0 && error <= LOOSE * position.length() {
            return Corner { position, error };
        }
        let planes = [incoming.generator, outgoing.generator, Generator::wall(PLANE)];
        let position = input.vertex(self.seed, planes).truncate();
        Corner { position, error: 2.0 * f64::EPSILON * position.abs().max_element() }
    }

    pub(crate) fn corner_count(&self) -> usize {
        self.corners.len()
    }

    /// A corner relative to the seed.
    pub(crate) fn corner(&self, corner: usize) -> DVec2 {
        self.corners[corner].position
    }

    /// The planes that meet in a corner, in positive orientation.
    pub(crate) fn corner_planes(&self, corner: usize) -> [Generator; 3] {
        let count = self.lines.len();
        let incoming = self.lines[(corner + count - 1) % count].generator;
        [incoming, self.lines[corner].generator, Generator::wall(PLANE)]
    }

    /// What lies beyond the edge that starts at a corner.
    pub(crate) fn edge_generator(&self, corner: usize) -> Generator {
        self.lines[corner].generator
    }

    /// Whether the edge that starts at a corner ends where it starts, exactly.
    pub(crate) fn has_no_length(&self, corner: usize, input: ExactInput) -> bool {
        let next = (corner + 1) % self.lines.len();
        self.has_ties && input.decide(self.seed, self.corner_planes(corner), self.lines[next].generator).tie
    }
}

impl Cutting for ConvexPolygon {
    fn start(&mut self, seed: u32, input: ExactInput) {
        self.seed = seed;
        self.has_ties = false;
        self.lines.clear();
        self.corners.clear();
        // y0, x1, y1, x0: counter-clockwise from the lower left corner.
        for wall in [2, 1, 3, 0].map(|index| Wall::ALL[index]) {
            self.lines.push(outermost_line(seed, wall, input));
        }
        for k in 0..4 {
            self.corners.push(self.intersect(self.lines[(k + 3) % 4], self.lines[k], input));
        }
    }

    fn security_radius(&self, weight_excess: f64) -> f64 {
        let reach = |corner: &Corner| corner.position.length() + 2.0 * corner.error;
        let radius = self.corners.iter().map(reach).fold(f64::NEG_INFINITY, f64::max);
        if radius < 0.0 { -1.0 } else { (radius + (radius * radius + weight_excess).sqrt()) * (1.0 + 1e-12) }
    }

    fn cut_with_bisector(&mut self, other: u32, input: ExactInput) {
        let line = bisector(self.seed, other, input);
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
        self.corners.insert(0, self.intersect(line, leaving, input));
        self.corners.push(self.intersect(entering, line, input));
        self.lines.push(line);
    }
}

fn bisector(seed: u32, other: u32, input: ExactInput) -> Line {
    let normal = input.difference(seed, other).truncate();
    let squared_length = normal.length_squared();
    let (own_weight, weight) = (input.weight(seed), input.weight(other));
    Line {
        generator: Generator::site(other),
        normal,
        offset: 0.5 * (squared_length + (own_weight - weight)),
        offset_size: 0.5 * (squared_length + own_weight.abs() + weight.abs()),
    }
}

/// The line of a wall, or across a periodic axis the one half a period away.
fn outermost_line(seed: u32, wall: Wall, input: ExactInput) -> Line {
    let generator = input.outermost(seed, wall);
    if let Some(image) = generator.as_site() {
        return bisector(seed, image, input);
    }
    let offset = input.outermost_distance(seed, wall);
    Line { generator, normal: wall.outward_normal().truncate(), offset, offset_size: offset.abs() }
}
