//! Fewer and better triangles for boundaries that many small polygons make up.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use glam::DVec3;
use voronoi::Side;

/// How much a triangle may turn when one of its corners moves along an edge, or an edge of it flips, as the cosine of the angle: 60 degrees.
const LEAST_COSINE: f64 = 0.5;

/// Edges of thinner triangles than this, in degrees, are not made, but by a collapse that leaves no thinner ones than there were.
const GOOD_ANGLE: f64 = 15.0;

/// Cosines of angles between the normals of two triangles at an edge that are not made, nor made less: inside a boundary folds by more than 72 degrees, between
/// different ones angles below 26.
const LEAST_COSINES: [f64; 2] = [0.3, -0.9];

/// Triangles of less height, in parts of the length below which edges close, may turn as they will.
const NARROW: f64 = 0.15;

/// Lines between points of four grains close when they are shorter than this part of other edges that do.
const SHORT_LINE: f64 = 0.4;

/// How often all edges are looked at, unless there is nothing left to do before. No experiment chose it.
const ROUNDS: usize = 4;

/// Triangles between grains, which share points along the lines where three and more meet.
pub(super) struct Coarsening<'a> {
    points: &'a [DVec3],
    /// Of each point: edges at it that are shorter close; none where it is to stay as it is.
    limits: &'a [Option<f64>],
    triangles: Vec<Option<[u32; 3]>>,
    sides: &'a [[Side; 2]],
    /// The triangles at each point, in order.
    at_points: Vec<Vec<u32>>,
}

/// What a point is part of, in the order of how free it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Boundary,
    /// With its two neighbours along the line.
    Line([u32; 2]),
    Node,
}

/// Closes edges shorter than the limits of both ends, the shortest first: one end moves to the other. Then edges inside boundaries flip where that makes angles larger.
///
/// No point moves from the lines and walls that it is on, and each grain stays a closed surface, which touches itself nowhere. What is left of each triangle is at
/// its place; nothing is left of those that have closed.
pub(super) fn coarsened(
    points: &[DVec3],
    limits: &[Option<f64>],
    triangles: &[[u32; 3]],
    sides: &[[Side; 2]],
) -> Vec<Option<[u32; 3]>> {
    if limits.iter().flatten().all(|limit| *limit == 0.0) {
        return triangles.iter().copied().map(Some).collect();
    }
    let mut at_points = vec![Vec::new(); points.len()];
    for (triangle, corners) in (0u32..).zip(triangles) {
        corners.iter().for_each(|corner| at_points[*corner as usize].push(triangle));
    }
    let triangles = triangles.iter().copied().map(Some).collect();
    let mut coarsening = Coarsening { points, limits, triangles, sides, at_points };
    for _ in 0..ROUNDS {
        let closed = coarsening.close_short_edges();
        let flipped = coarsening.flip_edges();
        if closed + flipped == 0 {
            break;
        }
    }
    coarsening.triangles
}

