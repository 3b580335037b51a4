//! The least area of the boundaries around some vertices, all else fixed.
//!
//! It tells which of two topologies a place is to have, without a flow: a boundary is a fan of triangles round the mean of its
//! corners, so few points are left to move.

use glam::DVec3;
use voronoi::{CellComplex, FaceId, Side};

use super::shape::Shape;
use crate::{Boundary, Freedom, GrainId};

/// Steps of descent.
const STEPS: usize = 40;

/// Halvings of a step that does not lessen the area.
const HALVINGS: usize = 10;

/// Length of the first step, in units of the size of what is looked at.
const FIRST_STEP: f64 = 0.01;

/// Most that a step is longer than the one before.
const LARGEST_GROWTH: f64 = 10.0;

/// A number that is small beside one.
const SMALL: f64 = 1e-9;

/// Boundaries around vertices that move.
pub(super) struct LocalArea {
    vertices: Vec<u32>,
    freedoms: Vec<Freedom>,
    points: Vec<DVec3>,
    faces: Vec<Polygon>,
}

struct Polygon {
    corners: Vec<Place>,
    /// From the mean of the corners to the centre.
    bulge: DVec3,
    tension: f64,
}

/// Where a corner is.
#[derive(Clone, Copy)]
enum Place {
    Fixed(DVec3),
    /// So far from a moving vertex.
    Moving(usize, DVec3),
}

impl LocalArea {
    /// All boundaries at some vertices of a complex.
    pub(super) fn new(
        complex: &CellComplex,
        vertices: &[u32],
        shape: &Shape,
        tension: &dyn Fn(&Boundary) -> f64,
    ) -> Self {
        let domain = complex.domain();
        let freedom = |vertex: &u32| {
            let normals = complex.walls_at(*vertex).into_iter().map(|wall| domain.outward_normal(wall));
            normals.map(Freedom::InPlane).fold(Freedom::Everywhere, Freedom::and)
        };
        let polygon = |face: FaceId| {
            let corners = complex.corners(face).iter().map(|corner| {
                match vertices.iter().position(|vertex| *vertex == corner.vertex) {
                    Some(moving) => Place::Moving(moving, corner.shift.vector(domain)),
                    None => Place::Fixed(complex.position(*corner)),
                }
            });
            let boundary = boundary(complex.sides(face));
            // All of a wall has the same area unless it folds, so that this does nothing but unfold it.
            let of_wall = if boundary.wall.is_some() { 1.0 } else { 0.0 };
            let tension = tension(&boundary) + of_wall;
            Polygon { corners: corners.collect(), bulge: shape.bulge(face), tension }
        };
        Self {
            freedoms: vertices.iter().map(freedom).collect(),
            points: vertices.iter().map(|vertex| complex.vertices[*vertex as usize]).collect(),
            faces: complex.faces_at(vertices).into_iter().map(polygon).collect(),
            vertices: vertices.to_vec(),
        }
    }

    /// Moves the vertices down to the least area near by, and gives that.
    pub(super) fn minimize(&mut self) -> f64 {
        let (mut area, mut slope) = self.area(&self.points);
        let steepest = slope.iter().map(|slope| slope.length()).fold(0.0, f64::max);
        let mut step = FIRST_STEP * area.sqrt() / steepest.max(SMALL * area.sqrt());
        for _ in 0..STEPS {
            let mut lower = None;
            for _ in 0..HALVINGS {
                let moved: Vec<DVec3> =
                    self.points.iter().zip(&slope).map(|(point, slope)| *point - *slope * step).collect();
                let (moved_area, moved_slope) = self.area(&moved);
                if moved_area < area {
                    lower = Some((moved, moved_area, moved_slope));
                    break;
                }
                step *= 0.5;
            }
            let Some((moved, moved_area, moved_slope)) = lower else { break };
            // The next step is as long as the change of the slope has it (Barzilai and Borwein 1988).
            let square: f64 = slope.iter().map(|slope| slope.length_squared()).sum();
            let bent: f64 = slope.iter().zip(&moved_slope).map(|(old, new)| old.dot(*old - *new)).sum();
            step *= if bent > SMALL * square { (square / bent).min(LARGEST_GROWTH) } else { 2.0 };
            (self.points, area, slope) = (moved, moved_area, moved_slope);
        }
        area
    }

    /// The length of the shortest edge that ends at one of the vertices: others stay as they are.
    pub(super) fn shortest_edge(&self) -> f64 {
        let is_moving = |corner: &Place| matches!(corner, Place::Moving(..));
        let shortest = self.faces.iter().map(|face| {
            let ring = face.ring(&self.points);
            let count = ring.len();
            let edges = (0..count).map(|k| [k, (k + 1) % count]);
            let moving = edges.filter(|ends| ends.iter().any(|end| is_moving(&face.corners[*end])));
            moving.map(|[a, b]| ring[a].distance(ring[b])).fold(f64::INFINITY, f64::min)
        });
        shortest.fold(f64::INFINITY, f64::min)
    }

