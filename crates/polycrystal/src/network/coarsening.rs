//! Fewer and better triangles for boundaries that many small polygons make up.

use glam::DVec3;
use voronoi::{Domain, PeriodicVertex, Side, Translation};

use crate::complex::ring::LARGEST_BEND;
use crate::mesh::fold::{LARGEST_FOLD, is_folded};
use crate::mesh::rounding;
use crate::mesh::triangle_quality::squared_sine;
use crate::network::corners::{edges, is_cycle, seen_from, translation_of, with_corner_moved};

/// Square of the sine of an angle (15 degrees): edges of thinner triangles are not made, but by a collapse that leaves no thinner ones than there were.
const GOOD_SQUARED_SINE: f64 = 0.067;

/// Cosines of angles between the normals of two triangles at an edge that are not made, nor made less: folds inside a boundary, and between
/// different ones angles below 26 degrees.
const LEAST_COSINES: [f64; 2] = [LARGEST_FOLD, -0.9];

/// Triangles of less height, in parts of the length below which edges collapse, may turn as they will.
const NARROW: f64 = 0.15;

/// Lines between points of four grains collapse when they are shorter than this part of other edges that do.
const SHORT_LINE: f64 = 0.4;

/// Triangles between grains, which share points along the lines where three and more meet. Each point is there once; in a periodic domain a corner of a
/// triangle is one moved by whole periods.
struct Coarsening<'a> {
    domain: &'a Domain,
    points: &'a [DVec3],
    /// Of each point: edges at it that are shorter collapse; none where it is to stay as it is.
    limits: &'a [Option<f64>],
    triangles: Vec<Option<[PeriodicVertex; 3]>>,
    /// What lies on both sides of each triangle, in the order of its winding.
    sides: &'a [[Side; 2]],
    /// The triangles at each point, in order.
    at_points: Vec<Vec<u32>>,
    /// Of each point: the last sweep in which a triangle at it changed.
    changed_in: Vec<u32>,
    /// Of collapses and flips in turn.
    sweep: u32,
}

/// The sweep before the first; one in which no first sweep takes an interest.
const BEFORE: u32 = 2;
const NEVER: u32 = 0;

/// A triangle at an edge, and by how much it is moved from there.
type AtEdge = (u32, Translation);

/// Triangles, and the corners that they are to have; none if they go.
type Changes = Vec<(u32, Option<[PeriodicVertex; 3]>)>;

/// What a point is part of, in the order of how free it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Boundary,
    /// With its two neighbours along the line, as seen from it.
    Line([PeriodicVertex; 2]),
    Node,
}

/// Collapses edges shorter than the limits of both ends, the shortest first: one end moves to the other. Then edges inside boundaries flip where that makes angles larger.
///
/// No point moves from the lines and walls that it is on, and each grain stays a closed surface, which touches itself nowhere. What is left of each triangle is at
/// its place; nothing is left of those that have collapsed.
pub(crate) fn coarsened(
    domain: &Domain,
    points: &[DVec3],
    limits: &[Option<f64>],
    triangles: &[[PeriodicVertex; 3]],
    sides: &[[Side; 2]],
) -> Vec<Option<[PeriodicVertex; 3]>> {
    if limits.iter().flatten().all(|limit| *limit == 0.0) {
        return triangles.iter().copied().map(Some).collect();
    }
    let triangles = triangles.iter().copied().map(Some).collect();
    coarsened_around(domain, points, limits, triangles, sides, &mut vec![true; points.len()])
}

/// As [`coarsened`], of the triangles that are there, but only around points that are marked. In the end those are marked around which triangles changed.
pub(crate) fn coarsened_around(
    domain: &Domain,
    points: &[DVec3],
    limits: &[Option<f64>],
    triangles: Vec<Option<[PeriodicVertex; 3]>>,
    sides: &[[Side; 2]],
    marked: &mut [bool],
) -> Vec<Option<[PeriodicVertex; 3]>> {
    let mut at_points = vec![Vec::new(); points.len()];
    for (triangle, corners) in (0u32..).zip(&triangles) {
        corners.iter().flatten().for_each(|corner| at_points[corner.vertex as usize].push(triangle));
    }
    let changed_in = marked.iter().map(|marked| if *marked { BEFORE } else { NEVER }).collect();
    let mut coarsening =
        Coarsening { domain, points, limits, triangles, sides, at_points, changed_in, sweep: BEFORE };
    // Each round leaves fewer triangles, or larger least angles: six rounds of 60 grains of 3:3:1 leave nothing to do.
    while coarsening.close_short_edges() + coarsening.flip_edges() > 0 {}
    let is_changed = coarsening.changed_in.iter().map(|sweep| *sweep > BEFORE);
    marked.iter_mut().zip(is_changed).for_each(|(marked, is_changed)| *marked = is_changed);
    coarsening.triangles
}