impl Coarsening<'_> {
    /// Closes short edges, and returns how many.
    fn close_short_edges(&mut self) -> usize {
        // Lengths are positive, so their bits are in order.
        let mut queue: BinaryHeap<Reverse<(u64, [u32; 2])>> = BinaryHeap::new();
        let push = |queue: &mut BinaryHeap<_>, own: &Self, ends: [u32; 2]| {
            let length = own.length(ends);
            if own.limit(ends).is_some_and(|limit| length < limit) {
                queue.push(Reverse((length.to_bits(), ends)));
            }
        };
        for corners in self.triangles.iter().flatten() {
            edges(*corners).for_each(|ends| push(&mut queue, self, ends));
        }
        let mut closed = 0;
        while let Some(Reverse((_, ends))) = queue.pop() {
            let [first, second] = ends;
            let moved =
                [[first, second], [second, first]].into_iter().find(|[from, to]| self.close(*from, *to));
            if let Some([_, to]) = moved {
                closed += 1;
                for triangle in &self.at_points[to as usize] {
                    let corners = self.triangles[*triangle as usize].expect("listed triangles are there");
                    edges(corners)
                        .filter(|ends| ends.contains(&to))
                        .for_each(|ends| push(&mut queue, self, ends));
                }
            }
        }
        closed
    }

    fn length(&self, [from, to]: [u32; 2]) -> f64 {
        self.points[from as usize].distance(self.points[to as usize])
    }

    /// Below what an edge is short; nothing where one of its ends stays as it is.
    fn limit(&self, [from, to]: [u32; 2]) -> Option<f64> {
        Some(self.limits[from as usize]?.min(self.limits[to as usize]?))
    }

    /// The triangles at an edge.
    fn at_edge(&self, [from, to]: [u32; 2]) -> Vec<u32> {
        let has_end = |triangle: &&u32| {
            self.triangles[**triangle as usize].is_some_and(|corners| corners.contains(&to))
        };
        self.at_points[from as usize].iter().filter(has_end).copied().collect()
    }

    /// Whether an edge lies inside a boundary.
    fn is_inside(&self, at_edge: &[u32]) -> bool {
        let [first, second] = at_edge[..] else { return false };
        self.sides[first as usize] == self.sides[second as usize]
    }

    fn part(&self, point: u32) -> Part {
        let mut along: Vec<u32> = Vec::new();
        for other in self.beside(point) {
            if !self.is_inside(&self.at_edge([point, other])) {
                along.push(other);
            }
        }
        match along[..] {
            [] => Part::Boundary,
            [before, after] => Part::Line([before, after]),
            _ => Part::Node,
        }
    }

    /// The points that share an edge with one, in order.
    fn beside(&self, point: u32) -> Vec<u32> {
        let corners =
            self.at_points[point as usize].iter().filter_map(|triangle| self.triangles[*triangle as usize]);
        let mut others: Vec<u32> = corners.flatten().filter(|corner| *corner != point).collect();
        others.sort_unstable();
        others.dedup();
        others
    }

    /// Moves a point along an edge to its other end, if that is allowed and good; returns whether.
    fn close(&mut self, from: u32, to: u32) -> bool {
        let at_edge = self.at_edge([from, to]);
        if at_edge.is_empty() {
            return false;
        }
        let is_allowed = match self.part(from) {
            Part::Boundary => true,
            Part::Line(ends) => ends.contains(&to),
            Part::Node => {
                let limit = self.limit([from, to]).map_or(0.0, |limit| SHORT_LINE * limit);
                self.part(to) == Part::Node
                    && !self.is_inside(&at_edge)
                    && self.length([from, to]) < limit
                    && self.keeps_walls(from, to)
            }
        };
        let moved: Vec<u32> = self.at_points[from as usize]
            .iter()
            .filter(|triangle| !at_edge.contains(triangle))
            .copied()
            .collect();
        if !is_allowed || !self.is_good(&moved, from, to) || !self.stays_closed(&moved, &at_edge, to, from) {
            return false;
        }
        let around: Vec<u32> =
            [from, to].iter().flat_map(|end| self.at_points[*end as usize].clone()).collect();
        let before = self.sharpest(&around);
        let mut gone = Vec::new();
        for triangle in &at_edge {
            let corners = self.triangles[*triangle as usize].take().expect("listed triangles are there");
            for corner in corners {
                self.at_points[corner as usize].retain(|other| other != triangle);
            }
            gone.push(corners);
        }
        for triangle in &moved {
            if let Some(corners) = &mut self.triangles[*triangle as usize] {
                corners.iter_mut().filter(|corner| **corner == from).for_each(|corner| *corner = to);
            }
        }
        let kept = std::mem::take(&mut self.at_points[from as usize]);
        self.at_points[to as usize].extend(&moved);
        self.at_points[to as usize].sort_unstable();
        let after = self.sharpest(&self.at_points[to as usize].clone());
        if Self::stays_flat(before, after) {
            return true;
        }
        // Back again.
        self.at_points[to as usize].retain(|triangle| moved.binary_search(triangle).is_err());
        for triangle in &moved {
            if let Some(corners) = &mut self.triangles[*triangle as usize] {
                corners.iter_mut().filter(|corner| **corner == to).for_each(|corner| *corner = from);
            }
        }
        self.at_points[from as usize] = kept;
        for (triangle, corners) in at_edge.iter().zip(gone) {
            self.triangles[*triangle as usize] = Some(corners);
            for corner in corners {
                let list = &mut self.at_points[corner as usize];
                list.push(*triangle);
                list.sort_unstable();
            }
        }
        false
    }

    /// How flat boundaries are at the edges of some triangles, and how far apart different ones: the least cosine of the angle between the normals of two triangles
    /// that share an edge, inside a boundary and between two.
    fn sharpest(&self, triangles: &[u32]) -> [f64; 2] {
        let mut least: [f64; 2] = [1.0; 2];
        for triangle in triangles {
            let Some(corners) = self.triangles[*triangle as usize] else { continue };
            for ends in edges(corners) {
                let at_edge = self.at_edge(ends);
                let least = &mut least[usize::from(!self.is_inside(&at_edge))];
                let own = self.away_from(ends, *triangle);
                for other in at_edge.iter().filter(|other| *other != triangle) {
                    *least = least.min(-own.dot(self.away_from(ends, *other)));
                }
            }
        }
        least
    }

    /// The direction in the plane of a triangle that leads from an edge of it to its third corner at a right angle.
    fn away_from(&self, ends: [u32; 2], triangle: u32) -> DVec3 {
        let corners = self.triangles[triangle as usize].expect("listed triangles are there");
        let tip = corners.into_iter().find(|corner| !ends.contains(corner)).unwrap_or(ends[0]);
        let [from, to, tip] = [ends[0], ends[1], tip].map(|point| self.points[point as usize]);
        (tip - from).reject_from(to - from).normalize_or_zero()
    }

    /// Whether boundaries are nowhere folded that were not before, nor nearer to each other.
    fn stays_flat(before: [f64; 2], after: [f64; 2]) -> bool {
        before
            .into_iter()
            .zip(after)
            .zip(LEAST_COSINES)
            .all(|((before, after), least)| after >= before.min(least))
    }

    /// Whether a point may be where another is for all that the walls ask.
    fn keeps_walls(&self, from: u32, to: u32) -> bool {
        let walls = |point: u32| {
            let sides =
                self.at_points[point as usize].iter().flat_map(|triangle| self.sides[*triangle as usize]);
            let mut walls: Vec<Side> = sides.filter(|side| matches!(side, Side::Wall(_))).collect();
            walls.sort_unstable();
            walls.dedup();
            walls
        };
        let there = walls(to);
        walls(from).iter().all(|wall| there.contains(wall))
    }

    /// Whether triangles stay as they lie, and are not thin, when a corner of them moves to another point.
    fn is_good(&self, moved: &[u32], from: u32, to: u32) -> bool {
        let before =
            self.at_points[from as usize].iter().filter_map(|triangle| self.triangles[*triangle as usize]);
        let thinnest = before.map(|corners| self.least_angle(corners)).fold(f64::INFINITY, f64::min);
        let limit = self.limit([from, to]).unwrap_or(0.0);
        moved.iter().all(|triangle| {
            let old = self.triangles[*triangle as usize].expect("listed triangles are there");
            let new = old.map(|corner| if corner == from { to } else { corner });
            let is_alike = self.lies_alike(old, new) || self.is_narrow(old, limit);
            self.least_angle(new) > thinnest.min(GOOD_ANGLE) && is_alike
        })
    }

    fn lies_alike(&self, one: [u32; 3], other: [u32; 3]) -> bool {
        let [one, other] = [one, other].map(|corners| self.normal(corners));
        one.dot(other) > LEAST_COSINE * one.length() * other.length()
    }

    /// Whether a triangle is so narrow that how it lies says nothing: part of a step between two faces.
    fn is_narrow(&self, corners: [u32; 3], limit: f64) -> bool {
        let longest = edges(corners).map(|ends| self.length(ends)).fold(0.0, f64::max);
        self.normal(corners).length() < NARROW * limit * longest
    }

    /// Twice the area, along the normal.
    fn normal(&self, corners: [u32; 3]) -> DVec3 {
        let [a, b, c] = corners.map(|corner| self.points[corner as usize]);
        (b - a).cross(c - a)
    }

    /// In degrees.
    fn least_angle(&self, corners: [u32; 3]) -> f64 {
        let places = corners.map(|corner| self.points[corner as usize]);
        let angle = |corner: usize| {
            let [a, b] = [1, 2].map(|step| places[(corner + step) % 3] - places[corner]);
            a.cross(b).length().atan2(a.dot(b)).to_degrees()
        };
        angle(0).min(angle(1)).min(angle(2))
    }

    /// Whether around the end of an edge that closes each grain's surface is still one closed fan.
    fn stays_closed(&self, moved: &[u32], at_edge: &[u32], to: u32, from: u32) -> bool {
        let mut rims: BTreeMap<Side, Vec<[u32; 2]>> = BTreeMap::new();
        let there = self.at_points[to as usize].iter().filter(|triangle| !at_edge.contains(triangle));
        for triangle in moved.iter().chain(there) {
            let corners = self.triangles[*triangle as usize].expect("listed triangles are there");
            let corners = corners.map(|corner| if corner == from { to } else { corner });
            let place = corners.iter().position(|corner| *corner == to).unwrap_or(0);
            let rim = [corners[(place + 1) % 3], corners[(place + 2) % 3]];
            if rim.contains(&to) {
                return false;
            }
            for side in
                self.sides[*triangle as usize].into_iter().filter(|side| !matches!(side, Side::Wall(_)))
            {
                rims.entry(side).or_default().push(rim);
            }
        }
        // A boundary that closes wholly leaves its grains to meet in a line.
        rims.values().all(|rim| is_cycle(rim)) && !self.doubles(moved, from, to)
    }

    /// Whether two triangles would have the same corners.
    fn doubles(&self, moved: &[u32], from: u32, to: u32) -> bool {
        let sorted = |mut corners: [u32; 3]| {
            corners.sort_unstable();
            corners
        };
        let there: Vec<[u32; 3]> = self.at_points[to as usize]
            .iter()
            .filter_map(|triangle| self.triangles[*triangle as usize])
            .map(sorted)
            .collect();
        moved.iter().filter_map(|triangle| self.triangles[*triangle as usize]).any(|corners| {
            there.contains(&sorted(corners.map(|corner| if corner == from { to } else { corner })))
        })
    }

    /// Flips edges inside boundaries that make the least angle of their two triangles larger, and returns how many.
    fn flip_edges(&mut self) -> usize {
        let mut flipped = 0;
        for triangle in 0..self.triangles.len() {
            let Some(corners) = self.triangles[triangle] else { continue };
            let flip = edges(corners).find(|ends| self.flip(*ends));
            flipped += usize::from(flip.is_some());
        }
        flipped
    }

    fn flip(&mut self, ends: [u32; 2]) -> bool {
        let at_edge = self.at_edge(ends);
        let [first, second] = at_edge[..] else { return false };
        if !self.is_inside(&at_edge) || ends.iter().any(|end| self.limits[*end as usize].is_none()) {
            return false;
        }
        let [one, other] =
            [first, second].map(|triangle| self.triangles[triangle as usize].expect("it is there"));
        let start = one.iter().position(|corner| !ends.contains(corner)).unwrap_or(0);
        let [top, from, to] = [0, 1, 2].map(|step| one[(start + step) % 3]);
        let Some(bottom) = other.into_iter().find(|corner| !ends.contains(corner)) else { return false };
        if top == bottom || !self.at_edge([top, bottom]).is_empty() {
            return false;
        }
        let (left, right) = ([top, from, bottom], [top, bottom, to]);
        let [before, after] = [[one, other], [left, right]].map(|pair| {
            pair.into_iter().map(|corners| self.least_angle(corners)).fold(f64::INFINITY, f64::min)
        });
        let is_alike = |new| self.lies_alike(one, new) && self.lies_alike(other, new);
        // Some more, so that flips end.
        if after < before + 0.01 || !is_alike(left) || !is_alike(right) {
            return false;
        }
        let sharpest = self.sharpest(&at_edge);
        self.triangles[first as usize] = Some(left);
        self.triangles[second as usize] = Some(right);
        self.at_points[to as usize].retain(|triangle| *triangle != first);
        self.at_points[from as usize].retain(|triangle| *triangle != second);
        for (point, triangle) in [(top, second), (bottom, first)] {
            let list = &mut self.at_points[point as usize];
            list.push(triangle);
            list.sort_unstable();
        }
        if Self::stays_flat(sharpest, self.sharpest(&at_edge)) {
            return true;
        }
        // Back again.
        self.triangles[first as usize] = Some(one);
        self.triangles[second as usize] = Some(other);
        for (point, triangle) in [(top, second), (bottom, first)] {
            self.at_points[point as usize].retain(|own| *own != triangle);
        }
        for (point, triangle) in [(to, first), (from, second)] {
            let list = &mut self.at_points[point as usize];
            list.push(triangle);
            list.sort_unstable();
        }
        false
    }
}

