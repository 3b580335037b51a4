//! One cell, cut plane by plane from the box.
//!
//! The polyhedron is kept in dual form: a vertex is the triple of planes that meet there, in general position always three
//! (ties are broken symbolically), oriented so that the determinant of their normals is positive. Clipping with a plane
//! removes the vertices beyond it and closes the hole with one new vertex for each polyhedron edge cut.

use crate::clip::clipping::Clipping;
use crate::clip::vertices::{CHUNK, farthest, find_beyond};
use crate::exact::generator::Generator;
use crate::exact::half_space::{EVALUATION_ERROR, HalfSpace, Intersection};
use crate::exact::input::ExactInput;

/// Relative error bound of a vertex above which its coordinates are computed exactly while cutting: a loose bound sends
/// every later decision about the vertex to exact arithmetic, which costs more than the vertex.
const LOOSE: f64 = 1e-7;

/// The cell of one seed while it is being cut.
#[derive(Debug)]
pub(crate) struct ConvexCell {
    seed: u32,
    planes: Vec<HalfSpace>,
    /// Of each vertex, the planes that meet there.
    triples: Vec<[u32; 3]>,
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    /// Bound on the error of `normal . vertex` for a normal of 1-norm 1: position and evaluation together.
    errors: Vec<f64>,
    /// Largest distance of a vertex from the seed, with its error.
    radius: f64,
    cut: Vec<usize>,
    /// Chunks of vertices that may have some beyond a plane.
    chunks: Vec<u32>,
    hole: Vec<(u32, u32)>,
}

impl ConvexCell {
    /// The cell of `seed` among its own images: the whole domain, a box, where there are none.
    pub(crate) fn new(seed: u32, input: ExactInput) -> Self {
        let mut cell = Self {
            seed,
            planes: input.outermost_planes(seed).map(|plane| HalfSpace::new(seed, plane, input)).collect(),
            triples: Vec::new(),
            x: Vec::new(),
            y: Vec::new(),
            z: Vec::new(),
            errors: Vec::new(),
            radius: 0.0,
            cut: Vec::new(),
            chunks: Vec::new(),
            hole: Vec::new(),
        };
        for corner in 0..8u32 {
            let upper = [corner & 1, (corner >> 1) & 1, (corner >> 2) & 1];
            let [a, b, c] = [upper[0], 2 + upper[1], 4 + upper[2]];
            // Each lower wall turns the orientation of the triple round once.
            let triple = if upper.iter().sum::<u32>() % 2 == 1 { [a, b, c] } else { [a, c, b] };
            cell.push_vertex(triple, input);
        }
        cell.update_radius();
        cell
    }

    fn generators(&self, triple: [u32; 3]) -> [Generator; 3] {
        triple.map(|plane| self.planes[plane as usize].generator)
    }

    /// Fills `self.cut` with the vertices beyond the plane; false where there are none.
    fn find_cut(&mut self, plane: &HalfSpace, input: ExactInput) -> bool {
        let HalfSpace { normal, offset, offset_size, .. } = *plane;
        let sum = normal.x.abs() + normal.y.abs() + normal.z.abs();
        let own_error = EVALUATION_ERROR * offset_size;
        let count = self.triples.len();
        let (x, y, z, errors) = (&self.x[..count], &self.y[..count], &self.z[..count], &self.errors[..count]);
        // Most planes tried miss the cell, or nearly all of it: one pass tells where to look.
        find_beyond([x, y, z, errors], normal, offset, -own_error, &mut self.chunks);
        self.cut.clear();
        let vertices = self.chunks.iter().flat_map(|chunk| {
            let first = *chunk as usize * CHUNK;
            first..count.min(first + CHUNK)
        });
        for v in vertices {
            let value = normal.x * x[v] + normal.y * y[v] + normal.z * z[v] - offset;
            let error = sum * errors[v] + own_error;
            let beyond = if value > error {
                true
            } else if value < -error {
                false
            } else {
                input.decide(self.seed, self.generators(self.triples[v]), plane.generator).beyond
            };
            if beyond {
                self.cut.push(v);
            }
        }
        !self.cut.is_empty()
    }

