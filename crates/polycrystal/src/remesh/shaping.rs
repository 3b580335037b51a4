//! Triangles of the size asked for, as regular as they can be, within one boundary.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_1_SQRT_2;

use cancellation::check_cancelled;
use glam::DVec3;

use crate::remesh::outline::Outlined;
use crate::remesh::patch::{Patch, edges, least_angle};
use crate::remesh::reference::{Foot, Reference};
use crate::remesh::torus::Moved;
use crate::remesh::tuning::RemeshTuning;

/// By how much the cosine of the least angle must be better for a flip, or a measure for a motion: so both end.
pub(super) const BETTER: f64 = 1e-4;

/// Sweeps over all edges within a round, each of which ends earlier where nothing happens.
const SWEEPS: usize = 4;

/// Steps in which a better place is looked for, in units of the size there, and the directions, along two axes.
const SEARCH_STEPS: [f64; 4] = [0.24, 0.12, 0.06, 0.02];
const SEARCH_DIRECTIONS: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [0.0, 1.0],
    [-FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [-1.0, 0.0],
    [-FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
    [0.0, -1.0],
    [FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
];

/// A boundary, its smooth surface, and at each point what that is like there.
pub(crate) struct Shaping<'a> {
    pub(crate) patch: Patch,
    reference: Reference,
    feet: Vec<Foot>,
    pub(super) tuning: &'a RemeshTuning,
    /// Whether edges may come to be between points of the outline.
    joins_outline: bool,
}

impl<'a> Shaping<'a> {
    pub(crate) fn new(patch: Patch, reference: Reference, near: &[u32], tuning: &'a RemeshTuning) -> Self {
        let feet = patch.points.iter().zip(near).map(|(point, near)| reference.foot(*point, *near)).collect();
        Self { patch, reference, feet, tuning, joins_outline: true }
    }

    /// Makes triangles of the size asked for.
    pub(crate) fn shape(&mut self) {
        self.split_joints();
        for _ in 0..self.tuning.rounds {
            check_cancelled();
            let has_changed = [self.split_long(), self.close_short(), self.flip()];
            self.relax();
            if has_changed == [false; 3] {
                break;
            }
        }
        self.widen();
        self.unfold();
    }

    /// Halves edges between points of the outline, which lie at other boundaries too; no other such edges come to be.
    pub(crate) fn separate(&mut self, edges: &[[u32; 2]]) {
        self.joins_outline = false;
        edges.iter().for_each(|edge| {
            self.halve(*edge);
        });
        self.flip();
        self.relax();
        self.widen();
        self.unfold();
    }

    /// Gives a lone triangle a point of its own.
    pub(crate) fn add_middle(&mut self) {
        let Some(corners) = self.patch.all().next() else { return };
        let middle = self.patch.places(corners).iter().sum::<DVec3>() / 3.0;
        let foot = self.reference.foot(middle, self.feet[corners[0] as usize].triangle);
        let triangle = self.patch.star(corners[0])[0];
        self.patch.split_triangle(triangle, foot.place);
        self.feet.push(foot);
    }

    /// Edges that join two points of one line.
    fn split_joints(&mut self) {
        for edge in self.patch.inner_edges() {
            if !self.patch.may_join(edge) {
                self.halve(edge);
            }
        }
    }

    fn size(&self, [from, to]: [u32; 2]) -> f64 {
        0.5 * (self.feet[from as usize].size + self.feet[to as usize].size)
    }

    fn may_join(&self, ends: [u32; 2]) -> bool {
        self.patch.may_join(ends)
            && (self.joins_outline || ends.iter().any(|end| !self.patch.is_outline(*end)))
    }

    fn halve(&mut self, edge: [u32; 2]) {
        let middle = self.patch.place(edge[0]).midpoint(self.patch.place(edge[1]));
        let foot = self.reference.foot(middle, self.feet[edge[0] as usize].triangle);
        self.patch.split(edge, foot.place, Vec::new());
        self.feet.push(foot);
    }

    /// Halves long edges; whether there were any.
    fn split_long(&mut self) -> bool {
        let mut has_split = false;
        for edge in self.patch.inner_edges() {
            if self.patch.length(edge) > self.tuning.longest * self.size(edge) {
                self.halve(edge);
                has_split = true;
            }
        }
        has_split
    }

    /// Collapses short edges; whether one did.
    fn close_short(&mut self) -> bool {
        self.sweep(|shaping| {
            let mut has_collapsed = false;
            for point in (0u32..).take(shaping.patch.points.len()) {
                if shaping.patch.is_inside(point) {
                    has_collapsed |= shaping.collapse_at(point);
                }
            }
            has_collapsed
        })
    }

    /// Does something until nothing happens any more, or often enough; whether anything happened.
    fn sweep(&mut self, mut once: impl FnMut(&mut Self) -> bool) -> bool {
        (0..SWEEPS).take_while(|_| once(self)).count() > 0
    }

    /// Collapses the shortest edge of a point that may collapse, if it is short.
    fn collapse_at(&mut self, point: u32) -> bool {
        let is_short = |other: &u32| {
            let edge = [point, *other];
            self.patch.length(edge) < self.tuning.shortest * self.size(edge)
        };
        let mut short: Vec<u32> = self.patch.neighbours(point).into_iter().filter(is_short).collect();
        short.sort_by(|a, b| self.patch.length([point, *a]).total_cmp(&self.patch.length([point, *b])));
        short.into_iter().any(|other| {
            self.collapse([point, other], |shaping, _, after| {
                let is_long =
                    |edge: [u32; 2]| shaping.patch.length(edge) > shaping.tuning.longest * shaping.size(edge);
                let mut edges = after.iter().flat_map(|corners| edges(*corners));
                !edges.any(|edge| edge.contains(&other) && is_long(edge))
            })
        })
    }

    /// Moves a point into one of its neighbours, if that makes the least angle around larger by so much. So do those between two lines that are an element and a half apart.
    fn collapse_to_widen(&mut self, point: u32, by: f64) -> bool {
        self.patch.neighbours(point).into_iter().any(|other| {
            self.collapse([point, other], |shaping, before, after| shaping.worst_angle(after) > before + by)
        })
    }

    /// Whether a point has four triangles or fewer, whose other corners are all on lines. Without it there are two, with angles that are as wide if they were those of a rectangle,
    /// and there is more room between them and a boundary that comes near.
    fn is_needless(&self, point: u32) -> bool {
        self.patch.star(point).len() <= 4
            && self.patch.neighbours(point).into_iter().all(|other| self.patch.is_outline(other))
    }

    /// Moves the first end of an edge into the other, or both inside into the middle, if `is_right` says so of the worst angle before and the triangles after.
    pub(super) fn collapse(
        &mut self,
        ends: [u32; 2],
        is_right: impl Fn(&Self, f64, &[[u32; 3]]) -> bool,
    ) -> bool {
        let [from, to] = ends;
        if !self.patch.pinched(ends).is_empty() {
            return false;
        }
        if self.patch.at_edge(ends).len() != 2 {
            return false;
        }
        let theirs = self.patch.neighbours(to);
        let new_edges = self.patch.neighbours(from).into_iter().filter(|point| *point != to);
        let new_edges: Vec<[u32; 2]> =
            new_edges.filter(|point| theirs.binary_search(point).is_err()).map(|point| [point, to]).collect();
        if new_edges.iter().any(|edge| !self.may_join(*edge)) {
            return false;
        }
        let moved = (!self.patch.is_outline(to)).then(|| {
            let middle = self.patch.place(from).midpoint(self.patch.place(to));
            self.reference.foot(middle, self.feet[to as usize].triangle)
        });
        let before = self.patch.star(from).iter().chain(self.patch.star(to));
        let before: Vec<[u32; 3]> = before.map(|triangle| self.patch.corners(*triangle)).collect();
        let mut after = self.patch.after_collapse(ends);
        let stay = self.patch.star(to).iter().map(|triangle| self.patch.corners(*triangle));
        after.extend(stay.filter(|corners| !corners.contains(&from)));
        let allowed = self.agreement(&before).min(self.tuning.least_cosine);
        let worst = self.worst_angle(&before);
        let old = (self.patch.place(to), self.feet[to as usize]);
        if let Some(foot) = moved {
            self.put(to, foot);
        }
        let is_good = is_right(self, worst, &after) && self.agreement(&after) >= allowed;
        if is_good {
            self.patch.collapse(ends);
        } else {
            self.patch.points[to as usize] = old.0;
            self.feet[to as usize] = old.1;
        }
        is_good
    }

    /// How triangles lie to the smooth surface: the least cosine of the angle between.
    fn agreement(&self, triangles: &[[u32; 3]]) -> f64 {
        let cosine = |corners: &[u32; 3]| {
            let smooth: DVec3 = corners.iter().map(|corner| self.feet[*corner as usize].normal).sum();
            self.normal(*corners).dot(smooth.normalize_or_zero())
        };
        triangles.iter().map(cosine).fold(1.0, f64::min)
    }

    pub(super) fn normal(&self, corners: [u32; 3]) -> DVec3 {
        let [a, b, c] = self.patch.places(corners);
        (b - a).cross(c - a).normalize_or_zero()
    }

    pub(super) fn worst_angle(&self, triangles: &[[u32; 3]]) -> f64 {
        triangles.iter().map(|corners| least_angle(self.patch.places(*corners))).fold(0.0, f64::min)
    }

    fn put(&mut self, point: u32, foot: Foot) {
        self.patch.points[point as usize] = foot.place;
        self.feet[point as usize] = foot;
    }

    /// Flips edges until no flip makes a least angle larger; whether one did.
    fn flip(&mut self) -> bool {
        self.sweep(|shaping| {
            let mut has_flipped = false;
            for edge in shaping.patch.inner_edges() {
                has_flipped |= shaping.flip_edge(edge);
            }
            has_flipped
        })
    }

    fn flip_edge(&mut self, edge: [u32; 2]) -> bool {
        self.flip_if(edge, |shaping, old, new| shaping.worst_angle(new) > shaping.worst_angle(old) + BETTER)
    }

    /// Flips an edge, if `is_right` says so of the triangles before and after.
    pub(super) fn flip_if(
        &mut self,
        edge: [u32; 2],
        is_right: impl Fn(&Self, &[[u32; 3]], &[[u32; 3]]) -> bool,
    ) -> bool {
        let Some(new) = self.patch.after_flipping(edge) else { return false };
        let [top, bottom] = [new[0][0], new[0][2]];
        if !self.may_join([top, bottom]) {
            return false;
        }
        let old: Vec<[u32; 3]> =
            self.patch.at_edge(edge).into_iter().map(|triangle| self.patch.corners(triangle)).collect();
        // Most edges are good as they are: that is asked for first.
        let is_good = is_right(self, &old, &new)
            && self.agreement(&new) >= self.agreement(&old).min(self.tuning.least_cosine);
        if is_good {
            self.patch.flip(edge, new);
        }
        is_good
    }

    /// Moves points to the middle of the triangles around, those of finer places counting more, and back to the surface.
    fn relax(&mut self) {
        for point in (0u32..).take(self.patch.points.len()) {
            if !self.patch.is_inside(point) {
                continue;
            }
            let star = self.star(point);
            let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
            for corners in &star {
                let [a, b, c] = self.patch.places(*corners);
                let size: f64 = corners.iter().map(|corner| self.feet[*corner as usize].size).sum();
                let weight = (b - a).cross(c - a).length() / size.powi(2);
                sum += weight * (a + b + c) / 3.0;
                weights += weight;
            }
            if weights > 0.0 {
                let foot = self.reference.foot(sum / weights, self.feet[point as usize].triangle);
                self.move_if(point, foot, &star, |_| true);
            }
        }
    }

    pub(super) fn star(&self, point: u32) -> Vec<[u32; 3]> {
        self.patch.star(point).iter().map(|triangle| self.patch.corners(*triangle)).collect()
    }

    /// Moves a point, if its triangles then lie to the surface as they should, and `is_right` says so; returns whether.
    fn move_if(
        &mut self,
        point: u32,
        foot: Foot,
        star: &[[u32; 3]],
        is_right: impl Fn(&Self) -> bool,
    ) -> bool {
        let old = (self.patch.place(point), self.feet[point as usize]);
        let allowed = self.agreement(star).min(self.tuning.least_cosine);
        self.put(point, foot);
        let is_good = is_right(self) && self.agreement(star) >= allowed;
        if !is_good {
            self.patch.points[point as usize] = old.0;
            self.feet[point as usize] = old.1;
        }
        is_good
    }

    /// Looks for places around points with narrow triangles where the least angle is larger; where there is none, such points may go.
    fn widen(&mut self) {
        let good = -self.tuning.wide;
        for _ in 0..self.tuning.searches {
            let mut has_moved = false;
            for point in (0u32..).take(self.patch.points.len()) {
                if !self.patch.is_inside(point) {
                    continue;
                }
                if self.is_needless(point) && self.collapse_to_widen(point, -BETTER) {
                    has_moved = true;
                    continue;
                }
                let star = self.star(point);
                if self.worst_angle(&star) < good {
                    has_moved |= self.search(point, &star, |shaping| shaping.worst_angle(&star))
                        || self.collapse_to_widen(point, BETTER);
                }
            }
            self.flip();
            if !has_moved {
                break;
            }
        }
    }

    /// Moves a point to where a measure of the triangles around it is larger; whether there is such a place nearby.
    pub(super) fn search(&mut self, point: u32, star: &[[u32; 3]], measure: impl Fn(&Self) -> f64) -> bool {
        let Foot { normal, size, .. } = self.feet[point as usize];
        let across = normal.any_orthonormal_vector();
        let along = normal.cross(across);
        let before = measure(self);
        for step in SEARCH_STEPS {
            let place = self.patch.place(point);
            let mut best = None;
            for [x, y] in SEARCH_DIRECTIONS {
                let by = (across * x + along * y) * (step * size);
                let foot = self.reference.foot(place + by, self.feet[point as usize].triangle);
                let old = (self.patch.place(point), self.feet[point as usize]);
                let wanted = best.map_or(before, |(found, _)| found);
                if self.move_if(point, foot, star, |shaping| measure(shaping) > wanted + BETTER) {
                    best = Some((measure(self), foot));
                    self.patch.points[point as usize] = old.0;
                    self.feet[point as usize] = old.1;
                }
            }
            if let Some((_, foot)) = best {
                self.put(point, foot);
                return true;
            }
        }
        false
    }
}

impl Outlined {
    /// The boundary with triangles of the size asked for.
    pub(crate) fn shaped(self, tuning: &RemeshTuning) -> (Shaping<'_>, BTreeMap<u32, Moved<u32>>) {
        let mut shaping = Shaping::new(self.patch, self.reference, &self.near, tuning);
        shaping.shape();
        (shaping, self.keys)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::remesh::gradation::Gradation;

    /// Six triangles around a point between two lines have angles of 27 degrees; four without it have 45.
    #[test]
    fn a_point_between_two_lines_goes_where_angles_are_wider_without_it() {
        let places = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.5]];
        let points = places.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        let triangles = [[0, 1, 6], [1, 2, 6], [2, 3, 6], [3, 4, 6], [4, 5, 6], [5, 0, 6]];
        let lines = vec![vec![0, 3], vec![0], vec![0, 1], vec![1, 2], vec![2], vec![2, 3], vec![]];
        let patch = Patch::new(points.clone(), lines, &triangles);
        let gradation = Gradation { growth: 0.4, most: 1.0 };
        let reference = Reference::new(points, vec![1.0; 7], triangles.to_vec(), gradation);
        let tuning = RemeshTuning::default();
        let mut shaping = Shaping::new(patch, reference, &[0; 7], &tuning);
        shaping.shape();
        let all: Vec<[u32; 3]> = shaping.patch.all().collect();
        assert_eq!(all.len(), 4);
        assert!((shaping.worst_angle(&all) + FRAC_1_SQRT_2).abs() < 1e-12);
    }

    /// A boundary beside a wall at 12 degrees had tetrahedra as flat as its triangles are low.
    #[test]
    fn a_point_among_lines_alone_goes() {
        let (square, triangle) = (
            vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]],
            vec![[0.0, 0.0], [1.0, 0.0], [0.5, 0.8], [0.5, 0.3]],
        );
        for (places, left) in [(square, 2), (triangle, 1)] {
            let points: Vec<DVec3> = places.iter().map(|[x, y]| DVec3::new(*x, *y, 0.0)).collect();
            let corners = u32::try_from(points.len() - 1).expect("few");
            let triangles: Vec<[u32; 3]> = (0..corners).map(|k| [k, (k + 1) % corners, corners]).collect();
            let mut lines: Vec<Vec<u32>> =
                (0..corners).map(|k| vec![(k + corners - 1) % corners, k]).collect();
            lines.push(Vec::new());
            let patch = Patch::new(points.clone(), lines, &triangles);
            let gradation = Gradation { growth: 0.4, most: 1.0 };
            let reference = Reference::new(points.clone(), vec![1.0; points.len()], triangles, gradation);
            let tuning = RemeshTuning::default();
            let mut shaping = Shaping::new(patch, reference, &vec![0; points.len()], &tuning);
            shaping.widen();
            assert_eq!(shaping.patch.all().count(), left);
        }
    }
}
