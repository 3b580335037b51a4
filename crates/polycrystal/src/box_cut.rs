//! A periodic network cut at the planes of its box.
//!
//! Grains of a periodic network are whole and stick out of the box. Here each element is cut where it meets a plane between
//! two copies of the box, and every piece moves into the box. Where grains were cut, flat caps close them, with the same
//! triangles on opposite walls.
//!
//! All of this happens on the torus: a point is one of the box, and a shift by whole periods. What is found on one side of a
//! plane is so found on the other, and points on opposite walls differ in that one coordinate alone, bit for bit.

mod caps;
mod pieces;

use std::collections::BTreeMap;

use glam::DVec3;
use voronoi::{Dimension, Domain, Shift};

use crate::face_mesh::id;
use crate::{BoundaryId, Elements, GrainId, Junctions, Network, NetworkError, Side, Surface};
use caps::caps;
use pieces::Pieces;

/// A point of the torus, moved by whole periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
struct Corner {
    point: u32,
    shift: Shift,
}

impl Corner {
    fn moved(self, by: Shift) -> Self {
        Self { shift: self.shift + by, ..self }
    }
}

/// A convex polygon between two sides; in the plane, a segment.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Piece {
    corners: Vec<Corner>,
    sides: [Side; 2],
}

impl Network {
    /// The network in the box alone, and its points, for the points of the finest level of a periodic network: grains end at the
    /// walls, some in several pieces. In its own box it has walls where the periodic one had copies, and a single level.
    ///
    /// Points on opposite walls are the same, bit for bit, but for the coordinate across. A boundary that lies in a plane of the box
    /// becomes two walls, and one at which a grain meets its own image is left out: in the box there is the same on both sides.
    ///
    /// # Errors
    /// [`NetworkError::CutCrosses`]; [`NetworkError::MeetsItself`] where that leaves folds; [`NetworkError::CutInvalid`] where the pieces are no valid network.
    ///
    /// # Panics
    /// When there is not one point per vertex of the finest level.
    pub fn cut_at_box(&self, points: &[DVec3]) -> Result<(Self, Vec<DVec3>), NetworkError> {
        let domain = self.domain();
        let mut pieces = Pieces::of_network(self, points);
        for axis in periodic_axes(domain) {
            pieces.cut(axis);
        }
        pieces.move_into_box();
        let only_grain = (self.grain_count() == 1).then_some(Side::Grain(GrainId(0)));
        let caps = caps(&mut pieces, only_grain)?;
        let Pieces { pieces, places, meets_itself, .. } = pieces;
        let mut numbers: BTreeMap<Corner, u32> = BTreeMap::new();
        let mut box_points = Vec::new();
        let mut sides: Vec<[Side; 2]> = pieces.iter().chain(&caps).map(|piece| piece.sides).collect();
        sides.sort_unstable();
        sides.dedup();
        let (mut triangles, mut segments, mut boundary_of) = (Vec::new(), Vec::new(), Vec::new());
        for piece in pieces.iter().chain(&caps) {
            let mut number = |corner: &Corner| {
                *numbers.entry(*corner).or_insert_with(|| {
                    box_points.push(place_in_box(domain, places[corner.point as usize], corner.shift));
                    id(box_points.len() - 1)
                })
            };
            let corners: Vec<u32> = piece.corners.iter().map(&mut number).collect();
            match domain.dimension() {
                Dimension::Two => segments.push([corners[0], corners[1]]),
                Dimension::Three => {
                    triangles.extend((2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]]))
                }
            }
            let side = sides.binary_search(&piece.sides).expect("all were listed");
            boundary_of.resize(triangles.len() + segments.len(), BoundaryId(id(side)));
        }
        let elements = match domain.dimension() {
            Dimension::Two => Elements::Segments(&segments),
            Dimension::Three => Elements::Triangles(&triangles),
        };
        let surface = Surface { points: &box_points, elements, boundary_of: &boundary_of, sides: &sides };
        let walled = domain.clone().with_periods(glam::BVec3::FALSE);
        match (Self::of_surface(&walled, &surface, Junctions::Crease, 0), meets_itself) {
            (Err(NetworkError::Invalid(_)), Some(grain)) => Err(NetworkError::MeetsItself { grain }),
            (Err(NetworkError::Invalid(faults)), None) => Err(NetworkError::CutInvalid(faults)),
            (result, _) => result,
        }
    }
}

fn periodic_axes(domain: &Domain) -> impl Iterator<Item = usize> {
    let periodic = domain.periodic();
    (0..3).filter(move |axis| periodic.test(*axis))
}

/// A place of the torus in the box: what is moved lies on the upper wall.
fn place_in_box(domain: &Domain, mut place: DVec3, shift: Shift) -> DVec3 {
    for axis in 0..3 {
        if shift.0[axis] != 0 {
            place[axis] = domain.upper()[axis];
        }
    }
    place
}
