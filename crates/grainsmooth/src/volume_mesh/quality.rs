//! How good tetrahedra are.

use std::fmt;

use glam::DVec3;
use polycrystal::tetrahedron_gamma;
use serde::Serialize;

use super::{VolumeMesh, volume};

/// Number of bins of a [`ShapeHistogram`].
const BINS: usize = 20;

/// The altitude of a regular tetrahedron, in units of its edges.
const REGULAR_ALTITUDE: f64 = 0.816_496_580_927_726;

/// The shape of a tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TetrahedronShape {
    /// Three times the radius of the ball within it divided by that of the ball around it.
    pub(crate) gamma: f64,
    /// The least angle between its faces, in degrees.
    pub(crate) least_angle: f64,
    /// Its longest edge divided by its least altitude, in units of this of a regular one.
    pub(crate) aspect_ratio: f64,
    /// Its volume, in units of the mean.
    pub(crate) volume: f64,
}

/// How many tetrahedra have how much of something.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ShapeHistogram {
    /// The least of all.
    pub least: f64,
    /// The mean.
    pub mean: f64,
    /// The largest of all.
    pub largest: f64,
    /// Width of the bins, of which the first starts at 0.
    pub width: f64,
    /// How many are in each bin; the last has all beyond too.
    pub counts: [usize; BINS],
}

impl ShapeHistogram {
    fn new(values: impl Iterator<Item = f64>, end: f64) -> Self {
        let width = end / BINS as f64;
        let (mut least, mut largest, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        let mut counts = [0; BINS];
        for value in values {
            (least, largest) = (least.min(value), largest.max(value));
            sum += value;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates: 0 below")]
            let bin = (value / width) as usize;
            counts[bin.min(BINS - 1)] += 1;
        }
        let mean = sum / counts.iter().sum::<usize>() as f64;
        Self { least, mean, largest, width, counts }
    }
}

/// A tetrahedron of little quality.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PoorTetrahedron {
    /// Its gamma.
    pub gamma: f64,
    /// Its grain.
    pub grain: u32,
    /// Where it is.
    pub place: [f64; 3],
}

/// Most tetrahedra that are named as poor.
const MOST_POOR: usize = 100;

/// Gamma of a tetrahedron below which it is poor.
const POOR: f64 = 0.1;

/// How good tetrahedra are, by gamma: three times the radius of the ball within one divided by that of the ball around it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TetrahedronQuality {
    /// Number of tetrahedra.
    pub count: usize,
    /// Least of all.
    pub least: f64,
    /// That which a hundredth is below.
    pub first_percentile: f64,
    /// The mean.
    pub mean: f64,
    /// How many are below 0.1.
    pub below_tenth: usize,
    /// The worst one, and the next up to a hundred that are below 0.1, the worst first.
    pub worst: Vec<PoorTetrahedron>,
    /// Gamma, from 0 to 1.
    pub gammas: ShapeHistogram,
    /// The least angle between the faces of each, in degrees; 70.5 of a regular one.
    pub least_angles: ShapeHistogram,
    /// The longest edge of each divided by its least altitude; 1 of a regular one.
    pub aspect_ratios: ShapeHistogram,
    /// The volume of each, in units of the mean.
    pub volumes: ShapeHistogram,
}

impl VolumeMesh {
    /// The shape of each tetrahedron.
    pub(crate) fn shapes(&self) -> Vec<TetrahedronShape> {
        let count = self.tetrahedra.len();
        let mean = (0..count).map(|number| volume(self.corners(number))).sum::<f64>() / count as f64;
        (0..count).map(|number| shape(self.corners(number), mean)).collect()
    }

