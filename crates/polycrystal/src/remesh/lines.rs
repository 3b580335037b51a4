//! Lines divided evenly, in units of the size there.

use std::collections::BTreeMap;

use glam::DVec3;
use voronoi::Translation;

use crate::mesh::id::id;
use crate::remesh::size_field::SizeField;
use crate::remesh::skeleton::Line;
use crate::remesh::torus::{Moved, Torus};

/// Fewest segments of a line that comes back to where it starts.
const OF_LOOP: usize = 3;

/// Fewest steps of the smooth line to a segment: points need ones of the smooth line near them.
const STEPS_OF_SEGMENT: usize = 2;

/// The points of a line, old and new.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DividedLine {
    /// Parts that each step of the smooth line is cut into, so that there are points enough.
    pub(crate) parts: usize,
    /// New points, without the line's ends.
    pub(crate) points: Vec<DVec3>,
    /// The middle of each segment along the smooth line.
    pub(crate) middles: Vec<DVec3>,
    /// The point, counted from the line's start, that each smooth one goes to.
    pub(crate) goes_to: Vec<u32>,
    /// The smooth points that stay, one for each new point and end.
    pub(crate) staying: Vec<u32>,
}

/// Divides all lines.
pub(crate) fn divide_lines(
    lines: &[Line],
    points: &[DVec3],
    sizes: &SizeField,
    torus: &Torus,
) -> Vec<DividedLine> {
    let smooth: Vec<Smooth> = lines.iter().map(|line| Smooth::new(line, points, sizes)).collect();
    let mut counts: Vec<usize> = smooth.iter().map(Smooth::count).collect();
    // Two single segments between the same points would be one.
    let mut between: BTreeMap<[Moved<u32>; 2], Vec<usize>> = BTreeMap::new();
    for (number, line) in lines.iter().enumerate() {
        if line.is_closed() {
            counts[number] = counts[number].max(OF_LOOP);
        } else {
            between.entry(ends(line, torus)).or_default().push(number);
        }
    }
    for alike in between.values().filter(|alike| alike.len() > 1) {
        alike.iter().for_each(|line| counts[*line] = counts[*line].max(2));
    }
    smooth.iter().zip(counts).map(|(line, count)| line.divide(count)).collect()
}

/// The ends of a line on the torus, in order, as seen from one of them.
fn ends(line: &Line, torus: &Torus) -> [Moved<u32>; 2] {
    let from = |own: u32, other: u32| {
        let Moved { original, translation } = torus.vertices[own as usize];
        [Moved { original, translation: Translation::ZERO }, torus.seen(other, translation)]
    };
    let (start, end) = (line.vertices[0], line.vertices[line.vertices.len() - 1]);
    from(start, end).min(from(end, start))
}

/// A smooth line as it is.
struct Smooth {
    places: Vec<DVec3>,
    /// At each point, how many segments of the size asked for the line has up to there.
    segments: Vec<f64>,
}

impl Smooth {
    fn new(line: &Line, points: &[DVec3], sizes: &SizeField) -> Self {
        let places: Vec<DVec3> = line.vertices.iter().map(|vertex| points[*vertex as usize]).collect();
        let mut segments = vec![0.0];
        let mut sum = 0.0;
        for (ends, vertices) in places.windows(2).zip(line.vertices.windows(2)) {
            let density = 0.5 * (1.0 / sizes.at(vertices[0]) + 1.0 / sizes.at(vertices[1]));
            sum += ends[0].distance(ends[1]) * density;
            segments.push(sum);
        }
        Self { places, segments }
    }

    fn total(&self) -> f64 {
        self.segments[self.segments.len() - 1]
    }

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
    fn count(&self) -> usize {
        (self.total().round() as usize).max(1)
    }

    /// The step that a share of the line ends in, and the share of this step.
    fn at(&self, share: f64) -> (usize, f64) {
        let wanted = self.total() * share;
        let step = self.segments.partition_point(|segments| *segments < wanted).max(1) - 1;
        (step, (wanted - self.segments[step]) / (self.segments[step + 1] - self.segments[step]))
    }

    fn place(&self, (step, share): (usize, f64)) -> DVec3 {
        self.places[step].lerp(self.places[step + 1], share)
    }

    fn divide(&self, count: usize) -> DividedLine {
        let steps = self.places.len() - 1;
        let parts =
            if steps >= STEPS_OF_SEGMENT * count { 1 } else { (STEPS_OF_SEGMENT * count).div_ceil(steps) };
        let fine = self.in_parts(parts);
        let last = fine.places.len() - 1;
        let (mut points, mut staying) = (Vec::with_capacity(count - 1), vec![0]);
        for number in 1..count {
            let (at, share) = fine.at(number as f64 / count as f64);
            points.push(fine.place((at, share)));
            let nearest = if share < 0.5 { at } else { at + 1 };
            // No two may stay at one point, and the later ones need their own too.
            let before = staying[number - 1] as usize;
            staying.push(id(nearest.clamp(before + 1, last - (count - number))));
        }
        staying.push(id(last));
        let mut goes_to = Vec::with_capacity(last + 1);
        for point in 0..=last {
            let next = staying.partition_point(|stays| (*stays as usize) < point);
            let is_nearer_before = next > 0 && {
                let [before, after] = [next - 1, next].map(|place| fine.segments[staying[place] as usize]);
                fine.segments[point] - before < after - fine.segments[point]
            };
            goes_to.push(id(if is_nearer_before { next - 1 } else { next }));
        }
        let middle = |segment: usize| fine.place(fine.at((segment as f64 + 0.5) / count as f64));
        let middles = (0..count).map(middle).collect();
        DividedLine { parts, points, middles, goes_to, staying }
    }

    /// The same line with each step cut into so many parts.
    fn in_parts(&self, parts: usize) -> Self {
        let mut fine = Self { places: vec![self.places[0]], segments: vec![0.0] };
        for (places, segments) in self.places.windows(2).zip(self.segments.windows(2)) {
            for part in 1..=parts {
                let share = part as f64 / parts as f64;
                let is_end = part == parts;
                fine.places.push(if is_end { places[1] } else { places[0].lerp(places[1], share) });
                fine.segments.push(segments[0] + share * (segments[1] - segments[0]));
            }
        }
        fine
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight(steps: u32, size: f64) -> Smooth {
        let places: Vec<DVec3> = (0..=steps).map(|step| DVec3::X * f64::from(step)).collect();
        Smooth { segments: places.iter().map(|place| place.x / size).collect(), places }
    }

    #[test]
    fn points_stand_evenly_and_smooth_ones_go_to_the_nearest() {
        let line = straight(10, 4.9);
        let divided = line.divide(line.count());
        assert_eq!(divided.parts, 1);
        assert_eq!(divided.points, [DVec3::X * 5.0]);
        assert_eq!(divided.staying, [0, 5, 10]);
        assert_eq!(divided.goes_to, [0, 0, 0, 1, 1, 1, 1, 1, 2, 2, 2]);
    }

    #[test]
    fn coarse_lines_are_cut_first() {
        let line = straight(1, 0.25);
        let divided = line.divide(line.count());
        assert_eq!(divided.parts, 8);
        assert_eq!(divided.points, [0.25, 0.5, 0.75].map(|x| DVec3::X * x));
        assert_eq!(divided.staying, [0, 2, 4, 6, 8]);
    }
}
