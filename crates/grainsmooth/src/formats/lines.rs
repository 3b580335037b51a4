//! The lines where boundaries meet: triple lines, and the edges of the domain.

use polycrystal::BoundaryId;

use super::surface::Surface;

/// A curve along which the same boundaries meet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct JunctionLine {
    /// Its points in order; the first is the last where the line has no ends.
    pub(crate) points: Vec<u32>,
    /// The boundaries that meet in it, sorted; one that meets itself counts twice.
    pub(crate) boundaries: Vec<BoundaryId>,
}

/// The lines of a surface, and the points where they end.
pub(crate) struct Junctions {
    /// Every line once, those with ends first.
    pub(crate) lines: Vec<JunctionLine>,
    /// The ends, sorted.
    pub(crate) corners: Vec<u32>,
}

impl Junctions {
    /// Follows the edges in which anything else meets than two triangles of one boundary.
    pub(crate) fn of(surface: &Surface<'_>) -> Self {
        let edges = junction_edges(surface);
        let ends = edges.iter().enumerate().flat_map(|(edge, (ends, _))| ends.map(|end| (end, edge)));
        let mut edges_at: Vec<(u32, usize)> = ends.collect();
        edges_at.sort_unstable();
        let mut trace = Trace { is_free: vec![true; edges.len()], edges, edges_at };
        let is_end = |at: &&[(u32, usize)]| trace.is_corner(at[0].0);
        let corners: Vec<u32> =
            trace.edges_at.chunk_by(|a, b| a.0 == b.0).filter(is_end).map(|at| at[0].0).collect();
        let from_corners: Vec<(u32, usize)> =
            corners.iter().flat_map(|&corner| trace.at(corner).to_vec()).collect();
        let mut lines: Vec<JunctionLine> =
            from_corners.into_iter().filter_map(|(corner, edge)| trace.follow(corner, edge)).collect();
        // What no corner leads to closes on itself.
        for edge in 0..trace.edges.len() {
            lines.extend(trace.follow(trace.edges[edge].0[0], edge));
        }
        Self { lines, corners }
    }
}

struct Trace {
    /// The ends of each edge, and the boundaries that meet in it.
    edges: Vec<([u32; 2], Vec<BoundaryId>)>,
    /// Points with the edges that end there, sorted.
    edges_at: Vec<(u32, usize)>,
    /// Whether the edge is in no line yet.
    is_free: Vec<bool>,
}

impl Trace {
    fn at(&self, point: u32) -> &[(u32, usize)] {
        let start = self.edges_at.partition_point(|(other, _)| *other < point);
        let count = self.edges_at[start..].partition_point(|(other, _)| *other == point);
        &self.edges_at[start..start + count]
    }

    /// Whether lines end at the point: it is not the middle of one.
    fn is_corner(&self, point: u32) -> bool {
        match self.at(point) {
            [(_, a), (_, b)] => self.edges[*a].1 != self.edges[*b].1,
            _ => true,
        }
    }

    /// The line that begins with this edge at `start`, unless it was followed before.
    fn follow(&mut self, start: u32, mut edge: usize) -> Option<JunctionLine> {
        if !self.is_free[edge] {
            return None;
        }
        let boundaries = self.edges[edge].1.clone();
        let (mut points, mut last) = (vec![start], start);
        loop {
            self.is_free[edge] = false;
            let [a, b] = self.edges[edge].0;
            last = if a == last { b } else { a };
            points.push(last);
            if last == start || self.is_corner(last) {
                return Some(JunctionLine { points, boundaries });
            }
            let [(_, one), (_, other)] = self.at(last) else { unreachable!("the middle of a line") };
            edge = if *one == edge { *other } else { *one };
        }
    }
}

/// The edges, sorted, in which anything else meets than two triangles of one boundary.
fn junction_edges(surface: &Surface<'_>) -> Vec<([u32; 2], Vec<BoundaryId>)> {
    // Only points of several boundaries can be on a line.
    let mut boundary_at: Vec<Option<BoundaryId>> = vec![None; surface.points.len()];
    let mut is_shared = vec![false; surface.points.len()];
    for part in &surface.parts {
        for point in surface.triangles_of(part).flatten() {
            let first = boundary_at[point as usize].get_or_insert(part.boundary);
            is_shared[point as usize] |= *first != part.boundary;
        }
    }
    let mut uses = Vec::new();
    for part in &surface.parts {
        for [a, b, c] in surface.triangles_of(part) {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                if is_shared[from as usize] && is_shared[to as usize] {
                    uses.push(([from.min(to), from.max(to)], part.boundary));
                }
            }
        }
    }
    uses.sort_unstable();
    let edges = uses.chunk_by(|a, b| a.0 == b.0);
    let is_inside = |edge: &[([u32; 2], BoundaryId)]| matches!(edge, [(_, a), (_, b)] if a == b);
    edges
        .filter(|edge| !is_inside(edge))
        .map(|edge| (edge[0].0, edge.iter().map(|(_, boundary)| *boundary).collect()))
        .collect()
}
