//! The least area of the boundaries around some vertices, all else fixed.
//!
//! It tells which of two topologies a place is to have, without a flow: a boundary is a fan of triangles round the mean of its
//! corners, so few points are left to move. A cell that changes its volume v by the way has it back from elsewhere, which costs
//! its pressure times v; without that small cells would collapse.

use glam::DVec3;
use voronoi::{CellId, FaceId};

use crate::energy::shape::Shape;
use crate::energy::sides::{boundary, cell_and_offset, freedom};
use crate::energy::triangle::Triangle;
use crate::{Boundary, CellComplex, Freedom};

/// Most steps of descent.
const STEPS: usize = 20;

/// Halvings of a step that does not lessen the area.
const HALVINGS: usize = 10;

/// Cotangents between which those of triangles count: all positive, so that each step goes down; the largest is that of 11 degrees.
const LEAST_COTANGENT: f64 = 0.05;
const LARGEST_COTANGENT: f64 = 5.0;

/// Most that a step is longer than the one before.
const LARGEST_GROWTH: f64 = 10.0;

/// How much the pressure of a cell of volume V rises where it loses v, in units of `v V^(-4/3)`. That of a ball alone rises by 1.1;
/// less than that would let small cells run away, and far more would hold up what the cells around give way to.
const STIFFNESS: f64 = 3.0;

/// A number that is small beside one.
const SMALL: f64 = 1e-9;

/// Share of the area by which a step has to lessen it for another one to follow. Two topologies differ by a hundred times as much;
/// most searches take some five steps.
const PROGRESS: f64 = 1e-5;

/// What the area around a place depends on, beside the complex.
#[derive(Clone, Copy)]
pub(crate) struct Conditions<'a> {
    pub(crate) shape: &'a Shape,
    /// Of each boundary, per area, in units of their mean.
    pub(crate) tension: &'a (dyn Fn(&Boundary) -> f64 + Sync),
    /// The volumes of all cells.
    pub(crate) volumes: &'a [f64],
    /// Their pressures: the area that each volume costs elsewhere.
    pub(crate) pressures: &'a [f64],
}

/// By how much the volume of each cell is above what it is to be.
pub(crate) type Excess = [f64];

/// Boundaries around vertices that move.
#[derive(Clone)]
pub(crate) struct LocalArea {
    freedoms: Vec<Freedom>,
    points: Vec<DVec3>,
    faces: Vec<Polygon>,
    cells: Vec<Cell>,
}

/// A cell around.
#[derive(Clone, Copy)]
struct Cell {
    id: CellId,
    /// The volume between its faces here and the origin, as it was.
    volume: f64,
    /// By how much the volume of all of it was above what it is to be.
    excess: f64,
    /// The volume of all of it.
    whole: f64,
    /// A change of volume by v costs `-pressure v + stiffness v^2 / 2`.
    pressure: f64,
    stiffness: f64,
}

#[derive(Clone)]
struct Polygon {
    corners: Vec<Place>,
    /// From the mean of the corners to the centre.
    bulge: DVec3,
    tension: f64,
    beside: Vec<Beside>,
}

/// A cell on one side of a face.
#[derive(Clone, Copy)]
struct Beside {
    /// Its place among the cells.
    cell: usize,
    /// How far the face is off where the cell has it.
    offset: DVec3,
    /// 1 where the cell sees the face's corners in their order, -1 where in reverse.
    sign: f64,
}

/// Where a corner is.
#[derive(Clone, Copy)]
enum Place {
    Fixed(DVec3),
    /// So far from a moving vertex.
    Moving(usize, DVec3),
}

