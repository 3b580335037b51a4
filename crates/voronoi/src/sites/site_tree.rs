//! Sites in boxes, and the searches among them.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::box_tree::BoxTree;
use crate::exact::generator::Generator;
use crate::lanes::LANES;
use crate::sites::columns::Columns;
use crate::sites::deepest::{Ball, DeepestSearch, find_deepest};
use crate::sites::grid::SeedGrid;
use crate::sites::near;
use crate::sites::near::Within;

/// Sites in rows of blocks up to which these are gone through: half as many again as around the largest cells of random seeds.
const MOST_IN_ROWS: usize = 1000;

/// Sites, sorted so that what is near in space is near in memory, and boxes around them.
pub(crate) struct SiteTree {
    /// Where few blocks are crowded, and the sites are in its order.
    grid: Option<SeedGrid>,
    sites: Vec<u32>,
    columns: [Vec<f64>; 3],
    weights: Option<Vec<f64>>,
    boxes: BoxTree,
}

impl SiteTree {
    /// Takes sites in the order of a grid, in boxes where its blocks are crowded.
    pub(crate) fn new(
        sites: Vec<u32>,
        grid: SeedGrid,
        position: impl Fn(u32) -> DVec3 + Sync,
        weight: Option<impl Fn(u32) -> f64 + Sync>,
    ) -> Self {
        let grid = (!grid.is_crowded()).then_some(grid);
        let mut columns = [const { Vec::new() }; 3];
        for (axis, column) in columns.iter_mut().enumerate() {
            *column = sites.par_iter().map(|site| position(*site)[axis]).collect();
        }
        let weights = weight.map(|weight| sites.par_iter().map(|site| weight(*site)).collect());
        let boxes = BoxTree::default();
        let mut tree = Self { grid, sites, columns, weights, boxes };
        let columns = tree.columns();
        let mut boxes =
            BoxTree::new(tree.sites.len(), |index| (columns.position(index), columns.weight(index)));
        if tree.is_crowded() {
            boxes.add_slabs(|index| columns.position(index));
        }
        tree.boxes = boxes;
        tree
    }

    /// Whether the sites are not in the order of a grid.
    pub(crate) fn is_crowded(&self) -> bool {
        self.grid.is_none()
    }

    pub(crate) fn columns(&self) -> Columns<'_> {
        let [x, y, z] = &self.columns;
        Columns { sites: &self.sites, x, y, z, weights: self.weights.as_deref() }
    }

    /// Finds runs of indices that hold all sites with which a seed has bisectors within a radius, and so up to some security_radius; false if
    /// these are more than some number of indices.
    #[inline]
    pub(crate) fn find_runs(
        &self,
        within: &Within,
        security_radius: f64,
        most: usize,
        runs: &mut Vec<Range<u32>>,
    ) -> bool {
        runs.clear();
        // Where seeds are spread evenly, and weights differ little, rows of blocks are quicker than boxes.
        if let Some(grid) = &self.grid
            && grid.find_runs(within.center, security_radius, MOST_IN_ROWS, runs)
        {
            return true;
        }
        runs.clear();
        near::find_runs(&self.boxes, within, most, runs)
    }

    /// The site that lies deepest in a ball, of those that certainly do; if none does, all that may are listed.
    pub(crate) fn deepest(&self, ball: &Ball, maybe: &mut Vec<Generator>) -> Option<InBox<'_>> {
        let mut search = DeepestSearch::new(ball, self.columns(), maybe);
        find_deepest(&self.boxes, &mut search);
        let index = search.deepest?;
        let first = index / LANES * LANES;
        let sites = &self.sites[first..self.sites.len().min(first + LANES)];
        Some(InBox { site: Generator::site(self.sites[index]), sites })
    }

    /// The sites in order of their distance from a point.
    pub(crate) fn near_first(&self, center: DVec3) -> NearFirst<'_> {
        let [top] = &self.boxes.levels[self.boxes.levels.len() - 1][..] else {
            unreachable!("one group holds all");
        };
        let largest_weight = top.weights.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let mut near = NearFirst { tree: self, center, largest_weight, heap: BinaryHeap::new() };
        let level = u32::try_from(self.boxes.levels.len() - 1).expect("there are eleven levels at most");
        near.push_group(level, 0, |_, _| true);
        near
    }
}

/// A site that was found, and all that are in the same box.
#[derive(Debug, PartialEq)]
pub(crate) struct InBox<'a> {
    pub(crate) site: Generator,
    pub(crate) sites: &'a [u32],
}

