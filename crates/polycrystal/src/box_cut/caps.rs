//! What closes grains where the box's planes cut them.

use std::collections::{BTreeMap, HashMap};

use spade::handles::{FixedVertexHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use voronoi::{Dimension, Shift};

use super::pieces::Pieces;
use super::{Corner, Piece, periodic_axes, place_in_box};
use crate::{NetworkError, Side};

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;
type Face = spade::handles::FixedFaceHandle<InnerTag>;

/// Caps on all walls across periodic axes: of a grain toward the exterior.
pub(super) fn caps(pieces: &mut Pieces) -> Result<Vec<Piece>, NetworkError> {
    let axes: Vec<usize> = periodic_axes(&pieces.domain).collect();
    let is_plane = pieces.domain.dimension() == Dimension::Two;
    let dimensions = if is_plane { 2 } else { 3 };
    // The corners of a box that is periodic along all its axes are one point.
    let origin = (axes.len() == dimensions).then(|| {
        let lower = pieces.domain.lower();
        pieces.add(lower, [0, 1, 2].map(|axis| axis < dimensions))
    });
    let mut caps = Vec::new();
    for axis in axes {
        if is_plane {
            caps_of_line(pieces, axis, origin, &mut caps);
        } else {
            caps_of_plane(pieces, axis, &mut caps)?;
        }
    }
    Ok(caps)
}

/// Adds the same cap on the lower and on the upper wall; its corners wind round the axis.
fn push_caps(caps: &mut Vec<Piece>, axis: usize, corners: Vec<Corner>, grain: Side) {
    let mut up = Shift::NONE;
    up.0[axis] = 1;
    let sides = [grain, Side::Exterior];
    caps.push(Piece { corners: corners.iter().map(|corner| corner.moved(up)).collect(), sides });
    caps.push(Piece { corners: corners.into_iter().rev().collect(), sides });
}

/// In the plane: what of a wall lies between points at which boundaries meet it.
fn caps_of_line(pieces: &Pieces, axis: usize, origin: Option<Corner>, caps: &mut Vec<Piece>) {
    let along = 1 - axis;
    // Of each point, the sides before and after it.
    let mut points: BTreeMap<Corner, [Side; 2]> = BTreeMap::new();
    for Piece { corners, sides } in &pieces.pieces {
        for (corner, is_end) in corners.iter().zip([false, true]) {
            if pieces.is_on_lower(*corner, axis) {
                // The first side is on the left: of what leaves x = 0 that is after, of what leaves y = 0 before.
                let [left, right] = *sides;
                points.insert(*corner, if is_end == (axis == 0) { [left, right] } else { [right, left] });
            }
        }
    }
    let height = |corner: &Corner| {
        place_in_box(&pieces.domain, pieces.places[corner.point as usize], corner.shift)[along]
    };
    let mut sorted: Vec<(Corner, [Side; 2])> = points.into_iter().collect();
    sorted.sort_by(|a, b| height(&a.0).total_cmp(&height(&b.0)));
    if let (Some(origin), [(_, [before, _]), .., (_, [_, after])]) = (origin, &sorted[..]) {
        let (before, after) = (*before, *after);
        let mut far = Shift::NONE;
        far.0[along] = 1;
        sorted.insert(0, (origin, [Side::Exterior, before]));
        sorted.push((origin.moved(far), [after, Side::Exterior]));
    }
    for pair in sorted.windows(2) {
        let [(from, [_, side]), (to, _)] = [pair[0], pair[1]];
        // Of the upper wall the grain is on the left going up y, and down x.
        let ends = if axis == 0 { vec![from, to] } else { vec![to, from] };
        if side != Side::Exterior {
            push_caps(caps, axis, ends, side);
        }
    }
}

/// In space: the triangles of a wall, constrained by the lines in which boundaries meet it.
fn caps_of_plane(pieces: &Pieces, axis: usize, caps: &mut Vec<Piece>) -> Result<(), NetworkError> {
    let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
    // What lies on the left of each edge, seen from above the lower wall.
    let mut left_of: HashMap<[Corner; 2], Side> = HashMap::new();
    let mut edges = Vec::new();
    for Piece { corners, sides } in &pieces.pieces {
        for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            if pieces.is_on_lower(*from, axis) && pieces.is_on_lower(*to, axis) {
                left_of.insert([*from, *to], sides[0]);
                left_of.insert([*to, *from], sides[1]);
                edges.push([*from, *to]);
            }
        }
    }
    for [across, along] in [[b, c], [c, b]] {
        if pieces.domain.periodic().test(across) {
            edges.extend(rims(pieces, [axis, across], along));
        }
    }
    let mut corners: Vec<Corner> = edges.iter().flatten().copied().collect();
    corners.sort_unstable();
    corners.dedup();
    let crosses = || NetworkError::CutCrosses { axis: ["x", "y", "z"][axis] };
    let mut delaunay = Delaunay::new();
    for (number, corner) in corners.iter().enumerate() {
        let place = place_in_box(&pieces.domain, pieces.places[corner.point as usize], corner.shift);
        let vertex = delaunay.insert(Point2::new(place[b], place[c])).map_err(|_| crosses())?;
        // An earlier point at the same place comes back as itself.
        if vertex.index() != number {
            return Err(crosses());
        }
    }
    for ends in &edges {
        let [from, to] = ends
            .map(|end| FixedVertexHandle::from_index(corners.binary_search(&end).expect("ends were listed")));
        if !delaunay.can_add_constraint(from, to) {
            return Err(crosses());
        }
        delaunay.add_constraint(from, to);
    }
    let side_at = |ends: [FixedVertexHandle; 2]| left_of.get(&ends.map(|end| corners[end.index()])).copied();
    let sides = fill(&delaunay, side_at);
    for face in delaunay.inner_faces() {
        let grain = *sides.get(&face.fix()).ok_or_else(crosses)?;
        if grain != Side::Exterior {
            push_caps(caps, axis, face.vertices().map(|vertex| corners[vertex.index()]).to_vec(), grain);
        }
    }
    Ok(())
}

