//! Seeds sorted into the blocks of a regular grid, so that what is near in space is near in memory.

use std::ops::Range;

use glam::{DVec3, IVec3};
use rayon::prelude::*;

/// Seeds a block holds on average: fewer make more rows of blocks to visit, more make more seeds to sort out.
const SEEDS_PER_BLOCK: f64 = 8.0;

/// Fewest and most blocks in a tile, nearly: what lies on the sides of a tile is worked out on both sides, and a tile is the unit
/// of work that threads share out.
const BLOCKS_PER_TILE: [f64; 2] = [500.0, 6000.0];

/// Tiles, where that leaves them neither too small nor too large.
const TILES: f64 = 8.0;

/// Blocks of a tile that follow one another along y, and along z, before those farther along x, y and z: neighbours that are taken
/// soon after one another find their vertices in the cache.
const BLOCKS_PER_BRICK: i32 = 3;

/// Blocks that a thread sorts at once.
const BLOCKS_SORTED_AT_ONCE: usize = 1024;

/// Blocks along an axis at most, nearly, which keeps extreme boxes within memory.
const MOST_BLOCKS: i32 = 1024;

/// Covers the rounding of a position in units of blocks, at most about [`MOST_BLOCKS`].
const BLOCK_MARGIN: f64 = 1e-9;

/// Seeds in the grid's order: their numbers in the input and their coordinates.
#[derive(Clone, Copy)]
pub(crate) struct Columns<'a> {
    pub(crate) sites: &'a [u32],
    pub(crate) x: &'a [f64],
    pub(crate) y: &'a [f64],
    pub(crate) z: &'a [f64],
}

/// The seeds in order of tiles, in these of bricks, of blocks, and of coordinates: an order that permuting the seeds does not change.
pub(crate) struct SeedGrid {
    lower: DVec3,
    block: DVec3,
    /// Blocks per length.
    density: DVec3,
    counts: IVec3,
    /// The number of block (x, y, z) is `offsets[0][x] + offsets[1][y] + offsets[2][z]`.
    offsets: [Vec<u32>; 3],
    /// Of each block along x, the last one in the same tile.
    tile_ends: Vec<u32>,
    /// Seeds of block b are `starts[b]..starts[b + 1]`.
    starts: Vec<u32>,
    tiles: Vec<Range<u32>>,
    /// The seeds' places in the input.
    pub(crate) order: Vec<u32>,
    columns: [Vec<f64>; 3],
}

impl SeedGrid {
    /// Sorts the seeds into blocks that are as close to cubes as the seeds' bounding box allows.
    pub(crate) fn new(seeds: Vec<DVec3>) -> Self {
        let lower = seeds.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let upper = seeds.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let size = upper - lower;
        // Casting saturates.
        let counts = cubes_along(size, seeds.len() as f64 / SEEDS_PER_BLOCK).as_ivec3();
        let counts = counts.clamp(IVec3::ONE, IVec3::splat(MOST_BLOCKS));
        let tile_counts = tile_counts(counts);
        // Tiles of one size take nearly the same time.
        let tile = (counts + (tile_counts - 1)) / tile_counts;
        let counts = tile * tile_counts;
        // An axis without extent gets one block of any positive width.
        let block = DVec3::from_array([0, 1, 2].map(|axis| {
            let width = size[axis] / f64::from(counts[axis]);
            if width > 0.0 { width } else { 1.0 }
        }));
        let (offsets, tile_blocks) = block_offsets(tile, tile_counts);
        let mut grid = Self {
            lower,
            block,
            density: 1.0 / block,
            counts,
            offsets,
            tile_ends: (0..counts.x).map(|x| ((x / tile.x + 1) * tile.x - 1).cast_unsigned()).collect(),
            starts: Vec::new(),
            tiles: Vec::new(),
            order: Vec::new(),
            columns: [const { Vec::new() }; 3],
        };
        grid.sort(&seeds, tile_counts.element_product().unsigned_abs() as usize * tile_blocks);
        let tile_starts = grid.starts.iter().copied().step_by(tile_blocks);
        let tile_starts: Vec<u32> = tile_starts.collect();
        grid.tiles =
            tile_starts.windows(2).map(|pair| pair[0]..pair[1]).filter(|tile| !tile.is_empty()).collect();
        grid
    }

