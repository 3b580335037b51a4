//! Seeds sorted into the blocks of a regular grid, visited from near to far.

use glam::{DVec3, IVec3};

/// Seeds a block holds on average: fewer make more empty blocks to visit, more make more seeds to sort out.
const SEEDS_PER_BLOCK: f64 = 3.0;

pub(crate) struct SeedGrid {
    lower: DVec3,
    block: DVec3,
    counts: IVec3,
    /// Seeds of block b are `seeds[starts[b]..starts[b + 1]]`.
    starts: Vec<u32>,
    seeds: Vec<u32>,
}

impl SeedGrid {
    /// Sorts the seeds into blocks that are as close to cubes as the seeds' bounding box allows.
    pub(crate) fn new(positions: &[DVec3]) -> Self {
        let lower = positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let upper = positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let size = upper - lower;
        let counts = block_counts(size, positions.len() as f64 / SEEDS_PER_BLOCK);
        // An axis without extent gets one block of any positive width.
        let block = DVec3::from_array([0, 1, 2].map(|axis| {
            let width = size[axis] / f64::from(counts[axis]);
            if width > 0.0 { width } else { 1.0 }
        }));
        let mut grid = Self { lower, block, counts, starts: Vec::new(), seeds: Vec::new() };
        grid.sort(positions);
        grid
    }

    fn sort(&mut self, positions: &[DVec3]) {
        let block_count = self.counts.as_usizevec3().element_product();
        let mut starts = vec![0u32; block_count + 1];
        for position in positions {
            starts[self.block_index(self.block_of(*position)) + 1] += 1;
        }
        for block in 0..block_count {
            starts[block + 1] += starts[block];
        }
        let mut next = starts.clone();
        self.seeds = vec![0; positions.len()];
        for (seed, position) in (0u32..).zip(positions) {
            let slot = &mut next[self.block_index(self.block_of(*position))];
            self.seeds[*slot as usize] = seed;
            *slot += 1;
        }
        self.starts = starts;
    }

    fn block_of(&self, position: DVec3) -> IVec3 {
        // Casting saturates, and the clamp takes in the seed on the upper side.
        ((position - self.lower) / self.block).as_ivec3().clamp(IVec3::ZERO, self.counts - 1)
    }

    fn block_index(&self, block: IVec3) -> usize {
        let [x, y, z] = block.as_usizevec3().to_array();
        let counts = self.counts.as_usizevec3();
        (z * counts.y + y) * counts.x + x
    }

    /// Starts a visit of all seeds around a place, shell by shell of blocks.
    pub(crate) fn shells(&self, center: DVec3) -> Shells<'_> {
        Shells { grid: self, center, home: self.block_of(center), ring: 0 }
    }
}

fn block_counts(size: DVec3, blocks_wanted: f64) -> IVec3 {
    // Axes much thinner than a cubic block count as flat: the blocks are shared out among the others.
    let mut axes: Vec<usize> = (0..3).filter(|axis| size[*axis] > 0.0).collect();
    let mut edge = 0.0;
    while !axes.is_empty() {
        let measure: f64 = axes.iter().map(|axis| size[*axis]).product();
        edge = (measure / blocks_wanted.max(1.0)).powf(1.0 / axes.len() as f64);
        let before = axes.len();
        axes.retain(|axis| size[*axis] >= edge);
        if axes.len() == before {
            break;
        }
    }
    let mut counts = IVec3::ONE;
    for axis in axes {
        // At most 1024 blocks an axis keeps extreme boxes within memory; the cast of a ratio of lengths saturates.
        #[expect(clippy::cast_possible_truncation, reason = "saturates, then clamped")]
        let count = (size[axis] / edge).floor() as i32;
        counts[axis] = count.clamp(1, 1024);
    }
    counts
}

/// A visit of blocks in growing distance from a place.
pub(crate) struct Shells<'a> {
    grid: &'a SeedGrid,
    center: DVec3,
    home: IVec3,
    ring: i32,
}

impl Shells<'_> {
    /// A lower bound on the distance of all seeds not handed out yet; nothing when there are none.
    pub(crate) fn distance_ahead(&self) -> Option<f64> {
        if self.ring == 0 {
            return Some(0.0);
        }
        let mut distance = f64::INFINITY;
        let mut has_more = false;
        for axis in 0..3 {
            let below = self.home[axis] - self.ring;
            let above = self.home[axis] + self.ring;
            // A block's rounded limits may be off by some last places: the margin is that of the coordinates.
            let edge = |index: i32| self.grid.lower[axis] + f64::from(index) * self.grid.block[axis];
            let margin = 1e-12 * self.grid.block[axis] * f64::from(self.grid.counts[axis]);
            has_more |= below >= 0 || above < self.grid.counts[axis];
            if below >= 0 {
                distance = distance.min(self.center[axis] - edge(below + 1) - margin);
            }
            if above < self.grid.counts[axis] {
                distance = distance.min(edge(above) - self.center[axis] - margin);
            }
        }
        has_more.then_some(distance.max(0.0))
    }

    /// Hands out the seeds of the next shell: the blocks `ring` steps from the home block.
    pub(crate) fn next_shell(&mut self, mut visit: impl FnMut(u32)) {
        let ring = self.ring;
        let lower = (self.home - ring).max(IVec3::ZERO);
        let upper = (self.home + ring).min(self.grid.counts - 1);
        for z in lower.z..=upper.z {
            for y in lower.y..=upper.y {
                let on_shell = (z - self.home.z).abs() == ring || (y - self.home.y).abs() == ring;
                // Inside the shell only its two ends along x are new.
                let step = if on_shell || ring == 0 { 1 } else { 2 * ring };
                let first = if on_shell { lower.x } else { self.home.x - ring };
                let last = if on_shell { upper.x } else { self.home.x + ring };
                let mut x = first;
                while x <= last {
                    if x >= lower.x && x <= upper.x {
                        let block = self.grid.block_index(IVec3::new(x, y, z));
                        let range = self.grid.starts[block] as usize..self.grid.starts[block + 1] as usize;
                        self.grid.seeds[range].iter().copied().for_each(&mut visit);
                    }
                    x += step;
                }
            }
        }
        self.ring += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_seed_is_handed_out_once_and_never_nearer_than_promised() {
        let seeds: Vec<DVec3> = (0..500)
            .map(|i| {
                let fraction = |k: f64| (f64::from(i) * k).fract();
                DVec3::new(fraction(0.618_034) * 5.0, fraction(0.754_878), fraction(0.569_84) * 0.1)
            })
            .collect();
        let grid = SeedGrid::new(&seeds);
        for center in [seeds[0], seeds[17], seeds[499]] {
            let mut shells = grid.shells(center);
            let mut seen = vec![0; seeds.len()];
            while let Some(promised) = shells.distance_ahead() {
                shells.next_shell(|seed| {
                    seen[seed as usize] += 1;
                    assert!(seeds[seed as usize].distance(center) >= promised);
                });
            }
            assert!(seen.iter().all(|count| *count == 1));
        }
    }
}
