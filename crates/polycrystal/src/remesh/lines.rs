//! A line divided in units of the size there.

use glam::DVec3;

use crate::mesh::id::id;
use crate::remesh::gradation::{Gradation, GradedEdge};
use crate::remesh::size_field::SizeField;
use crate::remesh::skeleton::Line;

/// Fewest steps of the smooth line to a segment: points need ones of the smooth line near them.
const STEPS_OF_SEGMENT: usize = 2;

/// The points of a line, old and new.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct DividedLine {
    /// Parts that each step of the smooth line is cut into, so that there are points enough.
    pub(crate) parts: Vec<usize>,
    /// New points, without the line's ends.
    pub(crate) points: Vec<DVec3>,
    /// The middle of each segment along the smooth line.
    pub(crate) middles: Vec<DVec3>,
    /// The point, counted from the line's start, that each smooth one goes to.
    pub(crate) goes_to: Vec<u32>,
    /// The smooth points that stay, one for each new point and end.
    pub(crate) staying: Vec<u32>,
}

/// Where points of so many segments stand along a line, from end to end; none where it becomes a point.
pub(crate) fn even_shares(count: usize) -> Vec<f64> {
    (0..=count).filter(|_| count > 0).map(|number| number as f64 / count as f64).collect()
}

/// A smooth line as it is.
pub(crate) struct SmoothLine {
    pub(crate) places: Vec<DVec3>,
    /// Sizes along each step.
    steps: Vec<GradedEdge>,
    /// At each point, how many segments of the size asked for the line has up to there.
    segments: Vec<f64>,
}

impl SmoothLine {
    pub(crate) fn new(line: &Line, points: &[DVec3], sizes: &SizeField) -> Self {
        let places: Vec<DVec3> = line.vertices.iter().map(|vertex| points[*vertex as usize]).collect();
        let of_points: Vec<f64> = line.vertices.iter().map(|vertex| sizes.at(*vertex)).collect();
        Self::of(places, &of_points, sizes.gradation)
    }

    pub(crate) fn of(places: Vec<DVec3>, sizes: &[f64], gradation: Gradation) -> Self {
        let ends = places.windows(2).zip(sizes.windows(2));
        let step = |(places, sizes): (&[DVec3], &[f64])| {
            gradation.edge(places[0].distance(places[1]), [sizes[0], sizes[1]])
        };
        let steps: Vec<GradedEdge> = ends.map(step).collect();
        let mut segments = vec![0.0];
        for step in &steps {
            segments.push(segments[segments.len() - 1] + step.segments());
        }
        Self { places, steps, segments }
    }

    fn total(&self) -> f64 {
        self.segments[self.segments.len() - 1]
    }

    pub(crate) fn count(&self) -> usize {
        rounded(self.total()).max(1)
    }

    /// The step that a share of the line ends in, and the segments of this step up to there.
    pub(crate) fn at(&self, share: f64) -> (usize, f64) {
        let wanted = self.total() * share;
        let step = self.segments.partition_point(|segments| *segments < wanted).max(1) - 1;
        (step, wanted - self.segments[step])
    }

    pub(crate) fn place(&self, (step, segments): (usize, f64)) -> DVec3 {
        self.places[step].lerp(self.places[step + 1], self.steps[step].share(segments))
    }

    /// Points at these shares of the line, of which the first and the last are its ends.
    pub(crate) fn divide(&self, shares: &[f64]) -> DividedLine {
        let count = shares.len() - 1;
        let per_segment = (STEPS_OF_SEGMENT * count) as f64 / self.total();
        let parts: Vec<usize> =
            self.steps.iter().map(|step| rounded_up(step.segments() * per_segment).max(1)).collect();
        // The points between parts, which are alike in segments, and how many segments there are up to each.
        let (mut first_of_step, mut segments_at) = (Vec::with_capacity(parts.len()), vec![0.0]);
        for ((step, before), parts) in self.steps.iter().zip(&self.segments).zip(&parts) {
            first_of_step.push(segments_at.len() - 1);
            let part = step.segments() / *parts as f64;
            segments_at.extend((1..=*parts).map(|number| before + number as f64 * part));
        }
        let last = segments_at.len() - 1;
        let (mut points, mut staying) = (Vec::with_capacity(count - 1), vec![0]);
        for number in 1..count {
            let (step, segments) = self.at(shares[number]);
            points.push(self.place((step, segments)));
            let share = segments / self.steps[step].segments();
            let nearest = first_of_step[step] + rounded(share * parts[step] as f64);
            // No two may stay at one point, and the later ones need their own too.
            let before = staying[number - 1] as usize;
            staying.push(id(nearest.clamp(before + 1, last - (count - number))));
        }
        staying.push(id(last));
        let mut goes_to = Vec::with_capacity(last + 1);
        for point in 0..=last {
            let next = staying.partition_point(|stays| (*stays as usize) < point);
            let is_nearer_before = next > 0 && {
                let [before, after] = [next - 1, next].map(|place| segments_at[staying[place] as usize]);
                segments_at[point] - before < after - segments_at[point]
            };
            goes_to.push(id(if is_nearer_before { next - 1 } else { next }));
        }
        let middle = |ends: &[f64]| self.place(self.at(ends[0].midpoint(ends[1])));
        let middles = shares.windows(2).map(middle).collect();
        DividedLine { parts, points, middles, goes_to, staying }
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
fn rounded(number: f64) -> usize {
    number.round() as usize
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
fn rounded_up(number: f64) -> usize {
    number.ceil() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight(places: &[f64], size: f64) -> SmoothLine {
        let places: Vec<DVec3> = places.iter().map(|x| DVec3::X * *x).collect();
        let sizes = vec![size; places.len()];
        SmoothLine::of(places, &sizes, Gradation { growth: 0.5, most: size })
    }

    #[test]
    fn points_stand_evenly_and_smooth_ones_go_to_the_nearest() {
        let line = straight(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0], 4.9);
        let divided = line.divide(&even_shares(line.count()));
        assert_eq!(divided.parts, [1; 10]);
        assert_eq!(divided.points, [DVec3::X * 5.0]);
        assert_eq!(divided.staying, [0, 5, 10]);
        assert_eq!(divided.goes_to, [0, 0, 0, 1, 1, 1, 1, 1, 2, 2, 2]);
    }

    #[test]
    fn coarse_lines_are_cut_first() {
        let line = straight(&[0.0, 1.0], 0.25);
        let divided = line.divide(&even_shares(line.count()));
        assert_eq!(divided.parts, [8]);
        assert_eq!(divided.points, [0.25, 0.5, 0.75].map(|x| DVec3::X * x));
        assert_eq!(divided.staying, [0, 2, 4, 6, 8]);
    }
    #[test]
    fn a_long_step_has_small_segments_only_where_sizes_are_small() {
        let places = vec![DVec3::ZERO, DVec3::X];
        let line = SmoothLine::of(places, &[0.01, 0.1], Gradation { growth: 0.5, most: 0.1 });
        let count = line.count();
        assert_eq!(count, 13, "ln 10 / 0.5 up to 0.18, and 0.82 / 0.1 from there");
        let divided = line.divide(&even_shares(count));
        let lengths: Vec<f64> = divided.points.windows(2).map(|ends| ends[0].distance(ends[1])).collect();
        assert!(lengths.windows(2).all(|pair| pair[1] > 0.99 * pair[0] && pair[1] < 1.7 * pair[0]));
        assert!((lengths[11 - 1] - 0.1).abs() < 0.01);
    }
}