impl Coarsening<'_> {
    /// Collapses short edges, the shortest first, each at most once, and returns how many.
    fn close_short_edges(&mut self) -> usize {
        let all = self.triangles.iter().flatten().flat_map(|corners| edges(*corners));
        let mut short: Vec<(f64, [PeriodicVertex; 2])> = all
            .filter_map(|ends| {
                let length = self.length(ends);
                self.limit(ends).filter(|limit| length < *limit).map(|_| (length, ends))
            })
            .collect();
        short.sort_unstable_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
        short.dedup();
        self.sweep += 1;
        let mut collapsed = 0;
        for (_, [first, second]) in short {
            let ends = [first.vertex, second.vertex];
            let mut around = ends.iter().flat_map(|end| &self.at_points[*end as usize]);
            if !around.any(|triangle| self.is_new(self.corners(*triangle))) {
                continue;
            }
            let back =
                PeriodicVertex { vertex: first.vertex, translation: first.translation - second.translation };
            let mut ways = [(first.vertex, second), (second.vertex, back)].into_iter();
            collapsed += usize::from(ways.any(|(from, to)| self.collapse(from, to)));
        }
        collapsed
    }

    /// Whether a triangle at some corner changed since the last sweep of this kind began: where none did, what was refused then would be again.
    fn is_new(&self, corners: [PeriodicVertex; 3]) -> bool {
        corners.iter().any(|corner| self.changed_in[corner.vertex as usize] + 2 >= self.sweep)
    }

    fn place(&self, corner: PeriodicVertex) -> DVec3 {
        let place = self.points[corner.vertex as usize];
        if corner.translation == Translation::ZERO {
            return place;
        }
        place + corner.translation.vector(self.domain)
    }

    fn length(&self, [from, to]: [PeriodicVertex; 2]) -> f64 {
        self.place(from).distance(self.place(to))
    }

    /// Below what an edge is short; nothing where one of its ends stays as it is.
    fn limit(&self, ends: [PeriodicVertex; 2]) -> Option<f64> {
        let [from, to] = ends.map(|end| self.limits[end.vertex as usize]);
        Some(from?.min(to?))
    }

    /// The corners of a triangle that is there.
    fn corners(&self, triangle: u32) -> [PeriodicVertex; 3] {
        self.triangles[triangle as usize].expect("listed triangles are there")
    }

    /// The triangles at an edge.
    fn at_edge(&self, [from, to]: [PeriodicVertex; 2]) -> impl Iterator<Item = AtEdge> {
        self.at_points[from.vertex as usize].iter().filter_map(move |triangle| {
            let corners = self.corners(*triangle);
            if corners.iter().all(|corner| corner.vertex != to.vertex) {
                return None;
            }
            let moved = translation_of(corners, from.vertex) - from.translation;
            corners.contains(&to.moved(moved)).then_some((*triangle, moved))
        })
    }

    /// Whether an edge lies inside a boundary.
    fn is_inside(&self, ends: [PeriodicVertex; 2]) -> bool {
        let mut at_edge = self.at_edge(ends);
        let [Some(first), Some(second), None] = std::array::from_fn(|_| at_edge.next()) else { return false };
        self.are_in_one_boundary(&[first, second])
    }

    /// Whether the triangles at an edge are two, with the same on both sides.
    fn are_in_one_boundary(&self, at_edge: &[AtEdge]) -> bool {
        let [first, second] = at_edge else { return false };
        self.sides_from(first.0, first.1) == self.sides_from(second.0, second.1)
    }

    /// What lies beside a triangle, as seen from where all is moved.
    fn sides_from(&self, triangle: u32, moved: Translation) -> [Side; 2] {
        self.sides[triangle as usize].map(|side| side.moved(Translation::ZERO - moved))
    }

    fn part(&self, point: u32) -> Part {
        let own = PeriodicVertex { vertex: point, translation: Translation::ZERO };
        let mut sides = self.at_points[point as usize]
            .iter()
            .map(|triangle| self.sides_from(*triangle, translation_of(self.corners(*triangle), point)));
        // Most points are inside a boundary, which is quick to tell.
        let first = sides.next();
        if sides.all(|sides| Some(sides) == first) {
            return Part::Boundary;
        }
        let mut along = self.beside(point);
        along.retain(|other| !self.is_inside([own, *other]));
        match along[..] {
            [] => Part::Boundary,
            [before, after] => Part::Line([before, after]),
            _ => Part::Node,
        }
    }

    /// The points that share an edge with one, in order, as seen from there.
    fn beside(&self, point: u32) -> Vec<PeriodicVertex> {
        let triangles = self.at_points[point as usize].iter();
        let corners = triangles.flat_map(|triangle| seen_from(self.corners(*triangle), point));
        let mut others: Vec<PeriodicVertex> = corners.filter(|corner| corner.vertex != point).collect();
        others.sort_unstable();
        others.dedup();
        others
    }

    /// Moves a point along an edge to its other end, as seen from the point, if that is allowed and good; returns whether.
    fn collapse(&mut self, from: u32, to: PeriodicVertex) -> bool {
        let ends = [PeriodicVertex { vertex: from, translation: Translation::ZERO }, to];
        let at_edge: Vec<AtEdge> = self.at_edge(ends).collect();
        if at_edge.is_empty() {
            return false;
        }
        let collapses = |triangle: &u32| at_edge.iter().any(|(own, _)| own == triangle);
        let moved: Vec<(u32, [PeriodicVertex; 3])> = self.at_points[from as usize]
            .iter()
            .filter(|triangle| !collapses(triangle))
            .map(|triangle| (*triangle, with_corner_moved(self.corners(*triangle), from, to)))
            .collect();
        // The cheapest first.
        if !self.is_good(&moved, ends) {
            return false;
        }
        let part = self.part(from);
        let stays_closed = || {
            // A triangle in place of three may be there already.
            let is_link_enough = part == Part::Boundary && moved.len() > 1;
            is_link_enough && self.is_link_of_edge(ends, at_edge.len())
                || !is_link_enough && self.stays_closed(&moved, to.vertex, collapses)
        };
        if !self.may_collapse(part, ends) || !stays_closed() {
            return false;
        }
        let gone = at_edge.iter().map(|(triangle, _)| (*triangle, None));
        let moved = moved.into_iter().map(|(triangle, corners)| (triangle, Some(corners)));
        self.change(gone.chain(moved).collect())
    }

    /// Whether the first end of an edge, which is such a part, may go to the other for what both are part of.
    fn may_collapse(&self, part: Part, ends: [PeriodicVertex; 2]) -> bool {
        let [from, to] = ends;
        match part {
            Part::Boundary => true,
            Part::Line(along) => along.contains(&to),
            Part::Node => {
                let limit = self.limit(ends).map_or(0.0, |limit| SHORT_LINE * limit);
                self.length(ends) < limit
                    && !self.is_inside(ends)
                    && self.part(to.vertex) == Part::Node
                    && self.keeps_walls(from.vertex, to.vertex)
            }
        }
    }

    /// Gives triangles other corners, or takes them away, unless boundaries fold by that; returns whether.
    fn change(&mut self, changed: Changes) -> bool {
        let triangles: Vec<u32> = changed.iter().map(|(triangle, _)| *triangle).collect();
        let old = self.set_all(changed);
        let after = self.sharpest(&triangles);
        let is_above = |least: [f64; 2]| after.iter().zip(least).all(|(after, least)| *after >= least);
        if !is_above(LEAST_COSINES) {
            let new = self.set_all(old.clone());
            let before = self.sharpest(&triangles);
            let least = [0, 1].map(|place| before[place].min(LEAST_COSINES[place]) - rounding::OF_COSINES);
            if !is_above(least) {
                return false;
            }
            self.set_all(new);
        }
        let new = triangles.iter().filter_map(|triangle| self.triangles[*triangle as usize]);
        for corner in old.into_iter().filter_map(|(_, corners)| corners).chain(new).flatten() {
            self.changed_in[corner.vertex as usize] = self.sweep;
        }
        true
    }

    /// Gives triangles other corners, and returns the ones they had.
    fn set_all(&mut self, all: Changes) -> Changes {
        all.into_iter().map(|(triangle, corners)| (triangle, self.set(triangle, corners))).collect()
    }

    /// Gives a triangle other corners, and returns the ones it had.
    fn set(&mut self, triangle: u32, corners: Option<[PeriodicVertex; 3]>) -> Option<[PeriodicVertex; 3]> {
        let old = std::mem::replace(&mut self.triangles[triangle as usize], corners);
        for corner in old.iter().flatten() {
            self.at_points[corner.vertex as usize].retain(|other| *other != triangle);
        }
        for corner in corners.iter().flatten() {
            let list = &mut self.at_points[corner.vertex as usize];
            list.insert(list.partition_point(|other| *other < triangle), triangle);
        }
        old
    }

    /// How flat boundaries are at the edges of some triangles, and how far apart different ones: the least cosine of the angle between the normals of two triangles
    /// that share an edge, inside a boundary and between two.
    fn sharpest(&self, triangles: &[u32]) -> [f64; 2] {
        let mut least: [f64; 2] = [1.0; 2];
        let mut around: Vec<AtEdge> = Vec::new();
        for triangle in triangles {
            let Some(corners) = self.triangles[*triangle as usize] else { continue };
            for ends in edges(corners) {
                around.clear();
                around.extend(self.at_edge(ends));
                let least = &mut least[usize::from(!self.are_in_one_boundary(&around))];
                let Some(own) = around.iter().find(|other| other.0 == *triangle) else { continue };
                let own = self.normal_from(ends, *own);
                for other in &around {
                    // Those that are in the list and lower have met this one.
                    if other.0 != *triangle && !(other.0 < *triangle && triangles.contains(&other.0)) {
                        let other = self.normal_from(ends, *other);
                        let product = (own.length_squared() * other.length_squared()).sqrt();
                        *least = least.min(if product > 0.0 { -own.dot(other) / product } else { 0.0 });
                    }
                }
            }
        }
        least
    }

    /// The normal of a triangle at an edge as that runs.
    fn normal_from(&self, ends: [PeriodicVertex; 2], (triangle, moved): AtEdge) -> DVec3 {
        let ends = ends.map(|end| end.moved(moved));
        let tip = self.corners(triangle).into_iter().find(|corner| !ends.contains(corner)).unwrap_or(ends[0]);
        self.normal([ends[0], ends[1], tip])
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

    /// Whether triangles stay as they lie, and are not thin, when a corner of them moves along an edge.
    fn is_good(&self, moved: &[(u32, [PeriodicVertex; 3])], ends: [PeriodicVertex; 2]) -> bool {
        let thinnest = |all: &mut dyn Iterator<Item = [PeriodicVertex; 3]>| {
            all.map(|corners| self.squared_sine(corners)).fold(f64::INFINITY, f64::min)
        };
        let after = thinnest(&mut moved.iter().map(|(_, corners)| *corners));
        let before =
            || self.at_points[ends[0].vertex as usize].iter().map(|triangle| self.corners(*triangle));
        if after <= GOOD_SQUARED_SINE && after <= thinnest(&mut before()) {
            return false;
        }
        let limit = self.limit(ends).unwrap_or(0.0);
        moved.iter().all(|(triangle, new)| {
            let old = self.corners(*triangle);
            self.lies_alike(old, *new) || self.is_narrow(old, limit)
        })
    }

    fn lies_alike(&self, one: [PeriodicVertex; 3], other: [PeriodicVertex; 3]) -> bool {
        let [one, other] = [one, other].map(|corners| self.normal(corners));
        !is_folded([one, other], LARGEST_BEND)
    }

    /// Whether a triangle is so narrow that how it lies says nothing: part of a step between two faces.
    fn is_narrow(&self, corners: [PeriodicVertex; 3], limit: f64) -> bool {
        let longest = edges(corners).map(|ends| self.length(ends)).fold(0.0, f64::max);
        self.normal(corners).length() < NARROW * limit * longest
    }

    /// Twice the area, along the normal.
    fn normal(&self, corners: [PeriodicVertex; 3]) -> DVec3 {
        let [a, b, c] = corners.map(|corner| self.place(corner));
        (b - a).cross(c - a)
    }

    /// The square of the sine of a triangle's least angle.
    fn squared_sine(&self, corners: [PeriodicVertex; 3]) -> f64 {
        squared_sine(corners.map(|corner| self.place(corner)))
    }

    /// Whether the points beside both ends of an edge are across from it in its triangles alone, so many: then an end inside a boundary may go to the other, and surfaces
    /// that touch themselves nowhere stay as they are (Dey and others, Topology preserving edge contraction, 1999).
    fn is_link_of_edge(&self, [from, to]: [PeriodicVertex; 2], triangles: usize) -> bool {
        let there = self.beside(to.vertex);
        let seen = |other: &PeriodicVertex| other.moved(Translation::ZERO - to.translation);
        let common =
            self.beside(from.vertex).iter().filter(|other| there.binary_search(&seen(other)).is_ok()).count();
        common == triangles
    }

    /// Whether around the end of an edge that collapses each grain's surface is still one closed fan, and no two triangles have the same corners.
    fn stays_closed(
        &self,
        moved: &[(u32, [PeriodicVertex; 3])],
        to: u32,
        collapses: impl Fn(&u32) -> bool,
    ) -> bool {
        let mut rims: Vec<(Side, [PeriodicVertex; 2])> = Vec::new();
        let mut all: Vec<[PeriodicVertex; 3]> = Vec::new();
        let there = self.at_points[to as usize].iter().filter(|triangle| !collapses(triangle));
        let there = there.map(|triangle| (*triangle, self.corners(*triangle)));
        for (triangle, corners) in moved.iter().copied().chain(there) {
            let mut seen = seen_from(corners, to);
            let place = seen.iter().position(|corner| corner.vertex == to).unwrap_or(0);
            let rim = [seen[(place + 1) % 3], seen[(place + 2) % 3]];
            if rim.iter().any(|corner| corner.vertex == to) {
                return false;
            }
            let sides = self.sides_from(triangle, translation_of(corners, to)).into_iter();
            rims.extend(sides.filter(|side| !matches!(side, Side::Wall(_))).map(|side| (side, rim)));
            seen.sort_unstable();
            all.push(seen);
        }
        all.sort_unstable();
        rims.sort_unstable();
        let mut rims = rims.chunk_by(|one, other| one.0 == other.0);
        // A boundary that collapses wholly leaves its grains to meet in a line.
        all.windows(2).all(|pair| pair[0] != pair[1]) && rims.all(is_cycle)
    }

    /// Flips edges inside boundaries where that takes an ear away or makes the least angle of the two triangles larger, and makes no ear. Returns how many.
    fn flip_edges(&mut self) -> usize {
        self.sweep += 1;
        let mut flipped = 0;
        for triangle in 0..self.triangles.len() {
            let Some(corners) = self.triangles[triangle].filter(|corners| self.is_new(*corners)) else {
                continue;
            };
            let flip = edges(corners).find(|ends| self.flip(*ends));
            flipped += usize::from(flip.is_some());
        }
        flipped
    }

    /// Whether a triangle's two edges at a corner are of one line: where that becomes smooth, the triangle has no area.
    fn is_ear(&self, tip: PeriodicVertex, others: [PeriodicVertex; 2]) -> bool {
        others.iter().all(|other| !self.is_inside([tip, *other]))
            && matches!(self.part(tip.vertex), Part::Line(_))
    }

    fn flip(&mut self, ends: [PeriodicVertex; 2]) -> bool {
        if self.limit(ends).is_none() || !self.is_inside(ends) {
            return false;
        }
        let [first, second] = self.at_edge(ends).collect::<Vec<_>>()[..] else { return false };
        // Both as seen from the first.
        let ends = ends.map(|end| end.moved(first.1));
        let apart = second.1 - first.1;
        let one = self.corners(first.0);
        let other = self.corners(second.0).map(|corner| corner.moved(Translation::ZERO - apart));
        let start = one.iter().position(|corner| !ends.contains(corner)).unwrap_or(0);
        let [top, from, to] = [0, 1, 2].map(|step| one[(start + step) % 3]);
        let Some(bottom) = other.into_iter().find(|corner| !ends.contains(corner)) else { return false };
        if top.vertex == bottom.vertex || self.at_edge([top, bottom]).next().is_some() {
            return false;
        }
        let (left, right) = ([top, from, bottom], [top, bottom, to]);
        let [before, after] = [[one, other], [left, right]].map(|pair| {
            pair.into_iter().map(|corners| self.squared_sine(corners)).fold(f64::INFINITY, f64::min)
        });
        let is_alike = |new| self.lies_alike(one, new) && self.lies_alike(other, new);
        let is_wider = after > before * (1.0 + rounding::OF_COSINES);
        let has_ear = |tips: [PeriodicVertex; 2], beside: [PeriodicVertex; 2]| {
            tips.iter().any(|tip| self.is_ear(*tip, beside))
        };
        if !is_wider && !has_ear([top, bottom], [from, to])
            || !is_alike(left)
            || !is_alike(right)
            || has_ear([from, to], [top, bottom])
        {
            return false;
        }
        let right = right.map(|corner| corner.moved(apart));
        self.change(vec![(first.0, Some(left)), (second.0, Some(right))])
    }
}
