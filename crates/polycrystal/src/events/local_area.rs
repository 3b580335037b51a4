//! The least area of the boundaries around some vertices, all else fixed.
//!
//! It tells which of two topologies a place is to have, without a flow: a boundary is a fan of triangles round the mean of its
//! corners, so few points are left to move. A cell that changes its volume v by the way has it back from elsewhere, which costs
//! its pressure times v; without that small cells would collapse.

mod descent;
mod fan;

use glam::DVec3;
use smallvec::SmallVec;
use voronoi::{CellId, FaceId};

use crate::energy::shape::Shape;
use crate::energy::sides::{cell_and_offset, freedom, tension_between};
use crate::{Boundary, CellComplex, Freedom};
use fan::Fan;

/// How much the pressure of a cell of volume V rises where it loses v, in units of `v V^(-4/3)`. That of a ball alone rises by 1.1;
/// less than that would let small cells run away, and far more would hold up what the cells around give way to.
const STIFFNESS: f64 = 3.0;

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

/// What there is for each vertex that moves, in place for an edge, a triangle or a boundary with four sides.
type OfVertices<T> = SmallVec<[T; 4]>;

/// What there is for each cell around, in place for the five at an edge and some more.
type OfCells<T> = SmallVec<[T; 8]>;

/// What there is for each corner and each centre, in place for the nine faces at an edge and some more.
type OfCorners<T> = SmallVec<[T; 64]>;

/// Boundaries around vertices that move.
#[derive(Clone)]
pub(crate) struct LocalArea {
    freedoms: OfVertices<Freedom>,
    points: OfVertices<DVec3>,
    faces: Vec<Polygon>,
    cells: OfCells<Cell>,
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
    corners: SmallVec<[Place; 8]>,
    /// From the mean of the corners to the centre.
    bulge: DVec3,
    tension: f64,
    beside: SmallVec<[Beside; 2]>,
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
        let mut cells = OfCells::<Cell>::new();
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
            let sides = complex.sides(face);
            let beside = sides.into_iter().zip([1.0, -1.0]);
            let beside = beside.filter_map(|(side, sign)| {
                let (cell, offset) = cell_and_offset(side, domain)?;
                Some(Beside { cell: number(cell), offset, sign })
            });
            Polygon {
                beside: beside.collect(),
                corners: corners.collect(),
                bulge: shape.bulge(face),
                tension: tension_between(sides, tension),
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
    fn rings(&self) -> OfCorners<DVec3> {
        let mut rings = SmallVec::new();
        self.place_rings(&self.points, &mut rings);
        rings
    }

    /// As [`Self::rings`] for vertices at other points.
    fn place_rings(&self, points: &[DVec3], rings: &mut OfCorners<DVec3>) {
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
    fn volumes(&self, rings: &[DVec3]) -> OfCells<f64> {
        self.volumes_and_normals(rings, |_| ())
    }

    /// The same, and shows the normals of all triangles, twice as long as their areas, one face after the other.
    fn volumes_and_normals(&self, rings: &[DVec3], mut show: impl FnMut(DVec3)) -> OfCells<f64> {
        let mut volumes: OfCells<f64> = SmallVec::from_elem(0.0, self.cells.len());
        for (face, fan) in self.fans(rings) {
            let mut sum = DVec3::ZERO;
            for normal in fan.normals() {
                sum += normal;
                show(normal);
            }
            for Beside { cell, offset, sign } in &face.beside {
                // All triangles end at the centre; from an origin that is off the cone has as much less as the offset goes along the normal.
                volumes[*cell] += sign * (fan.center - *offset).dot(sum) / 6.0;
            }
        }
        volumes
    }

    /// The area where the vertices are now.
    pub(crate) fn area_now(&self) -> f64 {
        self.area(&self.rings()).0
    }

    /// By how much the volume of each cell is above what it is to be, and that as a share of it.
    pub(crate) fn excesses(&self) -> impl Iterator<Item = (CellId, f64, f64)> {
        let cells = self.cells.iter().zip(self.volumes(&self.rings()));
        cells.map(|(cell, volume)| {
            let excess = cell.excess + volume - cell.volume;
            (cell.id, excess, excess / cell.whole)
        })
    }

    /// Whether no cell's volume is off by more than a share of it, or at least by no more than it is in another area of the same cells.
    pub(crate) fn keeps_volumes(&self, share: f64, before: &Self) -> bool {
        let before: Vec<_> = before.excesses().collect();
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
            let normals: Vec<DVec3> = Fan { ring, center }.normals().collect();
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
}

#[cfg(test)]
mod tests;
