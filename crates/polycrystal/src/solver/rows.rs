//! Sparse matrices.

use std::ops::AddAssign;

use cancellation::check_cancelled;
use rayon::prelude::*;

/// Rows that one task makes: enough to be worth a task, and few enough for all threads to have some.
const ROWS_PER_TASK: usize = 1024;

/// Rows of pairs of a column and a value, in blocks as tasks make them.
#[derive(Debug)]
pub(crate) struct CsrRows<T> {
    blocks: Vec<Block<T>>,
    len: usize,
}

/// Some rows, one after the other.
#[derive(Debug)]
struct Block<T> {
    /// Where each row starts, and the end.
    starts: Vec<usize>,
    entries: Vec<(u32, T)>,
}

impl<T> CsrRows<T> {
    /// Rows that are made in parallel, each by `fill`.
    pub(crate) fn made_by(len: usize, fill: impl Fn(usize, &mut NewRow<'_, T>) + Sync) -> Self
    where
        T: Copy + Send,
    {
        Self::made_of_sums(len, fill, |sum| sum)
    }

    /// The same from sums of another type, so that rounding does not depend on the order in which they are added up.
    pub(crate) fn made_of_sums<S: Copy>(
        len: usize,
        fill: impl Fn(usize, &mut NewRow<'_, S>) + Sync,
        value: impl Fn(S) -> T + Sync,
    ) -> Self
    where
        T: Send,
    {
        let block = |block: usize| {
            check_cancelled();
            let mut sums = Vec::new();
            let mut starts = vec![0];
            for row in block * ROWS_PER_TASK..len.min((block + 1) * ROWS_PER_TASK) {
                fill(row, &mut NewRow { start: sums.len(), entries: &mut sums });
                starts.push(sums.len());
            }
            Block { starts, entries: sums.iter().map(|(column, sum)| (*column, value(*sum))).collect() }
        };
        Self { blocks: (0..len.div_ceil(ROWS_PER_TASK)).into_par_iter().map(block).collect(), len }
    }

    /// The matrix with rows and columns exchanged.
    pub(crate) fn transposed(&self, column_count: usize) -> Self
    where
        T: Copy + Default,
    {
        let mut counts = vec![0; column_count];
        for (column, _) in self.blocks.iter().flat_map(|block| &block.entries) {
            counts[*column as usize] += 1;
        }
        let block = |counts: &mut [usize]| {
            let mut starts = vec![0];
            let mut end = 0;
            for count in counts {
                // From here on where the next entry of the row goes.
                end += std::mem::replace(count, end);
                starts.push(end);
            }
            Block { starts, entries: vec![(0, T::default()); end] }
        };
        let mut blocks: Vec<Block<T>> = counts.chunks_mut(ROWS_PER_TASK).map(block).collect();
        let mut next = counts;
        for row in 0..self.len {
            let id = u32::try_from(row).expect("a matrix has no more rows than ids");
            for (column, value) in self.row(row) {
                let column = *column as usize;
                blocks[column / ROWS_PER_TASK].entries[next[column]] = (id, *value);
                next[column] += 1;
            }
        }
        Self { blocks, len: column_count }
    }

    #[inline]
    pub(crate) fn row(&self, row: usize) -> &[(u32, T)] {
        let Block { starts, entries } = &self.blocks[row / ROWS_PER_TASK];
        let row = row % ROWS_PER_TASK;
        &entries[starts[row]..starts[row + 1]]
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }
}

/// A row as it is made: each column once.
pub(crate) struct NewRow<'a, T> {
    /// Those of rows before it come first.
    entries: &'a mut Vec<(u32, T)>,
    start: usize,
}

impl<T: AddAssign> NewRow<'_, T> {
    /// Adds to the value of a column.
    #[inline]
    pub(crate) fn add(&mut self, column: u32, value: T) {
        match self.entries[self.start..].iter_mut().find(|(known, _)| *known == column) {
            Some((_, sum)) => *sum += value,
            None => self.entries.push((column, value)),
        }
    }

    /// Makes other values of those that there are, or takes them out.
    pub(crate) fn filter_map(&mut self, value: impl Fn(&T) -> Option<T>) {
        let mut kept = self.start;
        for at in self.start..self.entries.len() {
            if let Some(value) = value(&self.entries[at].1) {
                self.entries[kept] = (self.entries[at].0, value);
                kept += 1;
            }
        }
        self.entries.truncate(kept);
    }
}

impl CsrRows<f32> {
    /// Divides each entry by the scales of its row and of its column.
    pub(crate) fn divide(&mut self, scales: &[f64]) {
        let divide = |(block, Block { starts, entries }): (usize, &mut Block<f32>)| {
            for (row, range) in starts.windows(2).enumerate() {
                let scale = scales[block * ROWS_PER_TASK + row];
                for (column, value) in &mut entries[range[0]..range[1]] {
                    *value = single(f64::from(*value) / (scale * scales[*column as usize]));
                }
            }
        };
        self.blocks.par_iter_mut().enumerate().for_each(divide);
    }
}

/// A number in single precision. One that is too large becomes the largest.
#[expect(clippy::cast_possible_truncation, reason = "rounding")]
pub(crate) fn single(value: f64) -> f32 {
    value.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
}

impl CsrRows<f64> {
    /// The entries on the diagonal, 0 where there is none.
    pub(crate) fn diagonal(&self) -> Vec<f64> {
        let own = |row: usize| self.row(row).iter().find(|(column, _)| *column as usize == row);
        (0..self.len()).map(|row| own(row).map_or(0.0, |(_, value)| *value)).collect()
    }
}
