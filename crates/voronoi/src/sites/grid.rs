//! Seeds sorted into the blocks of a regular grid, so that what is near in space is near in memory.

use std::ops::Range;

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use crate::box_tree::sort_into_boxes;

/// Seeds a block holds on average: fewer make more rows of blocks to visit, more make more seeds to sort out.
const SEEDS_PER_BLOCK: f64 = 8.0;

/// Fewest and most blocks in a tile, nearly: what lies on the sides of a tile is worked out on both sides, and a tile is the unit
/// of work that threads share out. Of 12 000 seeds with two threads, 8 tiles take 0.69 of the time of one, with one thread 1.07.
const BLOCKS_PER_TILE: [f64; 2] = [250.0, 6000.0];

/// Fewest blocks for two tiles where more would be too small. Of 4000 seeds they take 0.66 of the time of one with two threads, with one thread 1.19.
const BLOCKS_OF_TWO_TILES: f64 = 200.0;

/// Tiles, where that leaves them neither too small nor too large.
const TILES: f64 = 8.0;

/// Blocks of a tile that follow one another along y, and along z, before those farther along x, y and z: neighbours that are taken
/// soon after one another find their vertices in the cache.
const BLOCKS_PER_BRICK: i32 = 3;

/// Fewest and most seeds in a tile of boxes, and tiles where that leaves them between: boxes in boxes hold powers of eight.
const SEEDS_PER_TILE: [usize; 2] = [4096, 32_768];
const TILES_OF_BOXES: usize = 8;

/// Blocks that a thread sorts at once.
const BLOCKS_SORTED_AT_ONCE: usize = 1024;

/// Blocks along an axis at most, nearly, which keeps extreme boxes within memory.
const MOST_BLOCKS: i32 = 1024;

/// Covers the rounding of a position in units of blocks, at most about [`MOST_BLOCKS`].
const BLOCK_MARGIN: f64 = 1e-9;

/// Blocks from a point up to which rows of blocks are gone through: beyond, larger boxes are quicker.
const MOST_STEPS: f64 = 4.0;

/// Seeds in a block beyond which it is crowded: thrice the mean, which random seeds hardly ever come to.
const CROWD: usize = 24;

/// Share of the seeds in crowded blocks from which on blocks do not serve.
const MOST_CROWDED: f64 = 0.1;

/// The seeds in order of tiles, in these of bricks, of blocks, and of coordinates, or of boxes: an order that permuting the seeds does not change.
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
    /// The seeds of block b are `starts[b]..starts[b + 1]`.
    starts: Vec<u32>,
    tiles: Vec<Range<u32>>,
    /// The seeds' indices in the input.
    pub(crate) order: Vec<u32>,
}

impl SeedGrid {
    /// Sorts the seeds into blocks, and in these by coordinates.
    pub(crate) fn new(seeds: &[DVec3]) -> Self {
        let mut grid = Self::of_ordered(seeds);
        sort_in_blocks(seeds, &grid.starts, &mut grid.order);
        grid
    }

    /// Sorts seeds whose order does not depend on how they were given into blocks that are as close to cubes as their bounding box
    /// allows: in a block they stay in that order.
    pub(crate) fn of_ordered(seeds: &[DVec3]) -> Self {
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
        let density = 1.0 / block;
        let block_of = |seed: &DVec3| {
            let scaled = (*seed - lower) * density;
            // Casting saturates, and the clamp takes in the seed on the upper side.
            let block = scaled.as_ivec3().clamp(IVec3::ZERO, counts - 1).as_usizevec3();
            offsets[0][block.x] + offsets[1][block.y] + offsets[2][block.z]
        };
        let block_count = tile_counts.element_product().unsigned_abs() as usize * tile_blocks;
        let (starts, order) = sort(&seeds.par_iter().map(block_of).collect::<Vec<u32>>(), block_count);
        let tile_starts: Vec<u32> = starts.iter().copied().step_by(tile_blocks).collect();
        let tiles =
            tile_starts.windows(2).map(|pair| pair[0]..pair[1]).filter(|tile| !tile.is_empty()).collect();
        let tile_ends = (0..counts.x).map(|x| ((x / tile.x + 1) * tile.x - 1).cast_unsigned()).collect();
        Self { lower, block, density, counts, offsets, tile_ends, starts, tiles, order }
    }

    /// The ids of two seeds at one point, the smallest such pair.
    pub(crate) fn duplicates(&self, seeds: &[DVec3]) -> Option<(u32, u32)> {
        let pairs = self.order.windows(2).map(|pair| (pair[0], pair[1]));
        pairs.filter(|(a, b)| seeds[*a as usize] == seeds[*b as usize]).min()
    }

    /// The ranges of seeds, by index in the grid's order, that make up compact parts of space.
    pub(crate) fn tiles(&self) -> &[Range<u32>] {
        &self.tiles
    }

