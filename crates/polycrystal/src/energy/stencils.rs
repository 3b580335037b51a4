//! How finer points of boundaries follow from their coarser ones.

use std::ops::{AddAssign, Mul};

use glam::DVec3;

use crate::energy::local_elements::index_in;

/// Those of several boundaries, one after the other. In each, finer and coarser points are counted from 0.
#[derive(Debug)]
pub(crate) struct LocalStencils {
    /// The coarser points of which each finer one is the mean.
    ids: Vec<u32>,
    /// Of each finer point, the number of its weights: there are few different ones.
    row_of: Vec<u16>,
    rows: Vec<Vec<f64>>,
    /// Where the ids and the finer points of each boundary start, and the ends.
    starts: Vec<[usize; 2]>,
}

impl LocalStencils {
    /// None yet.
    pub(crate) fn new() -> Self {
        Self { ids: Vec::new(), row_of: Vec::new(), rows: Vec::new(), starts: vec![[0; 2]] }
    }

    /// Adds those of a boundary. `stencil` puts the coarser points that a finer one depends on in place of what it is given, each with its weight;
    /// `coarser` are all of them, sorted.
    pub(crate) fn add(
        &mut self,
        stencil: impl Fn(u32, &mut Vec<(u32, f64)>),
        coarser: &[u32],
        finer: impl Iterator<Item = u32>,
    ) {
        let mut entries = Vec::new();
        for point in finer {
            stencil(point, &mut entries);
            self.ids.extend(entries.iter().map(|(point, _)| index_in(coarser, *point)));
            let row = self.number_of(entries.iter().map(|(_, weight)| *weight));
            self.row_of.push(row);
        }
        self.starts.push([self.ids.len(), self.row_of.len()]);
    }

    /// Adds those of other boundaries.
    pub(crate) fn append(&mut self, others: &Self) {
        let firsts = [self.ids.len(), self.row_of.len()];
        let rows: Vec<u16> = others.rows.iter().map(|row| self.number_of(row.iter().copied())).collect();
        self.ids.extend_from_slice(&others.ids);
        self.row_of.extend(others.row_of.iter().map(|row| rows[usize::from(*row)]));
        let starts = others.starts[1..].iter();
        self.starts.extend(starts.map(|starts| [firsts[0] + starts[0], firsts[1] + starts[1]]));
    }

    /// The number of some weights, which are known from then on.
    fn number_of(&mut self, weights: impl Iterator<Item = f64> + Clone) -> u16 {
        let known = self.rows.iter().position(|row| row.iter().copied().eq(weights.clone()));
        let number = known.unwrap_or_else(|| {
            self.rows.push(weights.collect());
            self.rows.len() - 1
        });
        u16::try_from(number).expect("weights belong to a valence")
    }

    /// Those of a boundary.
    pub(crate) fn of(&self, boundary: usize) -> Stencils<'_> {
        let [[first_id, first], [end_of_ids, end]] = [self.starts[boundary], self.starts[boundary + 1]];
        Stencils { ids: &self.ids[first_id..end_of_ids], row_of: &self.row_of[first..end], rows: &self.rows }
    }
}

/// The stencils of a boundary, as of [`LocalStencils`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stencils<'a> {
    ids: &'a [u32],
    row_of: &'a [u16],
    rows: &'a [Vec<f64>],
}

impl Stencils<'_> {
    /// Of each finer point the coarser ones and their weights.
    fn rows(self) -> impl Iterator<Item = impl Iterator<Item = (usize, f64)>> {
        let Self { ids: mut rest, row_of, rows } = self;
        row_of.iter().map(move |row| {
            let weights = rows[usize::from(*row)].as_slice();
            let own;
            (own, rest) = rest.split_at(weights.len());
            own.iter().map(|id| *id as usize).zip(weights.iter().copied())
        })
    }

    /// The finer points.
    pub(crate) fn apply(self, points: &[DVec3]) -> Vec<DVec3> {
        self.rows().map(|row| row.map(|(c, weight)| points[c] * weight).sum()).collect()
    }

    /// Adds what is at finer points, forces or masses, to what is at coarser ones.
    pub(crate) fn pull_back<T: Copy + Mul<f64, Output = T> + AddAssign>(self, fine: &[T], coarse: &mut [T]) {
        for (row, at_fine) in self.rows().zip(fine) {
            row.for_each(|(c, weight)| coarse[c] += *at_fine * weight);
        }
    }
}
