//! Loops over columns of planes.

use glam::Vec3;

use crate::lanes::{LANES, compiled_thrice};

/// x, y and z of normals, and offsets, of planes `normal . y <= offset`.
pub(crate) type PlaneColumns<'a> = [&'a [[f32; LANES]]; 4];

/// A ray, and how much the normal of a plane must lie along it for the two to meet.
#[derive(Clone, Copy)]
pub(crate) struct Ray {
    pub(crate) start: Vec3,
    pub(crate) direction: Vec3,
    pub(crate) threshold: f32,
}

impl Ray {
    /// Where the ray meets a plane, in units of the direction; infinity if it does not.
    #[inline(always)]
    pub(crate) fn crossing(&self, x: f32, y: f32, z: f32, offset: f32) -> f32 {
        let slope = x * self.direction.x + y * self.direction.y + z * self.direction.z;
        let gap = offset - (x * self.start.x + y * self.start.y + z * self.start.z);
        let crossing = gap / slope;
        if slope > self.threshold { crossing } else { f32::INFINITY }
    }
}

compiled_thrice! {
    /// The first plane that a ray meets, and where; of several the first in number.
    fn first_crossing(columns: PlaneColumns, ray: &Ray) -> (f32, usize) = first_crossing_anywhere
}

#[inline(always)]
fn first_crossing_anywhere([x, y, z, offsets]: PlaneColumns, ray: &Ray) -> (f32, usize) {
    let mut nearest = [f32::INFINITY; LANES];
    let mut chunks = [0u32; LANES];
    for (chunk, (((x, y), z), offsets)) in (0u32..).zip(x.iter().zip(y).zip(z).zip(offsets)) {
        for lane in 0..LANES {
            let crossing = ray.crossing(x[lane], y[lane], z[lane], offsets[lane]);
            let is_nearer = crossing < nearest[lane];
            nearest[lane] = if is_nearer { crossing } else { nearest[lane] };
            chunks[lane] = if is_nearer { chunk } else { chunks[lane] };
        }
    }
    let mut least = nearest;
    for half in [4, 2, 1] {
        for lane in 0..half {
            least[lane] = if least[lane + half] < least[lane] { least[lane + half] } else { least[lane] };
        }
    }
    let mut first = usize::MAX;
    for lane in 0..LANES {
        let number = chunks[lane] as usize * LANES + lane;
        first = first.min(if nearest[lane] == least[0] { number } else { usize::MAX });
    }
    (least[0], first)
}

compiled_thrice! {
    /// Number of planes from which the point is not known to be more than `slack` inside.
    fn count_beyond(columns: PlaneColumns, point: Vec3, slack: f32) -> u32 = count_beyond_anywhere
}

#[inline(always)]
fn count_beyond_anywhere(columns: PlaneColumns, point: Vec3, slack: f32) -> u32 {
    let [x, y, z, offsets] = columns.map(<[_]>::as_flattened);
    let mut beyond = 0u32;
    for (((x, y), z), offset) in x.iter().zip(y).zip(z).zip(offsets) {
        let excess = x * point.x + y * point.y + z * point.z - offset;
        // What is not a number may be anything.
        let is_inside = excess < -slack;
        beyond += u32::from(!is_inside);
    }
    beyond
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_processors_differ_in_gives_the_same_planes() {
        // Numbers between -1 and 1 without a pattern.
        let column = |seed: f32| -> Vec<f32> { (1..105u8).map(|k| (f32::from(k) * seed).sin()).collect() };
        let mut columns = [12.345, 23.456, 34.567, 45.678].map(column);
        columns[3][7] = f32::NEG_INFINITY;
        let planes = columns.each_ref().map(|column| column.as_chunks().0);
        let point = Vec3::new(0.3, -0.2, 0.1);
        assert_eq!(count_beyond(planes, point, 0.01), count_beyond_anywhere(planes, point, 0.01));
        let ray = Ray { start: point, direction: Vec3::new(0.6, 0.0, 0.8), threshold: 1e-5 };
        let (crossing, number) = first_crossing(planes, &ray);
        assert_eq!((crossing, number), first_crossing_anywhere(planes, &ray));
        let [x, y, z, offsets] = planes.map(<[_]>::as_flattened);
        let least = (0..x.len()).map(|k| (ray.crossing(x[k], y[k], z[k], offsets[k]), k));
        assert_eq!((crossing, number), least.reduce(|a, b| if b < a { b } else { a }).expect("planes"));
    }
}