impl LocalArea {
    /// All boundaries at some vertices of a complex whose cells have so much volume too much.
    pub(crate) fn new(
        complex: &CellComplex,
        vertices: &[u32],
        Conditions { shape, tension, volumes, pressures }: &Conditions<'_>,
        excess: &Excess,
    ) -> Self {
        let domain = complex.domain();
        let mut cells: Vec<Cell> = Vec::new();
        let mut number = |id: CellId| {
            cells.iter().position(|cell| cell.id == id).unwrap_or_else(|| {
                let whole = volumes[id.index()];
                let stiffness = STIFFNESS / whole.powf(4.0 / 3.0);
                let excess = excess[id.index()];
                cells.push(Cell {
                    id,
                    volume: 0.0,
                    excess,
                    whole,
                    pressure: pressures[id.index()],
                    stiffness,
                });
                cells.len() - 1
            })
        };
        let polygon = |face: FaceId| {
            let corners = complex.corners(face).iter().map(|corner| {
                match vertices.iter().position(|vertex| *vertex == corner.vertex) {
                    Some(moving) => Place::Moving(moving, corner.translation.vector(domain)),
                    None => Place::Fixed(complex.position(*corner)),
                }
            });
            let boundary = boundary(complex.sides(face));
            // All of a wall has the same area unless it folds, so that this does nothing but unfold it.
            let of_wall = if boundary.wall.is_some() { 1.0 } else { 0.0 };
            let tension = tension(&boundary) + of_wall;
            let sides = complex.sides(face).into_iter().zip([1.0, -1.0]);
            let beside = sides.filter_map(|(side, sign)| {
                let (cell, offset) = cell_and_offset(side, domain)?;
                Some(Beside { cell: number(cell), offset, sign })
            });
            Polygon {
                beside: beside.collect(),
                corners: corners.collect(),
                bulge: shape.bulge(face),
                tension,
            }
        };
        let faces = complex.faces_at(vertices).into_iter().map(polygon).collect();
        let mut area = Self {
            freedoms: vertices.iter().map(|vertex| freedom(complex, *vertex)).collect(),
            points: vertices.iter().map(|vertex| complex.vertices[*vertex as usize]).collect(),
            faces,
            cells,
        };
        let volumes = area.volumes(&area.rings());
        for (cell, volume) in area.cells.iter_mut().zip(volumes) {
            cell.volume = volume;
        }
        area
    }

    /// The area whose cells are to have the volumes that they have in another one, around the same place.
    pub(crate) fn with_volumes_of(mut self, other: &Self) -> Self {
        for cell in &mut self.cells {
            if let Some(same) = other.cells.iter().find(|same| same.id == cell.id) {
                cell.volume = same.volume;
            }
        }
        self
    }

    /// The corners of each face, and its centre after them, one face after the other.
    fn rings(&self) -> Vec<DVec3> {
        let mut rings = Vec::new();
        self.place_rings(&self.points, &mut rings);
        rings
    }

    /// As [`Self::rings`] for vertices at other points.
    fn place_rings(&self, points: &[DVec3], rings: &mut Vec<DVec3>) {
        rings.clear();
        for face in &self.faces {
            let start = rings.len();
            rings.extend(face.corners.iter().map(|corner| match *corner {
                Place::Fixed(point) => point,
                Place::Moving(moving, translation) => points[moving] + translation,
            }));
            let sum: DVec3 = rings[start..].iter().sum();
            rings.push(sum / face.corners.len() as f64 + face.bulge);
        }
    }

