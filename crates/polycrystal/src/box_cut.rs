//! A periodic network cut at the planes of its box.
//!
//! Grains of a periodic network are whole and stick out of the box. Here each element is cut where it meets a plane between
//! two copies of the box, and every piece moves into the box. Where grains were cut, flat caps close them, with the same
//! triangles on opposite walls.
//!
//! All of this happens on the torus: a point is one of the box, and a translation by whole periods. What is found on one side of a
//! plane is so found on the other, and points on opposite walls differ in that one coordinate alone, bit for bit.

mod cap_points;
mod caps;
mod pieces;
mod shape;
mod snap;
mod steep;
mod volumes;

use std::collections::BTreeMap;

use glam::DVec3;
use voronoi::{Dimension, Domain, PeriodicVertex, Translation};

use crate::mesh::id::id;
use crate::{Attempt, BoundaryId, Elements, GrainId, Junctions, Network, NetworkError, Side, Surface};
use caps::caps;
use pieces::{Pieces, Torus};
use shape::widen;
use snap::snap;
use volumes::restore;

/// A convex polygon between two sides; in the plane, a segment.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Piece {
    corners: Vec<PeriodicVertex>,
    sides: [Side; 2],
    /// The boundary that it is part of; none for a cap.
    boundary: Option<BoundaryId>,
}

/// Which points move for the sake of triangles at the planes of the box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shaping {
    /// Those near planes before the cut, and those of thin triangles after it.
    Full,
    /// Those near planes before the cut.
    Near,
    /// Those of thin triangles after the cut.
    Thin,
    /// None.
    None,
}

impl Shaping {
    /// What to try, one after the other; where points come in each other's way, none may move at last.
    const SOME: [Self; 3] = [Self::Full, Self::Near, Self::Thin];

    fn in_words(self) -> &'static str {
        match self {
            Self::Full => "the cut at the box, points of thin triangles moved before and after it",
            Self::Near => "the cut at the box, points near its planes moved before it",
            Self::Thin => "the cut at the box, points of thin triangles moved after it",
            Self::None => "the cut at the box, no points moved",
        }
    }

    fn moves_near(self) -> bool {
        matches!(self, Self::Full | Self::Near)
    }

    fn moves_thin(self) -> bool {
        matches!(self, Self::Full | Self::Thin)
    }
}

/// A periodic network in its box alone.
#[derive(Debug, Clone)]
pub struct BoxCut {
    /// The network, of a single level.
    pub network: Network,
    /// Its points.
    pub points: Vec<DVec3>,
    /// Ways to better triangles that were tried before, and tangled.
    pub attempts: Vec<Attempt>,
}

impl Network {
    /// The network in the box alone, and its points, for the points of the finest level of a periodic network: grains end at the
    /// walls, some in several pieces. In its own box it has walls where the periodic one had copies, and a single level.
    ///
    /// Points on opposite walls are the same, bit for bit, but for the coordinate across. A boundary that lies in a plane of the box
    /// becomes two walls, and one at which a grain meets its own image is left out: in the box there is the same on both sides.
    ///
    /// In space, points near the planes move so that these cut no slivers, and volumes are restored; those of boundaries that are flat
    /// move within these alone.
    ///
    /// ```
    /// use glam::{BVec3, DVec3};
    /// use polycrystal::{Junctions, Network};
    /// use voronoi::{Domain, Tessellation};
    ///
    /// let seeds: Vec<DVec3> = (1..=20).map(|k| (DVec3::new(0.819, 0.671, 0.550) * f64::from(k)).fract()).collect();
    /// let cells = Tessellation::new(&Domain::unit_cube().with_periods(BVec3::TRUE), &seeds)?;
    /// let (network, points) = Network::new(&cells, Junctions::Crease, 0)?;
    /// let cut = network.cut_at_box(&points, true)?;
    /// assert!(cut.points.iter().all(|point| point.min_element() >= 0.0 && point.max_element() <= 1.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`NetworkError::CutCrosses`]; [`NetworkError::TouchesItself`]; [`NetworkError::VolumeNotRestored`]; [`NetworkError::CutInvalid`] where the pieces are no valid network otherwise.
    ///
    /// # Panics
    /// When there is not one point per vertex of the finest level.
    pub fn cut_at_box(&self, points: &[DVec3], is_flat: bool) -> Result<BoxCut, NetworkError> {
        let mut attempts = Vec::new();
        if self.domain().dimension() == Dimension::Three {
            for shaping in Shaping::SOME {
                match self.cut(points, shaping, is_flat) {
                    Ok((network, points)) => return Ok(BoxCut { network, points, attempts }),
                    Err(error) if error.is_tangle() => error.give_up(shaping.in_words(), &mut attempts),
                    Err(error) => return Err(error.after(attempts)),
                }
            }
        }
        match self.cut(points, Shaping::None, is_flat) {
            Ok((network, points)) => Ok(BoxCut { network, points, attempts }),
            Err(error) => Err(error.after(attempts)),
        }
    }

