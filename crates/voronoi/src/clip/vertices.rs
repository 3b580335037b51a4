//! Loops over the vertices of a cell.

use glam::DVec3;

use crate::lanes::{LANES, compiled_thrice, larger};

/// Points that are looked at together, of a number of which most are not wanted.
pub(crate) const CHUNK: usize = 4 * LANES;

compiled_thrice! {
    /// Lists the chunks of points, of which x, y, z and errors are given, that have one which may be farther beyond the plane
    /// `normal . y = offset` than a limit.
    fn find_beyond(points: [&[f64]; 4], normal: DVec3, offset: f64, limit: f64, chunks: &mut Vec<u32>) -> () = find_beyond_anywhere
}

#[inline(always)]
fn find_beyond_anywhere(
    [x, y, z, errors]: [&[f64]; 4],
    normal: DVec3,
    offset: f64,
    limit: f64,
    chunks: &mut Vec<u32>,
) {
    let sum = normal.x.abs() + normal.y.abs() + normal.z.abs();
    chunks.clear();
    let points = x.chunks(CHUNK).zip(y.chunks(CHUNK)).zip(z.chunks(CHUNK)).zip(errors.chunks(CHUNK));
    for (chunk, (((x, y), z), errors)) in (0u32..).zip(points) {
        let mut beyond = 0u64;
        for (((x, y), z), error) in x.iter().zip(y).zip(z).zip(errors) {
            let value = normal.x * x + normal.y * y + normal.z * z - offset;
            // What is not a number may be anything.
            let is_inside = value + sum * error < limit;
            beyond += u64::from(!is_inside);
        }
        if beyond > 0 {
            chunks.push(chunk);
        }
    }
}

compiled_thrice! {
    /// The largest square of a distance from the origin and the largest error of points, of which x, y, z and errors are given.
    fn farthest(points: [&[f64]; 4]) -> (f64, f64) = farthest_anywhere
}

#[inline(always)]
fn farthest_anywhere([x, y, z, errors]: [&[f64]; 4]) -> (f64, f64) {
    let (mut squares, mut largest) = ([0.0; LANES], [0.0; LANES]);
    let [xs, ys, zs, all_errors] = [x, y, z, errors].map(|column| column.as_chunks::<LANES>());
    for (((x, y), z), errors) in xs.0.iter().zip(ys.0).zip(zs.0).zip(all_errors.0) {
        for lane in 0..LANES {
            squares[lane] = larger(x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane], squares[lane]);
            largest[lane] = larger(errors[lane], largest[lane]);
        }
    }
    for (((x, y), z), error) in xs.1.iter().zip(ys.1).zip(zs.1).zip(all_errors.1) {
        squares[0] = larger(x * x + y * y + z * z, squares[0]);
        largest[0] = larger(*error, largest[0]);
    }
    (squares.into_iter().fold(0.0, larger), largest.into_iter().fold(0.0, larger))
}
