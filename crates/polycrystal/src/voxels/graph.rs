//! How points of boundaries are neighbours, for least bending.

use rayon::prelude::*;

use crate::mesh::grouped::Grouped;
use crate::voxels::staircase::{Faces, Staircase};

/// The neighbours of each point along the edges of faces: those along lines first.
///
/// Two faces of one kind meet in an edge inside a boundary (in the plane: in a point inside a line); every other edge is part of a line.
pub(super) struct Graph {
    starts: Vec<usize>,
    neighbors: Vec<u32>,
    along_lines: Vec<u8>,
}

/// What a point is part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Boundary,
    Line,
    /// Where lines end or meet.
    Node,
}

impl Graph {
    pub(super) fn new(staircase: &Staircase, at_points: &Grouped<u32>) -> Self {
        let all: Vec<(Vec<u32>, u8)> = (0..staircase.places.len())
            .into_par_iter()
            .map(|point| match &staircase.faces {
                Faces::Squares(squares) => around_squares(squares, &staircase.kind_of, at_points, point),
                Faces::Segments(segments) => at_segments(segments, &staircase.kind_of, at_points, point),
            })
            .collect();
        let mut starts = Vec::with_capacity(all.len() + 1);
        starts.push(0);
        let mut neighbors = Vec::with_capacity(5 * all.len());
        for (own, _) in &all {
            neighbors.extend_from_slice(own);
            starts.push(neighbors.len());
        }
        Self { starts, neighbors, along_lines: all.iter().map(|(_, count)| *count).collect() }
    }

    pub(super) fn count(&self) -> usize {
        self.along_lines.len()
    }

    pub(super) fn part(&self, point: usize) -> Part {
        match self.along_lines[point] {
            0 => Part::Boundary,
            2 => Part::Line,
            _ => Part::Node,
        }
    }

    /// All neighbours.
    pub(super) fn beside(&self, point: usize) -> &[u32] {
        &self.neighbors[self.starts[point]..self.starts[point + 1]]
    }

    /// Those along lines, and the others.
    pub(super) fn along_and_off(&self, point: usize) -> (&[u32], &[u32]) {
        self.beside(point).split_at(usize::from(self.along_lines[point]))
    }

    /// Those whose mean a point is to be: of a point of a line the two along it, of a point inside a boundary all; none of others.
    pub(super) fn followed(&self, point: usize) -> &[u32] {
        match self.part(point) {
            Part::Boundary => self.beside(point),
            Part::Line => self.along_and_off(point).0,
            Part::Node => &[],
        }
    }
}

fn around_squares(
    squares: &[[u32; 4]],
    kind_of: &[u32],
    at_points: &Grouped<u32>,
    point: usize,
) -> (Vec<u32>, u8) {
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
    let mut neighbors: Vec<u32> = edges().filter(|at| !is_inside(at)).map(|at| at[0].0).collect();
    let along = neighbors.len();
    neighbors.extend(edges().filter(|at| is_inside(at)).map(|at| at[0].0));
    (neighbors, u8::try_from(along).expect("a point of the lattice has six edges"))
}

fn at_segments(
    segments: &[[u32; 2]],
    kind_of: &[u32],
    at_points: &Grouped<u32>,
    point: usize,
) -> (Vec<u32>, u8) {
    let other = |segment: &u32| {
        let [start, end] = segments[*segment as usize];
        if start as usize == point { end } else { start }
    };
    let at = at_points.of(point);
    let neighbors: Vec<u32> = at.iter().map(other).collect();
    let is_inside = matches!(at, [one, other] if kind_of[*one as usize] == kind_of[*other as usize]);
    // Where lines meet nothing is to be straight.
    (neighbors, if is_inside { 0 } else { 1 })
}