    fn sort(&mut self, seeds: &[DVec3], block_count: usize) {
        let block_of = |seed: &DVec3| {
            let place = (*seed - self.lower) * self.density;
            // Casting saturates, and the clamp takes in the seed on the upper side.
            let block = place.as_ivec3().clamp(IVec3::ZERO, self.counts - 1).as_usizevec3();
            self.offsets[0][block.x] + self.offsets[1][block.y] + self.offsets[2][block.z]
        };
        let blocks: Vec<u32> = seeds.par_iter().map(block_of).collect();
        let mut starts = vec![0u32; block_count + 1];
        for block in &blocks {
            starts[*block as usize + 1] += 1;
        }
        for block in 0..block_count {
            starts[block + 1] += starts[block];
        }
        let mut next = starts.clone();
        self.order = vec![0; seeds.len()];
        for (seed, block) in (0u32..).zip(&blocks) {
            let slot = &mut next[*block as usize];
            self.order[*slot as usize] = seed;
            *slot += 1;
        }
        // Adding zero makes -0 and 0 the same place.
        let key = |id: &u32| (seeds[*id as usize] + DVec3::ZERO).to_array();
        let before = |a: &u32, b: &u32| {
            let (left, right) = (key(a), key(b));
            let by_axis = |axis: usize| left[axis].total_cmp(&right[axis]);
            by_axis(0).then_with(|| by_axis(1)).then_with(|| by_axis(2)).then(a.cmp(b))
        };
        let (mut rest, mut parts) = (&mut self.order[..], Vec::new());
        for first in (0..block_count).step_by(BLOCKS_SORTED_AT_ONCE) {
            let starts = &starts[first..=(first + BLOCKS_SORTED_AT_ONCE).min(block_count)];
            let (part, others) = rest.split_at_mut((starts[starts.len() - 1] - starts[0]) as usize);
            parts.push((starts, part));
            rest = others;
        }
        parts.into_par_iter().for_each(|(starts, part)| {
            for block in starts.windows(2) {
                let [from, to] = [block[0], block[1]].map(|start| (start - starts[0]) as usize);
                part[from..to].sort_unstable_by(before);
            }
        });
        self.columns =
            [0, 1, 2].map(|axis| self.order.par_iter().map(|id| seeds[*id as usize][axis]).collect());
        self.starts = starts;
    }

    /// The ids of two seeds at one place, the smallest such pair.
    pub(crate) fn duplicates(&self) -> Option<(u32, u32)> {
        let places = 1..self.order.len();
        let pairs =
            places.filter(|place| self.columns.iter().all(|column| column[place - 1] == column[*place]));
        pairs.map(|place| (self.order[place - 1], self.order[place])).min()
    }

    /// The same grid for seeds that were brought into its order.
    pub(crate) fn renumbered(self) -> Self {
        Self { order: (0u32..).take(self.order.len()).collect(), ..self }
    }

    /// The ranges of seeds, by place in the grid's order, that make up compact parts of space.
    pub(crate) fn tiles(&self) -> &[Range<u32>] {
        &self.tiles
    }

    /// Longest side of a block along the axes that have several; infinite if there are none.
    pub(crate) fn block_size(&self) -> f64 {
        let sides = (0..3).filter(|axis| self.counts[*axis] > 1).map(|axis| self.block[axis]);
        sides.reduce(f64::max).unwrap_or(f64::INFINITY)
    }

    /// Visits all seeds further than `from` and at most `to` from a place, as their number in the input, the vector to
    /// them and its squared length.
    pub(crate) fn for_each_within(
        &self,
        center: DVec3,
        from: f64,
        to: f64,
        mut visit: impl FnMut(u32, DVec3, f64),
    ) {
        let (from, to_squared) = (if from < 0.0 { -1.0 } else { from * from }, to * to);
        let Columns { sites, x, y, z } = self.columns();
        self.for_each_run(center, to, |run| {
            for k in run.start as usize..run.end as usize {
                let to_seed = DVec3::new(x[k], y[k], z[k]) - center;
                let squared = to_seed.length_squared();
                if squared > from && squared <= to_squared {
                    visit(sites[k], to_seed, squared);
                }
            }
        });
    }

    /// Visits runs of seeds that follow one another in the grid's order, among which are all those at most `to` from a place.
    #[inline]
    pub(crate) fn for_each_run(&self, center: DVec3, to: f64, mut visit: impl FnMut(Range<u32>)) {
        let to_squared = to * to;
        let place = (center - self.lower) * self.density;
        let steps = to * self.density + BLOCK_MARGIN;
        let first = (place - steps).max(DVec3::ZERO).as_ivec3().clamp(IVec3::ZERO, self.counts - 1);
        let last = (place + steps).max(DVec3::ZERO).as_ivec3().clamp(IVec3::ZERO, self.counts - 1);
        // Squared distance from a row of blocks along one axis.
        let beside = |axis: usize, b: i32| {
            let below = f64::from(b) - place[axis] - BLOCK_MARGIN;
            let above = place[axis] - f64::from(b + 1) - BLOCK_MARGIN;
            let distance = below.max(above).max(0.0) * self.block[axis];
            distance * distance
        };
        for z in first.z..=last.z {
            let beside_z = beside(2, z);
            for y in first.y..=last.y {
                let rest = to_squared - (beside_z + beside(1, y));
                if rest < 0.0 {
                    continue;
                }
                let step = rest.sqrt() * self.density.x + BLOCK_MARGIN;
                #[expect(clippy::cast_possible_truncation, reason = "saturates, then clamped")]
                let [mut x, end] = [place.x - step, place.x + step]
                    .map(|x| (x.max(0.0) as i32).min(self.counts.x - 1) as usize);
                let row = self.offsets[1][y as usize] + self.offsets[2][z as usize];
                while x <= end {
                    // Blocks follow one another up to the end of the tile.
                    let last = end.min(self.tile_ends[x] as usize);
                    let start = self.starts[(row + self.offsets[0][x]) as usize];
                    let stop = self.starts[(row + self.offsets[0][last]) as usize + 1];
                    visit(start..stop);
                    x = last + 1;
                }
            }
        }
    }

