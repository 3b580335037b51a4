//! Which planes between copies of the box meet boundaries and lines at the largest angles.
//!
//! Between a plane and a boundary that meets it at a small angle there is room for flat tetrahedra only, whatever their size; a line that does so
//! leaves boundaries with narrow tips. So does a boundary that meets an edge of the box at a small angle: there its trace in one plane meets another
//! plane so. On the torus, planes may lie anywhere.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

use glam::DVec3;
use subzero::{EdgeId, TriangleMesh, VertexRule};

use crate::box_cut::periodic_axes;
use crate::box_cut::pieces::ROUNDING;
use crate::box_cut::snap::NEAR;
use crate::{GrainId, Mesh, Network};

/// Planes that are tried across each axis. On the mean of nine axes (200 random grains, seeds 1 and 2, default and equilibrium), the best of 128 meets lines at
/// 8 degrees or more, of 1024 at 8.5; one taken by chance at 0.3.
const PLANES: i32 = 1024;

/// Each triangle and line that a plane meets counts against it, by this power of one over the sine of the angle: so high that the smallest angles decide, and so low that it
/// matters how many there are. Of 20 networks of 200 random grains at equilibrium, cut and filled with five elements to a diameter, 18 then had no tetrahedron with a gamma below 0.1, the others 1 and
/// 2; where the smallest angle alone decided, 6 had such ones, 8 in all.
const POWER: i32 = 6;

/// Sine at which a line may meet a plane, in units of that of a boundary. Of the tetrahedra with a gamma below 0.1 in four such networks, those between
/// boundaries and a plane stood at angles below 16 degrees, those at lines below 8.
const OF_LINES: f64 = 2.0;

impl Network {
    /// How far a periodic network has to move for the planes of its box to meet boundaries and lines as steeply as they can, for the points of its
    /// finest level: at most half a period along each axis.
    ///
    /// The moved network is the same on the torus, and [`Self::cut_at_box`] leaves fewer narrow wedges and tips in it.
    ///
    /// # Panics
    /// When there is not one point per vertex of the finest level.
    pub fn motion_for_steep_cut(&self, points: &[DVec3]) -> DVec3 {
        let mut motion = DVec3::ZERO;
        // The lines in which planes that are chosen meet boundaries.
        let mut traces = Vec::new();
        for axis in periodic_axes(self.domain()) {
            let flatness = self.flatness(points, axis, &traces);
            // The first of equal ones: the planes stay where nothing is gained.
            let steepest = (0..PLANES).zip(flatness).min_by(|a, b| a.1.total_cmp(&b.1));
            let (best, _) = steepest.expect("there are planes");
            let back = if 2 * best > PLANES { PLANES - best } else { -best };
            motion[axis] = self.domain().size()[axis] * f64::from(back) / f64::from(PLANES);
            traces.extend(self.traces(points, axis, best));
        }
        motion
    }

    /// How flatly each plane across an axis meets boundaries, lines, and traces in other planes.
    fn flatness(&self, points: &[DVec3], axis: usize, traces: &[[DVec3; 2]]) -> Vec<f64> {
        let level = self.finest_level();
        assert_eq!(points.len(), level.vertex_count(), "there must be one point per vertex");
        let spacing = self.domain().size()[axis] / f64::from(PLANES);
        let mut planes = Planes {
            axis,
            lower: self.domain().lower()[axis],
            spacing,
            near: NEAR * self.mean_edge_length(points) / spacing,
            flatness: vec![0.0; (0..PLANES).len()],
        };
        let place = |corner: u32| points[corner as usize];
        match &level.mesh {
            Mesh::Triangles(mesh) => {
                for corners in mesh.triangles() {
                    planes.meet_triangle(corners.map(place));
                }
                let edges = (0u32..).map(EdgeId).zip(mesh.edges());
                for (_, ends) in edges.filter(|(edge, _)| mesh.is_crease(*edge)) {
                    planes.meet_segment(ends.map(place), OF_LINES);
                }
                for tip in self.tips(mesh, points, axis) {
                    planes.meet_tip(place(tip));
                }
            }
            Mesh::Segments(mesh) => {
                for ends in mesh.segments() {
                    planes.meet_segment(ends.map(place), 1.0);
                }
            }
        }
        traces.iter().for_each(|ends| planes.meet_segment(*ends, OF_LINES));
        planes.flatness
    }