    /// The faces as fans.
    fn fans<'a>(&'a self, rings: &'a [DVec3]) -> impl Iterator<Item = (&'a Polygon, Fan<'a>)> {
        let mut rest = rings;
        self.faces.iter().map(move |face| {
            let (ring, others) = rest.split_at(face.corners.len());
            rest = &others[1..];
            (face, Fan { ring, center: others[0] })
        })
    }

    /// The volumes between the faces of each cell and the origin.
    fn volumes(&self, rings: &[DVec3]) -> Vec<f64> {
        let mut volumes = vec![0.0; self.cells.len()];
        for (face, fan) in self.fans(rings) {
            let VolumeGradient { volume, normal } = fan.volume_gradient();
            for Beside { cell, offset, sign } in &face.beside {
                volumes[*cell] += sign * (volume - offset.dot(normal)) / 6.0;
            }
        }
        volumes
    }

    /// The area where the vertices are now.
    pub(crate) fn area_now(&self) -> f64 {
        self.area(&self.rings()).0
    }

    /// Moves the vertices down to the least area near by, or to one that is no more than `enough`, and gives that: no more than
    /// [`Self::area_now`].
    ///
    /// Steps go along the gradient as the stiffness of the faces has it, so that they need not be small where triangles are.
    pub(crate) fn minimize(&mut self, enough: f64) -> f64 {
        // What cells resist may well make the whole negative: the faces alone tell how large the place is.
        let mut rings = self.rings();
        let faces: f64 = self.fans(&rings).map(|(_, fan)| fan.area()).sum();
        let stiffness = self.stiffness(&rings);
        let (mut area, mut slope) = self.area(&rings);
        let mut direction = self.solve(&stiffness, &slope);
        let mut step = 1.0;
        for _ in 0..STEPS {
            let mut lower = None;
            for _ in 0..HALVINGS {
                let moved: Vec<DVec3> =
                    self.points.iter().zip(&direction).map(|(point, by)| *point - *by * step).collect();
                self.place_rings(&moved, &mut rings);
                let (moved_area, moved_slope) = self.area(&rings);
                if moved_area < area {
                    lower = Some((moved, moved_area, moved_slope));
                    break;
                }
                step *= 0.5;
            }
            let Some((moved, moved_area, moved_slope)) = lower else { break };
            // The next step is as long as the change of the slope has it (Barzilai and Borwein 1988).
            let dot = |slope: &[DVec3]| slope.iter().zip(&direction).map(|(a, b)| a.dot(*b)).sum::<f64>();
            let square = dot(&slope);
            let bent = square - dot(&moved_slope);
            step *= if bent > SMALL * square { (square / bent).min(LARGEST_GROWTH) } else { 2.0 };
            let is_slow = area - moved_area < PROGRESS * faces;
            (self.points, area, slope) = (moved, moved_area, moved_slope);
            if is_slow || area <= enough {
                break;
            }
            direction = self.solve(&stiffness, &slope);
        }
        area
    }

    /// The stiffness of the faces between the vertices: that of the linear elements that the fans are, in each direction the same.
    fn stiffness(&self, rings: &[DVec3]) -> Vec<f64> {
        let count = self.points.len();
        let mut stiffness = vec![0.0; count * count];
        let mut add = |i: usize, j: usize, value: f64| stiffness[i * count + j] += value;
        let (mut rims, mut to_center) = (Vec::new(), Vec::new());
        for (face, Fan { ring, center }) in self.fans(rings) {
            let corners = ring.len();
            let cotangent_weight = |apex: DVec3, from: DVec3, to: DVec3| {
                let (a, b) = (from - apex, to - apex);
                let cotangent = a.dot(b) / a.cross(b).length().max(f64::MIN_POSITIVE);
                0.5 * face.tension * cotangent.clamp(LEAST_COTANGENT, LARGEST_COTANGENT)
            };
            rims.clear();
            to_center.clear();
            to_center.resize(corners, 0.0);
            for k in 0..corners {
                let next = (k + 1) % corners;
                rims.push(cotangent_weight(center, ring[k], ring[next]));
                to_center[k] += cotangent_weight(ring[next], center, ring[k]);
                to_center[next] += cotangent_weight(ring[k], ring[next], center);
            }
            // The centre follows all corners alike.
            let follows = 1.0 / corners as f64;
            let moving = || {
                face.corners.iter().enumerate().filter_map(|(k, corner)| match corner {
                    Place::Moving(moving, _) => Some((k, *moving)),
                    Place::Fixed(_) => None,
                })
            };
            let all: f64 = to_center.iter().sum();
            for (k, i) in moving() {
                let next = (k + 1) % corners;
                let previous = (k + corners - 1) % corners;
                add(i, i, to_center[k] + rims[k] + rims[previous]);
                if let Place::Moving(j, _) = face.corners[next] {
                    add(i, j, -rims[k]);
                    add(j, i, -rims[k]);
                }
                for (_, j) in moving() {
                    add(i, j, (all * follows - to_center[k]) * follows);
                    add(j, i, -to_center[k] * follows);
                }
            }
        }
        stiffness
    }

    /// The displacement under some forces, within what the walls leave.
    fn solve(&self, stiffness: &[f64], forces: &[DVec3]) -> Vec<DVec3> {
        let count = forces.len();
        let mut matrix = stiffness.to_vec();
        let mut result = forces.to_vec();
        for pivot in 0..count {
            let diagonal = matrix[pivot * count + pivot];
            for row in pivot + 1..count {
                let factor = matrix[row * count + pivot] / diagonal;
                for column in pivot..count {
                    matrix[row * count + column] -= factor * matrix[pivot * count + column];
                }
                let by = result[pivot] * factor;
                result[row] -= by;
            }
        }
        for row in (0..count).rev() {
            for column in row + 1..count {
                let by = result[column] * matrix[row * count + column];
                result[row] -= by;
            }
            result[row] /= matrix[row * count + row];
        }
        result.iter_mut().zip(&self.freedoms).for_each(|(by, freedom)| *by = freedom.project(*by));
        result
    }

    /// By how much the volume of each cell is above what it is to be, and that as a share of it.
    pub(crate) fn excesses(&self) -> impl Iterator<Item = (CellId, f64, f64)> {
        let cells = self.cells.iter().zip(self.volumes(&self.rings()));
        cells.map(|(cell, volume)| {
            let excess = cell.excess + volume - cell.volume;
            (cell.id, excess, excess / cell.whole)
        })
    }

    /// Whether no cell's volume is off by more than a share of it, or at least by no more than it was in another area of the same cells.
    pub(crate) fn keeps_volumes(&self, share: f64, before: &[(CellId, f64, f64)]) -> bool {
        self.excesses().all(|(cell, _, off)| {
            let was = before.iter().find(|(id, ..)| *id == cell).map_or(0.0, |(_, _, was)| was.abs());
            off.abs() <= was.max(share)
        })
    }

    /// The length of the shortest edge that ends at one of the vertices: others stay as they are.
    pub(crate) fn shortest_edge(&self) -> f64 {
        let is_moving = |corner: &Place| matches!(corner, Place::Moving(..));
        let rings = self.rings();
        let shortest = self.fans(&rings).map(|(face, Fan { ring, .. })| {
            let count = ring.len();
            let edges = (0..count).map(|k| [k, (k + 1) % count]);
            let moving = edges.filter(|ends| ends.iter().any(|end| is_moving(&face.corners[*end])));
            moving.map(|[a, b]| ring[a].distance(ring[b])).fold(f64::INFINITY, f64::min)
        });
        shortest.fold(f64::INFINITY, f64::min)
    }

    /// Number of folds: where neighbouring triangles of a fan are more than 90 degrees apart, or the angle at a corner is above 180
    /// degrees, which subdivision folds.
    pub(crate) fn fold_count(&self) -> usize {
        let rings = self.rings();
        let of_face = |Fan { ring, center }: Fan<'_>| {
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
        self.fans(&rings).map(|(_, fan)| of_face(fan)).sum()
    }

    /// Where the vertices are.
    pub(crate) fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// The area weighted by tension together with what cells resist, and how it changes with the points.
    fn area(&self, rings: &[DVec3]) -> (f64, Vec<DVec3>) {
        let mut area = 0.0;
        let mut pulls = Vec::with_capacity(self.cells.len());
        for (cell, volume) in self.cells.iter().zip(self.volumes(rings)) {
            let excess = volume - cell.volume;
            area += (0.5 * cell.stiffness * excess - cell.pressure) * excess;
            pulls.push(cell.stiffness * excess - cell.pressure);
        }
        let mut slope = vec![DVec3::ZERO; self.points.len()];
        for (face, fan) in self.fans(rings) {
            // All cells beside a face together pull on its cone from the origin, and on its area.
            let (mut pull, mut pull_of_offset) = (0.0, DVec3::ZERO);
            for Beside { cell, offset, sign } in &face.beside {
                pull += sign * pulls[*cell] / 6.0;
                pull_of_offset += *offset * (sign * pulls[*cell] / 6.0);
            }
            let count = fan.ring.len();
            let center = fan.center;
            let mut of_center = DVec3::ZERO;
            for k in 0..count {
                let next = (k + 1) % count;
                let [a, b] = [k, next].map(|corner| fan.ring[corner]);
                let triangle = Triangle::new([center, a, b]);
                let Triangle { normal, doubled_area, .. } = triangle;
                area += 0.5 * face.tension * doubled_area;
                let half_pull = normal * (0.5 * face.tension / doubled_area.max(f64::MIN_POSITIVE));
                // A cone from an origin that is off changes as an area does.
                let [at_center, at_a, at_b] = triangle.gradients(half_pull - pull_of_offset);
                of_center += at_center + a.cross(b) * pull;
                if let Place::Moving(moving, _) = face.corners[k] {
                    slope[moving] += at_a + b.cross(center) * pull;
                }
                if let Place::Moving(moving, _) = face.corners[next] {
                    slope[moving] += at_b + center.cross(a) * pull;
                }
            }
            for corner in &face.corners {
                if let Place::Moving(moving, _) = corner {
                    slope[*moving] += of_center / count as f64;
                }
            }
        }
        slope.iter_mut().zip(&self.freedoms).for_each(|(slope, freedom)| *slope = freedom.project(*slope));
        (area, slope)
    }
}

