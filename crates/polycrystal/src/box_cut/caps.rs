//! What closes grains where the box's planes cut them.

use std::collections::{HashMap, HashSet};

use glam::DVec3;
use spade::handles::{FixedVertexHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use voronoi::{Dimension, PeriodicVertex, Translation};

use crate::box_cut::cap_points::add_points;
use crate::box_cut::pieces::{End, Pieces};
use crate::box_cut::{Piece, periodic_axes, position_in_box};
use crate::{NetworkError, Side};

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;
type Face = spade::handles::FixedFaceHandle<InnerTag>;

/// Where behind a piece to look for what a wall belongs to, as a share of the piece: of seeds on lattices others may end behind its middle.
const OFF_MIDDLE: f64 = 0.381_966;

/// Caps on all walls across periodic axes: of a grain toward the exterior. What lies within such a wall becomes caps of both
/// sides, one on each of the opposite walls.
pub(crate) fn caps(pieces: &mut Pieces, only_grain: Option<Side>) -> Result<Vec<Piece>, NetworkError> {
    let axes: Vec<usize> = periodic_axes(&pieces.domain).collect();
    let is_plane = pieces.domain.dimension() == Dimension::Two;
    // The corners of a box that is periodic along all its axes are one point.
    let origin = (axes.len() == if is_plane { 2 } else { 3 }).then(|| pieces.origin());
    if !is_plane {
        divide_rims(pieces);
    }
    let mut caps = Vec::new();
    for axis in axes {
        if is_plane {
            caps_of_line(pieces, axis, (origin, only_grain), &mut caps)?;
        } else {
            caps_of_plane(pieces, axis, only_grain, &mut caps)?;
        }
    }
    let all = std::mem::take(&mut pieces.pieces);
    let is_inside = |piece: &Piece| !periodic_axes(&pieces.domain).any(|axis| pieces.is_within(piece, axis));
    pieces.pieces = all.into_iter().filter(is_inside).collect();
    Ok(caps)
}

/// Adds a cap of a grain, whose corners on the lower wall wind round the axis, on one of the opposite walls.
fn push_cap(caps: &mut Vec<Piece>, axis: usize, corners: &[PeriodicVertex], grain: Side, end: End) {
    let mut up = Translation::ZERO;
    up.0[axis] = end as i8;
    let mut corners: Vec<PeriodicVertex> = corners.iter().map(|corner| corner.moved(up)).collect();
    if end == End::Lower {
        corners.reverse();
    }
    caps.push(Piece { corners, sides: [grain, Side::Exterior], boundary: None });
}

fn crosses(axis: usize) -> NetworkError {
    NetworkError::CutCrosses { axis: ["x", "y", "z"][axis] }
}

/// In the plane: what of a wall lies between points at which boundaries meet it.
fn caps_of_line(
    pieces: &Pieces,
    axis: usize,
    (origin, only_grain): (Option<PeriodicVertex>, Option<Side>),
    caps: &mut Vec<Piece>,
) -> Result<(), NetworkError> {
    let along = 1 - axis;
    let position = |corner: PeriodicVertex| {
        position_in_box(&pieces.domain, pieces.positions[corner.vertex as usize], corner.translation)
    };
    let mut far = Translation::ZERO;
    far.0[along] = 1;
    let mut line: Vec<PeriodicVertex> =
        origin.into_iter().flat_map(|origin| [origin, origin.moved(far)]).collect();
    for corner in pieces.pieces.iter().flat_map(|piece| &piece.corners) {
        let end = [End::Lower, End::Upper].into_iter().find(|end| pieces.is_on(*corner, axis, *end));
        line.extend(end.map(|end| pieces.lowered(*corner, axis, end)));
    }
    line.sort_unstable_by(|a, b| position(*a)[along].total_cmp(&position(*b)[along]).then(a.cmp(b)));
    line.dedup();
    for end in [End::Lower, End::Upper] {
        // The sides after and before each point, each with the slope along the wall of the boundary that bounds it.
        let mut beside: HashMap<(PeriodicVertex, bool), (f64, Side)> = HashMap::new();
        for piece in &pieces.pieces {
            let ends = [piece.corners[0], piece.corners[1]];
            let is_within = pieces.is_within(piece, axis);
            for (at, other, [left, right]) in
                [(ends[0], ends[1], piece.sides), (ends[1], ends[0], [piece.sides[1], piece.sides[0]])]
            {
                let away = (position(other) - position(at)).normalize_or_zero();
                if is_within {
                    // Along x the left is above, along y it is below.
                    let is_left = (axis == 1) == ((away[along] > 0.0) == (end == End::Lower));
                    let side = if is_left { left } else { right };
                    beside.insert((at, away[along] > 0.0), (f64::INFINITY, side));
                } else if pieces.is_on(at, axis, end) {
                    let base = pieces.lowered(at, axis, end);
                    // Leaving x = 0 the left is after, leaving y = 0 before; leaving the upper wall the other way round.
                    let is_left_after = (axis == 0) == (end == End::Lower);
                    for (is_after, slope) in [(true, away[along]), (false, -away[along])] {
                        let side = if is_after == is_left_after { left } else { right };
                        let best = beside.entry((base, is_after)).or_insert((slope, side));
                        if slope > best.0 {
                            *best = (slope, side);
                        }
                    }
                }
            }
        }
        let known = |corner: PeriodicVertex, is_after| beside.get(&(corner, is_after)).map(|(_, side)| *side);
        let between = |pair: &[PeriodicVertex]| known(pair[0], true).or_else(|| known(pair[1], false));
        let mut sides: Vec<Option<Side>> = line.windows(2).map(between).collect();
        // Where no boundary meets the wall the same grain goes on.
        let first = sides.iter().copied().flatten().next_back().or(only_grain);
        let first = first.or_else(|| seen_from_wall(pieces, axis, end, behind_widest(pieces, axis)?));
        let mut last = first;
        for side in &mut sides {
            last = side.or(last);
            *side = last;
        }
        for (pair, side) in line.windows(2).zip(sides) {
            let side = side.ok_or_else(|| crosses(axis))?;
            // Of the upper wall the grain is on the left going up y, and down x.
            let corners = if axis == 0 { [pair[0], pair[1]] } else { [pair[1], pair[0]] };
            if side != Side::Exterior {
                push_cap(caps, axis, &corners, side, end);
            }
        }
    }
    Ok(())
}

/// In space: the triangles of a wall, constrained by the lines in which boundaries meet it from above and from below.
fn caps_of_plane(
    pieces: &mut Pieces,
    axis: usize,
    only_grain: Option<Side>,
    caps: &mut Vec<Piece>,
) -> Result<(), NetworkError> {
    let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
    let position = |corner: PeriodicVertex| {
        let position = pieces.position(corner);
        Point2::new(position[b], position[c])
    };
    // What lies on the left of each edge, seen from above: at the lower wall and at the upper one.
    let mut left_of = [Lefts::default(), Lefts::default()];
    let mut edges = Vec::new();
    for piece @ Piece { sides: [first, second], .. } in &pieces.pieces {
        let along = edges_of(piece);
        if pieces.is_within(piece, axis) {
            let crossed = along.clone().map(|ends| ends.map(position)).map(|[p, q]| p.x * q.y - q.x * p.y);
            let is_upward = crossed.sum::<f64>() > 0.0;
            for [from, to] in along {
                let (ends, above, below) =
                    if is_upward { ([from, to], second, first) } else { ([to, from], first, second) };
                left_of[End::Lower as usize].add(ends, f64::INFINITY, *above);
                left_of[End::Upper as usize].add(ends, f64::INFINITY, *below);
                edges.push(ends);
            }
            continue;
        }
        for ends in along {
            let on = |end| ends.iter().all(|corner| pieces.is_on(*corner, axis, end));
            let Some(end) = [End::Lower, End::Upper].into_iter().find(|end| on(*end)) else { continue };
            let leaning = leaning(pieces, piece, ends, axis);
            let [from, to] = ends.map(|corner| pieces.lowered(corner, axis, end));
            // A piece above has its first side on the left of its edge, one below on the right.
            let [left, right] = if end == End::Lower { [*first, *second] } else { [*second, *first] };
            left_of[end as usize].add([from, to], leaning, left);
            left_of[end as usize].add([to, from], -leaning, right);
            edges.push([from, to]);
        }
    }
    for [across, along] in [[b, c], [c, b]] {
        if pieces.domain.periodic().test(across) {
            edges.extend(rims(pieces, [axis, across], along));
        }
    }
    let mut corners: Vec<PeriodicVertex> = edges.iter().flatten().copied().collect();
    corners.sort_unstable();
    corners.dedup();
    let mut delaunay = Delaunay::new();
    for (number, corner) in corners.iter().enumerate() {
        let vertex = delaunay.insert(position(*corner)).map_err(|_| crosses(axis))?;
        // An earlier point at the same place comes back as itself.
        if vertex.index() != number {
            return Err(crosses(axis));
        }
    }
    for ends in &edges {
        let [from, to] = ends
            .map(|end| FixedVertexHandle::from_index(corners.binary_search(&end).expect("ends were listed")));
        if !delaunay.can_add_constraint(from, to) {
            return Err(crosses(axis));
        }
        delaunay.add_constraint(from, to);
    }
    add_points(&mut delaunay);
    for vertex in delaunay.vertices().skip(corners.len()) {
        let mut position = pieces.domain.lower();
        (position[b], position[c]) = (vertex.position().x, vertex.position().y);
        corners.push(pieces.add(position, [0, 1, 2].map(|other| other == axis)));
    }
    for (end, left_of) in [End::Lower, End::Upper].into_iter().zip(&left_of) {
        let side_at = |ends: [FixedVertexHandle; 2]| left_of.side(ends.map(|end| corners[end.index()]));
        let look = |face: Face| {
            let [x, y] = delaunay.face(face).center().into();
            let mut at = pieces.domain.lower();
            (at[b], at[c]) = (x, y);
            seen_from_wall(pieces, axis, end, at)
        };
        let sides = fill(&delaunay, side_at, look);
        for face in delaunay.inner_faces() {
            let grain = sides.get(&face.fix()).copied().or(only_grain).ok_or_else(|| crosses(axis))?;
            if grain != Side::Exterior {
                push_cap(caps, axis, &face.vertices().map(|vertex| corners[vertex.index()]), grain, end);
            }
        }
    }
    Ok(())
}

/// What lies on the left of edges in a wall: where several pieces end there, the side of the one that leans there most.
#[derive(Default)]
struct Lefts(HashMap<[PeriodicVertex; 2], (f64, Side)>);

impl Lefts {
    fn add(&mut self, ends: [PeriodicVertex; 2], leaning: f64, side: Side) {
        let best = self.0.entry(ends).or_insert((leaning, side));
        if leaning > best.0 {
            *best = (leaning, side);
        }
    }

    fn side(&self, ends: [PeriodicVertex; 2]) -> Option<Side> {
        self.0.get(&ends).map(|(_, side)| *side)
    }
}

/// How far a piece leans to the left of its edge in a wall across an axis, seen from above: from -1 to 1.
fn leaning(pieces: &Pieces, piece: &Piece, ends: [PeriodicVertex; 2], axis: usize) -> f64 {
    let position = |corner: PeriodicVertex| {
        position_in_box(&pieces.domain, pieces.positions[corner.vertex as usize], corner.translation)
    };
    let [start, end] = ends.map(position);
    let along = (end - start).normalize_or_zero();
    let left = DVec3::AXES[axis].cross(along);
    // The farthest corner tells best how a thin piece leans.
    let legs = piece.corners.iter().map(|corner| (position(*corner) - start).reject_from_normalized(along));
    let leg = legs.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or_default();
    leg.normalize_or_zero().dot(left)
}

/// Divides the edges of the box into steps that are no longer than edges of boundaries on the mean. Boundaries may come near them where none meets them.
fn divide_rims(pieces: &mut Pieces) {
    let length = mean_edge_length(pieces);
    for [axis, across, along] in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
        if ![axis, across].iter().all(|axis| pieces.domain.periodic().test(*axis)) {
            continue;
        }
        let is_on_edge = |corner: &PeriodicVertex| {
            let planes = pieces.planes[corner.vertex as usize];
            planes[axis] && planes[across]
        };
        // Steps along which a boundary lies, which has its own triangles there.
        let mut taken: HashSet<[u32; 2]> = HashSet::new();
        for [from, to] in pieces.pieces.iter().flat_map(edges_of) {
            if is_on_edge(&from) && is_on_edge(&to) {
                taken.extend([[from.vertex, to.vertex], [to.vertex, from.vertex]]);
            }
        }
        for ends in rim(pieces, [axis, across], along).windows(2) {
            if taken.contains(&[ends[0].vertex, ends[1].vertex]) {
                continue;
            }
            let [from, to] = [ends[0], ends[1]].map(|end| pieces.position(end));
            let (step, count) = (to[along] - from[along], ((to[along] - from[along]) / length).ceil());
            let shares = (1..).map(|number| f64::from(number) / count).take_while(|share| *share < 1.0);
            for share in shares {
                let mut position = from;
                position[along] += share * step;
                pieces.add(position, [0, 1, 2].map(|other| other != along));
            }
        }
    }
}

