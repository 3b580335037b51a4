//! Cutting a cell with the seeds around it, from near to far.

use crate::grid::SeedGrid;
use crate::predicate::ExactInput;

/// A cell that is being cut: polyhedron or polygon.
pub(crate) trait Cutting {
    /// The distance from which on no seed reaches the cell, if no weight exceeds the cell's own by more than
    /// `weight_excess`; negative for an empty cell.
    fn security_radius(&self, weight_excess: f64) -> f64;

    /// Cuts off what lies nearer to another seed, by power distance.
    fn cut_with_bisector(&mut self, other: u32, input: ExactInput);
}

/// All seeds, sorted for visits from near to far.
pub(crate) struct NearSeeds<'a> {
    input: ExactInput<'a>,
    grid: SeedGrid,
    largest_weight: f64,
}

impl<'a> NearSeeds<'a> {
    pub(crate) fn new(input: ExactInput<'a>) -> Self {
        let largest_weight = match input.weights {
            Some(weights) => weights.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            None => 0.0,
        };
        Self { input, grid: SeedGrid::new(input.seeds), largest_weight }
    }

    /// Cuts a started cell with the seeds around it, until no further seed can reach it.
    pub(crate) fn cut(&self, cell: &mut impl Cutting, seed: u32, buffer: &mut Vec<(f64, u32)>) {
        let own = self.input.seeds[seed as usize];
        let excess = self.largest_weight - self.input.weight(seed);
        let mut shells = self.grid.shells(own);
        while let Some(distance) = shells.distance_ahead() {
            let reach = cell.security_radius(excess);
            if distance > reach {
                break;
            }
            buffer.clear();
            shells.next_shell(|other| {
                let distance = self.input.seeds[other as usize].distance(own);
                if other != seed && distance <= reach {
                    buffer.push((distance, other));
                }
            });
            buffer.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for (distance, other) in buffer.iter() {
                if *distance > cell.security_radius(excess) {
                    break;
                }
                cell.cut_with_bisector(*other, self.input);
            }
        }
    }
}
