//! Flat seeds sorted into squares.

use std::ops::Range;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::Domain;

/// Mean number of seeds in a block, which is four mean distances of seeds wide: the circle of hardly any triangle of a square
/// reaches farther than the ring of blocks around it.
const SEEDS_PER_BLOCK: usize = 16;

/// Blocks along a side of a square: nine thousand seeds, whose triangulation stays in the cache.
const BLOCKS_PER_SQUARE: usize = 24;

/// Seeds in a square if they are spread evenly.
pub(crate) const SEEDS_PER_SQUARE: usize = SEEDS_PER_BLOCK * BLOCKS_PER_SQUARE * BLOCKS_PER_SQUARE;

/// Covers the rounding of a position in units of blocks.
const BLOCK_MARGIN: f64 = 1e-9;

/// The seeds in order of blocks, row by row, so that what is near in space is near in memory.
pub(crate) struct Squares {
    pub(crate) seeds: Vec<DVec3>,
    /// The seeds' places in the user's input.
    pub(crate) ids: Vec<u32>,
    lower: DVec2,
    block: DVec2,
    counts: [usize; 2],
    /// Seeds of block b are `starts[b]..starts[b + 1]`.
    starts: Vec<u32>,
}

/// Ranges of blocks along x and y.
pub(crate) type Square = [Range<usize>; 2];

/// What a square knows.
pub(crate) struct Known {
    /// The seeds, those of the square itself first.
    pub(crate) seeds: Vec<u32>,
    /// Number of the square's own seeds.
    pub(crate) own: usize,
    /// Between these corners all seeds are known.
    pub(crate) bounds: [DVec2; 2],
}

impl Squares {
    pub(crate) fn new(domain: &Domain, seeds: &[DVec3]) -> Self {
        let (lower, size) = (domain.lower().truncate(), domain.size().truncate());
        let blocks = (seeds.len() as f64 / SEEDS_PER_BLOCK as f64).max(1.0);
        let edge = (size.x * size.y / blocks).sqrt();
        // The cast of a ratio of lengths saturates.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        let counts = (size / edge).to_array().map(|count| count.clamp(1.0, blocks) as usize);
        let block = size / DVec2::new(counts[0] as f64, counts[1] as f64);
        let block_of = |seed: &DVec3| {
            let place = (seed.truncate() - lower) / block;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "seeds lie in the domain"
            )]
            let [x, y] = place.to_array().map(|place| place as usize);
            x.min(counts[0] - 1) + counts[0] * y.min(counts[1] - 1)
        };
        let blocks: Vec<usize> = seeds.par_iter().map(block_of).collect();
        let mut starts = vec![0; counts[0] * counts[1] + 1];
        for block in &blocks {
            starts[block + 1] += 1;
        }
        for block in 1..starts.len() {
            starts[block] += starts[block - 1];
        }
        let mut next = starts.clone();
        let mut ids = vec![0; seeds.len()];
        for (seed, block) in (0..).zip(&blocks) {
            ids[next[*block] as usize] = seed;
            next[*block] += 1;
        }
        let seeds = ids.par_iter().map(|id| seeds[*id as usize]).collect();
        Self { seeds, ids, lower, block, counts, starts }
    }

    /// All squares that have seeds.
    pub(crate) fn all(&self) -> Vec<Square> {
        let parts = |count: usize| {
            let parts = count.div_ceil(BLOCKS_PER_SQUARE);
            (0..parts).map(move |part| part * count / parts..(part + 1) * count / parts)
        };
        let squares = parts(self.counts[1]).flat_map(|y| parts(self.counts[0]).map(move |x| [x, y.clone()]));
        squares.filter(|square| self.rows(square).any(|row| !row.is_empty())).collect()
    }

    /// The seeds of a square row by row.
    fn rows(&self, [x, y]: &Square) -> impl Iterator<Item = Range<u32>> {
        let x = x.clone();
        y.clone().map(move |y| {
            let row = self.counts[0] * y;
            self.starts[row + x.start]..self.starts[row + x.end]
        })
    }

    /// What is known in a square and so many rings of blocks around it.
    pub(crate) fn around(&self, square: &Square, rings: usize) -> Known {
        let wider = |axis: usize| {
            let Range { start, end } = square[axis];
            start.saturating_sub(rings)..(end + rings).min(self.counts[axis])
        };
        let all @ [x, y] = &[wider(0), wider(1)];
        let mut seeds: Vec<u32> = self.rows(square).flatten().collect();
        let own = seeds.len();
        let beside = |y: usize| -> [Range<usize>; 2] {
            if square[1].contains(&y) {
                [x.start..square[0].start, square[0].end..x.end]
            } else {
                [x.clone(), 0..0]
            }
        };
        for y in y.clone() {
            for x in beside(y) {
                seeds.extend(self.rows(&[x, y..y + 1]).flatten());
            }
        }
        // No seed lies beyond the walls.
        let bound = |axis: usize| {
            let at =
                |block: usize, margin: f64| self.lower[axis] + (block as f64 + margin) * self.block[axis];
            let Range { start, end } = all[axis];
            let lower = if start == 0 { f64::NEG_INFINITY } else { at(start, BLOCK_MARGIN) };
            let upper = if end == self.counts[axis] { f64::INFINITY } else { at(end, -BLOCK_MARGIN) };
            [lower, upper]
        };
        let [[x0, x1], [y0, y1]] = [bound(0), bound(1)];
        Known { seeds, own, bounds: [DVec2::new(x0, y0), DVec2::new(x1, y1)] }
    }
}
