//! Half-spaces and what they have in common.

use std::ops::Range;

use glam::DVec3;

use crate::big::unit_normal;
use crate::box_tree::{BoxSearch, BoxTree, Boxes, sort_into_boxes};
use crate::convex_cell::ConvexCell;
use crate::domain::MOST_WALLS;
use crate::generator::{Generator, Plane};
use crate::half_space::{EVALUATION_ERROR, HalfSpace};
use crate::images::ImageTable;
use crate::polygon::ConvexPolygon;
use crate::predicate::ExactInput;
use crate::search::Cutting;
use crate::wide::LANES;
use crate::{Dimension, Domain, VoronoiError, Wall, WallPlane};

/// How much farther than its walls a polyhedron may reach from the origin: beyond, it counts as unbounded.
const FARTHEST: f64 = (1u64 << 30) as f64;

/// A bounded polyhedron, or polygon in the plane.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Polyhedron {
    pub(crate) walls: Vec<WallPlane>,
    /// Their outward normals, of length 1 up to rounding.
    pub(crate) normals: Vec<DVec3>,
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
    /// A polyhedron whose volume is yet to be measured, given walls and their normals, and the largest coordinates of its box.
    pub(crate) fn new(
        walls: Vec<WallPlane>,
        normals: Vec<DVec3>,
        corner: DVec3,
        name: Option<String>,
    ) -> Self {
        let from_origin =
            |(plane, normal): (_, &_)| HalfSpace::of_plane(DVec3::ZERO, Generator::NONE, plane, *normal);
        let (mut distances, mut largest) = (Vec::with_capacity(walls.len()), 0.0f64);
        for HalfSpace { offset, offset_size, .. } in walls.iter().zip(&normals).map(from_origin) {
            distances.push(offset);
            largest = largest.max(offset_size);
        }
        let mut order: Vec<u32> = (0u32..).take(walls.len()).collect();
        sort_into_boxes(&mut order, 0, &|wall| normals[wall as usize]);
        let order: Vec<Wall> = order.into_iter().map(Wall).collect();
        let boxes = BoxTree::new(order.len(), |place| {
            let wall = order[place].index();
            (normals[wall], -distances[wall])
        });
        let distance_error = 2.0 * EVALUATION_ERROR * (largest + corner.element_sum());
        let (measure, center) = (f64::NAN, DVec3::NAN);
        Self { walls, normals, boxes, order, distances, distance_error, measure, center, name }
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
        let Polyhedron { order, distances, normals, .. } = self.polyhedron;
        for wall in &order[places] {
            let is_far = distances[wall.index()] - normals[wall.index()].dot(self.point) > self.limit;
            if !is_far {
                (self.visit)(*wall);
            }
        }
        true
    }
}

/// Where a polyhedron is.
pub(crate) struct Extent {
    pub(crate) lower: DVec3,
    pub(crate) upper: DVec3,
    /// Mean of its vertices.
    pub(crate) center: DVec3,
}

impl Extent {
    /// Cuts what the walls leave out of a box much larger than they are.
    pub(crate) fn of(walls: &[WallPlane], dimension: Dimension) -> Result<Self, VoronoiError> {
        if walls.len() > usize::from(MOST_WALLS) {
            return Err(VoronoiError::TooManyWalls { most: MOST_WALLS });
        }
        if let Some(wall) = walls.iter().position(|wall| !is_plane(wall, dimension)) {
            return Err(VoronoiError::BadHalfSpace { wall });
        }
        let distances: Vec<f64> = walls.iter().map(distance_from_origin).collect();
        let is_far = |distance: &f64| distance.is_nan() || distance > Domain::LENGTHS.end();
        if let Some(wall) = distances.iter().position(is_far) {
            return Err(VoronoiError::FarHalfSpace { wall, distance: distances[wall] });
        }
        let farthest = distances.into_iter().fold(0.0, f64::max);
        let in_plane = if dimension == Dimension::Two { DVec3::new(1.0, 1.0, 0.0) } else { DVec3::ONE };
        let corner = in_plane * FARTHEST * if farthest > 0.0 { farthest } else { 1.0 };
        let domain = Domain::cut_out_of_box(-corner, corner, dimension, walls.to_vec(), None);
        let (seeds, images) = ([DVec3::ZERO], ImageTable::default());
        let input = ExactInput { domain: &domain, seeds: &seeds, weights: None, images: &images };
        match dimension {
            Dimension::Three => Self::cut(ConvexCell::new(0, input), input),
            Dimension::Two => Self::cut(ConvexPolygon::new(0, input), input),
        }
    }

    fn cut(mut cell: impl Cutting, input: ExactInput) -> Result<Self, VoronoiError> {
        for wall in input.domain.walls() {
            cell.cut(Generator::facet(wall), input);
            if cell.radius() < 0.0 {
                return Err(VoronoiError::EmptyDomain { wall: wall.index() });
            }
        }
        // To the last place, so that boxes of round numbers have round numbers.
        let exact = |planes| (planes, input.vertex(0, planes));
        let corners: Vec<([Generator; 3], DVec3)> = cell.vertices().into_iter().map(exact).collect();
        let is_side = |generator: &Generator| matches!(generator.plane(), Plane::Side(side) if !is_drawing_plane(side, input));
        if let Some((_, corner)) = corners.iter().find(|(generators, _)| generators.iter().any(is_side)) {
            return Err(VoronoiError::UnboundedDomain { direction: corner.normalize_or_zero() });
        }
        let positions = || corners.iter().map(|(_, position)| *position);
        Ok(Self {
            lower: positions().fold(DVec3::INFINITY, DVec3::min),
            upper: positions().fold(DVec3::NEG_INFINITY, DVec3::max),
            center: positions().sum::<DVec3>() / corners.len() as f64,
        })
    }
}

/// In the plane, z = 0 is a side through every corner.
fn is_drawing_plane(side: Wall, input: ExactInput) -> bool {
    input.domain.dimension() == Dimension::Two && side.axis() == 2
}

fn is_plane(wall: &WallPlane, dimension: Dimension) -> bool {
    let numbers = match wall {
        WallPlane::HalfSpace { normal, offset } => normal.is_finite() && offset.is_finite(),
        WallPlane::Through(points) => points.iter().all(|point| point.is_finite()),
    };
    if !numbers {
        return false;
    }
    let normal = unit_normal(wall);
    normal != DVec3::ZERO && normal.is_finite() && (dimension == Dimension::Three || normal.z == 0.0)
}

fn distance_from_origin(wall: &WallPlane) -> f64 {
    match wall {
        WallPlane::HalfSpace { normal, offset } => {
            // Scaled first, for squares of very large or small coordinates leave the range of doubles.
            let scale = normal.abs().max_element();
            offset.abs() / scale / (*normal / scale).length()
        }
        WallPlane::Through(points) => points.iter().map(|point| point.length()).fold(0.0, f64::max),
    }
}