/// The edges of a triangle, smaller end first.
fn edges([a, b, c]: [u32; 3]) -> impl Iterator<Item = [u32; 2]> {
    [[a, b], [b, c], [c, a]].into_iter().map(|[from, to]| [from.min(to), from.max(to)])
}

/// Whether segments make up one closed line that passes no point twice.
fn is_cycle(segments: &[[u32; 2]]) -> bool {
    let mut ends: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for [from, to] in segments {
        ends.entry(*from).or_default().push(*to);
        ends.entry(*to).or_default().push(*from);
    }
    if segments.len() < 3 || ends.values().any(|others| others.len() != 2) {
        return false;
    }
    let start = segments[0][0];
    let (mut before, mut at, mut count) = (start, ends[&start][0], 1);
    while at != start {
        let others = &ends[&at];
        let next = if others[0] == before { others[1] } else { others[0] };
        (before, at) = (at, next);
        count += 1;
    }
    count == ends.len()
}

/// The same in the plane: points inside a boundary go where a segment at them is shorter than the limits of both ends. Where boundaries meet nothing moves.
pub(super) fn coarsened_segments(
    points: &[DVec3],
    limits: &[Option<f64>],
    segments: &[[u32; 2]],
    sides: &[[Side; 2]],
) -> Vec<Option<[u32; 2]>> {
    let mut at_points = vec![Vec::new(); points.len()];
    for (segment, ends) in (0u32..).zip(segments) {
        ends.iter().for_each(|end| at_points[*end as usize].push(segment));
    }
    let mut left: Vec<Option<[u32; 2]>> = segments.iter().copied().map(Some).collect();
    let length = |[from, to]: [u32; 2]| points[from as usize].distance(points[to as usize]);
    let mut queue: BinaryHeap<Reverse<(u64, u32)>> = BinaryHeap::new();
    let push = |queue: &mut BinaryHeap<_>, segment: u32, ends: [u32; 2]| {
        let [from, to] = ends.map(|end| limits[end as usize]);
        if from.zip(to).is_some_and(|(from, to)| length(ends) < from.min(to)) {
            queue.push(Reverse((length(ends).to_bits(), segment)));
        }
    };
    (0u32..).zip(segments).for_each(|(segment, ends)| push(&mut queue, segment, *ends));
    while let Some(Reverse((bits, segment))) = queue.pop() {
        let Some(ends) = left[segment as usize].filter(|ends| length(*ends).to_bits() == bits) else {
            continue;
        };
        let [first, second] = ends;
        for [from, to] in [[first, second], [second, first]] {
            let [one, other] = at_points[from as usize][..] else { continue };
            let next = if one == segment { other } else { one };
            let Some(beyond) = left[next as usize] else { continue };
            let far = if beyond[0] == from { beyond[1] } else { beyond[0] };
            let is_beside = |segment: &u32| left[*segment as usize].is_some_and(|ends| ends.contains(&to));
            let meets = far == to || at_points[far as usize].iter().any(is_beside);
            if sides[segment as usize] != sides[next as usize] || meets {
                continue;
            }
            left[segment as usize] = None;
            let moved = beyond.map(|end| if end == from { to } else { end });
            left[next as usize] = Some(moved);
            at_points[from as usize].clear();
            at_points[to as usize].iter_mut().filter(|own| **own == segment).for_each(|own| *own = next);
            push(&mut queue, next, moved);
            break;
        }
    }
    left
}
