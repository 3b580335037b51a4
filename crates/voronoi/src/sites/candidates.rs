//! The planes that may bound a cell, in arrays that loops without branches run over.
//!
//! They only suggest: coordinates are in single precision, and what these cannot tell is asked again from the generators.
//! Offsets and points are in units near the first distance that is searched, so that single precision neither overflows nor
//! underflows, and normals have a length near 1, so that it tells as much of near planes as of far ones.

use std::ops::Range;

use glam::{DVec3, Vec3};

use crate::exact::generator::Generator;
use crate::exact::half_space::HalfSpace;
use crate::lanes::LANES;
use crate::sites::bisectors::{self, Around, Units, signed_square};
use crate::sites::near::Within;
use crate::sites::planes::{self, PlaneColumns, Ray};
use crate::sites::site_tree::SiteTree;

/// Half the distance between 1 and the next number in single precision.
const SINGLE_ROUNDOFF: f64 = f32::EPSILON as f64 / 2.0;

/// Roundings that a dot product of a rounded normal with a rounded point, less an offset, can accumulate, with a margin of two.
const EVALUATION_ERROR: f64 = 16.0 * SINGLE_ROUNDOFF;

/// Sine of the angle between a plane and an edge below which the plane is not suggested as the edge's end: there rounding
/// decides where they meet. Planes through the edge are such.
const GRAZING: f64 = 32.0 * SINGLE_ROUNDOFF;

/// Bound on the 1-norms of the normals, which are at most as long as the root of 2.
const LARGEST_SUM: f64 = 2.5;

/// Share of the rounding errors of single precision that those of a site's position may have: it is a quarter of one more rounding.
const POSITION_ERROR: f64 = SINGLE_ROUNDOFF / 4.0;

/// Planes `normal . y <= offset`, y relative to the cell's seed. Offsets are less by as much as rounding may have made them, or a
/// point beyond, seem too large.
#[derive(Debug, Default)]
pub(crate) struct Candidates {
    count: usize,
    generators: Vec<Generator>,
    // Columns are longer than `count`: up to whole lanes they hold planes that cut nothing.
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    offsets: Vec<f32>,
    units: Units,
    /// Those of the grid that are looked through, for reuse.
    runs: Vec<Range<u32>>,
}

/// A point, and how far inside of a plane it may seem to be if it is beyond.
#[derive(Clone, Copy)]
pub(crate) struct Probe {
    point: Vec3,
    slack: f32,
}

impl Candidates {
    /// Takes all planes out. The next are for a search that goes to about some distance, among sites of which, from one on, each
    /// coordinate is wrong by at most some error.
    pub(crate) fn restart(&mut self, distance: f64, first_rounded: u32, position_error: f64) {
        self.count = 0;
        // The power of two at or above the reciprocal; where there is none, single precision will not tell much.
        let biased_exponent = distance.to_bits() >> 52 & 0x7ff;
        let scale = f64::from_bits(2046u64.saturating_sub(biased_exponent).clamp(1, 2045) << 52);
        self.units = Units {
            scale,
            half_unit: 0.5 * scale * (1.0 - EVALUATION_ERROR),
            // The factor above makes a negative difference too large.
            weight_error: 4.0 * EVALUATION_ERROR,
            first_rounded,
            largest_unit: POSITION_ERROR / position_error,
        };
    }

    /// Takes all planes out. The next are for the same search.
    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }

    pub(crate) fn generators(&self) -> &[Generator] {
        &self.generators[..self.count]
    }

    /// Adds a plane within the distance that is searched.
    pub(crate) fn push(&mut self, plane: &HalfSpace) {
        self.make_room(1);
        let per_length = self.units.scale / plane.length;
        let offset = (plane.offset - EVALUATION_ERROR * plane.offset_size) * per_length;
        self.set(self.count, plane.generator, plane.normal / plane.length, offset);
        self.count += 1;
    }

    /// Adds the bisectors of a seed with the sites of a tree that are farther away than a radius, if there is one, and within that of
    /// `within`; the sites are within a security radius. False if too many would have to be looked at: then none is added.
    #[inline]
    pub(crate) fn push_within(
        &mut self,
        seed: u32,
        tree: &SiteTree,
        within: &Within,
        security_radius: f64,
        from: Option<f64>,
        most: usize,
    ) -> bool {
        let mut runs = std::mem::take(&mut self.runs);
        let is_found = tree.find_runs(within, security_radius, most, &mut runs);
        if is_found {
            self.make_room(LANES + runs.iter().map(|run| run.len()).sum::<usize>());
            let first = self.count;
            let generators = &mut self.generators[first..];
            let [x, y, z, offsets] = [&mut self.x, &mut self.y, &mut self.z, &mut self.offsets];
            let planes = [&mut x[first..], &mut y[first..], &mut z[first..], &mut offsets[first..]];
            let limits = [from, Some(within.radius)].map(|radius| Some(signed_square(2.0 * radius?)));
            let &Within { center, own_weight, .. } = within;
            let around = Around { seed, center, own_weight, limits, units: self.units };
            self.count += bisectors::compact(tree.columns(), &runs, &around, generators, planes);
        }
        self.runs = runs;
        is_found
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
        // The product of two normals: single precision knows its size if it knows that of lengths.
        let scale = self.units.scale;
        let direction = direction * (scale * scale);
        let threshold = GRAZING * LARGEST_SUM * direction.abs().element_sum();
        let start = (start * scale).as_vec3();
        Ray { start, direction: direction.as_vec3(), threshold: single(threshold) }
    }

    /// Where a ray meets the first of the planes, and its number.
    pub(crate) fn first_crossing(&self, ray: &Ray) -> (f32, usize) {
        planes::first_crossing(self.columns(), ray)
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
        let point = point * self.units.scale;
        let slack = LARGEST_SUM * (error * self.units.scale + EVALUATION_ERROR * point.abs().max_element());
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
        planes::count_beyond(self.columns(), point, slack)
    }
}

/// Rounded to single precision.
#[expect(clippy::cast_possible_truncation, reason = "to be rounded")]
fn single(number: f64) -> f32 {
    number as f32
}
