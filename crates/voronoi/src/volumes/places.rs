//! Places for grains on the faces, edges and vertices of cells, and inside them.

use std::collections::BTreeMap;
use std::fmt;

use glam::DVec3;

use super::inclusions::{Inclusion, beyond_face};
use super::spheres::{SphereGrid, wrapped};
use crate::{CellId, Dimension, FaceId, Tessellation};

/// How many places an inclusion tries before it takes that of most room.
const MOST_PLACES: usize = 200;

/// How much room an inclusion wants around it, in radii of a ball as large.
const ROOM: f64 = 1.2;

/// By how much inclusions may overlap, in the sum of the radii of balls with room around: at a sixth the balls themselves touch.
const MOST_OVERLAP: f64 = 0.35;

/// Where inclusions are put.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum InclusionPlace {
    /// Inside a cell.
    Interior,
    /// On the face between two cells; in the plane on the edge between them.
    Boundaries,
    /// On the edge where three cells meet; in the plane on the vertex.
    TripleLines,
    /// On the vertex where four cells meet; in three dimensions only.
    QuadruplePoints,
}

impl InclusionPlace {
    /// Number of cells that meet there.
    pub fn cells(self) -> usize {
        match self {
            Self::Interior => 1,
            Self::Boundaries => 2,
            Self::TripleLines => 3,
            Self::QuadruplePoints => 4,
        }
    }
}

/// Why inclusions find no place.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlaceError {
    /// Cells nowhere meet like that.
    #[error("there is no place {place}")]
    None {
        /// The place.
        place: InclusionPlace,
    },
    /// They would overlap.
    #[error("there is room {place} for {placed} of {wanted} grains")]
    NoRoom {
        /// The place.
        place: InclusionPlace,
        /// How many were placed there.
        placed: usize,
        /// How many were to be.
        wanted: usize,
    },
}

impl fmt::Display for InclusionPlace {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Interior => "inside grains",
            Self::Boundaries => "on boundaries",
            Self::TripleLines => "on triple lines",
            Self::QuadruplePoints => "at quadruple points",
        })
    }
}

/// Places for inclusions of given volumes (in the plane: areas), at random, the largest first, so that they do not overlap and touch no other cells
/// than those that meet at their centre. Where there is no such place, an inclusion takes the one of most room.
///
/// `fraction` gives random numbers from 0 up to but not including 1.
///
/// # Errors
/// [`PlaceError`].
///
/// # Panics
/// When there are not as many weights as cells.
pub fn place_inclusions(
    tessellation: &Tessellation,
    weights: &[f64],
    wanted: &[(InclusionPlace, f64)],
    mut fraction: impl FnMut() -> f64,
) -> Result<Vec<Inclusion>, PlaceError> {
    assert_eq!(tessellation.cell_count(), weights.len(), "one weight for each cell");
    let domain = tessellation.domain();
    let mut spots_of: BTreeMap<InclusionPlace, Vec<Spot>> = BTreeMap::new();
    for (place, _) in wanted {
        spots_of.entry(*place).or_insert_with(|| spots(tessellation, *place));
    }
    let radius_of = |volume: f64| ROOM * 0.5 * domain.dimension().ball_diameter(volume);
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_unstable_by(|a, b| wanted[*b].1.total_cmp(&wanted[*a].1).then(a.cmp(b)));
    let largest = wanted.iter().map(|(_, volume)| *volume).fold(0.0, f64::max);
    let mut grid = SphereGrid::new(domain, radius_of(largest), wanted.len());
    let mut placed: Vec<Option<Inclusion>> = vec![None; wanted.len()];
    for number in order {
        let (place, volume) = wanted[number];
        let spots = &spots_of[&place];
        let Some(all) = spots.last().map(|spot| spot.sum) else { return Err(PlaceError::None { place }) };
        let radius = radius_of(volume);
        let mut best: Option<(f64, Inclusion)> = None;
        for _ in 0..MOST_PLACES {
            let goal = fraction() * all;
            let spot = &spots[spots.partition_point(|spot| spot.sum <= goal).min(spots.len() - 1)];
            let center = spot.point(&mut fraction);
            let overlap = grid.overlap(wrapped(domain, center), radius, f64::INFINITY);
            if overlap > MOST_OVERLAP {
                continue;
            }
            let room = room(tessellation, weights, spot.cell, place, center);
            let lack = overlap.max(1.0 - room / radius);
            if best.is_none_or(|(least, _)| lack < least) {
                best = Some((lack, Inclusion { cell: spot.cell, center, volume }));
            }
            if lack <= 0.0 {
                break;
            }
        }
        let Some((_, inclusion)) = best else {
            let is_here = |other: &usize| wanted[*other].0 == place;
            let all = || (0..wanted.len()).filter(is_here);
            let placed = all().filter(|other| placed[*other].is_some()).count();
            return Err(PlaceError::NoRoom { place, placed, wanted: all().count() });
        };
        placed[number] = Some(inclusion);
        grid.insert(wrapped(domain, inclusion.center), radius);
    }
    Ok(placed.into_iter().flatten().collect())
}

