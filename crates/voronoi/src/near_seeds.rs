//! Cutting a cell with the seeds around it, from near to far.

use crate::generator::Generator;
use crate::grid::SeedGrid;
use crate::predicate::ExactInput;

/// Covers the rounding of distances and radii, relative to them.
const RADIUS_MARGIN: f64 = 1.0 + 1e-12;

/// Growth of the reach from one round of the search to the next: twice the volume.
const GROWTH: f64 = 1.26;

/// A cell that is being cut: polyhedron or polygon.
pub(crate) trait Cutting {
    /// A radius around the seed that holds the cell; negative for an empty cell.
    fn radius(&self) -> f64;

    /// Cuts off what lies nearer to another seed, by power distance.
    fn cut_with_bisector(&mut self, other: u32, input: ExactInput);

    /// The planes of one vertex, in positive orientation; none for an empty cell.
    fn any_vertex(&self) -> Option<[Generator; 3]>;
}

/// All seeds, sorted for visits from near to far.
#[derive(Clone, Copy)]
pub(crate) struct NearSeeds<'a> {
    /// The seeds in the order of the grid.
    pub(crate) input: ExactInput<'a>,
    pub(crate) grid: &'a SeedGrid,
    largest_weight: f64,
}

impl<'a> NearSeeds<'a> {
    pub(crate) fn new(input: ExactInput<'a>, grid: &'a SeedGrid) -> Self {
        let largest_weight = match input.weights {
            Some(weights) => weights.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            None => 0.0,
        };
        Self { input, grid, largest_weight }
    }

    /// The distance from a seed within which all seeds lie that can touch or cut the part of its cell within `radius`.
    pub(crate) fn reach(&self, seed: u32, radius: f64) -> f64 {
        // The bisector with a seed at distance d lies (d^2 - excess) / (2 d) away.
        let excess = self.largest_weight - self.input.weight(seed);
        (radius + (radius * radius + excess).sqrt()) * RADIUS_MARGIN
    }

    /// Next reach of a search that has come to `reach` and needs to go to `wanted`.
    pub(crate) fn grow(&self, reach: f64, wanted: f64) -> f64 {
        wanted.min((reach * GROWTH).max(self.grid.block_size()))
    }

    /// Cuts a started cell with the seeds around it, until no further seed can reach it.
    pub(crate) fn cut(&self, cell: &mut impl Cutting, seed: u32) {
        let own = self.input.seeds[seed as usize];
        let mut near = Vec::new();
        let mut reach = -1.0;
        loop {
            let radius = cell.radius();
            if radius < 0.0 || self.reach(seed, radius) <= reach {
                return;
            }
            let next = self.grow(reach, self.reach(seed, radius));
            near.clear();
            self.grid.for_each_within(own, reach, next, |other, _, squared| near.push((squared, other)));
            near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for (squared, other) in near.iter().filter(|(_, other)| *other != seed) {
                let radius = cell.radius();
                if radius < 0.0 || squared.sqrt() > self.reach(seed, radius) {
                    return;
                }
                cell.cut_with_bisector(*other, self.input);
            }
            reach = next;
        }
    }
}