    pub(crate) fn columns(&self) -> Columns<'_> {
        let [x, y, z] = &self.columns;
        Columns { sites: &self.order, x, y, z }
    }
}

/// How many cubes, of which some number fills a box, lie along each axis; 1 along axes that are thinner than the cubes.
fn cubes_along(size: DVec3, wanted: f64) -> DVec3 {
    let mut axes: Vec<usize> = (0..3).filter(|axis| size[*axis] > 0.0).collect();
    let mut edge = 0.0;
    while !axes.is_empty() {
        let measure: f64 = axes.iter().map(|axis| size[*axis]).product();
        edge = (measure / wanted.max(1.0)).powf(1.0 / axes.len() as f64);
        let before = axes.len();
        axes.retain(|axis| size[*axis] >= edge);
        if axes.len() == before {
            break;
        }
    }
    let mut counts = DVec3::ONE;
    for axis in axes {
        counts[axis] = size[axis] / edge;
    }
    counts
}

/// Numbers of tiles along the axes, given those of blocks.
fn tile_counts(blocks: IVec3) -> IVec3 {
    let block_count: f64 = blocks.to_array().into_iter().map(f64::from).product();
    let blocks_per_tile = (block_count / TILES).clamp(BLOCKS_PER_TILE[0], BLOCKS_PER_TILE[1]);
    let mut tiles = cubes_along(blocks.as_dvec3(), block_count / blocks_per_tile).round().as_ivec3();
    let count = tiles.element_product();
    // Threads take tiles in turn, and mostly there is an even number of them.
    if count > 1 && count % 2 == 1 {
        tiles[blocks.max_position()] += 1;
    }
    tiles
}

/// The numbers that blocks get from their places along each axis, and how many a tile has with those that fill its last bricks, from
/// the numbers of blocks in a tile and of tiles along the axes.
fn block_offsets(tile: IVec3, tile_counts: IVec3) -> ([Vec<u32>; 3], usize) {
    let brick = IVec3::new(tile.x, tile.y.min(BLOCKS_PER_BRICK), tile.z.min(BLOCKS_PER_BRICK));
    let brick_counts = (tile + (brick - 1)) / brick;
    let brick_blocks = brick.element_product();
    let tile_blocks = brick_blocks * brick_counts.element_product();
    // From one to the next along each axis: blocks in a brick, bricks in a tile, tiles.
    let steps = |counts: IVec3| [1, counts.x, counts.x * counts.y];
    let (block_steps, brick_steps, tile_steps) = (steps(brick), steps(brick_counts), steps(tile_counts));
    let offsets = [0, 1, 2].map(|axis| {
        let offset = |block: i32| {
            let in_tile = block % tile[axis];
            let in_brick = in_tile % brick[axis] * block_steps[axis];
            let before_brick = in_tile / brick[axis] * brick_steps[axis] * brick_blocks;
            let before_tile = block / tile[axis] * tile_steps[axis] * tile_blocks;
            (in_brick + before_brick + before_tile).cast_unsigned()
        };
        (0..tile[axis] * tile_counts[axis]).map(offset).collect()
    });
    (offsets, tile_blocks.unsigned_abs() as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seeds() -> Vec<DVec3> {
        let fraction = |i: u32, k: f64| (f64::from(i) * k).fract();
        let seed = |i: u32| {
            DVec3::new(fraction(i, 0.618_034) * 5.0, fraction(i, 0.754_878), fraction(i, 0.569_84) * 0.1)
        };
        (0..20_000).map(seed).collect()
    }

    #[test]
    fn rings_of_distance_hold_every_seed_once() {
        let seeds = seeds();
        let grid = SeedGrid::new(seeds.clone());
        for center in [seeds[0], seeds[17], seeds[499]] {
            let mut seen = vec![0; seeds.len()];
            for [from, to] in [[-1.0, 0.0], [0.0, 0.03], [0.03, 0.3], [0.3, 10.0]] {
                grid.for_each_within(center, from, to, |id, to_seed, squared| {
                    let id = id as usize;
                    seen[id] += 1;
                    assert_eq!(to_seed, seeds[id] - center);
                    assert!(squared.sqrt() > from && squared.sqrt() <= to);
                });
            }
            assert!(seen.iter().all(|count| *count == 1));
        }
    }

    #[test]
    fn tiles_hold_every_seed_and_the_order_does_not_depend_on_that_of_the_seeds() {
        let mut seeds = seeds();
        let grid = SeedGrid::new(seeds.clone());
        assert!(grid.tiles().len() > 1);
        assert!(grid.tiles().iter().cloned().flatten().eq(0..20_000));
        seeds.reverse();
        assert_eq!(SeedGrid::new(seeds.clone()).columns, grid.columns);
    }
}
