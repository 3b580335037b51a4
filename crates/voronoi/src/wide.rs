//! Loops over columns of planes, compiled a second time for processors that take four doubles at once, which halves
//! their time.
//!
//! Rust compiles for the oldest processors of an architecture unless told otherwise. Only the speed differs: neither version
//! contracts or reorders operations. The crate's only unsafe code is here, calls of functions that need AVX2; each stands
//! behind the question whether the processor has it.
#![allow(unsafe_code)]

use glam::DVec3;

/// Numbers that loops take at a time.
pub(crate) const LANES: usize = 8;

/// x, y and z of normals, and offsets, of planes `normal . y <= offset`.
pub(crate) type PlaneColumns<'a> = [&'a [[f64; LANES]]; 4];

/// A ray, and how much the normal of a plane must lie along it for the two to meet.
#[derive(Clone, Copy)]
pub(crate) struct Ray {
    pub(crate) start: DVec3,
    pub(crate) direction: DVec3,
    pub(crate) threshold: f64,
}

impl Ray {
    /// Where the ray meets a plane, in units of the direction; infinity if it does not.
    #[inline(always)]
    pub(crate) fn crossing(&self, x: f64, y: f64, z: f64, offset: f64) -> f64 {
        let slope = x * self.direction.x + y * self.direction.y + z * self.direction.z;
        let gap = offset - (x * self.start.x + y * self.start.y + z * self.start.z);
        let crossing = gap / slope;
        if slope > self.threshold { crossing } else { f64::INFINITY }
    }
}

/// The first plane that a ray meets, and where; of several the first in number.
pub(crate) fn first_crossing(columns: PlaneColumns, ray: &Ray) -> (f64, usize) {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2.
        return unsafe { first_crossing_avx2(columns, ray) };
    }
    first_crossing_anywhere(columns, ray)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn first_crossing_avx2(columns: PlaneColumns, ray: &Ray) -> (f64, usize) {
    first_crossing_anywhere(columns, ray)
}

#[inline(always)]
fn first_crossing_anywhere([x, y, z, offsets]: PlaneColumns, ray: &Ray) -> (f64, usize) {
    let mut nearest = [f64::INFINITY; LANES];
    let mut chunks = [0usize; LANES];
    for (chunk, (((x, y), z), offsets)) in (0..).zip(x.iter().zip(y).zip(z).zip(offsets)) {
        for lane in 0..LANES {
            let crossing = ray.crossing(x[lane], y[lane], z[lane], offsets[lane]);
            let is_nearer = crossing < nearest[lane];
            nearest[lane] = if is_nearer { crossing } else { nearest[lane] };
            chunks[lane] = if is_nearer { chunk } else { chunks[lane] };
        }
    }
    let mut first = (f64::INFINITY, usize::MAX);
    for lane in 0..LANES {
        let own = (nearest[lane], chunks[lane] * LANES + lane);
        first = if own < first { own } else { first };
    }
    first
}

/// Number of planes from which a point is at most `slack` inside.
pub(crate) fn count_beyond(columns: PlaneColumns, point: DVec3, slack: f64) -> usize {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2.
        return unsafe { count_beyond_avx2(columns, point, slack) };
    }
    count_beyond_anywhere(columns, point, slack)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn count_beyond_avx2(columns: PlaneColumns, point: DVec3, slack: f64) -> usize {
    count_beyond_anywhere(columns, point, slack)
}

#[inline(always)]
fn count_beyond_anywhere([x, y, z, offsets]: PlaneColumns, point: DVec3, slack: f64) -> usize {
    let mut beyond = [0usize; LANES];
    for (((x, y), z), offsets) in x.iter().zip(y).zip(z).zip(offsets) {
        for lane in 0..LANES {
            let excess = x[lane] * point.x + y[lane] * point.y + z[lane] * point.z - offsets[lane];
            beyond[lane] += usize::from(excess >= -slack);
        }
    }
    beyond.iter().sum()
}