    /// Number of folds: where neighbouring triangles of a fan are more than 90 degrees apart, or the angle at a corner is above 180
    /// degrees, which subdivision folds.
    pub(super) fn fold_count(&self) -> usize {
        let of_face = |face: &Polygon| {
            let ring = face.ring(&self.points);
            let center = face.center(&ring);
            let count = ring.len();
            let normals: Vec<DVec3> =
                (0..count).map(|k| (ring[k] - center).cross(ring[(k + 1) % count] - center)).collect();
            let whole: DVec3 = normals.iter().sum();
            let is_folded = |k: &usize| {
                let [a, b, c] = [*k, k + 1, k + 2].map(|k| ring[k % count]);
                normals[*k].dot(normals[(k + 1) % count]) <= 0.0 || (b - a).cross(c - b).dot(whole) <= 0.0
            };
            (0..count).filter(is_folded).count()
        };
        self.faces.iter().map(of_face).sum()
    }

    /// Puts the vertices of the complex where the points are.
    pub(super) fn place(&self, complex: &mut CellComplex) {
        for (vertex, point) in self.vertices.iter().zip(&self.points) {
            complex.vertices[*vertex as usize] = *point;
        }
    }

    /// The area weighted by tension, and how it changes with the points.
    fn area(&self, points: &[DVec3]) -> (f64, Vec<DVec3>) {
        let mut area = 0.0;
        let mut slope = vec![DVec3::ZERO; points.len()];
        for face in &self.faces {
            let ring = face.ring(points);
            let center = face.center(&ring);
            let mut of_center = DVec3::ZERO;
            for (k, a) in ring.iter().enumerate() {
                let next = (k + 1) % ring.len();
                let b = ring[next];
                let normal = (*a - center).cross(b - center);
                let length = normal.length();
                area += 0.5 * face.tension * length;
                let unit = normal * (0.5 * face.tension / length.max(f64::MIN_POSITIVE));
                of_center += unit.cross(b - *a);
                for (corner, across) in [(k, center - b), (next, *a - center)] {
                    if let Place::Moving(moving, _) = face.corners[corner] {
                        slope[moving] += unit.cross(across);
                    }
                }
            }
            for corner in &face.corners {
                if let Place::Moving(moving, _) = corner {
                    slope[*moving] += of_center / ring.len() as f64;
                }
            }
        }
        slope.iter_mut().zip(&self.freedoms).for_each(|(slope, freedom)| *slope = freedom.project(*slope));
        (area, slope)
    }
}

impl Polygon {
    fn ring(&self, points: &[DVec3]) -> Vec<DVec3> {
        let at = |corner: &Place| match *corner {
            Place::Fixed(point) => point,
            Place::Moving(moving, shift) => points[moving] + shift,
        };
        self.corners.iter().map(at).collect()
    }

    fn center(&self, ring: &[DVec3]) -> DVec3 {
        ring.iter().sum::<DVec3>() / ring.len() as f64 + self.bulge
    }
}

fn boundary(sides: [Side; 2]) -> Boundary {
    let side = |side| match side {
        Side::Cell(cell) | Side::Image(cell, _) => crate::Side::Grain(GrainId(cell.0)),
        Side::Wall(_) => crate::Side::Exterior,
    };
    let wall = match sides[1] {
        Side::Wall(wall) => Some(wall),
        Side::Cell(_) | Side::Image(..) => None,
    };
    Boundary { sides: sides.map(side), wall, twin: None }
}

#[cfg(test)]
mod tests {
    use voronoi::{Domain, Tessellation};

    use super::*;

    /// Lines that are too short elsewhere are no reason against an event here.
    #[test]
    fn only_edges_of_vertices_that_move_count_as_short() {
        let seeds = [
            (0.2, 0.3, 0.1),
            (0.7, 0.2, 0.4),
            (0.4, 0.8, 0.3),
            (0.9, 0.9, 0.8),
            (0.1, 0.6, 0.9),
            (0.5, 0.5, 0.6),
        ]
        .map(|(x, y, z)| DVec3::new(x, y, z));
        let cells = Tessellation::new(&Domain::unit_cube(), &seeds).expect("valid seeds");
        let complex = CellComplex::from(&cells);
        let edges = complex.edges();
        for vertex in 0..u32::try_from(complex.vertices.len()).expect("few vertices") {
            let area = LocalArea::new(&complex, &[vertex], &Shape::default(), &|_| 1.0);
            let own = edges.iter().filter(|edge| edge.start == vertex || edge.end.vertex == vertex);
            let lengths =
                own.map(|edge| complex.vertices[edge.start as usize].distance(complex.position(edge.end)));
            assert_eq!(area.shortest_edge(), lengths.fold(f64::INFINITY, f64::min));
        }
    }
}