    /// Replaces the vertices in `self.cut` by those of the new plane.
    fn close_hole(&mut self, plane: HalfSpace, input: ExactInput) {
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
        let new = u32::try_from(self.planes.len()).expect("there are fewer than 2^32 generators");
        self.planes.push(plane);
        for edge in 0..self.hole.len() {
            let (from, to) = self.hole[edge];
            self.push_vertex([from, to, new], input);
        }
        if self.planes.len() > 256 && self.planes.len() > 4 * self.triples.len() {
            self.forget_unused_planes();
        }
    }

    fn push_vertex(&mut self, triple: [u32; 3], input: ExactInput) {
        let planes = triple.map(|p| &self.planes[p as usize]);
        let vertex = Intersection::rounded(planes).filter(|vertex| vertex.is_good_to(LOOSE));
        let vertex = vertex.unwrap_or_else(|| Intersection::exact(self.seed, planes, input));
        self.triples.push(triple);
        self.x.push(vertex.position.x);
        self.y.push(vertex.position.y);
        self.z.push(vertex.position.z);
        self.errors.push(vertex.evaluation_error());
    }

    fn update_radius(&mut self) {
        let (squared, error) = farthest([&self.x, &self.y, &self.z, &self.errors]);
        // The error bounds each coordinate, so a distance by sqrt(3) times it.
        self.radius = squared.sqrt() + 2.0 * error;
    }

    /// Drops planes that no vertex lies on, so that a cell tried with many candidates stays small.
    fn forget_unused_planes(&mut self) {
        let mut used = vec![false; self.planes.len()];
        for p in self.triples.iter().flatten() {
            used[*p as usize] = true;
        }
        let mut new_index = vec![0u32; self.planes.len()];
        let mut kept = 0;
        for (index, is_used) in new_index.iter_mut().zip(&used) {
            *index = kept;
            kept += u32::from(*is_used);
        }
        let mut keep = used.iter();
        self.planes.retain(|_| *keep.next().unwrap_or(&true));
        for p in self.triples.iter_mut().flatten() {
            *p = new_index[*p as usize];
        }
    }
}

impl Clipping for ConvexCell {
    fn radius(&self) -> f64 {
        if self.triples.is_empty() { -1.0 } else { self.radius }
    }

    fn cut(&mut self, generator: Generator, input: ExactInput) {
        let plane = HalfSpace::new(self.seed, generator, input);
        if self.find_cut(&plane, input) {
            self.close_hole(plane, input);
            self.update_radius();
        }
    }

    fn vertices(&self) -> Vec<[Generator; 3]> {
        self.triples.iter().map(|triple| self.generators(*triple)).collect()
    }

    fn nearest_vertex(&self) -> Option<[Generator; 3]> {
        let squared = |v: &usize| self.x[*v].powi(2) + self.y[*v].powi(2) + self.z[*v].powi(2);
        let nearest = (0..self.triples.len()).min_by(|v, w| squared(v).total_cmp(&squared(w)))?;
        Some(self.generators(self.triples[nearest]))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::Domain;
    use crate::exact::image::ImageTable;

    /// Numbers of planes once had 16 bits: a cell with as many neighbours ended the program.
    #[test]
    fn more_planes_than_16_bits_number() {
        let centre = DVec3::splat(0.5);
        let mut seeds = vec![centre];
        seeds.extend(DVec3::AXES.into_iter().flat_map(|axis| [centre - 0.25 * axis, centre + 0.25 * axis]));
        let (domain, images) = (Domain::unit_cube(), ImageTable::default());
        let input = ExactInput { frame: &domain.frame, seeds: &seeds, weights: None, images: &images };
        let mut cell = ConvexCell::new(0, input);
        for site in 1..7 {
            // As if so many had cut the cell, and were cut off themselves.
            cell.planes.resize(70_000, cell.planes[0]);
            cell.cut(Generator::site(site), input);
        }
        assert_eq!(cell.vertices().len(), 8);
        assert!(cell.vertices().iter().flatten().all(|generator| (1..7).contains(&generator.0)));
        assert!((cell.radius() - 0.125 * 3f64.sqrt()).abs() < 1e-12);
    }
}
