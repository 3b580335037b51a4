use std::ops::Range;

use rayon::prelude::*;

use crate::{CellId, FaceId, Side};

/// The faces of every cell.
///
/// The lists may follow one another in any order of the cells: what is near in space should be near in memory.
#[derive(Debug, Default, Clone)]
pub(crate) struct CellFaces {
    /// Where the list of each cell is.
    pub(crate) ranges: Vec<Range<u32>>,
    pub(crate) lists: Vec<FaceId>,
}

impl PartialEq for CellFaces {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

impl CellFaces {
    /// Lists the faces of each cell by number, given the sides of all faces and the index of each cell's list among the lists; in
    /// that order, `counts` are the lengths of these if they are known. Each thread takes some of the cells and looks for them through all
    /// faces.
    pub(crate) fn new(face_sides: &[[Side; 2]], indices: &[u32], counts: Option<Vec<u32>>) -> Self {
        // The cells of a face among `count` from index `first` on, by index counted from there.
        let cells_of = |sides: [Side; 2], first: usize, count: usize| {
            let index = move |side: Side| match side {
                Side::Cell(cell) => Some((indices[cell.index()] as usize).wrapping_sub(first)),
                Side::Image(..) | Side::Wall(_) => None,
            };
            sides.into_iter().filter_map(index).filter(move |index| *index < count)
        };
        let some_cells = indices.len().div_ceil(rayon::current_num_threads());
        let counts = counts.unwrap_or_else(|| {
            let mut counts = vec![0; indices.len()];
            counts.par_chunks_mut(some_cells).enumerate().for_each(|(chunk, counts)| {
                for sides in face_sides {
                    for index in cells_of(*sides, chunk * some_cells, counts.len()) {
                        counts[index] += 1;
                    }
                }
            });
            counts
        });
        let mut starts = vec![0u32];
        let mut end = 0u32;
        starts.extend(counts.iter().map(|count| {
            end = end.checked_add(*count).expect("the sides of all faces fit 32 bits");
            end
        }));
        // As numbers, for then zeros are pages that nobody has written yet, and the threads share the work of the first time.
        let mut lists = vec![0u32; starts[indices.len()] as usize];
        let mut rest = &mut lists[..];
        let mut parts = Vec::new();
        for first in (0..indices.len()).step_by(some_cells) {
            let starts = &starts[first..=(first + some_cells).min(indices.len())];
            let (part, others) = rest.split_at_mut((starts[starts.len() - 1] - starts[0]) as usize);
            parts.push((first, starts, part));
            rest = others;
        }
        parts.into_par_iter().for_each(|(first, starts, part)| {
            let mut next: Vec<u32> = starts.iter().map(|start| start - starts[0]).collect();
            for (face, sides) in (0u32..).zip(face_sides) {
                for index in cells_of(*sides, first, starts.len() - 1) {
                    part[next[index] as usize] = face;
                    next[index] += 1;
                }
            }
        });
        let range = |index: &u32| starts[*index as usize]..starts[*index as usize + 1];
        Self {
            ranges: indices.par_iter().map(range).collect(),
            lists: lists.into_iter().map(FaceId).collect(),
        }
    }

    /// The faces of a cell.
    pub(crate) fn of(&self, cell: CellId) -> &[FaceId] {
        let Range { start, end } = self.ranges[cell.index()];
        &self.lists[start as usize..end as usize]
    }

    fn iter(&self) -> impl Iterator<Item = &[FaceId]> {
        self.ranges.iter().map(|range| &self.lists[range.start as usize..range.end as usize])
    }
}