    fn cut(
        &self,
        points: &[DVec3],
        shaping: Shaping,
        is_flat: bool,
    ) -> Result<(Self, Vec<DVec3>), NetworkError> {
        let domain = self.domain();
        let mut torus = Torus::new(self, points);
        if shaping.moves_near() {
            snap(self, &mut torus, points, is_flat);
        }
        let mut pieces = Pieces::of_network(self, torus);
        for axis in periodic_axes(domain) {
            pieces.cut(axis);
        }
        pieces.move_into_box();
        if domain.dimension() == Dimension::Three {
            pieces.triangulate();
        }
        let only_grain = (self.grain_count() == 1).then_some(Side::Grain(GrainId(0)));
        let caps = caps(&mut pieces, only_grain)?;
        if shaping.moves_thin() {
            widen(&mut pieces, &caps, is_flat);
        }
        if shaping != Shaping::None && !is_flat {
            restore(&mut pieces, &caps, self.cell_volumes())?;
        }
        self.in_box(&pieces, &caps)
    }

    /// The network that pieces and caps make up.
    fn in_box(&self, pieces: &Pieces, caps: &[Piece]) -> Result<(Self, Vec<DVec3>), NetworkError> {
        let domain = self.domain();
        let mut numbers: BTreeMap<PeriodicVertex, u32> = BTreeMap::new();
        let mut box_points = Vec::new();
        let all = || pieces.pieces.iter().chain(caps);
        // Where a boundary between a grain and its own image was left out, others end that lie between the same grains.
        let mut boundaries: Vec<([Side; 2], Option<BoundaryId>)> =
            all().map(|piece| (piece.sides, piece.boundary)).collect();
        boundaries.sort_unstable();
        boundaries.dedup();
        let (mut triangles, mut segments, mut boundary_of) = (Vec::new(), Vec::new(), Vec::new());
        for piece in all() {
            let mut number = |corner: &PeriodicVertex| {
                *numbers.entry(*corner).or_insert_with(|| {
                    box_points.push(pieces.position(*corner));
                    id(box_points.len() - 1)
                })
            };
            let corners: Vec<u32> = piece.corners.iter().map(&mut number).collect();
            match domain.dimension() {
                Dimension::Two => segments.push([corners[0], corners[1]]),
                Dimension::Three => triangles.push([corners[0], corners[1], corners[2]]),
            }
            let boundary = boundaries.binary_search(&(piece.sides, piece.boundary));
            boundary_of.push(BoundaryId(id(boundary.expect("all were listed"))));
        }
        let elements = match domain.dimension() {
            Dimension::Two => Elements::Segments(&segments),
            Dimension::Three => Elements::Triangles(&triangles),
        };
        let sides: Vec<[Side; 2]> = boundaries.iter().map(|(sides, _)| *sides).collect();
        let surface = Surface { points: &box_points, elements, boundary_of: &boundary_of, sides: &sides };
        let walled = domain.clone().with_periods(glam::BVec3::FALSE);
        let left = Self::of_grains_left(&walled, &surface, self.grain_count(), Junctions::Crease, 0);
        left.map_err(|error| match error {
            NetworkError::Invalid(faults) => match faults.pinched_grain() {
                Some(grain) => NetworkError::TouchesItself { grain },
                None => NetworkError::CutInvalid(faults),
            },
            error => error,
        })
    }
}

fn periodic_axes(domain: &Domain) -> impl Iterator<Item = usize> {
    let periodic = domain.periodic();
    (0..3).filter(move |axis| periodic.test(*axis))
}

/// A place of the torus in the box: what is moved lies on the upper wall.
fn position_in_box(domain: &Domain, mut position: DVec3, translation: Translation) -> DVec3 {
    for axis in 0..3 {
        if translation.0[axis] != 0 {
            position[axis] = domain.upper()[axis];
        }
    }
    position
}
