//! Lines divided evenly, in units of the size there.

use std::collections::BTreeMap;

use crate::mesh::id::id;
use crate::remesh::lines::{DividedLine, SmoothLine, even_shares};
use crate::remesh::narrow_corners::pair_at_narrow_corners;
use crate::remesh::size_field::{SizeField, Surroundings};
use crate::remesh::torus::Moved;
use crate::remesh::tuning::RemeshTuning;

/// Fewest segments of a line that comes back to where it starts.
const OF_LOOP: usize = 3;

/// Divides all lines but those that become points.
pub(crate) fn divide_lines(
    around: &Surroundings<'_>,
    sizes: &SizeField,
    tuning: &RemeshTuning,
) -> Vec<DividedLine> {
    let lines = &around.skeleton.lines;
    let smooth: Vec<SmoothLine> =
        lines.iter().map(|line| SmoothLine::new(line, around.points, sizes)).collect();
    let mut counts: Vec<usize> = smooth.iter().map(SmoothLine::count).collect();
    // Two single segments between the same points would be one.
    let mut between: BTreeMap<[Moved<u32>; 2], Vec<usize>> = BTreeMap::new();
    for (number, line) in lines.iter().enumerate() {
        if around.short.has(id(number)) {
            counts[number] = 0;
        } else if line.is_closed() {
            counts[number] = counts[number].max(OF_LOOP);
        } else {
            between.entry(around.short.ends(line.ends(), around.torus)).or_default().push(number);
        }
    }
    for alike in between.values().filter(|alike| alike.len() > 1) {
        alike.iter().for_each(|line| counts[*line] = counts[*line].max(2));
    }
    let mut shares: Vec<Vec<f64>> = counts.iter().map(|count| even_shares(*count)).collect();
    if !around.is_plane {
        pair_at_narrow_corners(around, &smooth, &mut shares, tuning);
    }
    let divided = |(line, shares): (&SmoothLine, &Vec<f64>)| match &shares[..] {
        [] => DividedLine::default(),
        shares => line.divide(shares),
    };
    smooth.iter().zip(&shares).map(divided).collect()
}
