//! Sparse matrices.

use std::ops::AddAssign;

use cancellation::check_cancelled;
use rayon::prelude::*;

/// Rows that one task makes: enough to be worth a task, and few enough for all threads to have some.
const ROWS_PER_TASK: usize = 1024;

/// Rows of pairs of a column and a value.
#[derive(Debug)]
pub(crate) struct CsrRows<T> {
    starts: Vec<usize>,
    entries: Vec<(u32, T)>,
}

impl<T: Copy> CsrRows<T> {
    pub(crate) fn new(rows: Vec<Vec<(u32, T)>>) -> Self {
        let mut starts = vec![0];
        for row in &rows {
            starts.push(starts[starts.len() - 1] + row.len());
        }
        Self { starts, entries: rows.concat() }
    }

    /// Rows that are made in parallel, each by `fill`.
    pub(crate) fn made_by(count: usize, fill: impl Fn(usize, &mut NewRow<'_, T>) + Sync) -> Self
    where
        T: Send,
    {
        let task = |task: usize| {
            check_cancelled();
            let mut entries = Vec::new();
            let rows = task * ROWS_PER_TASK..count.min((task + 1) * ROWS_PER_TASK);
            let ends: Vec<usize> = rows
                .map(|row| {
                    fill(row, &mut NewRow { start: entries.len(), entries: &mut entries });
                    entries.len()
                })
                .collect();
            (ends, entries)
        };
        let tasks: Vec<_> = (0..count.div_ceil(ROWS_PER_TASK)).into_par_iter().map(task).collect();
        let mut rows = Self { starts: vec![0], entries: Vec::new() };
        rows.entries.reserve_exact(tasks.iter().map(|(_, entries)| entries.len()).sum());
        for (ends, entries) in tasks {
            let before = rows.entries.len();
            rows.starts.extend(ends.iter().map(|end| before + end));
            rows.entries.extend(entries);
        }
        rows
    }

    /// The matrix with rows and columns exchanged.
    pub(crate) fn transposed(&self, column_count: usize) -> Self
    where
        T: Default,
    {
        let mut starts = vec![0; column_count + 1];
        for (column, _) in &self.entries {
            starts[*column as usize + 1] += 1;
        }
        for column in 0..column_count {
            starts[column + 1] += starts[column];
        }
        let mut next = starts.clone();
        let mut entries = vec![(0, T::default()); self.entries.len()];
        for row in 0..self.len() {
            let id = u32::try_from(row).expect("a matrix has no more rows than ids");
            for (column, value) in self.row(row) {
                let place = &mut next[*column as usize];
                entries[*place] = (id, *value);
                *place += 1;
            }
        }
        Self { starts, entries }
    }

    pub(crate) fn row(&self, row: usize) -> &[(u32, T)] {
        &self.entries[self.starts[row]..self.starts[row + 1]]
    }

    pub(crate) fn len(&self) -> usize {
        self.starts.len() - 1
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

impl CsrRows<f64> {
    /// The entries on the diagonal, 0 where there is none.
    pub(crate) fn diagonal(&self) -> Vec<f64> {
        let own = |row: usize| self.row(row).iter().find(|(column, _)| *column as usize == row);
        (0..self.len()).map(|row| own(row).map_or(0.0, |(_, value)| *value)).collect()
    }
}