fn mean_edge_length(pieces: &Pieces) -> f64 {
    let ends = pieces.pieces.iter().flat_map(edges_of);
    let lengths = ends.map(|[from, to]| pieces.position(from).distance(pieces.position(to)));
    let (sum, count) = lengths.fold((0.0, 0.0), |(sum, count), length| (sum + length, count + 1.0));
    sum / count
}

fn edges_of(piece: &Piece) -> impl Iterator<Item = [PeriodicVertex; 2]> + Clone + '_ {
    let corners = &piece.corners;
    corners.iter().zip(corners.iter().cycle().skip(1)).map(|(from, to)| [*from, *to])
}

/// The edges of the lower wall across the first of two axes that lie on walls across the second, below and above.
fn rims(pieces: &Pieces, [axis, across]: [usize; 2], along: usize) -> Vec<[PeriodicVertex; 2]> {
    let mut up = Translation::ZERO;
    up.0[across] = 1;
    let line = rim(pieces, [axis, across], along);
    let pairs = line.windows(2).map(|pair| [pair[0], pair[1]]);
    pairs.flat_map(|ends| [ends, ends.map(|end| end.moved(up))]).collect()
}

/// The points along the edge of the box between the lower walls across two axes, from end to end.
fn rim(pieces: &Pieces, [axis, across]: [usize; 2], along: usize) -> Vec<PeriodicVertex> {
    let on_edge = (0u32..).zip(&pieces.planes).filter(|(_, planes)| planes[axis] && planes[across]);
    let height = |point: &u32| pieces.positions[*point as usize][along];
    let mut points: Vec<u32> = on_edge.map(|(point, _)| point).collect();
    points.sort_by(|a, b| height(a).total_cmp(&height(b)));
    let mut line: Vec<PeriodicVertex> = points
        .into_iter()
        .map(|point| PeriodicVertex { vertex: point, translation: Translation::ZERO })
        .collect();
    let mut far = Translation::ZERO;
    far.0[along] = 1;
    // The lowest is a corner of the box, and also the highest, where these are one point.
    let first = line[0];
    if pieces.planes[first.vertex as usize][along] {
        line.push(first.moved(far));
    }
    line
}

