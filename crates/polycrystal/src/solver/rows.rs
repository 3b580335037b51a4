//! Sparse matrices.

use std::ops::AddAssign;

use cancellation::check_cancelled;
use rayon::prelude::*;

use crate::mesh::id::id;

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
    starts: Vec<u32>,
    entries: Vec<(u32, T)>,
}

impl<T> CsrRows<T> {
    /// Rows that are made in parallel, each by `fill`.
    pub(crate) fn made_by(len: usize, fill: impl Fn(usize, &mut NewRow<'_, T>) + Sync) -> Self
    where
        T: Copy + Send,
    {
        Self::made_of_sums(len, fill, |_, _, sum| sum)
    }

    /// The same from sums of another type, so that rounding does not depend on the order in which they are added up: `value` makes an entry
    /// of its row, its column and its sum.
    pub(crate) fn made_of_sums<S: Copy>(
        len: usize,
        fill: impl Fn(usize, &mut NewRow<'_, S>) + Sync,
        value: impl Fn(usize, u32, S) -> T + Sync,
    ) -> Self
    where
        T: Send,
    {
        let block = |block: usize| {
            check_cancelled();
            let (mut sums, mut entries) = (Vec::new(), Vec::new());
            let mut starts = vec![0];
            for row in block * ROWS_PER_TASK..len.min((block + 1) * ROWS_PER_TASK) {
                fill(row, &mut NewRow { entries: &mut sums });
                entries.extend(sums.drain(..).map(|(column, sum)| (column, value(row, column, sum))));
                starts.push(id(entries.len()));
            }
            entries.shrink_to_fit();
            Block { starts, entries }
        };
        Self { blocks: (0..len.div_ceil(ROWS_PER_TASK)).into_par_iter().map(block).collect(), len }
    }

    /// The matrix with rows and columns exchanged.
    pub(crate) fn transposed(&self, column_count: usize) -> Self
    where
        T: Copy + Default,
    {
        let mut counts = vec![0_u32; column_count];
        self.columns().for_each(|column| counts[column as usize] += 1);
        let block = |counts: &mut [u32]| {
            let mut starts = vec![0];
            let mut end = 0;
            for count in counts {
                // From here on where the next entry of the row goes.
                end += std::mem::replace(count, end);
                starts.push(end);
            }
            Block { starts, entries: vec![(0, T::default()); end as usize] }
        };
        let mut blocks: Vec<Block<T>> = counts.chunks_mut(ROWS_PER_TASK).map(block).collect();
        let mut next = counts;
        for row in 0..self.len {
            for (column, value) in self.row(row) {
                let column = *column as usize;
                blocks[column / ROWS_PER_TASK].entries[next[column] as usize] = (id(row), *value);
                next[column] += 1;
            }
        }
        Self { blocks, len: column_count }
    }

    /// The columns of all entries, row by row.
    pub(crate) fn columns(&self) -> impl Iterator<Item = u32> {
        self.blocks.iter().flat_map(|block| &block.entries).map(|(column, _)| *column)
    }

    /// Gives each column the number that is listed for it.
    pub(crate) fn renumber_columns(&mut self, numbers: &[u32])
    where
        T: Send,
    {
        let entries = self.blocks.par_iter_mut().flat_map_iter(|block| &mut block.entries);
        entries.for_each(|(column, _)| *column = numbers[*column as usize]);
    }

    #[inline]
    pub(crate) fn row(&self, row: usize) -> &[(u32, T)] {
        let Block { starts, entries } = &self.blocks[row / ROWS_PER_TASK];
        let row = row % ROWS_PER_TASK;
        &entries[starts[row] as usize..starts[row + 1] as usize]
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }
}

/// A row as it is made: each column once.
pub(crate) struct NewRow<'a, T> {
    entries: &'a mut Vec<(u32, T)>,
}

impl<T: AddAssign> NewRow<'_, T> {
    /// Adds to the value of a column.
    #[inline]
    pub(crate) fn add(&mut self, column: u32, value: T) {
        match self.entries.iter_mut().find(|(known, _)| *known == column) {
            Some((_, sum)) => *sum += value,
            None => self.entries.push((column, value)),
        }
    }

    /// Makes other values of those that there are, or takes them out.
    pub(crate) fn filter_map(&mut self, value: impl Fn(&T) -> Option<T>) {
        self.entries.retain_mut(|(_, entry)| match value(entry) {
            Some(value) => {
                *entry = value;
                true
            }
            None => false,
        });
    }
}

impl CsrRows<f64> {
    /// The entries on the diagonal, 0 where there is none.
    pub(crate) fn diagonal(&self) -> Vec<f64> {
        let own = |row: usize| self.row(row).iter().find(|(column, _)| *column as usize == row);
        (0..self.len()).map(|row| own(row).map_or(0.0, |(_, value)| *value)).collect()
    }
}
