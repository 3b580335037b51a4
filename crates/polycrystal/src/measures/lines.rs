use rayon::prelude::*;

use crate::measures::complex::Complex;
use crate::mesh::adjacency::Incidence;
use crate::mesh::angles::edge_length;
use crate::mesh::grouped::Grouped;
use crate::{BoundaryId, Surface};

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

impl Line<'_> {
    /// Its length on a surface.
    pub(crate) fn length(&self, surface: &Surface<'_>) -> f64 {
        self.edges.iter().map(|at| edge_length(surface, at)).sum()
    }
}

impl<'a> Lines<'a> {
    /// Follows all edges between boundaries.
    pub(crate) fn of(complex: &'a Complex<'_>) -> Self {
        let edges: Vec<&[Incidence]> = complex.non_manifold_edges().collect();
        let ends: Vec<[u32; 2]> = edges
            .par_iter()
            .map(|at| at[0].ends(complex.surface.elements).map(|end| complex.original(end)))
            .collect();
        let point_count = ends.iter().flatten().max().map_or(0, |last| *last as usize + 1);
        let edges_at = ends.iter().enumerate().flat_map(|(edge, ends)| ends.map(|end| (end as usize, edge)));
        let edges_at = Grouped::new(point_count, edges_at);
        let is_corner = |point: usize| match edges_at.of(point) {
            [] => false,
            [a, b] => complex.boundaries(edges[*a]) != complex.boundaries(edges[*b]),
            _ => true,
        };
        let is_corner: Vec<bool> = (0..point_count).into_par_iter().map(is_corner).collect();
        let corners: Vec<u32> = (0u32..).zip(&is_corner).filter(|(_, is)| **is).map(|(at, _)| at).collect();
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
                let next = edges_at.of(last as usize).iter().find(|edge| !is_taken[**edge]);
                match next {
                    Some(next) if !is_corner[last as usize] => edge = *next,
                    _ => break,
                }
            }
            lines.push(line);
        };
        for corner in &corners {
            edges_at.of(*corner as usize).iter().for_each(|edge| follow(*corner, *edge, false));
        }
        // What no corner leads to closes on itself.
        for (edge, ends) in ends.iter().enumerate() {
            follow(ends[0], edge, true);
        }
        Self { lines, corners }
    }
}