/// In the plane: the place on a wall behind the piece that is widest as seen from there. Elsewhere nothing may stand in the way: a grain may be small.
fn behind_widest(pieces: &Pieces, axis: usize) -> Option<DVec3> {
    let along = 1 - axis;
    let ends = |piece: &Piece| [0, 1].map(|end| pieces.position(piece.corners[end])[along]);
    let all = pieces.pieces.iter().map(ends);
    let [start, end] = all.max_by(|a, b| (a[1] - a[0]).abs().total_cmp(&(b[1] - b[0]).abs()))?;
    let mut at = pieces.domain.lower();
    at[along] = start + OFF_MIDDLE * (end - start);
    Some(at)
}

/// What a wall that no boundary meets near a place belongs to: the side, toward the wall, of the first piece across it from there.
fn seen_from_wall(pieces: &Pieces, axis: usize, end: End, at: DVec3) -> Option<Side> {
    let others = [(axis + 1) % 3, (axis + 2) % 3];
    let height_and_side = |piece: &Piece| {
        let corners: Vec<DVec3> = piece.corners.iter().map(|corner| pieces.position(*corner) - at).collect();
        let normal = match corners.as_slice() {
            [start, end] => (*end - *start).cross(DVec3::Z),
            corners => (corners[1] - corners[0]).cross(corners[2] - corners[0]),
        };
        let next = corners.iter().cycle().skip(1);
        let turns = || {
            let turn = |(p, q): (&DVec3, &DVec3)| p[others[0]] * q[others[1]] - p[others[1]] * q[others[0]];
            corners.iter().zip(next.clone()).map(turn)
        };
        let is_across = match corners.as_slice() {
            [start, end] => {
                let along = 1 - axis;
                (start[along] > 0.0) != (end[along] > 0.0)
            }
            _ => turns().all(|turn| turn > 0.0) || turns().all(|turn| turn < 0.0),
        };
        let height = at[axis] + normal.dot(corners[0]) / normal[axis];
        let [below, above] = if normal[axis] > 0.0 { piece.sides } else { [piece.sides[1], piece.sides[0]] };
        (is_across && height.is_finite()).then_some((height, below, above))
    };
    let across = pieces.pieces.iter().filter_map(height_and_side);
    match end {
        End::Lower => across.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, below, _)| below),
        End::Upper => across.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, _, above)| above),
    }
}

/// The side in which each triangle lies, from those of the edges that have one on their left, or where there is none, as `look` finds.
fn fill(
    delaunay: &Delaunay,
    side_at: impl Fn([FixedVertexHandle; 2]) -> Option<Side>,
    look: impl Fn(Face) -> Option<Side>,
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
    let mut all = delaunay.inner_faces();
    loop {
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
        let Some(face) = all.next() else { return sides };
        if !sides.contains_key(&face.fix())
            && let Some(side) = look(face.fix())
        {
            sides.insert(face.fix(), side);
            next.push(face.fix());
        }
    }
}