/// A polygon where its points are: triangles from its centre to each two corners in a row.
struct Fan<'a> {
    ring: &'a [DVec3],
    center: DVec3,
}

/// Of a fan six times the volume of the cone from the origin, and its normal, twice as long as its area.
///
/// From an origin that is off by o, the cone has `o normal` less.
struct VolumeGradient {
    volume: f64,
    normal: DVec3,
}

impl Fan<'_> {
    fn area(&self) -> f64 {
        let ends = self.ring.iter().zip(self.ring.iter().cycle().skip(1));
        ends.map(|(a, b)| 0.5 * (*a - self.center).cross(*b - self.center).length()).sum()
    }

    fn volume_gradient(&self) -> VolumeGradient {
        let ends = self.ring.iter().zip(self.ring.iter().cycle().skip(1));
        let normal: DVec3 = ends.map(|(a, b)| (*a - self.center).cross(*b - self.center)).sum();
        // All triangles end at the centre.
        VolumeGradient { volume: self.center.dot(normal), normal }
    }
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
        let volumes: Vec<f64> = cells.cell_measures().iter().map(|cell| cell.volume).collect();
        let pressures = vec![0.0; volumes.len()];
        let shape = Shape::default();
        let conditions =
            Conditions { shape: &shape, tension: &|_| 1.0, volumes: &volumes, pressures: &pressures };
        let edges = complex.edges();
        for vertex in 0..u32::try_from(complex.vertices.len()).expect("few vertices") {
            let area = LocalArea::new(&complex, &[vertex], &conditions, &vec![0.0; volumes.len()]);
            let own = edges.iter().filter(|edge| edge.start == vertex || edge.end.vertex == vertex);
            let lengths =
                own.map(|edge| complex.vertices[edge.start as usize].distance(complex.position(edge.end)));
            assert_eq!(area.shortest_edge(), lengths.fold(f64::INFINITY, f64::min));
        }
    }

    /// Four cells of a periodic cube, most of which are their own neighbours; some vertices are a little off.
    fn check_moved(mut check: impl FnMut(&LocalArea, &[DVec3])) {
        let seeds = [(0.2, 0.3, 0.1), (0.7, 0.2, 0.4), (0.4, 0.8, 0.3), (0.9, 0.9, 0.8)]
            .map(|(x, y, z)| DVec3::new(x, y, z));
        let domain = Domain::unit_cube().with_periods(glam::BVec3::TRUE);
        let cells = Tessellation::new(&domain, &seeds).expect("valid seeds");
        let complex = CellComplex::from(&cells);
        let volumes: Vec<f64> = cells.cell_measures().iter().map(|cell| cell.volume).collect();
        let shape = Shape::default();
        let pressures = [0.5, -1.0, 2.0, 0.7];
        let conditions =
            Conditions { shape: &shape, tension: &|_| 1.0, volumes: &volumes, pressures: &pressures };
        for edge in complex.edges() {
            let area = LocalArea::new(&complex, &[edge.start, edge.end.vertex], &conditions, &[0.0; 4]);
            let moved: Vec<DVec3> =
                area.points.iter().map(|point| *point + 0.02 * DVec3::new(point.z, -0.6, point.x)).collect();
            check(&area, &moved);
        }
    }

    /// Its energy is negative there: the search would end where it began.
    #[test]
    fn the_search_goes_down_where_cells_lack_volume_under_high_pressure() {
        let mut searched = 0;
        check_moved(|area, _| {
            let mut pressed = area.clone();
            for cell in &mut pressed.cells {
                cell.pressure *= 1e3;
                cell.volume -= 0.02 * cell.pressure.signum();
            }
            let (before, _) = pressed.area(&pressed.rings());
            let after = pressed.minimize(f64::NEG_INFINITY);
            assert!(after.is_finite() && after < before - 1e-3, "{before} {after}");
            searched += usize::from(before < 0.0);
        });
        assert!(searched > 10, "{searched}");
    }

    #[test]
    fn what_one_cell_loses_others_gain() {
        check_moved(|area, moved| {
            let mut rings = Vec::new();
            area.place_rings(moved, &mut rings);
            let volumes = area.volumes(&rings);
            let gains = || area.cells.iter().zip(&volumes).map(|(cell, volume)| volume - cell.volume);
            assert!(gains().sum::<f64>().abs() < 1e-15);
            assert!(gains().map(f64::abs).fold(0.0, f64::max) > 1e-4);
        });
    }

    /// The energy of stiffness with the same constants, point by point.
    #[test]
    fn the_stiffness_is_that_of_springs_along_the_edges_of_fans() {
        check_moved(|area, _| {
            let rings = area.rings();
            let stiffness = area.stiffness(&rings);
            let count = area.points.len();
            let moves: Vec<f64> = (0..count).map(|i| 0.3 + 0.7 * i as f64).collect();
            let of_matrix: f64 = (0..count * count)
                .map(|entry| stiffness[entry] * moves[entry / count] * moves[entry % count])
                .sum();
            let mut of_springs = 0.0;
            for (face, Fan { ring, center }) in area.fans(&rings) {
                let by = |corner: usize| match face.corners[corner] {
                    Place::Moving(moving, _) => moves[moving],
                    Place::Fixed(_) => 0.0,
                };
                let of_center = (0..ring.len()).map(by).sum::<f64>() / ring.len() as f64;
                for k in 0..ring.len() {
                    let next = (k + 1) % ring.len();
                    let triangle = [(ring[k], by(k)), (ring[next], by(next)), (center, of_center)];
                    for opposite in 0..3 {
                        let [apex, from, to] = [0, 1, 2].map(|turn| triangle[(opposite + turn) % 3]);
                        let (a, b) = (from.0 - apex.0, to.0 - apex.0);
                        let cotangent =
                            (a.dot(b) / a.cross(b).length()).clamp(LEAST_COTANGENT, LARGEST_COTANGENT);
                        of_springs += 0.5 * face.tension * cotangent * (from.1 - to.1).powi(2);
                    }
                }
            }
            assert!((of_matrix - of_springs).abs() < 1e-12 * of_springs, "{of_matrix} {of_springs}");
        });
    }

    #[test]
    fn slopes_are_those_of_the_area() {
        const STEP: f64 = 1e-6;
        check_moved(|area, moved| {
            let area_at = |points: &[DVec3]| {
                let mut rings = Vec::new();
                area.place_rings(points, &mut rings);
                area.area(&rings)
            };
            let (_, slope) = area_at(moved);
            for (point, axis) in (0..moved.len()).flat_map(|point| DVec3::AXES.map(|axis| (point, axis))) {
                let at = |step: f64| {
                    let mut moved = moved.to_vec();
                    moved[point] += axis * step;
                    area_at(&moved).0
                };
                let difference = (at(STEP) - at(-STEP)) / (2.0 * STEP);
                assert!(
                    (slope[point].dot(axis) - difference).abs() < 1e-6,
                    "{} {difference}",
                    slope[point].dot(axis)
                );
            }
        });
    }
}
