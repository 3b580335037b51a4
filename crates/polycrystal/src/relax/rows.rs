//! Sparse matrices.

/// Rows of pairs of a column and a value.
pub(super) struct Rows<T> {
    starts: Vec<usize>,
    entries: Vec<(u32, T)>,
}

impl<T: Copy> Rows<T> {
    pub(super) fn new(rows: Vec<Vec<(u32, T)>>) -> Self {
        let mut starts = vec![0];
        for row in &rows {
            starts.push(starts[starts.len() - 1] + row.len());
        }
        Self { starts, entries: rows.concat() }
    }

    /// Of rows, columns and values in any order; within a row they stay in it.
    pub(super) fn of_entries(count: usize, entries: impl Iterator<Item = (u32, u32, T)> + Clone) -> Self
    where
        T: Default,
    {
        let mut starts = vec![0; count + 1];
        for (row, ..) in entries.clone() {
            starts[row as usize + 1] += 1;
        }
        for row in 0..count {
            starts[row + 1] += starts[row];
        }
        let mut next = starts.clone();
        let mut sorted = vec![(0, T::default()); starts[count]];
        for (row, column, value) in entries {
            sorted[next[row as usize]] = (column, value);
            next[row as usize] += 1;
        }
        Self { starts, entries: sorted }
    }

    pub(super) fn row(&self, row: usize) -> &[(u32, T)] {
        &self.entries[self.starts[row]..self.starts[row + 1]]
    }

    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }
}