    /// Finds runs of seeds that follow one another in the grid's order, among which are all those at most `to` from a point; false if
    /// these are more than some number of seeds, or too many blocks.
    #[inline]
    pub(crate) fn find_runs(&self, center: DVec3, to: f64, most: usize, runs: &mut Vec<Range<u32>>) -> bool {
        let to_squared = to * to;
        let scaled = (center - self.lower) * self.density;
        let steps = to * self.density + BLOCK_MARGIN;
        // Along an axis with one block, it is all the same.
        let is_far = steps.cmpgt(DVec3::splat(MOST_STEPS)) & self.counts.cmpgt(IVec3::splat(8));
        if is_far.any() {
            return false;
        }
        let mut count = 0;
        let first = (scaled - steps).max(DVec3::ZERO).as_ivec3().clamp(IVec3::ZERO, self.counts - 1);
        let last = (scaled + steps).max(DVec3::ZERO).as_ivec3().clamp(IVec3::ZERO, self.counts - 1);
        // Squared distance from a row of blocks along one axis.
        let beside = |axis: usize, b: i32| {
            let below = f64::from(b) - scaled[axis] - BLOCK_MARGIN;
            let above = scaled[axis] - f64::from(b + 1) - BLOCK_MARGIN;
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
                let [mut x, end] = [scaled.x - step, scaled.x + step]
                    .map(|x| (x.max(0.0) as i32).min(self.counts.x - 1).unsigned_abs() as usize);
                let row =
                    self.offsets[1][y.unsigned_abs() as usize] + self.offsets[2][z.unsigned_abs() as usize];
                while x <= end {
                    // Blocks follow one another up to the end of the tile.
                    let last = end.min(self.tile_ends[x] as usize);
                    let start = self.starts[(row + self.offsets[0][x]) as usize];
                    let stop = self.starts[(row + self.offsets[0][last]) as usize + 1];
                    count += (stop - start) as usize;
                    runs.push(start..stop);
                    x = last + 1;
                }
                if count > most {
                    return false;
                }
            }
        }
        true
    }

    /// Where blocks are crowded, brings the seeds into boxes instead, and makes tiles of as many of these.
    pub(crate) fn relieve(&mut self, seeds: &[DVec3]) {
        if !self.is_crowded() {
            return;
        }
        let count = seeds.len();
        let mut indices: Vec<u32> = (0u32..).take(count).collect();
        let tile = (count / TILES_OF_BOXES).next_multiple_of(SEEDS_PER_TILE[0]).min(SEEDS_PER_TILE[1]);
        self.tiles = indices.chunks(tile).map(|tile| tile[0]..tile[tile.len() - 1] + 1).collect();
        sort_into_boxes(&mut indices, 0, &|index: u32| seeds[self.order[index as usize] as usize]);
        self.order = indices.into_iter().map(|index| self.order[index as usize]).collect();
    }

    /// Whether many seeds are in blocks that have so many that their order does not tell which are near one another.
    pub(crate) fn is_crowded(&self) -> bool {
        let counts = self.starts.windows(2).map(|block| (block[1] - block[0]) as usize);
        let crowded: usize = counts.filter(|count| *count > CROWD).sum();
        crowded as f64 > MOST_CROWDED * self.order.len() as f64
    }
}

/// Sorts seeds, of which the blocks are given, by block, and in it as they come. Returns where the blocks start, and the order.
fn sort(blocks: &[u32], block_count: usize) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; block_count + 1];
    for block in blocks {
        starts[*block as usize + 1] += 1;
    }
    for block in 0..block_count {
        starts[block + 1] += starts[block];
    }
    let mut next = starts.clone();
    let mut order = vec![0; blocks.len()];
    for (seed, block) in (0u32..).zip(blocks) {
        let slot = &mut next[*block as usize];
        order[*slot as usize] = seed;
        *slot += 1;
    }
    (starts, order)
}

/// Sorts the seeds of each block by their coordinates.
fn sort_in_blocks(seeds: &[DVec3], starts: &[u32], order: &mut [u32]) {
    let block_count = starts.len() - 1;
    // Adding zero makes -0 and 0 the same point.
    let key = |id: &u32| (seeds[*id as usize] + DVec3::ZERO).to_array();
    let before = |a: &u32, b: &u32| {
        let (left, right) = (key(a), key(b));
        let by_axis = |axis: usize| left[axis].total_cmp(&right[axis]);
        by_axis(0).then_with(|| by_axis(1)).then_with(|| by_axis(2)).then(a.cmp(b))
    };
    let (mut rest, mut parts) = (order, Vec::new());
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
    if count % 2 == 1 && (count > 1 || block_count >= BLOCKS_OF_TWO_TILES) {
        tiles[blocks.max_position()] += 1;
    }
    tiles
}

/// The numbers that blocks get from their positions along each axis, and how many a tile has with those that fill its last bricks, from
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
    fn tiles_hold_every_seed_and_the_order_does_not_depend_on_that_of_the_seeds() {
        let mut seeds = seeds();
        let sorted = |seeds: &[DVec3]| -> Vec<DVec3> {
            let grid = SeedGrid::new(seeds);
            assert!(grid.tiles().len() > 1);
            assert!(grid.tiles().iter().cloned().flatten().eq(0..20_000));
            grid.order.iter().map(|id| seeds[*id as usize]).collect()
        };
        let first = sorted(&seeds);
        seeds.reverse();
        assert_eq!(sorted(&seeds), first);
    }
}
