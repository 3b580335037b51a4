//! The planes that may bound a cell, in arrays that loops without branches run over.
//!
//! They only suggest: coordinates are in single precision, and what these cannot tell is asked again from the generators.
//! All lengths are in units near the first distance that is searched, so that single precision neither overflows nor underflows.

use glam::{DVec3, Vec3};

use crate::generator::Generator;
use crate::grid::Run;
use crate::half_space::{self, HalfSpace};
use crate::wide::{self, LANES, PlaneColumns, Ray};

/// Half the distance between 1 and the next number in single precision.
const SINGLE_ROUNDOFF: f64 = f32::EPSILON as f64 / 2.0;

/// Roundings that a dot product of a rounded normal with a rounded point, less an offset, can accumulate, with a margin of two.
const EVALUATION_ERROR: f64 = 16.0 * SINGLE_ROUNDOFF;

/// Sine of the angle between a plane and an edge below which the plane is not suggested as the edge's end: there rounding
/// decides where they meet. Planes through the edge are such.
const GRAZING: f64 = 32.0 * SINGLE_ROUNDOFF;

/// Planes `normal . y <= offset`, y relative to the cell's seed, and bounds on what their rounding errors are relative to.
#[derive(Debug, Default)]
pub(crate) struct Candidates {
    count: usize,
    generators: Vec<Generator>,
    // Columns are longer than `count`: up to whole lanes they hold planes that cut nothing.
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    offsets: Vec<f32>,
    /// Units in a length of 1, a power of two.
    scale: f64,
    /// Bound on the 1-norms of the normals.
    largest_sum: f64,
    /// Bound on the sizes of the offsets' terms.
    largest_offset_size: f64,
    /// Bound on what is wrong, before it is rounded, with an offset, or with a normal along a vertex.
    largest_error: f64,
}

/// A point, and how far inside of a plane it may seem to be if it is beyond.
#[derive(Clone, Copy)]
pub(crate) struct Probe {
    point: Vec3,
    slack: f32,
}

impl Candidates {
    /// Takes all planes out. The next are for a search that goes to about some distance.
    pub(crate) fn restart(&mut self, distance: f64) {
        self.count = 0;
        (self.largest_sum, self.largest_offset_size, self.largest_error) = (0.0, 0.0, 0.0);
        // The power of two at or above the reciprocal; where there is none, single precision will not tell much.
        let biased_exponent = distance.to_bits() >> 52 & 0x7ff;
        self.scale = f64::from_bits(2046u64.saturating_sub(biased_exponent).clamp(1, 2045) << 52);
    }

    pub(crate) fn len(&self) -> usize {
        self.count
    }

    pub(crate) fn generators(&self) -> &[Generator] {
        &self.generators[..self.count]
    }

    /// Adds a plane within the distance that is searched.
    pub(crate) fn push(&mut self, plane: &HalfSpace) {
        self.make_room(1);
        // Far planes and near ones shall have coordinates of one size.
        let per_length = self.scale / plane.length;
        let offset = plane.offset * per_length;
        self.set(self.count, plane.generator, plane.normal / plane.length, offset);
        self.count += 1;
        self.largest_sum = self.largest_sum.max(plane.sum() / plane.length);
        self.largest_offset_size = self.largest_offset_size.max(offset.abs());
        let error = half_space::EVALUATION_ERROR * plane.offset_size * per_length;
        self.largest_error = self.largest_error.max(error);
    }

    /// Raises the bounds to those of bisectors with sites up to a distance away, of which coordinates are wrong by at most some
    /// error; what weights add to an offset has a size and an error, too.
    pub(crate) fn raise_bounds(&mut self, distance: f64, error: f64, weight: f64, weight_error: f64) {
        let squared_scale = self.scale * self.scale;
        // The 1-norm of a vector is at most the root of 3 times its length; images may be a last place farther away.
        self.largest_sum = self.largest_sum.max(2.0 * distance * self.scale);
        let offset_size = (0.75 * distance * distance + weight) * squared_scale;
        self.largest_offset_size = self.largest_offset_size.max(offset_size);
        // What is wrong with a normal counts along itself and along a vertex, which is at most half as long: 1.5 times the root of 3.
        let error = (3.0 * error * distance + weight_error) * squared_scale;
        self.largest_error = self.largest_error.max(error);
    }