/// The distance of a place from the nearest cell or wall that it is not at itself.
fn room(
    tessellation: &Tessellation,
    weights: &[f64],
    cell: CellId,
    place: InclusionPlace,
    center: DVec3,
) -> f64 {
    let faces = tessellation.cell_faces(cell).iter();
    let mut distances: Vec<f64> =
        faces.map(|face| beyond_face(tessellation, weights, cell, *face, center)).collect();
    distances.sort_unstable_by(f64::total_cmp);
    distances.get(place.cells() - 1).copied().unwrap_or(f64::INFINITY)
}

/// A simplex that places are drawn in.
struct Spot {
    cell: CellId,
    corners: Vec<DVec3>,
    /// The measures of all up to this one.
    sum: f64,
}

impl Spot {
    /// A random point: sorted numbers are the ends of the shares of the corners.
    fn point(&self, fraction: &mut impl FnMut() -> f64) -> DVec3 {
        let mut ends: Vec<f64> = self.corners[1..].iter().map(|_| fraction()).collect();
        ends.sort_unstable_by(f64::total_cmp);
        let starts = std::iter::once(0.0).chain(ends.iter().copied());
        let terms = ends.iter().zip(starts).zip(&self.corners[1..]);
        terms.fold(self.corners[0], |point, ((end, start), corner)| {
            point + (corner - self.corners[0]) * (end - start)
        })
    }
}

/// All simplices of a kind of places. Those that several cells share come once in each.
fn spots(tessellation: &Tessellation, place: InclusionPlace) -> Vec<Spot> {
    let mut spots: Vec<Spot> = Vec::new();
    let mut sum = 0.0;
    let measures = tessellation.cell_measures();
    let is_plane = tessellation.domain().dimension() == Dimension::Two;
    for cell in (0u32..).map(CellId).take(tessellation.cell_count()) {
        let mut push = |corners: Vec<DVec3>| {
            let ways: Vec<DVec3> = corners[1..].iter().map(|corner| corner - corners[0]).collect();
            sum += match ways[..] {
                [] => 1.0,
                [way] => way.length(),
                [one, other] => 0.5 * one.cross(other).length(),
                [one, other, third, ..] => one.cross(other).dot(third).abs() / 6.0,
            };
            spots.push(Spot { cell, corners, sum });
        };
        let places = |face: &FaceId| -> Vec<DVec3> {
            tessellation
                .face_corners(*face)
                .iter()
                .map(|corner| tessellation.vertices()[corner.index()])
                .collect()
        };
        let faces = tessellation.cell_faces(cell);
        let is_between = |face: &FaceId| tessellation.across(cell, *face).cell().is_some();
        match place {
            InclusionPlace::Interior => {
                let middle = measures[cell.index()].centroid;
                for corners in faces.iter().map(places) {
                    for ends in corners[1..].windows(2) {
                        push(vec![middle, corners[0], ends[0], ends[1]]);
                    }
                    if let [start, end] = corners[..] {
                        push(vec![middle, start, end]);
                    }
                }
            }
            InclusionPlace::Boundaries => {
                for corners in faces.iter().filter(|face| is_between(face)).map(places) {
                    for ends in corners[1..].windows(2) {
                        push(vec![corners[0], ends[0], ends[1]]);
                    }
                    if corners.len() == 2 {
                        push(corners);
                    }
                }
            }
            InclusionPlace::TripleLines | InclusionPlace::QuadruplePoints => {
                // Each edge of a cell lies between two of its faces, and each vertex at three or more.
                let is_vertex = is_plane || place == InclusionPlace::QuadruplePoints;
                let mut meetings: Vec<([crate::VertexId; 2], bool)> = Vec::new();
                for face in faces {
                    let corners = tessellation.face_corners(*face);
                    for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                        let to = if is_vertex { from } else { to };
                        meetings.push(([*from.min(to), *from.max(to)], is_between(face)));
                    }
                }
                meetings.sort_unstable();
                for same in meetings.chunk_by(|one, other| one.0 == other.0) {
                    if same.iter().all(|(_, is_between)| *is_between) {
                        let [start, end] = same[0].0.map(|end| tessellation.vertices()[end.index()]);
                        push(if is_vertex { vec![start] } else { vec![start, end] });
                    }
                }
            }
        }
    }
    spots
}
