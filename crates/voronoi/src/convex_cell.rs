//! One cell, cut plane by plane from the box.
//!
//! The polyhedron is kept in dual form: a vertex is the triple of planes that meet there, in general position always three
//! (ties are broken symbolically), oriented so that the determinant of their normals is positive. Cutting with a plane
//! removes the vertices beyond it and closes the hole with one new vertex for each polyhedron edge cut.

use glam::DVec3;

use crate::Wall;
use crate::generator::Generator;
use crate::near_seeds::Cutting;
use crate::predicate::ExactInput;

/// Half the distance between 1 and the next double: the largest relative error of one rounding.
const ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Roundings that a dot product of a rounded normal with a vertex, less an offset, can accumulate, with a margin of two.
const EVALUATION_ERROR: f64 = 16.0 * ROUNDOFF;

/// The same for the coordinates of the vertex of three planes, in units of the sums of absolute products.
const INTERSECTION_ERROR: f64 = 32.0 * ROUNDOFF;

/// Relative error bound of a vertex above which its coordinates are computed exactly while cutting: a loose bound sends
/// every later decision about the vertex to exact arithmetic, which costs more than the vertex.
const LOOSE_WHILE_CUTTING: f64 = 1e-7;

/// Relative error bound above which the coordinates handed on are computed exactly. The bound overestimates by an order
/// of magnitude, so what is handed on is good to about 1e-14 of the cell's size.
const LOOSE_AT_THE_END: f64 = 2e-13;

/// A closed half-space `normal . y <= offset`, y relative to the cell's seed.
#[derive(Debug, Clone, Copy)]
struct Plane {
    generator: Generator,
    normal: DVec3,
    offset: f64,
    /// The offset's terms without their signs: what its rounding error is relative to.
    offset_size: f64,
    /// Length of the normal.
    length: f64,
}

/// The cell of one seed while it is being cut. Reused from seed to seed so that the buffers are allocated once.
#[derive(Debug)]
pub(crate) struct ConvexCell {
    seed: u32,
    planes: Vec<Plane>,
    /// Of each vertex, the planes that meet there.
    triples: Vec<[u16; 3]>,
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    /// Bound on the error of `normal . vertex` for a normal of 1-norm 1: position and evaluation together.
    errors: Vec<f64>,
    /// Largest distance of a vertex from the seed, with its error.
    radius: f64,
    /// A decision was a tie, so there may be edges without length.
    has_ties: bool,
    cut: Vec<usize>,
    hole: Vec<(u16, u16)>,
}

/// A face of a finished cell as the vertices of the cell, counter-clockwise from outside.
pub(crate) struct CellFace<'a> {
    pub(crate) generator: Generator,
    pub(crate) corners: &'a [u32],
}

impl ConvexCell {
    pub(crate) fn new() -> Self {
        Self {
            seed: 0,
            planes: Vec::new(),
            triples: Vec::new(),
            x: Vec::new(),
            y: Vec::new(),
            z: Vec::new(),
            errors: Vec::new(),
            radius: 0.0,
            has_ties: false,
            cut: Vec::new(),
            hole: Vec::new(),
        }
    }

    /// Fills `self.cut` with the vertices beyond the plane; false where there are none.
    fn find_cut(&mut self, plane: &Plane, input: ExactInput) -> bool {
        let Plane { normal, offset, offset_size, .. } = *plane;
        let sum = normal.x.abs() + normal.y.abs() + normal.z.abs();
        let own_error = EVALUATION_ERROR * offset_size;
        let count = self.triples.len();
        let (x, y, z, errors) = (&self.x[..count], &self.y[..count], &self.z[..count], &self.errors[..count]);
        // Most planes tried miss the cell: one pass without branches tells.
        let mut highest = f64::NEG_INFINITY;
        for v in 0..count {
            let value = normal.x * x[v] + normal.y * y[v] + normal.z * z[v] - offset;
            let upper_bound = value + sum * errors[v];
            highest = if upper_bound > highest { upper_bound } else { highest };
        }
        if highest < -own_error {
            return false;
        }
        self.cut.clear();
        for v in 0..count {
            let value = normal.x * x[v] + normal.y * y[v] + normal.z * z[v] - offset;
            let error = sum * errors[v] + own_error;
            let beyond = if value > error {
                true
            } else if value < -error {
                false
            } else {
                let planes = self.triples[v].map(|p| self.planes[usize::from(p)].generator);
                let decision = input.decide(self.seed, planes, plane.generator);
                self.has_ties |= decision.tie;
                decision.beyond
            };
            if beyond {
                self.cut.push(v);
            }
        }
        !self.cut.is_empty()
    }