    /// Adds the bisectors of `seed` at `center` with the sites of a run further than the root of `from` and at most that
    /// of `to` away, as if no site had a weight.
    #[inline]
    pub(crate) fn push_within(&mut self, seed: u32, center: DVec3, run: &Run, squares: [f64; 2]) {
        self.make_room(run.sites.len() + LANES);
        let first = self.count;
        let generators = &mut self.generators[first..];
        let [x, y, z, offsets] = [&mut self.x, &mut self.y, &mut self.z, &mut self.offsets];
        let columns = [&mut x[first..], &mut y[first..], &mut z[first..], &mut offsets[first..]];
        self.count += wide::compact(run, seed, center, squares, self.scale, generators, columns);
    }

    /// Moves planes from number `first` on outward.
    pub(crate) fn shift_offsets(&mut self, first: usize, mut shift: impl FnMut(Generator) -> f64) {
        let squared_scale = self.scale * self.scale;
        for (generator, offset) in
            self.generators[first..self.count].iter().zip(&mut self.offsets[first..self.count])
        {
            *offset += single(squared_scale * shift(*generator));
        }
    }

    /// Fills the last lanes, after planes were added.
    pub(crate) fn fill_lanes(&mut self) {
        self.make_room(LANES);
        for number in self.count..self.count.next_multiple_of(LANES) {
            self.set(number, Generator::NONE, DVec3::ZERO, f64::INFINITY);
        }
    }

    #[inline]
    fn make_room(&mut self, count: usize) {
        let needed = self.count + count;
        if needed > self.generators.len() {
            let len = 2 * needed.next_multiple_of(LANES);
            self.generators.resize(len, Generator::NONE);
            for column in [&mut self.x, &mut self.y, &mut self.z, &mut self.offsets] {
                column.resize(len, 0.0);
            }
        }
    }

    fn set(&mut self, number: usize, generator: Generator, normal: DVec3, offset: f64) {
        self.generators[number] = generator;
        (self.x[number], self.y[number], self.z[number]) = normal.as_vec3().into();
        self.offsets[number] = single(offset);
    }

    /// The columns of all whole lanes.
    fn columns(&self) -> PlaneColumns<'_> {
        let len = self.count.next_multiple_of(LANES);
        [&self.x, &self.y, &self.z, &self.offsets].map(|column| column[..len].as_chunks().0)
    }

    /// A ray from a point on, such that planes through it are not met.
    #[inline]
    pub(crate) fn ray(&self, start: DVec3, direction: DVec3) -> Ray {
        // The product of two normals: single precision knows its size if it knows theirs.
        let direction = direction * (self.scale * self.scale);
        let threshold = GRAZING * self.largest_sum * direction.abs().element_sum();
        let start = (start * self.scale).as_vec3();
        Ray { start, direction: direction.as_vec3(), threshold: single(threshold) }
    }

    /// Where a ray meets the first of the planes, and its number.
    pub(crate) fn first_crossing(&self, ray: &Ray) -> (f32, usize) {
        wide::first_crossing(self.columns(), ray)
    }

    /// The same for the plane that the ray meets next after it met another one.
    pub(crate) fn next_crossing(&self, ray: &Ray, after: (f32, usize)) -> (f32, usize) {
        let crossing = |k: usize| (ray.crossing(self.x[k], self.y[k], self.z[k], self.offsets[k]), k);
        let later = (0..self.count).map(crossing).filter(|crossing| *crossing > after);
        later.fold((f32::INFINITY, usize::MAX), |first, other| if other < first { other } else { first })
    }

    /// Looks at a point, each coordinate of which is known up to an error.
    #[inline]
    pub(crate) fn probe(&self, point: DVec3, error: f64) -> Probe {
        let point = point * self.scale;
        let per_sum = error * self.scale + EVALUATION_ERROR * point.abs().max_element();
        let slack =
            self.largest_sum * per_sum + EVALUATION_ERROR * self.largest_offset_size + self.largest_error;
        Probe { point: point.as_vec3(), slack: single(slack) }
    }

    /// The planes that a point may lie beyond.
    pub(crate) fn maybe_beyond(&self, Probe { point, slack }: Probe) -> impl Iterator<Item = Generator> {
        let excess =
            move |k: usize| self.x[k] * point.x + self.y[k] * point.y + self.z[k] * point.z - self.offsets[k];
        let planes = (0..self.count).filter(move |number| {
            // What is not a number may be anything.
            let is_inside = excess(*number) < -slack;
            !is_inside
        });
        planes.map(|number| self.generators[number])
    }

    /// Number of planes that a point may lie beyond.
    pub(crate) fn count_maybe_beyond(&self, Probe { point, slack }: Probe) -> u32 {
        wide::count_beyond(self.columns(), point, slack)
    }
}

/// Rounded to single precision.
#[expect(clippy::cast_possible_truncation, reason = "to be rounded")]
fn single(number: f64) -> f32 {
    number as f32
}
