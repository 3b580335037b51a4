//! The site that cuts a vertex off farthest.

use std::ops::Range;

use glam::DVec3;

use crate::box_tree::{BoxSearch, BoxTree, Boxes, Slabs};
use crate::exact::generator::Generator;
use crate::exact::half_space::EVALUATION_ERROR;
use crate::lanes::{LANES, compiled_thrice, lanes, larger, smaller};
use crate::sites::columns::Columns;

/// The ball around a vertex of a cell, in terms of powers: what lies in it cuts the vertex off.
pub(crate) struct Ball {
    /// The cell's seed.
    pub(crate) center: DVec3,
    pub(crate) own_weight: f64,
    /// Relative to the seed.
    pub(crate) vertex: DVec3,
    /// Bound on the errors of the coordinates of the vertex and of sites together.
    pub(crate) error: f64,
    /// What meets in the vertex.
    pub(crate) generators: [Generator; 4],
}

/// A search for the site that lies deepest in a ball, of those that certainly do.
pub(crate) struct DeepestSearch<'a> {
    ball: &'a Ball,
    columns: Columns<'a>,
    /// Bounds on the errors of depths are the first times the square of a site's distance from the seed, and the second.
    error: [f64; 2],
    /// The index of the deepest so far, and its depth.
    pub(crate) deepest: Option<usize>,
    depth: f64,
    /// As long as there is none, those that may lie in the ball.
    maybe: &'a mut Vec<Generator>,
}

impl<'a> DeepestSearch<'a> {
    pub(crate) fn new(ball: &'a Ball, columns: Columns<'a>, maybe: &'a mut Vec<Generator>) -> Self {
        // An error in the vertex counts by the site's distance d and twice the vertex's, an error in the site by twice these: with
        // the roots of 3 for errors of coordinates, by 7 times d and 14 times the other together. And d is at most half of d^2 / l
        // and l together, for any length l.
        let distance = ball.vertex.length();
        let length = (distance + LEAST_LENGTH * ball.error).max(f64::MIN_POSITIVE);
        let share = 2.0 * EVALUATION_ERROR + 3.5 * ball.error / length;
        let least = EVALUATION_ERROR * distance * distance + (3.5 * length + 14.0 * distance) * ball.error;
        Self { ball, columns, error: [share, least], deepest: None, depth: 0.0, maybe }
    }
}

/// A length that errors of squares are relative to, in units of the error of a coordinate: not so short that all would be lost.
const LEAST_LENGTH: f64 = 1e8;

compiled_thrice! {
    /// Looks for the deepest site in a ball.
    fn find_deepest(boxes: &BoxTree, search: &mut DeepestSearch) -> () = find_deepest_anywhere
}

#[inline(always)]
fn find_deepest_anywhere(boxes: &BoxTree, search: &mut DeepestSearch) {
    boxes.search(search);
}

impl BoxSearch for DeepestSearch<'_> {
    #[inline(always)]
    fn wanted(&self, boxes: &Boxes) -> u32 {
        let Ball { center, vertex, .. } = *self.ball;
        let nearest = |axis: usize, lane: usize| {
            let corners = [&boxes.lower, &boxes.upper];
            let [lower, upper] = corners.map(|corner| corner[axis][lane] - center[axis]);
            smaller(larger(vertex[axis], lower), upper)
        };
        self.may_be_deeper(nearest, &boxes.weights)
    }

    #[inline(always)]
    fn reached(&self, boxes: &Boxes, slabs: &Slabs) -> u32 {
        let Ball { center, own_weight, vertex, error, .. } = *self.ball;
        let position = center + vertex;
        // Of an offset, as errors of coordinates make at most the root of 3 times as much.
        let offset_error = 2.0 * error + EVALUATION_ERROR * (center.abs() + vertex.abs()).element_sum();
        let radius = vertex.length() * (1.0 + EVALUATION_ERROR) + 2.0 * error;
        let squared = radius * radius;
        let mut reached = 0;
        for lane in 0..LANES {
            let offset = slabs.normals[0][lane] * position.x
                + slabs.normals[1][lane] * position.y
                + slabs.normals[2][lane] * position.z
                - slabs.middles[lane];
            let gap = offset.abs() - slabs.halves[lane] - offset_error;
            let excess = boxes.weights[lane] - own_weight;
            let limit = squared + (excess + EVALUATION_ERROR * excess.abs());
            let is_beside = (gap > 0.0) & (gap * gap * (1.0 - EVALUATION_ERROR) > limit);
            reached |= u32::from(!is_beside) << lane;
        }
        reached
    }

    #[inline(always)]
    fn visit(&mut self, indices: Range<usize>) -> bool {
        let Columns { sites, x, y, z, weights } = self.columns;
        let positions = [lanes(&x[indices.clone()]), lanes(&y[indices.clone()]), lanes(&z[indices.clone()])];
        let weights = weights.map_or([0.0; LANES], |weights| lanes(&weights[indices.clone()]));
        let center = self.ball.center;
        let mut chosen = self.may_be_deeper(|axis, lane| positions[axis][lane] - center[axis], &weights);
        chosen &= (1 << indices.len()) - 1;
        while chosen != 0 {
            let lane = chosen.trailing_zeros() as usize;
            chosen &= chosen - 1;
            let site = Generator::site(sites[indices.start + lane]);
            if self.ball.generators.contains(&site) {
                continue;
            }
            let [x, y, z] = [0, 1, 2].map(|axis| positions[axis][lane] - center[axis]);
            let (depth, error) = self.depth([x, y, z], weights[lane]);
            if depth + error < 0.0 {
                if self.deepest.is_none() || depth < self.depth {
                    (self.deepest, self.depth) = (Some(indices.start + lane), depth);
                    self.maybe.clear();
                }
            } else if self.deepest.is_none() {
                self.maybe.push(site);
            }
        }
        true
    }
}

impl DeepestSearch<'_> {
    /// Of sites near the seed, one for each lane, those that may lie deeper in the ball than the deepest site so far, a bit for each.
    /// Their coordinates are given by axis and lane.
    #[inline(always)]
    fn may_be_deeper(&self, coordinate: impl Fn(usize, usize) -> f64, weights: &[f64; LANES]) -> u32 {
        let mut least = [0.0; LANES];
        for lane in 0..LANES {
            let (depth, error) =
                self.depth([coordinate(0, lane), coordinate(1, lane), coordinate(2, lane)], weights[lane]);
            least[lane] = depth - error;
        }
        let mut chosen = 0;
        for (lane, least) in least.into_iter().enumerate() {
            let is_outside = least > self.depth;
            chosen |= u32::from(!is_outside) << lane;
        }
        chosen
    }

    /// By how much less the power of the vertex is from a site somewhere near the seed than from the seed, negative where it is less,
    /// and a bound on the error of that.
    #[inline(always)]
    fn depth(&self, [x, y, z]: [f64; 3], weight: f64) -> (f64, f64) {
        let Ball { own_weight, vertex, .. } = *self.ball;
        let [error_share, least_error] = self.error;
        let squared = x * x + y * y + z * z;
        let product = x * vertex.x + y * vertex.y + z * vertex.z;
        let excess = own_weight - weight;
        // The powers' common term, the square of the vertex, is left out: it may be far larger than the rest.
        let depth = squared - 2.0 * product + excess;
        (depth, error_share * squared + least_error + EVALUATION_ERROR * excess.abs())
    }
}
