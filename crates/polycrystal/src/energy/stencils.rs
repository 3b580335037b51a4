//! How finer points of boundaries follow from their coarser ones.

use std::ops::{AddAssign, Mul, Range};

use glam::DVec3;

use crate::energy::local_elements::index_in;
use crate::mesh::id::id;

/// Those of several boundaries, one after the other. In each, finer and coarser points are counted from 0.
#[derive(Debug)]
pub(crate) struct LocalStencils {
    /// Finer point f is the mean of the coarser points `ids[starts[f]..starts[f + 1]]` by the weights of the same range.
    starts: Vec<u32>,
    ids: Vec<u32>,
    /// As numbers of `values`: there are few different ones.
    weights: Vec<u16>,
    values: Vec<f64>,
}

impl LocalStencils {
    /// None yet.
    pub(crate) fn new() -> Self {
        Self { starts: vec![0], ids: Vec::new(), weights: Vec::new(), values: Vec::new() }
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
            for (point, weight) in &entries {
                let number = self.number_of(*weight);
                self.ids.push(index_in(coarser, *point));
                self.weights.push(number);
            }
            self.starts.push(id(self.ids.len()));
        }
    }

    /// Adds those of other boundaries.
    pub(crate) fn append(&mut self, others: &Self) {
        let first = id(self.ids.len());
        let numbers: Vec<u16> = others.values.iter().map(|value| self.number_of(*value)).collect();
        self.starts.extend(others.starts[1..].iter().map(|start| first + start));
        self.ids.extend_from_slice(&others.ids);
        self.weights.extend(others.weights.iter().map(|weight| numbers[usize::from(*weight)]));
    }

    fn number_of(&mut self, weight: f64) -> u16 {
        let known = self.values.iter().position(|value| *value == weight);
        let number = known.unwrap_or_else(|| {
            self.values.push(weight);
            self.values.len() - 1
        });
        u16::try_from(number).expect("a weight belongs to a valence")
    }

    /// Those of some finer points: all of a boundary.
    pub(crate) fn of(&self, finer: Range<usize>) -> Stencils<'_> {
        Stencils { starts: &self.starts[finer.start..=finer.end], all: self }
    }

    /// Those of all finer points, which are those of one boundary.
    pub(crate) fn all(&self) -> Stencils<'_> {
        self.of(0..self.starts.len() - 1)
    }
}

/// The stencils of a boundary.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stencils<'a> {
    starts: &'a [u32],
    all: &'a LocalStencils,
}

impl Stencils<'_> {
    fn row(&self, point: usize) -> impl Iterator<Item = (usize, f64)> {
        let LocalStencils { ids, weights, values, .. } = self.all;
        let range = self.starts[point] as usize..self.starts[point + 1] as usize;
        let weights = weights[range.clone()].iter().map(|number| values[usize::from(*number)]);
        ids[range].iter().map(|id| *id as usize).zip(weights)
    }

    /// The finer points.
    pub(crate) fn apply(&self, points: &[DVec3]) -> Vec<DVec3> {
        let point = |f: usize| self.row(f).map(|(c, weight)| points[c] * weight).sum();
        (0..self.starts.len() - 1).map(point).collect()
    }

    /// Adds what is at finer points, forces or masses, to what is at coarser ones.
    pub(crate) fn pull_back<T: Copy + Mul<f64, Output = T> + AddAssign>(&self, fine: &[T], coarse: &mut [T]) {
        for (f, at_fine) in fine.iter().enumerate() {
            self.row(f).for_each(|(c, weight)| coarse[c] += *at_fine * weight);
        }
    }
}
