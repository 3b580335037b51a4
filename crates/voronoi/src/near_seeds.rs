//! Cutting a cell with the seeds around it, from near to far.

use glam::DVec3;

use crate::grid::SeedGrid;
use crate::predicate::ExactInput;

/// A cell that is being cut: polyhedron or polygon.
pub(crate) trait Cutting {
    /// Starts anew with the cell of `seed` among its own images: the whole domain, where there are none.
    fn start(&mut self, seed: u32, input: ExactInput);

    /// The distance from which on no seed reaches the cell, if no weight exceeds the cell's own by more than
    /// `weight_excess`; negative for an empty cell.
    fn security_radius(&self, weight_excess: f64) -> f64;

    /// Cuts off what lies nearer to another seed, by power distance.
    fn cut_with_bisector(&mut self, other: u32, input: ExactInput);
}

/// All sites, sorted for visits from near to far.
pub(crate) struct NearSeeds {
    grid: SeedGrid,
    largest_weight: f64,
}

impl NearSeeds {
    pub(crate) fn new(input: ExactInput) -> Self {
        let largest_weight = match input.weights {
            Some(weights) => weights.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            None => 0.0,
        };
        let positions: Vec<DVec3> = (0..input.site_count()).map(|site| input.position(site)).collect();
        Self { grid: SeedGrid::new(&positions), largest_weight }
    }

    /// Cuts a started cell with the sites around it, until no further one can reach it. Returns how far it then reaches.
    pub(crate) fn cut(
        &self,
        cell: &mut impl Cutting,
        seed: u32,
        input: ExactInput,
        buffer: &mut Vec<(f64, u32)>,
    ) -> f64 {
        let own = input.seeds[seed as usize];
        let excess = self.largest_weight - input.weight(seed);
        let mut shells = self.grid.shells(own);
        while let Some(distance) = shells.distance_ahead() {
            let reach = cell.security_radius(excess);
            if distance > reach {
                break;
            }
            buffer.clear();
            shells.next_shell(|other| {
                let distance = input.difference(seed, other).length();
                if distance <= reach && !input.bounds_from_start(seed, other) {
                    buffer.push((distance, other));
                }
            });
            buffer.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for (distance, other) in buffer.iter() {
                if *distance > cell.security_radius(excess) {
                    break;
                }
                cell.cut_with_bisector(*other, input);
            }
        }
        cell.security_radius(excess)
    }
}
