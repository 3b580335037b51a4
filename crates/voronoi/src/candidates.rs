//! The planes that may bound a cell, in arrays that loops without branches run over.

use glam::DVec3;

use crate::generator::Generator;
use crate::grid::Run;
use crate::half_space::HalfSpace;
use crate::wide::{LANES, PlaneColumns, Ray, count_beyond, first_crossing};

/// Coordinates of planes `normal . y <= offset`, and bounds on what their rounding errors are relative to.
#[derive(Debug, Default)]
pub(crate) struct Candidates {
    count: usize,
    generators: Vec<Generator>,
    // Columns are longer than `count`: up to whole lanes they hold planes that cut nothing.
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    offsets: Vec<f64>,
    /// Bound on the 1-norms of the normals.
    pub(crate) largest_sum: f64,
    /// Bound on the sizes of the offsets' terms.
    pub(crate) largest_offset_size: f64,
}

impl Candidates {
    pub(crate) fn clear(&mut self) {
        self.count = 0;
        (self.largest_sum, self.largest_offset_size) = (0.0, 0.0);
    }

    pub(crate) fn len(&self) -> usize {
        self.count
    }

    pub(crate) fn generators(&self) -> &[Generator] {
        &self.generators[..self.count]
    }

    /// Raises the bounds to those of planes that are to come.
    pub(crate) fn raise_bounds(&mut self, sum: f64, offset_size: f64) {
        self.largest_sum = self.largest_sum.max(sum);
        self.largest_offset_size = self.largest_offset_size.max(offset_size);
    }

    pub(crate) fn push(&mut self, plane: &HalfSpace) {
        self.make_room(1);
        self.set(self.count, plane.generator, plane.normal, plane.offset);
        self.count += 1;
        self.raise_bounds(plane.sum(), plane.offset_size);
    }

    /// Adds the bisectors of `seed` at `center` with the sites of a run further than the root of `from` and at most that
    /// of `to` away, as if no site had a weight.
    #[inline]
    pub(crate) fn push_within(&mut self, seed: u32, center: DVec3, run: &Run, [from, to]: [f64; 2]) {
        let count = run.sites.len();
        self.make_room(count);
        let range = self.count..self.count + count;
        let generators = &mut self.generators[range.clone()];
        let (x, y, z) = (&mut self.x[range.clone()], &mut self.y[range.clone()], &mut self.z[range.clone()]);
        let offsets = &mut self.offsets[range];
        let (sites, run_x, run_y, run_z) = (run.sites, &run.x[..count], &run.y[..count], &run.z[..count]);
        let mut kept = 0;
        for k in 0..count {
            let normal = DVec3::new(run_x[k], run_y[k], run_z[k]) - center;
            let squared = normal.length_squared();
            // Written in any case, and kept or overwritten by the next: branches would be mispredicted.
            generators[kept] = Generator(sites[k]);
            (x[kept], y[kept], z[kept]) = (normal.x, normal.y, normal.z);
            offsets[kept] = 0.5 * squared;
            kept += usize::from((squared > from) & (squared <= to) & (sites[k] != seed));
        }
        self.count += kept;
    }

    /// Lets a function replace the planes from number `first` on, or take them out.
    pub(crate) fn revise(
        &mut self,
        first: usize,
        mut revised: impl FnMut(Generator, DVec3, f64) -> Option<(DVec3, f64)>,
    ) {
        let mut kept = first;
        for number in first..self.count {
            let normal = DVec3::new(self.x[number], self.y[number], self.z[number]);
            let generator = self.generators[number];
            if let Some((normal, offset)) = revised(generator, normal, self.offsets[number]) {
                self.set(kept, generator, normal, offset);
                kept += 1;
            }
        }
        self.count = kept;
    }

    /// Fills the last lanes, after planes were added.
    pub(crate) fn fill_lanes(&mut self) {
        self.make_room(LANES);
        for number in self.count..self.count.next_multiple_of(LANES) {
            self.set(number, Generator::NONE, DVec3::ZERO, f64::INFINITY);
        }
    }

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
        (self.x[number], self.y[number], self.z[number]) = (normal.x, normal.y, normal.z);
        self.offsets[number] = offset;
    }

    /// The columns of all whole lanes.
    fn columns(&self) -> PlaneColumns<'_> {
        let len = self.count.next_multiple_of(LANES);
        [&self.x, &self.y, &self.z, &self.offsets].map(|column| column[..len].as_chunks().0)
    }

    /// Where a ray meets the first of the planes, and its number.
    pub(crate) fn first_crossing(&self, ray: &Ray) -> (f64, usize) {
        first_crossing(self.columns(), ray)
    }

    /// The same for the plane that the ray meets next after it met another one.
    pub(crate) fn next_crossing(&self, ray: &Ray, after: (f64, usize)) -> (f64, usize) {
        let crossing = |k: usize| (ray.crossing(self.x[k], self.y[k], self.z[k], self.offsets[k]), k);
        let later = (0..self.count).map(crossing).filter(|crossing| *crossing > after);
        later.fold((f64::INFINITY, usize::MAX), |first, other| if other < first { other } else { first })
    }

    /// How far a point lies beyond a plane.
    pub(crate) fn excess(&self, candidate: usize, point: DVec3) -> f64 {
        let (x, y, z) = (self.x[candidate], self.y[candidate], self.z[candidate]);
        x * point.x + y * point.y + z * point.z - self.offsets[candidate]
    }

    /// Number of planes from which the point is at most `slack` inside.
    pub(crate) fn count_beyond(&self, point: DVec3, slack: f64) -> usize {
        count_beyond(self.columns(), point, slack)
    }
}
