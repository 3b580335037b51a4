//! Points of lines near a node that they leave at a small angle.
//!
//! Triangles between two such lines are as narrow as their angle in any case. With points at other distances from the node they are obtuse as well, and
//! tetrahedra on them half as good, as their circumspheres are twice as large. So first points stand at the same distances, as on concentric shells
//! (Shewchuk 2002, section 5). Where lines are apart, triangles between points at different distances have wider angles.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::remesh::lines::SmoothLine;
use crate::remesh::size_field::Surroundings;
use crate::remesh::tuning::RemeshTuning;

/// Halvings of the part of a line that a place is looked for in: to a thousandth of a segment.
const HALVINGS: usize = 10;

/// An end of a line.
#[derive(Debug, Clone, Copy)]
struct LineEnd {
    line: usize,
    is_last: bool,
}

impl LineEnd {
    /// The number of the point that is so many segments from this end, if there is one between the ends.
    fn inner(self, shares: &[Vec<f64>], segments: usize) -> Option<usize> {
        let last = shares[self.line].len().checked_sub(1)?;
        (segments < last).then(|| if self.is_last { last - segments } else { segments })
    }
}

/// Makes points of lines that leave a node at a small angle stand opposite each other, as long as they are near.
pub(super) fn pair_at_narrow_corners(
    around: &Surroundings<'_>,
    smooth: &[SmoothLine],
    shares: &mut [Vec<f64>],
    tuning: &RemeshTuning,
) {
    let mut at_nodes: BTreeMap<u32, Vec<LineEnd>> = BTreeMap::new();
    for (line, own) in around.skeleton.lines.iter().enumerate().filter(|(line, _)| !shares[*line].is_empty())
    {
        for (is_last, end) in [false, true].into_iter().zip(own.ends()) {
            at_nodes.entry(around.node(end).original).or_default().push(LineEnd { line, is_last });
        }
    }
    let mut corners = Vec::new();
    for ends in at_nodes.values() {
        for (number, one) in ends.iter().enumerate() {
            for other in &ends[number + 1..] {
                let [a, b] = [one, other].map(|end| smooth[end.line].way_to(*end, 1, shares));
                let angle = a.angle_between(b);
                if angle < tuning.narrow_corner {
                    corners.push((angle, [*one, *other]));
                }
            }
        }
    }
    corners.sort_by(|a, b| a.0.total_cmp(&b.0));
    let corners: Vec<[LineEnd; 2]> = corners.into_iter().map(|(_, ends)| ends).collect();
    pair(smooth, &corners, shares, tuning);
}

/// The same for the lines at these corners; what is moved at one stays for the others.
fn pair(smooth: &[SmoothLine], corners: &[[LineEnd; 2]], shares: &mut [Vec<f64>], tuning: &RemeshTuning) {
    let mut is_placed: Vec<Vec<bool>> = shares.iter().map(|shares| vec![false; shares.len()]).collect();
    for ends in corners {
        for segments in 1.. {
            let [Some(one), Some(other)] = ends.map(|end| end.inner(shares, segments)) else { break };
            let ways = ends.map(|end| smooth[end.line].way_to(end, segments, shares));
            let distances = ways.map(DVec3::length);
            let mean = distances[0].midpoint(distances[1]);
            let spacing = mean / segments as f64;
            let is_apart = ways[0].angle_between(ways[1]) * mean > tuning.apart * spacing;
            let by = if is_apart { tuning.stagger * spacing } else { 0.0 };
            let [nearer, farther] = if distances[0] <= distances[1] { [0, 1] } else { [1, 0] };
            let points = [one, other];
            let placed = [0, 1].map(|side| is_placed[ends[side].line][points[side]]);
            let least = match [placed[nearer], placed[farther]] {
                [true, true] => break,
                [true, false] => distances[nearer],
                [false, true] => distances[farther] - by,
                [false, false] => mean - 0.5 * by,
            };
            for (side, wanted) in [(nearer, least), (farther, least + by)] {
                let (end, point) = (ends[side], points[side]);
                if !is_placed[end.line][point] {
                    smooth[end.line].put_at_distance(end, point, wanted, &mut shares[end.line]);
                    is_placed[end.line][point] = true;
                }
            }
            if is_apart {
                break;
            }
        }
    }
}

impl SmoothLine {
    /// The way from an end to the point so many segments from it, or to the other end.
    fn way_to(&self, end: LineEnd, segments: usize, shares: &[Vec<f64>]) -> DVec3 {
        let share = match end.inner(shares, segments) {
            Some(point) => shares[end.line][point],
            None => f64::from(u8::from(!end.is_last)),
        };
        self.place(self.at(share)) - self.end(end)
    }

    fn end(&self, end: LineEnd) -> DVec3 {
        if end.is_last { self.places[self.places.len() - 1] } else { self.places[0] }
    }

    /// Moves a point along the line to a distance from an end, but no farther than halfway to the points before and after it.
    fn put_at_distance(&self, end: LineEnd, point: usize, distance: f64, shares: &mut [f64]) {
        let [before, after] = [point - 1, point + 1].map(|next| shares[next].midpoint(shares[point]));
        let [mut near, mut far] = if end.is_last { [after, before] } else { [before, after] };
        for _ in 0..HALVINGS {
            let middle = near.midpoint(far);
            if self.place(self.at(middle)).distance(self.end(end)) < distance {
                near = middle
            } else {
                far = middle
            }
        }
        shares[point] = near;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::remesh::gradation::Gradation;
    use crate::remesh::lines::even_shares;

    /// Two lines at an angle of 6 degrees, divided into 9 and 11: points up to a distance of 2 are nearer than 0.3 of their spacing.
    #[test]
    fn points_in_a_narrow_corner_stand_opposite_and_then_apart() {
        let angle = 0.105_f64;
        let line = |places: [DVec3; 2]| {
            SmoothLine::of(
                places.map(|place| 10.0 * place).to_vec(),
                &[1.0; 2],
                Gradation { growth: 0.5, most: 1.0 },
            )
        };
        let other = DVec3::new(angle.cos(), angle.sin(), 0.0);
        for is_last in [false, true] {
            let ends = [DVec3::ZERO, other];
            let smooth =
                [line([DVec3::ZERO, DVec3::X]), line(if is_last { [ends[1], ends[0]] } else { ends })];
            let start = [even_shares(9), even_shares(11)];
            let mut shares = start.to_vec();
            pair(
                &smooth,
                &[[LineEnd { line: 0, is_last: false }, LineEnd { line: 1, is_last }]],
                &mut shares,
                &RemeshTuning::default(),
            );
            if is_last {
                shares[1] = shares[1].iter().rev().map(|share| 1.0 - share).collect();
            }
            let distances = |segments: usize| [0, 1].map(|line| 10.0 * shares[line][segments]);
            for segments in [1, 2] {
                let [one, other] = distances(segments);
                let mean = 5.0 * (start[0][segments] + start[1][segments]);
                assert!((one - other).abs() < 5e-3 && (one - mean).abs() < 5e-3, "{one} {other} {mean}");
            }
            let [one, other] = distances(3);
            assert!(one - other > 0.29, "{one} {other}");
            for (found, start) in shares.iter().zip(&start) {
                let rest = found[4..].iter().zip(&start[4..]);
                assert!(rest.into_iter().all(|(found, start)| (found - start).abs() < 1e-15));
            }
        }
    }
}
