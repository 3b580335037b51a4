//! Half-spaces in common, and which of them are near.

use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;

use crate::Wall;
use crate::box_tree::{BoxSearch, BoxTree, Boxes, sort_into_boxes};
use crate::exact::frame::Facets;
use crate::exact::generator::Generator;
use crate::exact::half_space::{EVALUATION_ERROR, HalfSpace};
use crate::lanes::LANES;

/// A bounded polyhedron, or polygon in the plane.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Polyhedron {
    pub(crate) facets: Arc<Facets>,
    /// The walls in boxes of their normals, with how far in along these the walls are as weights.
    boxes: BoxTree,
    /// The walls in the order of the boxes.
    order: Vec<Wall>,
    /// How far out along their normals the walls are.
    distances: Vec<f64>,
    /// Bound on the rounding of these distances, and of those between a wall and a point of the polyhedron made of them.
    distance_error: f64,
    /// Volume; in the plane, area.
    pub(crate) measure: f64,
    /// A point inside.
    pub(crate) center: DVec3,
    /// What to call it in messages, if not after its walls.
    pub(crate) name: Option<String>,
}

impl Polyhedron {
    /// A polyhedron whose volume is yet to be measured, given the walls, and the largest coordinates of its box.
    pub(crate) fn new(facets: Arc<Facets>, corner: DVec3, name: Option<String>) -> Self {
        let Facets { planes, normals } = &*facets;
        let from_origin =
            |(plane, normal): (_, &_)| HalfSpace::of_plane(DVec3::ZERO, Generator::NONE, plane, *normal);
        let (mut distances, mut largest) = (Vec::with_capacity(planes.len()), 0.0f64);
        for HalfSpace { offset, offset_size, .. } in planes.iter().zip(normals).map(from_origin) {
            distances.push(offset);
            largest = largest.max(offset_size);
        }
        let mut order: Vec<u32> = (0u32..).take(planes.len()).collect();
        sort_into_boxes(&mut order, 0, &|wall| normals[wall as usize]);
        let order: Vec<Wall> = order.into_iter().map(Wall).collect();
        let boxes = BoxTree::new(order.len(), |place| {
            let wall = order[place].index();
            (normals[wall], -distances[wall])
        });
        let distance_error = 2.0 * EVALUATION_ERROR * (largest + corner.element_sum());
        let (measure, center) = (f64::NAN, DVec3::NAN);
        Self { facets, boxes, order, distances, distance_error, measure, center, name }
    }

    /// Visits the walls that may be up to a distance from a point, or have it beyond them, and some more.
    pub(crate) fn for_each_wall_within(&self, point: DVec3, distance: f64, mut visit: impl FnMut(Wall)) {
        // That of the polyhedron is for points in it.
        let limit = distance + self.distance_error + 4.0 * EVALUATION_ERROR * point.abs().element_sum();
        self.boxes.search(&mut WallSearch { polyhedron: self, point, limit, visit: &mut visit });
    }
}

/// A search for the walls that are not farther than a limit inward from a point.
struct WallSearch<'a, Visit> {
    polyhedron: &'a Polyhedron,
    point: DVec3,
    limit: f64,
    visit: &'a mut Visit,
}

impl<Visit: FnMut(Wall)> BoxSearch for WallSearch<'_, Visit> {
    fn wanted(&self, boxes: &Boxes) -> u32 {
        let mut wanted = 0;
        for lane in 0..LANES {
            let mut out = boxes.weights[lane];
            for axis in 0..3 {
                let at = self.point[axis];
                out += at * if at > 0.0 { boxes.upper[axis][lane] } else { boxes.lower[axis][lane] };
            }
            let is_far = -out > self.limit;
            wanted |= u32::from(!is_far) << lane;
        }
        wanted
    }

    fn visit(&mut self, places: Range<usize>) -> bool {
        let Polyhedron { order, distances, facets, .. } = self.polyhedron;
        for wall in &order[places] {
            let is_far = distances[wall.index()] - facets.normals[wall.index()].dot(self.point) > self.limit;
            if !is_far {
                (self.visit)(*wall);
            }
        }
        true
    }
}
