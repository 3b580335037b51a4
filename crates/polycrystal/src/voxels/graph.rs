//! How points of boundaries are neighbours, for least bending.

use std::ops::Range;

use rayon::prelude::*;

use crate::mesh::grouped::Grouped;
use crate::voxels::staircase::{Faces, Staircase};

/// The neighbours of each point along the edges of faces.
///
/// Two faces of one kind meet in an edge inside a boundary (in the plane: in a point inside a line); every other edge is part of a line.
#[derive(Default)]
pub(super) struct Graph {
    starts: Vec<usize>,
    /// Those along lines first. Of these, nodes come first, of the others points inside boundaries: so those that follow a point stand in a row.
    neighbors: Vec<u32>,
    along_lines: Vec<u8>,
    /// Of each point: the first of its neighbours that follow it, and the first one behind these.
    following: Vec<[u8; 2]>,
}

/// Points whose neighbours a thread looks for in one go: enough to keep it busy.
const POINTS_AT_ONCE: usize = 1 << 14;

/// What a point is part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Boundary,
    /// A boundary, with a neighbour on a line.
    BesideLine,
    Line,
    /// Where lines end or meet.
    Node,
}

impl Graph {
    pub(super) fn new(staircase: &Staircase, at_points: &Grouped<u32>) -> Self {
        let count = staircase.places.len();
        let around = |points: Range<usize>| {
            let mut some = Self::default();
            for point in points {
                let along = match &staircase.faces {
                    Faces::Squares(squares) => {
                        around_squares(squares, &staircase.kind_of, at_points, point, &mut some.neighbors)
                    }
                    Faces::Segments(segments) => {
                        at_segments(segments, &staircase.kind_of, at_points, point, &mut some.neighbors)
                    }
                };
                some.along_lines.push(along);
                some.starts.push(some.neighbors.len());
            }
            some
        };
        let chunks = (0..count.div_ceil(POINTS_AT_ONCE)).into_par_iter().map(|chunk| {
            let first = chunk * POINTS_AT_ONCE;
            around(first..count.min(first + POINTS_AT_ONCE))
        });
        let mut chunks: Vec<Self> = chunks.collect();
        let along_lines: Vec<u8> =
            chunks.iter_mut().flat_map(|some| std::mem::take(&mut some.along_lines)).collect();
        let firsts = (0..count).into_par_iter().step_by(POINTS_AT_ONCE);
        firsts.zip(&mut chunks).for_each(|(first, some)| some.put_followers_together(first, &along_lines));
        let mut all = Self { starts: vec![0], along_lines, ..Self::default() };
        for some in chunks {
            let before = all.neighbors.len();
            all.starts.extend(some.starts.iter().map(|end| before + end));
            all.neighbors.extend(some.neighbors);
            all.following.extend(some.following);
        }
        all
    }

    /// Puts the neighbours of some points in order, of which the first has this number.
    fn put_followers_together(&mut self, first: usize, along_lines: &[u8]) {
        let part = |point: &u32| part(along_lines[*point as usize]);
        let mut start = 0;
        for (end, along) in self.starts.iter().zip(&along_lines[first..]) {
            let (along, off) = self.neighbors[start..*end].split_at_mut(usize::from(*along));
            along.sort_by_key(|other| part(other) != Part::Node);
            off.sort_by_key(|other| part(other) != Part::Boundary);
            let nodes = along.partition_point(|other| part(other) == Part::Node);
            let inside = off.partition_point(|other| part(other) == Part::Boundary);
            self.following.push([nodes, along.len() + inside].map(few));
            start = *end;
        }
    }

    pub(super) fn count(&self) -> usize {
        self.along_lines.len()
    }

    /// All neighbours.
    pub(super) fn beside(&self, point: usize) -> &[u32] {
        &self.neighbors[self.starts[point]..self.starts[point + 1]]
    }

    /// Those whose mean a point is to be: of a point of a line the two along it, of a point inside a boundary all; none of others.
    pub(super) fn followed(&self, point: usize) -> &[u32] {
        match part(self.along_lines[point]) {
            Part::Boundary | Part::BesideLine => self.beside(point),
            Part::Line => &self.beside(point)[..2],
            Part::Node => &[],
        }
    }

    /// What a point is part of.
    pub(super) fn part(&self, point: usize) -> Part {
        let is_on_line = |other: &u32| part(self.along_lines[*other as usize]) == Part::Line;
        match part(self.along_lines[point]) {
            Part::Boundary if self.beside(point).iter().any(is_on_line) => Part::BesideLine,
            part => part,
        }
    }

    /// The neighbours of all points, one point after the other.
    pub(super) fn neighbors(&self) -> &[u32] {
        &self.neighbors
    }

    /// The first neighbour of a point, among those of all.
    pub(super) fn first_neighbor(&self, point: usize) -> usize {
        self.starts[point]
    }

    /// Which of its neighbours follow a point: along a line all but its ends, beside it those inside boundaries.
    pub(super) fn followers_among_neighbors(&self, point: usize) -> Range<u8> {
        let [first, end] = self.following[point];
        first..end
    }
}

/// The part of a point with so many neighbours along lines.
fn part(along_lines: u8) -> Part {
    match along_lines {
        0 => Part::Boundary,
        2 => Part::Line,
        _ => Part::Node,
    }
}

/// A number of neighbours.
pub(super) fn few(count: usize) -> u8 {
    u8::try_from(count).expect("a point of the lattice has six edges, each with two sheets at most")
}

/// Adds the neighbours of a point, and returns how many are along lines.
fn around_squares(
    squares: &[[u32; 4]],
    kind_of: &[u32],
    at_points: &Grouped<u32>,
    point: usize,
    neighbors: &mut Vec<u32>,
) -> u8 {
    let mut ends: Vec<(u32, u32)> = Vec::with_capacity(16);
    for square in at_points.of(point) {
        let corners = &squares[*square as usize];
        let own = corners.iter().position(|corner| *corner as usize == point).unwrap_or(0);
        let kind = kind_of[*square as usize];
        ends.extend([(corners[(own + 1) % 4], kind), (corners[(own + 3) % 4], kind)]);
    }
    ends.sort_unstable();
    let is_inside = |at: &[(u32, u32)]| matches!(at, [one, other] if one.1 == other.1);
    let edges = || ends.chunk_by(|one, other| one.0 == other.0);
    let before = neighbors.len();
    neighbors.extend(edges().filter(|at| !is_inside(at)).map(|at| at[0].0));
    let along = neighbors.len() - before;
    neighbors.extend(edges().filter(|at| is_inside(at)).map(|at| at[0].0));
    few(along)
}

/// As [`around_squares`].
fn at_segments(
    segments: &[[u32; 2]],
    kind_of: &[u32],
    at_points: &Grouped<u32>,
    point: usize,
    neighbors: &mut Vec<u32>,
) -> u8 {
    let at = at_points.of(point);
    neighbors.extend(at.iter().map(|segment| {
        let [start, end] = segments[*segment as usize];
        if start as usize == point { end } else { start }
    }));
    let is_inside = matches!(at, [one, other] if kind_of[*one as usize] == kind_of[*other as usize]);
    // Where lines meet nothing is to be straight: such a point counts as one where a single line ends.
    u8::from(!is_inside)
}
