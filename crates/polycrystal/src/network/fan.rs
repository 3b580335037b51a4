//! Fans of triangles from points inside a boundary to its outline.
//!
//! From one centre, triangles are thin wherever the outline has a short segment far away, or is long itself. A second centre
//! there, which takes a part of the first one's ring over, makes two round fans of one.

use glam::DVec3;
use smallvec::{SmallVec, smallvec};

use crate::complex::ring::LARGEST_BEND;
use crate::mesh::id::id;

/// Smallest angle, in degrees, of a fan that is good enough.
const GOOD_ANGLE: f64 = 20.0;

/// Most centres of a boundary.
pub(crate) const MOST_CENTERS: usize = 3;

/// Factor by which one more centre has to widen the smallest angle.
const GAIN: f64 = 1.1;

/// Fewest segments of a ring that a centre keeps or takes over: it has one neighbour more, the other centre.
const FEWEST_SEGMENTS: usize = 2;

/// Sweeps in which each centre goes to the mean of its neighbours, as it will during relaxation.
const SWEEPS: usize = 6;

/// The neighbours round a centre, in place up to so many: five corners, as many middles and other centres.
type Ring = SmallVec<[u32; 16]>;

/// A boundary's outline, some centres within, and triangles between them.
#[derive(Clone)]
pub(crate) struct Fan {
    outline: usize,
    /// Those of the outline, then the centres.
    points: Vec<DVec3>,
    /// The neighbours round each centre, counter-clockwise.
    rings: SmallVec<[Ring; MOST_CENTERS]>,
    /// The sum of the triangles' normals, each as long as twice the area: the same whatever is inside the outline.
    normal: DVec3,
}

impl Fan {
    /// A fan round the outline's own centre.
    pub(crate) fn new(outline: &[DVec3]) -> Self {
        let center = outline_center(outline);
        let next = outline.iter().cycle().skip(1);
        let normal = outline.iter().zip(next).map(|(a, b)| (*a - center).cross(*b - center)).sum();
        let mut points = outline.to_vec();
        points.push(center);
        Self { outline: outline.len(), points, rings: smallvec![(0..id(outline.len())).collect()], normal }
    }

    /// The fan around another centre where the outline's own does not see all of it: that of a long, bent boundary lies beside it.
    pub(crate) fn or_around(mut self, center: DVec3) -> Self {
        let is_seen = |fan: &Self| fan.thinnest(1.0).is_some();
        if !is_seen(&self) {
            let own = std::mem::replace(&mut self.points[self.outline], center);
            if !is_seen(&self) {
                self.points[self.outline] = own;
            }
        }
        self
    }

    /// The fan with more centres, as long as they make its smallest angle wider.
    pub(crate) fn with_more_centers(mut self) -> Self {
        let mut thinnest = self.thinnest(f64::INFINITY);
        while let Some((worst, cosine)) = thinnest
            && cosine > GOOD_ANGLE.to_radians().cos()
            && self.rings.len() < MOST_CENTERS
        {
            thinnest = None;
            let mut bound = (GAIN * cosine.acos()).cos();
            let centers = worst.into_iter().filter_map(|point| (point as usize).checked_sub(self.outline));
            // Most splits are worse: they are made where the last one was.
            let (mut best, mut split) = (None, self.clone());
            for (center, ends) in centers.flat_map(|center| self.splits(center)) {
                self.split(center, ends, &mut split);
                if let Some(found) = split.thinnest(bound) {
                    (thinnest, bound) = (Some(found), found.1);
                    std::mem::swap(best.get_or_insert_with(|| self.clone()), &mut split);
                }
            }
            self = best.unwrap_or(self);
        }
        self
    }