    /// Replaces the vertices in `self.cut` by those of the new plane.
    fn close_hole(&mut self, plane: Plane, input: ExactInput) {
        // Of a directed dual edge (a, b) of a vertex removed, the twin (b, a) belongs to the vertex at the other end of
        // the polyhedron edge a-b. Where that is removed too the two cancel; the rest runs round the hole.
        self.hole.clear();
        for &v in &self.cut {
            let [a, b, c] = self.triples[v];
            for (from, to) in [(a, b), (b, c), (c, a)] {
                match self.hole.iter().position(|edge| *edge == (to, from)) {
                    Some(twin) => drop(self.hole.swap_remove(twin)),
                    None => self.hole.push((from, to)),
                }
            }
        }
        for position in (0..self.cut.len()).rev() {
            let v = self.cut[position];
            self.triples.swap_remove(v);
            for buffer in [&mut self.x, &mut self.y, &mut self.z, &mut self.errors] {
                buffer.swap_remove(v);
            }
        }
        let new = u16::try_from(self.planes.len()).expect("a cell is cut by fewer than 65 536 planes");
        self.planes.push(plane);
        for edge in 0..self.hole.len() {
            let (from, to) = self.hole[edge];
            self.push_vertex([from, to, new], input);
        }
        if self.planes.len() > 256 && self.planes.len() > 4 * self.triples.len() {
            self.forget_unused_planes();
        }
    }

    fn push_vertex(&mut self, triple: [u16; 3], input: ExactInput) {
        let (position, error) = match self.intersect(triple) {
            Some((position, error)) if error <= LOOSE_WHILE_CUTTING * position.length() => (position, error),
            _ => self.intersect_exactly(triple, input),
        };
        self.triples.push(triple);
        self.x.push(position.x);
        self.y.push(position.y);
        self.z.push(position.z);
        self.errors.push(error + EVALUATION_ERROR * position.abs().max_element());
    }

    /// The common point of three planes and a bound on the error of its coordinates, if floating point can tell.
    fn intersect(&self, triple: [u16; 3]) -> Option<(DVec3, f64)> {
        let [a, b, c] = triple.map(|p| self.planes[usize::from(p)]);
        let bc = b.normal.cross(c.normal);
        let ca = c.normal.cross(a.normal);
        let ab = a.normal.cross(b.normal);
        let determinant = a.normal.dot(bc);
        let position = (bc * a.offset + ca * b.offset + ab * c.offset) / determinant;
        // Cauchy's inequality bounds the sums of absolute products by products of lengths.
        let lengths = a.length * b.length * c.length;
        let numerators =
            lengths * (a.offset_size / a.length + b.offset_size / b.length + c.offset_size / c.length);
        let determinants = 2.0 * lengths;
        let safe_determinant = determinant - INTERSECTION_ERROR * determinants;
        let size = position.abs().max_element();
        let error = INTERSECTION_ERROR * (numerators + size * determinants) / safe_determinant;
        (safe_determinant > 0.0).then_some((position, error))
    }

    fn intersect_exactly(&self, triple: [u16; 3], input: ExactInput) -> (DVec3, f64) {
        let planes = triple.map(|p| self.planes[usize::from(p)].generator);
        let position = input.vertex(self.seed, planes);
        (position, 4.0 * ROUNDOFF * position.abs().max_element())
    }

    fn update_radius(&mut self) {
        let mut squared = 0.0f64;
        for v in 0..self.triples.len() {
            let length = self.x[v] * self.x[v] + self.y[v] * self.y[v] + self.z[v] * self.z[v];
            squared = squared.max(length);
        }
        let error = self.errors.iter().fold(0.0f64, |largest, error| largest.max(*error));
        // The error bounds each coordinate, so a distance by sqrt(3) times it.
        self.radius = squared.sqrt() + 2.0 * error;
    }

    /// Drops planes that no vertex lies on, so that a cell tried with many candidates stays small.
    fn forget_unused_planes(&mut self) {
        let mut used = vec![false; self.planes.len()];
        for p in self.triples.iter().flatten() {
            used[usize::from(*p)] = true;
        }
        let mut new_index = vec![0u16; self.planes.len()];
        let mut kept = 0u16;
        for (index, is_used) in new_index.iter_mut().zip(&used) {
            *index = kept;
            kept += u16::from(*is_used);
        }
        let mut keep = used.iter();
        self.planes.retain(|_| *keep.next().unwrap_or(&true));
        for p in self.triples.iter_mut().flatten() {
            *p = new_index[usize::from(*p)];
        }
    }