    /// The points of several boundaries where a grain ends along an axis: all of its surface around lies on one side.
    fn tips(&self, mesh: &TriangleMesh, points: &[DVec3], axis: usize) -> BTreeSet<u32> {
        let level = self.finest_level();
        // Whether a point's neighbours on a grain lie below and above it.
        let mut around: BTreeMap<(u32, GrainId), [bool; 2]> = BTreeMap::new();
        for (corners, boundary) in mesh.triangles().iter().zip(&level.boundary_of) {
            for corner in corners.iter().filter(|corner| mesh.vertex_rule(**corner) == VertexRule::Corner) {
                for grain in self.boundaries()[boundary.index()].sides.iter().filter_map(|side| side.grain())
                {
                    let sides = around.entry((*corner, grain)).or_default();
                    let height = |point: u32| points[point as usize][axis];
                    for other in corners.iter().filter(|other| height(**other) != height(*corner)) {
                        sides[usize::from(height(*other) > height(*corner))] = true;
                    }
                }
            }
        }
        let tips = around.into_iter().filter(|(_, sides)| *sides != [true; 2]);
        tips.map(|((point, _), _)| point).collect()
    }

    /// The segments in which a plane across an axis and its periodic images meet the triangles of boundaries.
    fn traces(&self, points: &[DVec3], axis: usize, plane: i32) -> Vec<[DVec3; 2]> {
        let level = self.finest_level();
        let Mesh::Triangles(mesh) = &level.mesh else { return Vec::new() };
        let (lower, period) = (self.domain().lower()[axis], self.domain().size()[axis]);
        let first = lower + period * f64::from(plane) / f64::from(PLANES);
        let mut traces = Vec::new();
        for corners in mesh.triangles() {
            let corners = corners.map(|corner| points[corner as usize]);
            // In periods above the plane.
            let heights = corners.map(|corner| (corner[axis] - first) / period);
            let image = heights.into_iter().fold(f64::INFINITY, f64::min).ceil();
            let is_above = heights.map(|height| height > image);
            let crossings =
                [[0, 1], [1, 2], [2, 0]].into_iter().filter(|[from, to]| is_above[*from] != is_above[*to]);
            let ends = crossings.map(|[from, to]| {
                corners[from].lerp(corners[to], (image - heights[from]) / (heights[to] - heights[from]))
            });
            if let [from, to] = ends.collect::<Vec<_>>()[..]
                && from != to
            {
                traces.push([from, to]);
            }
        }
        traces
    }
}

/// Planes across an axis, evenly between the walls of the box.
struct Planes {
    axis: usize,
    lower: f64,
    spacing: f64,
    /// Distance, in units of the spacing, within which points move into a plane.
    near: f64,
    /// Of each of them the sum over all that it meets; what stands upright on it counts nothing.
    flatness: Vec<f64>,
}

impl Planes {
    /// Where a place lies along the axis, in units of the spacing.
    fn height(&self, place: DVec3) -> f64 {
        (place[self.axis] - self.lower) / self.spacing
    }

    /// The planes that meet what lies between two heights, or come near it.
    #[expect(clippy::cast_possible_truncation, reason = "the network is small beside 2^31 planes")]
    fn planes_near(&self, [low, high]: [f64; 2]) -> RangeInclusive<i32> {
        (low - self.near).ceil() as i32..=(high + self.near).floor() as i32
    }

    fn meet_triangle(&mut self, corners: [DVec3; 3]) {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize();
        self.meet(&corners, (1.0 - normal[self.axis].powi(2)).sqrt());
    }

    fn meet_segment(&mut self, ends: [DVec3; 2], factor: f64) {
        let along = (ends[1] - ends[0]).normalize();
        self.meet(&ends, factor * along[self.axis].abs());
    }

    /// Takes note of a point where a grain ends: a plane just inside it cuts off a tip that no element fits into.
    fn meet_tip(&mut self, place: DVec3) {
        let height = self.height(place);
        for plane in self.planes_near([height; 2]) {
            let depth = (height - f64::from(plane)).abs();
            // What lies in a plane is not cut off by it.
            if depth >= ROUNDING * f64::from(PLANES) {
                let share = depth / self.near;
                self.flatness[plane.rem_euclid(PLANES) as usize] += share.powi(-POWER) - 1.0;
            }
        }
    }

