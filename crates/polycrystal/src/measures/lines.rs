use rayon::prelude::*;

use crate::BoundaryId;
use crate::measures::complex::Complex;
use crate::mesh::adjacency::Incidence;

/// The curves along which the same boundaries meet, triple lines and edges of the domain, and the points where they end.
pub(crate) struct Lines<'a> {
    pub(crate) lines: Vec<Line<'a>>,
    /// Points where lines end, sorted; none is a copy.
    pub(crate) corners: Vec<u32>,
}

/// A curve along which the same boundaries meet.
pub(crate) struct Line<'a> {
    /// Its edges in order.
    pub(crate) edges: Vec<&'a [Incidence]>,
    /// Its points in order, no copies; the first is the last where the line closes on itself.
    pub(crate) points: Vec<u32>,
    /// Whether it closes on itself without a corner.
    pub(crate) is_closed: bool,
    /// The boundaries that meet in it, sorted; one that meets itself comes twice.
    pub(crate) boundaries: Vec<BoundaryId>,
}

impl<'a> Lines<'a> {
    /// Follows all edges between boundaries.
    pub(crate) fn of(complex: &'a Complex<'_>) -> Self {
        let edges: Vec<&[Incidence]> = complex.non_manifold_edges().collect();
        let ends: Vec<[u32; 2]> = edges
            .par_iter()
            .map(|at| at[0].ends(complex.surface.elements).map(|end| complex.original(end)))
            .collect();
        let mut halves: Vec<(u32, usize)> =
            ends.par_iter().enumerate().flat_map_iter(|(edge, ends)| ends.map(|end| (end, edge))).collect();
        halves.par_sort_unstable();
        let at = |point: u32| {
            let start = halves.partition_point(|(other, _)| *other < point);
            let count = halves[start..].partition_point(|(other, _)| *other == point);
            &halves[start..start + count]
        };
        let is_middle = |point: u32| match at(point) {
            [(_, a), (_, b)] => complex.boundaries(edges[*a]) == complex.boundaries(edges[*b]),
            _ => false,
        };
        let corners = halves.par_chunk_by(|a, b| a.0 == b.0).map(|at| at[0].0);
        let corners: Vec<u32> = corners.filter(|point| !is_middle(*point)).collect();
        let mut is_taken = vec![false; edges.len()];
        let mut lines = Vec::new();
        let mut follow = |start: u32, first: usize, is_closed: bool| {
            if is_taken[first] {
                return;
            }
            let boundaries = complex.boundaries(edges[first]);
            let mut line = Line { edges: Vec::new(), points: vec![start], is_closed, boundaries };
            let (mut edge, mut last) = (first, start);
            loop {
                is_taken[edge] = true;
                let [a, b] = ends[edge];
                last = if a == last { b } else { a };
                line.edges.push(edges[edge]);
                line.points.push(last);
                let next = at(last).iter().find(|(_, edge)| !is_taken[*edge]);
                match next {
                    Some((_, next)) if is_middle(last) => edge = *next,
                    _ => break,
                }
            }
            lines.push(line);
        };
        for corner in &corners {
            at(*corner).iter().for_each(|(_, edge)| follow(*corner, *edge, false));
        }
        // What no corner leads to closes on itself.
        for (edge, ends) in ends.iter().enumerate() {
            follow(ends[0], edge, true);
        }
        Self { lines, corners }
    }
}