/// The edges of the lower wall across the first of two axes that lie on walls across the second, below and above.
fn rims(pieces: &Pieces, [axis, across]: [usize; 2], along: usize) -> Vec<[Corner; 2]> {
    let on_edge = (0u32..).zip(&pieces.planes).filter(|(_, planes)| planes[axis] && planes[across]);
    let height = |point: &u32| pieces.places[*point as usize][along];
    let mut points: Vec<u32> = on_edge.map(|(point, _)| point).collect();
    points.sort_by(|a, b| height(a).total_cmp(&height(b)));
    let mut line: Vec<Corner> =
        points.into_iter().map(|point| Corner { point, shift: Shift::NONE }).collect();
    let mut far = Shift::NONE;
    far.0[along] = 1;
    // The lowest is a corner of the box, and also the highest, where these are one point.
    let first = line[0];
    if pieces.planes[first.point as usize][along] {
        line.push(first.moved(far));
    }
    let mut up = Shift::NONE;
    up.0[across] = 1;
    let pairs = line.windows(2).map(|pair| [pair[0], pair[1]]);
    pairs.flat_map(|ends| [ends, ends.map(|end| end.moved(up))]).collect()
}

/// The side in which each triangle lies, from those of the edges that have one on their left.
fn fill(
    delaunay: &Delaunay,
    side_at: impl Fn([FixedVertexHandle; 2]) -> Option<Side>,
) -> HashMap<Face, Side> {
    let mut sides = HashMap::new();
    let mut next = Vec::new();
    for face in delaunay.inner_faces() {
        let known =
            face.adjacent_edges().into_iter().find_map(|edge| side_at([edge.from().fix(), edge.to().fix()]));
        if let Some(side) = known {
            sides.insert(face.fix(), side);
            next.push(face.fix());
        }
    }
    while let Some(face) = next.pop() {
        let side = sides[&face];
        for edge in delaunay.face(face).adjacent_edges() {
            let is_open = side_at([edge.from().fix(), edge.to().fix()]).is_none();
            if let (true, Some(neighbor)) = (is_open, edge.rev().face().as_inner()) {
                sides.entry(neighbor.fix()).or_insert_with(|| {
                    next.push(neighbor.fix());
                    side
                });
            }
        }
    }
    sides
}