    /// Takes note of what has these corners, and this sine to each plane that it meets or comes near.
    fn meet(&mut self, corners: &[DVec3], sine: f64) {
        let heights = corners.iter().map(|corner| self.height(*corner));
        let low = heights.clone().fold(f64::INFINITY, f64::min);
        let high = heights.fold(f64::NEG_INFINITY, f64::max);
        for plane in self.planes_near([low, high]) {
            // What lies in a plane is not cut by it.
            let lies_in = |end: f64| (end - f64::from(plane)).abs() < ROUNDING * f64::from(PLANES);
            if !(lies_in(low) && lies_in(high)) {
                self.flatness[plane.rem_euclid(PLANES) as usize] += sine.min(1.0).powi(-POWER) - 1.0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use voronoi::{Domain, Tessellation};

    use super::*;
    use crate::Junctions;

    /// Eight cubes in a periodic box, around these places along each axis.
    fn cubes(places: [f64; 2]) -> (Network, Vec<DVec3>) {
        let domain = Domain::unit_cube().with_periods(glam::BVec3::TRUE);
        let rows = places.into_iter().flat_map(|x| places.map(|y| [x, y]));
        let seeds: Vec<DVec3> = rows.flat_map(|[x, y]| places.map(|z| DVec3::new(x, y, z))).collect();
        let tessellation = Tessellation::new(&domain, &seeds).expect("valid seeds");
        let (network, flat) = Network::new(&tessellation, Junctions::Crease, 1).expect("cubes");
        let points = network.subdivide(&flat);
        (network, points)
    }

    #[test]
    fn planes_that_cut_off_tips_count_as_flat() {
        let mut planes =
            Planes { axis: 1, lower: 0.0, spacing: 0.1, near: 2.5, flatness: vec![0.0; (0..PLANES).len()] };
        planes.meet_tip(DVec3::new(7.0, 10.08, -3.0));
        let flat: Vec<usize> =
            (0..).zip(&planes.flatness).filter(|(_, flat)| **flat > 0.0).map(|(k, _)| k).collect();
        assert_eq!(flat, [99, 100, 101, 102, 103]);
        let expected = (2.5_f64 / 0.8).powi(POWER) - 1.0;
        assert!(
            (planes.flatness[100] / expected - 1.0).abs() < 1e-9 && planes.flatness[101] > 100.0 * expected
        );
        // A plane through the tip leaves it whole.
        planes.flatness.fill(0.0);
        planes.meet_tip(DVec3::new(0.0, 10.0, 0.0));
        assert_eq!(planes.flatness[100], 0.0);
        assert!(planes.flatness[99] > 0.0 && planes.flatness[101] > 0.0);
    }

    /// At each corner of a cube it ends, along all axes.
    #[test]
    fn corners_of_cubes_are_tips() {
        let (network, points) = cubes([0.3, 0.8]);
        let Mesh::Triangles(mesh) = &network.finest_level().mesh else { panic!("in space") };
        let is_corner =
            |place: DVec3| place.to_array().iter().all(|x| ((x - 0.05) * 2.0).fract().abs() < 1e-9);
        let corners = (0u32..).zip(&points).filter(|(_, place)| is_corner(**place)).map(|(corner, _)| corner);
        let corners: BTreeSet<u32> = corners.collect();
        assert!(corners.len() >= 8);
        for axis in 0..3 {
            assert_eq!(network.tips(mesh, &points, axis), corners);
        }
    }

    /// Each plane meets eight cubes in four lines, as long as a period; two of them are boundaries between copies, which come twice.
    #[test]
    fn traces_are_the_lines_in_which_planes_meet_boundaries() {
        let (network, points) = cubes([0.35, 0.85]);
        for axis in 0..3 {
            for plane in [5, 400, 1000] {
                let traces = network.traces(&points, axis, plane);
                let length: f64 = traces.iter().map(|[from, to]| from.distance(*to)).sum();
                assert!((length - 6.0).abs() < 1e-9, "{axis} {plane}: {length}");
                let across = traces.iter().map(|[from, to]| (to[axis] - from[axis]).abs());
                assert!(across.fold(0.0, f64::max) < 1e-12, "traces lie in the plane");
            }
        }
    }
}