    /// The centres, and the triangles by places in the outline and, after that, among the centres.
    pub(crate) fn into_mesh(mut self) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let triangles = self.triangles().collect();
        (self.points.split_off(self.outline), triangles)
    }

    /// Each triangle once: from that of its centres with the smallest number.
    fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        (id(self.outline)..).zip(&self.rings).flat_map(move |(center, ring)| {
            let pairs = ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| [*a, *b]);
            let is_first = move |point: &u32| (*point as usize) < self.outline || *point > center;
            pairs.filter(move |pair| pair.iter().all(is_first)).map(move |[a, b]| [a, b, center])
        })
    }

    /// The triangle with the smallest angle, and that angle's cosine; nothing if the cosine reaches the bound. A triangle that
    /// turns away from the boundary, or is folded over one beside it, has no angle.
    fn thinnest(&self, bound: f64) -> Option<([u32; 3], f64)> {
        let largest_bend = LARGEST_BEND * self.normal.length();
        let at = |point: u32| self.points[point as usize];
        let mut thinnest: Option<([u32; 3], f64)> = None;
        for (center, ring) in (id(self.outline)..).zip(&self.rings) {
            let sides = |[a, b]: [u32; 2]| [at(b) - at(a), at(center) - at(b), at(a) - at(center)];
            let normal = |sides: [DVec3; 3]| sides[0].cross(sides[1]);
            let mut before = normal(sides([ring[ring.len() - 1], ring[0]]));
            for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                let sides = sides([*a, *b]);
                let normal = normal(sides);
                let is_turned = normal.dot(self.normal) < largest_bend * normal.length();
                let cosine = if is_turned || normal.dot(before) < 0.0 { 1.0 } else { largest_cosine(sides) };
                before = normal;
                if cosine >= bound {
                    return None;
                }
                if thinnest.is_none_or(|(_, largest)| cosine >= largest) {
                    thinnest = Some(([*a, *b, center], cosine));
                }
            }
        }
        thinnest
    }

    /// Where a new centre may take a part of a centre's ring over.
    fn splits(&self, center: usize) -> impl Iterator<Item = (usize, [usize; 2])> + use<> {
        let count = self.rings[center].len();
        let pairs = (0..count).flat_map(move |first| {
            let last = (count - 1).min((first + count).saturating_sub(FEWEST_SEGMENTS));
            (first + FEWEST_SEGMENTS..=last).map(move |second| [first, second])
        });
        pairs.map(move |ends| (center, ends))
    }

    /// Makes of a fan this one where a centre keeps its ring from the first of two places to the second, and a new one has the rest.
    fn split(&self, center: usize, [first, second]: [usize; 2], fan: &mut Self) {
        fan.points.clone_from(&self.points);
        fan.rings.clone_from(&self.rings);
        let [old, new] = [center, self.rings.len()].map(|center| id(self.outline + center));
        let ring = &self.rings[center];
        let kept = &ring[first..=second];
        let mut given: Ring = ring[second..].iter().chain(&ring[..=first]).copied().collect();
        fan.points
            .push(given.iter().map(|point| self.points[*point as usize]).sum::<DVec3>() / given.len() as f64);
        // Centres of the ring see the new one instead, or, at the ends of its part, beside the old one.
        for (place, point) in given.iter().enumerate() {
            let Some(other) = (*point as usize).checked_sub(self.outline) else { continue };
            let ring = &mut fan.rings[other];
            let at = ring.iter().position(|point| *point == old).expect("neighbours know each other");
            if place == 0 {
                ring.insert(at, new);
            } else if place == given.len() - 1 {
                ring.insert(at + 1, new);
            } else {
                ring[at] = new;
            }
        }
        let of_old = &mut fan.rings[center];
        of_old.clear();
        of_old.extend_from_slice(kept);
        of_old.push(new);
        given.push(old);
        fan.rings.push(given);
        fan.smooth();
    }

    fn smooth(&mut self) {
        for _ in 0..SWEEPS {
            for (ring, center) in self.rings.iter().zip(self.outline..) {
                let sum: DVec3 = ring.iter().map(|point| self.points[*point as usize]).sum();
                self.points[center] = sum / ring.len() as f64;
            }
        }
    }
}

/// The cosine of the smallest angle of a triangle, which is opposite its shortest side.
fn largest_cosine(sides: [DVec3; 3]) -> f64 {
    let squares = sides.map(DVec3::length_squared);
    let [ab, bc, ca] = squares;
    let shortest = if ab <= bc && ab <= ca {
        0
    } else if bc <= ca {
        1
    } else {
        2
    };
    let [one, other] = [(shortest + 1) % 3, (shortest + 2) % 3];
    (-sides[one].dot(sides[other]) / (squares[one] * squares[other]).sqrt()).min(1.0)
}