    /// How good the tetrahedra are; nothing where there are none.
    pub fn quality(&self) -> Option<TetrahedronQuality> {
        let shapes = self.shapes();
        let mut all: Vec<(f64, usize)> = shapes.iter().map(|shape| shape.gamma).zip(0..).collect();
        all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let (least, _) = *all.first()?;
        let below_tenth = all.partition_point(|(gamma, _)| *gamma < POOR);
        let poor = |(gamma, number): &(f64, usize)| PoorTetrahedron {
            gamma: *gamma,
            grain: self.grains[*number].0,
            place: (self.corners(*number).iter().sum::<DVec3>() / 4.0).to_array(),
        };
        let worst = all[..below_tenth.clamp(1, MOST_POOR)].iter().map(poor).collect();
        let gammas = ShapeHistogram::new(shapes.iter().map(|shape| shape.gamma), 1.0);
        Some(TetrahedronQuality {
            count: all.len(),
            least,
            first_percentile: all[all.len() / 100].0,
            mean: gammas.mean,
            below_tenth,
            worst,
            gammas,
            least_angles: ShapeHistogram::new(shapes.iter().map(|shape| shape.least_angle), 80.0),
            aspect_ratios: ShapeHistogram::new(shapes.iter().map(|shape| shape.aspect_ratio), 10.0),
            volumes: ShapeHistogram::new(shapes.iter().map(|shape| shape.volume), 5.0),
        })
    }
}

fn shape(corners: [DVec3; 4], mean_volume: f64) -> TetrahedronShape {
    let [a, b, c, d] = corners;
    let edges = [b - a, c - a, d - a, c - b, d - b, d - c];
    // Normals of the faces, each toward the corner opposite, twice as long as the face's area is large.
    let normals = [(d - b).cross(c - b), (c - a).cross(d - a), (d - a).cross(b - a), (b - a).cross(c - a)];
    let pairs = (0..4).flat_map(|i| (i + 1..4).map(move |j| [i, j]));
    let angles = pairs.map(|[i, j]| (-normals[i]).angle_between(normals[j]).to_degrees());
    let longest = edges.iter().map(|edge| edge.length()).fold(0.0, f64::max);
    let widest = normals.iter().map(|normal| normal.length()).fold(0.0, f64::max);
    let least_altitude = 6.0 * volume(corners) / widest;
    TetrahedronShape {
        gamma: tetrahedron_gamma(corners),
        least_angle: angles.fold(f64::INFINITY, f64::min),
        aspect_ratio: longest / least_altitude * REGULAR_ALTITUDE,
        volume: volume(corners) / mean_volume,
    }
}

impl fmt::Display for TetrahedronQuality {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { count, least, first_percentile, mean, below_tenth, worst, .. } = self;
        let PoorTetrahedron { grain, place: [x, y, z], .. } = &worst[0];
        write!(
            out,
            "{count}, gamma {mean:.3} on the mean, a hundredth below {first_percentile:.3}, {below_tenth} below 0.1, least {least:.3} in grain {grain} at {x:.4} {y:.4} {z:.4}; least angle between faces {:.1} degrees, largest aspect ratio {:.1}",
            self.least_angles.least, self.aspect_ratios.largest
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regular_and_cube_corner_tetrahedra_have_their_shapes() {
        let regular =
            [[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]].map(DVec3::from);
        let [a, b, c, d] = regular;
        let regular = if volume(regular) > 0.0 { regular } else { [b, a, c, d] };
        let found = shape(regular, volume(regular));
        assert!(
            (found.least_angle.to_radians().cos() - 1.0 / 3.0).abs() < 1e-12
                && (found.aspect_ratio - 1.0).abs() < 1e-12
        );
        assert!((found.gamma - 1.0).abs() < 1e-12 && (found.volume - 1.0).abs() < 1e-12);
        // Between the slanted face and each other one: the cosine is 1 / sqrt 3; edges sqrt 2, altitude 1 / sqrt 3.
        let corner = shape([DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z], 1.0);
        assert!((corner.least_angle.to_radians().cos() - 3f64.sqrt().recip()).abs() < 1e-12);
        assert!((corner.aspect_ratio - 6f64.sqrt() * REGULAR_ALTITUDE).abs() < 1e-12);
    }

    #[test]
    fn histograms_count_everything_once() {
        let histogram = ShapeHistogram::new([-0.1, 0.0, 0.049, 0.05, 0.99, 3.0].into_iter(), 1.0);
        assert_eq!([histogram.counts[0], histogram.counts[1], histogram.counts[BINS - 1]], [3, 1, 2]);
        assert_eq!((histogram.least, histogram.largest), (-0.1, 3.0));
        assert_eq!(histogram.counts.iter().sum::<usize>(), 6);
    }
}
