//! The faces of a periodic tessellation, each once.

use std::collections::HashMap;

use rayon::prelude::*;

use crate::exact::face_end::FaceEnd;
use crate::{Dimension, PeriodicVertex, Translation};

/// Faces in flat arrays. The first end is a cell that is not moved; the second is a greater cell, moved or not, the same
/// cell moved, or a wall.
pub(crate) struct TorusFaces {
    dimension: Dimension,
    ends: Vec<[FaceEnd; 2]>,
    starts: Vec<usize>,
    corners: Vec<PeriodicVertex>,
}

impl TorusFaces {
    pub(crate) fn new(dimension: Dimension) -> Self {
        Self { dimension, ends: Vec::new(), starts: vec![0], corners: Vec::new() }
    }

    /// Faces with the given ends, of which corners follow one another from the given starts on.
    pub(crate) fn of_parts(
        dimension: Dimension,
        ends: Vec<[FaceEnd; 2]>,
        starts: Vec<usize>,
        corners: Vec<PeriodicVertex>,
    ) -> Self {
        Self { dimension, ends, starts, corners }
    }

    /// Adds a face, unless it has shrunk to a line or a point.
    pub(crate) fn push(&mut self, ends: [FaceEnd; 2], corners: impl Iterator<Item = PeriodicVertex>) {
        let first = self.corners.len();
        for corner in corners {
            if self.corners.len() == first || self.corners[self.corners.len() - 1] != corner {
                self.corners.push(corner);
            }
        }
        if self.corners.len() > first + 1 && self.corners[self.corners.len() - 1] == self.corners[first] {
            self.corners.pop();
        }
        if self.corners.len() - first < self.dimension.fewest_corners() {
            self.corners.truncate(first);
            return;
        }
        self.ends.push(ends);
        self.starts.push(self.corners.len());
    }

    /// Adds a face that is told from either side, and may be moved by whole periods.
    pub(crate) fn push_in_order(
        &mut self,
        ends: [FaceEnd; 2],
        corners: impl Iterator<Item = PeriodicVertex>,
    ) {
        let (ends, back, is_turned) = in_order(ends);
        let moved = corners.map(|corner| corner.moved(back));
        if is_turned {
            let corners: Vec<PeriodicVertex> = moved.collect();
            self.push(ends, corners.into_iter().rev());
        } else {
            self.push(ends, moved);
        }
    }

    pub(crate) fn par_iter(&self) -> impl IndexedParallelIterator<Item = ([FaceEnd; 2], &[PeriodicVertex])> {
        let corners = self.starts.par_windows(2).map(|range| &self.corners[range[0]..range[1]]);
        self.ends.par_iter().copied().zip(corners)
    }

    fn iter(&self) -> impl Iterator<Item = ([FaceEnd; 2], &[PeriodicVertex])> {
        let corners = self.starts.windows(2).map(|range| &self.corners[range[0]..range[1]]);
        self.ends.iter().copied().zip(corners)
    }

    /// The two sides of each face.
    pub(crate) fn ends(&self) -> &[[FaceEnd; 2]] {
        &self.ends
    }

    /// Those of face f are `corners()[starts()[f]..starts()[f + 1]]`.
    pub(crate) fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// The corners of one face after the other.
    pub(crate) fn corners(&self) -> &[PeriodicVertex] {
        &self.corners
    }

    /// Takes cells without volume out that have two faces only, so that the cells beyond share one.
    ///
    /// With the right weights the bisectors of a seed with two others, one on either side, are one and the same plane: the
    /// seed's cell is then a polygon. Symbolically it has a thickness; once coincident vertices are united its two faces have the
    /// same corners, and the cells beyond them touch each other. (In the plane: a segment with two edges.)
    pub(crate) fn remove_flat_cells(&mut self, cell_count: usize) {
        let mut face_counts = vec![0usize; cell_count];
        for end in self.ends.iter().flatten() {
            if let FaceEnd::Cell(image) = end {
                face_counts[image.seed as usize] += 1;
            }
        }
        let fewest_faces = self.dimension.fewest_faces();
        let is_flat = |end: &FaceEnd| matches!(end, FaceEnd::Cell(image) if face_counts[image.seed as usize] < fewest_faces);
        let mut faces_of: HashMap<u32, Vec<usize>> = HashMap::new();
        for (face, ends) in self.ends.iter().enumerate() {
            for end in ends.iter().filter(|end| is_flat(end)) {
                if let FaceEnd::Cell(image) = end {
                    faces_of.entry(image.seed).or_default().push(face);
                }
            }
        }
        let mut flat: Vec<u32> = faces_of.keys().copied().collect();
        flat.sort_unstable();
        let mut is_dropped = vec![false; self.ends.len()];
        for cell in flat {
            let &[kept, dropped] = &faces_of[&cell][..] else {
                unreachable!("what a flat cell has beside its two faces has shrunk to lines")
            };
            let [here, there] = [kept, dropped].map(|face| usize::from(self.ends[face][1].is(cell)));
            let translation = self.ends[kept][here].translation() - self.ends[dropped][there].translation();
            let beyond = self.ends[dropped][1 - there];
            self.ends[kept][here] = beyond.moved(translation);
            is_dropped[dropped] = true;
            if let FaceEnd::Cell(image) = beyond
                && let Some(faces) = faces_of.get_mut(&image.seed)
            {
                faces.iter_mut().filter(|face| **face == dropped).for_each(|face| *face = kept);
            }
        }
        if faces_of.is_empty() {
            return;
        }
        let mut rest = Self::new(self.dimension);
        for (face, (ends, corners)) in self.iter().enumerate() {
            if !is_dropped[face] {
                rest.push_in_order(ends, corners.iter().copied());
            }
        }
        *self = rest;
    }
}

/// The ends of a face in the order of [`TorusFaces`], by how much they were moved, and whether they changed places.
fn in_order(ends: [FaceEnd; 2]) -> ([FaceEnd; 2], Translation, bool) {
    let [straight, turned] = [ends, [ends[1], ends[0]]].map(|ends| {
        let back = Translation::ZERO - ends[0].translation();
        (ends.map(|end| end.moved(back)), back)
    });
    let is_turned =
        turned.0[0] < straight.0[0] || (turned.0[0] == straight.0[0] && turned.0[1] > straight.0[1]);
    let (ends, back) = if is_turned { turned } else { straight };
    (ends, back, is_turned)
}