/// The centroid of an outline: inside the face, and well defined for the thinnest of slivers.
pub(crate) fn outline_center(outline: &[DVec3]) -> DVec3 {
    let origin = outline[0];
    let (mut weighted, mut perimeter) = (DVec3::ZERO, 0.0);
    for (from, to) in outline.iter().zip(outline.iter().cycle().skip(1)) {
        let length = from.distance(*to);
        weighted += (from.midpoint(*to) - origin) * length;
        perimeter += length;
    }
    origin + weighted / perimeter
}

#[cfg(test)]
mod tests {
    use super::*;

    fn smallest_angle(fan: &Fan) -> f64 {
        fan.thinnest(f64::INFINITY).expect("a fan has triangles").1.acos().to_degrees()
    }

    #[test]
    fn round_outlines_have_one_centre_and_long_ones_have_more() {
        let ellipse = |width: f64| -> Vec<DVec3> {
            let angle = |k: u32| f64::from(k) * std::f64::consts::TAU / 10.0;
            (0..10).map(|k| DVec3::new(width * angle(k).cos(), angle(k).sin(), 0.0)).collect()
        };
        assert_eq!(Fan::new(&ellipse(1.0)).with_more_centers().rings.len(), 1);
        let one = Fan::new(&ellipse(4.0));
        let more = one.clone().with_more_centers();
        assert!(more.rings.len() > 1 && smallest_angle(&more) > 1.5 * smallest_angle(&one));
    }

    /// Two grains of 200 (`--seeding random --rng-seed 7`) met in a long, bent boundary, whose fan folded: so all of them kept the topology that they had.
    #[test]
    fn a_bent_boundary_has_the_centre_that_sees_all_of_it() {
        let outline = [
            [0.99698, 0.91503, 0.88407],
            [0.94854, 0.91178, 0.87369],
            [0.89464, 0.91254, 0.86233],
            [0.79852, 0.87997, 0.86923],
            [0.69793, 0.86096, 0.84067],
            [0.68873, 0.85898, 0.83924],
            [0.68056, 0.85512, 0.83927],
            [0.67991, 0.84504, 0.85136],
            [0.67896, 0.83583, 0.86363],
            [0.82790, 0.87405, 0.89239],
        ]
        .map(DVec3::from_array);
        let settled = DVec3::new(0.78244, 0.87230, 0.87391);
        let own = Fan::new(&outline);
        assert!(own.thinnest(1.0).is_none());
        let other = own.clone().or_around(settled);
        assert!(other.thinnest(1.0).is_some() && other.points[10] == settled);
        // From farther away less is seen.
        let far = own.clone().or_around(settled + DVec3::Y);
        assert_eq!(far.points, own.points);
    }

    #[test]
    fn triangles_fill_the_outline_once() {
        let outline = [(0.0, 0.0), (2.0, 0.0), (4.0, 0.1), (4.05, 0.2), (4.0, 1.0), (2.0, 1.2), (0.3, 1.0)];
        let outline = outline.map(|(x, y)| DVec3::new(x, y, 0.0));
        let area = |a: DVec3, b: DVec3, c: DVec3| (b - a).cross(c - a).z / 2.0;
        let whole: f64 = (1..6).map(|k| area(outline[0], outline[k], outline[k + 1])).sum();
        let fan = Fan::new(&outline).with_more_centers();
        assert!(fan.rings.len() > 1);
        let points = fan.points.clone();
        let (centers, triangles) = fan.into_mesh();
        assert_eq!(triangles.len(), outline.len() + 2 * (centers.len() - 1));
        let areas: Vec<f64> = triangles
            .iter()
            .map(|t| t.map(|point| points[point as usize]))
            .map(|[a, b, c]| area(a, b, c))
            .collect();
        assert!(areas.iter().all(|area| *area > 0.0));
        assert!((areas.iter().sum::<f64>() - whole).abs() < 1e-12);
    }
}
