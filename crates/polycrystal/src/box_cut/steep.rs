//! Which planes between copies of the box meet boundaries and lines at the largest angles.
//!
//! Between a plane and a boundary that meets it at a small angle there is room for flat tetrahedra only, whatever their size; a line that does so
//! leaves boundaries with narrow tips. On the torus, planes may lie anywhere: those across an axis are free of those across another.

use glam::DVec3;
use subzero::EdgeId;

use crate::box_cut::periodic_axes;
use crate::box_cut::pieces::ROUNDING;
use crate::box_cut::snap::NEAR;
use crate::{Mesh, Network};

/// Planes that are tried across each axis. On the mean of nine axes (200 random grains, seeds 1 and 2, default and equilibrium), the best of 128 meets lines at
/// 8 degrees or more, of 1024 at 8.5; one taken by chance at 0.3.
const PLANES: i32 = 1024;

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
        for axis in periodic_axes(self.domain()) {
            let least = self.least_angles(points, axis);
            // The first of equal ones: the planes stay where nothing is gained.
            let steepest = (0..PLANES).zip(least).rev().max_by(|a, b| a.1.total_cmp(&b.1));
            let (best, _) = steepest.expect("there are planes");
            let back = if 2 * best > PLANES { PLANES - best } else { -best };
            motion[axis] = self.domain().size()[axis] * f64::from(back) / f64::from(PLANES);
        }
        motion
    }

    /// Squares of the sine of the least angle at which each plane across an axis meets something.
    fn least_angles(&self, points: &[DVec3], axis: usize) -> Vec<f64> {
        let level = self.finest_level();
        assert_eq!(points.len(), level.vertex_count(), "there must be one point per vertex");
        let spacing = self.domain().size()[axis] / f64::from(PLANES);
        let mut planes = Planes {
            axis,
            lower: self.domain().lower()[axis],
            spacing,
            near: NEAR * self.mean_edge_length(points) / spacing,
            least: vec![1.0; (0..PLANES).len()],
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
            }
            Mesh::Segments(mesh) => {
                for ends in mesh.segments() {
                    planes.meet_segment(ends.map(place), 1.0);
                }
            }
        }
        planes.least
    }
}

/// Planes across an axis, evenly between the walls of the box.
struct Planes {
    axis: usize,
    lower: f64,
    spacing: f64,
    /// Distance, in units of the spacing, within which points move into a plane.
    near: f64,
    /// The square of the least sine at each of them.
    least: Vec<f64>,
}

impl Planes {
    fn meet_triangle(&mut self, corners: [DVec3; 3]) {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize();
        self.meet(&corners, 1.0 - normal[self.axis].powi(2));
    }

    fn meet_segment(&mut self, ends: [DVec3; 2], factor: f64) {
        let along = (ends[1] - ends[0]).normalize();
        self.meet(&ends, (factor * along[self.axis]).powi(2));
    }

    /// Takes note of what has these corners, and the square of a sine to each plane that it meets or comes near.
    #[expect(clippy::cast_possible_truncation, reason = "the network is small beside 2^31 planes")]
    fn meet(&mut self, corners: &[DVec3], squared: f64) {
        let heights = corners.iter().map(|corner| (corner[self.axis] - self.lower) / self.spacing);
        let low = heights.clone().fold(f64::INFINITY, f64::min);
        let high = heights.fold(f64::NEG_INFINITY, f64::max);
        for plane in (low - self.near).ceil() as i32..=(high + self.near).floor() as i32 {
            // What lies in a plane is not cut by it.
            let lies_in = |end: f64| (end - f64::from(plane)).abs() < ROUNDING * f64::from(PLANES);
            if !(lies_in(low) && lies_in(high)) {
                let least = &mut self.least[plane.rem_euclid(PLANES) as usize];
                *least = least.min(squared);
            }
        }
    }
}