    /// Whether two coincident vertices may exist.
    pub(crate) fn has_ties(&self) -> bool {
        self.has_ties
    }

    /// Number of vertices, those that coincide counted apart.
    pub(crate) fn vertex_count(&self) -> usize {
        self.triples.len()
    }

    /// The planes that meet in a vertex, in positive orientation.
    pub(crate) fn vertex_planes(&self, v: usize) -> [Generator; 3] {
        self.triples[v].map(|p| self.planes[usize::from(p)].generator)
    }

    /// A vertex relative to the seed, good to about 1e-14 of the cell's size.
    pub(crate) fn vertex(&self, v: usize, input: ExactInput) -> DVec3 {
        let position = DVec3::new(self.x[v], self.y[v], self.z[v]);
        if self.errors[v] > LOOSE_AT_THE_END * position.length() {
            return input.vertex(self.seed, self.vertex_planes(v));
        }
        position
    }

    /// Hands the faces over, sorted by generator.
    pub(crate) fn for_each_face(&self, mut visit: impl FnMut(CellFace)) {
        // Of each vertex on a plane p, the triple turned so that p comes first: (p, incoming, outgoing, vertex).
        let mut corners: Vec<(Generator, u16, u16, u32)> = Vec::with_capacity(3 * self.triples.len());
        for (v, &[a, b, c]) in (0u32..).zip(&self.triples) {
            for (p, incoming, outgoing) in [(a, b, c), (b, c, a), (c, a, b)] {
                corners.push((self.planes[usize::from(p)].generator, incoming, outgoing, v));
            }
        }
        corners.sort_unstable();
        let mut ring = Vec::new();
        for face in corners.chunk_by(|left, right| left.0 == right.0) {
            ring.clear();
            let mut corner = &face[0];
            for _ in 0..face.len() {
                ring.push(corner.3);
                // The next corner lies at the other end of the edge that this face shares with the outgoing plane.
                corner = face.iter().find(|next| next.1 == corner.2).expect("a face is one closed ring");
            }
            visit(CellFace { generator: face[0].0, corners: &ring });
        }
    }
}

impl Cutting for ConvexCell {
    fn start(&mut self, seed: u32, input: ExactInput) {
        self.seed = seed;
        self.planes.clear();
        self.triples.clear();
        for buffer in [&mut self.x, &mut self.y, &mut self.z, &mut self.errors] {
            buffer.clear();
        }
        self.has_ties = false;
        for wall in Wall::ALL {
            self.planes.push(outermost_plane(seed, wall, input));
        }
        for corner in 0..8u16 {
            let upper = [corner & 1, (corner >> 1) & 1, (corner >> 2) & 1];
            let [a, b, c] = [upper[0], 2 + upper[1], 4 + upper[2]];
            // Each lower wall turns the orientation of the triple round once.
            let triple = if upper.iter().sum::<u16>() % 2 == 1 { [a, b, c] } else { [a, c, b] };
            self.push_vertex(triple, input);
        }
        self.update_radius();
    }

    fn security_radius(&self, weight_excess: f64) -> f64 {
        if self.triples.is_empty() {
            return -1.0;
        }
        // The bisector with a seed at distance d lies (d^2 - excess) / (2 d) away. The margin covers rounding.
        (self.radius + (self.radius * self.radius + weight_excess).sqrt()) * (1.0 + 1e-12)
    }

    fn cut_with_bisector(&mut self, other: u32, input: ExactInput) {
        let plane = bisector(self.seed, other, input);
        if self.find_cut(&plane, input) {
            self.close_hole(plane, input);
            self.update_radius();
        }
    }
}

fn bisector(seed: u32, other: u32, input: ExactInput) -> Plane {
    let normal = input.difference(seed, other);
    let squared_length = normal.length_squared();
    let (own_weight, weight) = (input.weight(seed), input.weight(other));
    Plane {
        generator: Generator::site(other),
        normal,
        offset: 0.5 * (squared_length + (own_weight - weight)),
        offset_size: 0.5 * (squared_length + own_weight.abs() + weight.abs()),
        length: squared_length.sqrt(),
    }
}

/// The plane of a wall, or across a periodic axis the one half a period away.
fn outermost_plane(seed: u32, wall: Wall, input: ExactInput) -> Plane {
    let generator = input.outermost(seed, wall);
    if let Some(image) = generator.as_site() {
        return bisector(seed, image, input);
    }
    let normal = wall.outward_normal();
    let offset = input.outermost_distance(seed, wall);
    Plane { generator, normal, offset, offset_size: offset.abs(), length: 1.0 }
}