/// In place of the level of boxes: what waits is a plane.
const PLANE: u32 = u32::MAX;

/// A search from near to far.
pub(crate) struct NearFirst<'a> {
    tree: &'a SiteTree,
    center: DVec3,
    /// Of all sites.
    largest_weight: f64,
    /// What waits to be visited: the square of its distance, of which the bits come in the same order, and the level and the number of
    /// a box, or [`PLANE`] and a generator.
    heap: BinaryHeap<Reverse<(u64, u32, u32)>>,
}

impl NearFirst<'_> {
    /// Lets a plane wait as if it were the bisector with a site of which the square of the distance is given.
    pub(crate) fn push(&mut self, plane: Generator, squared: f64) {
        self.heap.push(Reverse((squared.to_bits(), PLANE, plane.0)));
    }

    /// The next plane and the square of its site's distance, if `is_wanted` still says so of the square and the site's weight: once it
    /// does not, it must not later, nor of what is farther away or lighter.
    pub(crate) fn next(&mut self, is_wanted: impl Fn(f64, f64) -> bool) -> Option<(Generator, f64)> {
        while let Some(Reverse((squared, level, number))) = self.heap.pop() {
            if !is_wanted(f64::from_bits(squared), self.largest_weight) {
                return None;
            }
            let first = number as usize * LANES;
            match level {
                PLANE => return Some((Generator(number), f64::from_bits(squared))),
                0 => {
                    let columns = self.tree.columns();
                    for index in first..columns.sites.len().min(first + LANES) {
                        let squared = (columns.position(index) - self.center).length_squared();
                        if is_wanted(squared, columns.weight(index)) {
                            self.push(Generator::site(columns.sites[index]), squared);
                        }
                    }
                }
                _ => self.push_group(level - 1, number, &is_wanted),
            }
        }
        None
    }

    fn push_group(&mut self, level: u32, group: u32, is_wanted: impl Fn(f64, f64) -> bool) {
        let boxes = &self.tree.boxes.levels[level as usize][group as usize];
        let first = u32::try_from(LANES).expect("eight") * group;
        let lanes = (first..).zip(0..LANES);
        for (number, lane) in lanes.filter(|(_, lane)| boxes.weights[*lane] > f64::NEG_INFINITY) {
            let [lower, upper] =
                [&boxes.lower, &boxes.upper].map(|corner| DVec3::from_array(corner.map(|lanes| lanes[lane])));
            // Rounding must not make it farther than what it holds.
            let squared = (self.center.clamp(lower, upper) - self.center).length_squared() * (1.0 - 1e-15);
            if is_wanted(squared, boxes.weights[lane]) {
                self.heap.push(Reverse((squared.to_bits(), level, number)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seeds in a box and as many in a corner of it, with weights of which some are large.
    fn seeds() -> (Vec<DVec3>, Vec<f64>) {
        let fraction = |i: u32, k: f64| (f64::from(i) * k).fract();
        let seed = |i: u32| {
            let seed = DVec3::new(fraction(i, 0.618_034), fraction(i, 0.754_878), fraction(i, 0.569_84));
            if i.is_multiple_of(2) { seed } else { seed * 0.01 }
        };
        let weight = |i: u32| if i.is_multiple_of(97) { 0.01 } else { 1e-6 * fraction(i, 0.41) };
        ((0..4000).map(seed).collect(), (0..4000).map(weight).collect())
    }

    fn tree(seeds: &[DVec3], weights: Option<&[f64]>) -> SiteTree {
        let mut grid = SeedGrid::new(seeds);
        assert!(grid.is_crowded());
        grid.relieve(seeds);
        let weight = weights.map(|weights| |site: u32| weights[site as usize]);
        SiteTree::new(grid.order.clone(), grid, |site| seeds[site as usize], weight)
    }

    #[test]
    fn runs_hold_all_bisectors_within_a_radius() {
        let (seeds, weights) = seeds();
        for weights in [None, Some(&weights[..])] {
            let tree = tree(&seeds, weights);
            let weight = |site: usize| weights.map_or(0.0, |weights| weights[site]);
            for seed in [0, 1, 17, 18, 97, 3999] {
                for radius in [1e-4, 1e-3, 0.03, 0.3] {
                    let (center, own_weight) = (seeds[seed], weight(seed));
                    let within = Within { center, own_weight, radius };
                    let mut found = vec![false; seeds.len()];
                    let security_radius = radius + (radius * radius + 0.01).sqrt();
                    let mut runs = Vec::new();
                    assert!(tree.find_runs(&within, security_radius, usize::MAX, &mut runs));
                    for index in runs.into_iter().flatten() {
                        found[tree.sites[index as usize] as usize] = true;
                    }
                    for other in (0..seeds.len()).filter(|other| *other != seed) {
                        let squared = seeds[other].distance_squared(center);
                        let distance = (squared + own_weight - weight(other)) / (2.0 * squared.sqrt());
                        assert!(found[other] || distance > radius, "{other} at {distance}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_deepest_site_in_a_ball_is_found_and_else_all_that_may_be_in_it() {
        let (seeds, weights) = seeds();
        let tree = tree(&seeds, Some(&weights));
        let generators = [0, 1, 2, 3].map(Generator::site);
        for k in 0..300u32 {
            let vertex = seeds[(7 * k) as usize] * 0.02 - seeds[0];
            let ball = |own_weight| Ball { center: seeds[0], own_weight, vertex, error: 1e-15, generators };
            let power = |site: usize| (seeds[site] - seeds[0] - vertex).length_squared() - weights[site];
            let expected = (4..seeds.len()).min_by(|a, b| power(*a).total_cmp(&power(*b))).expect("seeds");
            // A ball that the site is in, and one on which it lies.
            let mut maybe = Vec::new();
            let own_weight = vertex.length_squared() - power(expected);
            let found = tree.deepest(&ball(own_weight - 1e-6), &mut maybe);
            let expected_site = u32::try_from(expected).expect("few");
            assert!(found.is_some_and(|found| {
                found.site == Generator::site(expected_site) && found.sites.contains(&expected_site)
            }));
            assert!(maybe.is_empty());
            let found = tree.deepest(&ball(own_weight), &mut maybe);
            assert!(
                found.is_none() && maybe.contains(&Generator::site(u32::try_from(expected).expect("few")))
            );
        }
    }

    /// On a sphere boxes are far thicker than what is in them, and slabs tell what a ball that touches it from inside or outside meets.
    #[test]
    fn the_deepest_site_on_a_sphere_is_found_behind_slabs() {
        let (directions, weights) = seeds();
        let seeds: Vec<DVec3> = directions.iter().map(|seed| (*seed - 0.3).normalize() + 2.0).collect();
        let weights: Vec<f64> = weights.iter().map(|weight| 0.01 * weight).collect();
        for weights in [None, Some(&weights[..])] {
            let tree = tree(&seeds, weights);
            assert!(tree.boxes.has_slabs());
            let weight = |site: usize| weights.map_or(0.0, |weights| weights[site]);
            for k in 0..300u32 {
                let own = (13 * k) as usize;
                let vertex = (seeds[own] - 2.0) * if k.is_multiple_of(2) { -0.5 } else { 0.5 };
                let power = |site: usize| (seeds[site] - seeds[own] - vertex).length_squared() - weight(site);
                let others = (0..seeds.len()).filter(|site| *site != own);
                let expected = others.min_by(|a, b| power(*a).total_cmp(&power(*b))).expect("seeds");
                let expected_site = Generator::site(u32::try_from(expected).expect("few"));
                let generators = [Generator::site(13 * k); 4];
                // What lies deeper than a little less, what lies on the ball, and a little more, which nothing does.
                for (more, is_in, may_be_in) in
                    [(1e-9, true, true), (0.0, false, true), (-1e-9, false, false)]
                {
                    let own_weight = vertex.length_squared() - power(expected) - more;
                    let ball = Ball { center: seeds[own], own_weight, vertex, error: 1e-15, generators };
                    let mut maybe = Vec::new();
                    let found = tree.deepest(&ball, &mut maybe);
                    assert_eq!(found.map(|found| found.site), is_in.then_some(expected_site));
                    assert_eq!(maybe.contains(&expected_site), may_be_in && !is_in);
                }
            }
        }
    }

    #[test]
    fn sites_come_from_near_to_far() {
        let (seeds, _) = seeds();
        let tree = tree(&seeds, None);
        let mut near = tree.near_first(seeds[5]);
        let found = std::iter::from_fn(|| near.next(|squared, _| squared < 0.04));
        let found: Vec<(Generator, f64)> = found.collect();
        assert!(found.windows(2).all(|pair| pair[0].1 <= pair[1].1));
        let expected = seeds.iter().filter(|seed| seed.distance_squared(seeds[5]) < 0.04).count();
        assert_eq!(found.len(), expected);
    }
}
