//! Points where the surface of a grain touches itself, with no edge in common.

use rayon::prelude::*;

use crate::check::fault::Fault;
use crate::mesh::adjacency::{Adjacency, Incidence};
use crate::mesh::disjoint_sets::DisjointSets;
use crate::{Elements, Side, Surface};

/// The points of closed surfaces in space where the triangles of a grain are not one fan around the point but several.
///
/// In the plane, where edges are points, closedness tells that.
pub(crate) fn pinched_points(surface: &Surface<'_>, adjacency: &Adjacency) -> Vec<Fault> {
    let Elements::Triangles(triangles) = surface.elements else { return Vec::new() };
    let fans = Fans::within_boundaries(triangles, &adjacency.inner);
    let suspects = suspects(surface, adjacency, &fans);
    if !suspects.contains(&true) {
        return Vec::new();
    }
    let mut parts: Vec<Part> = Vec::new();
    for (corner, point) in (0u32..).zip(triangles.as_flattened()) {
        if suspects[*point as usize] {
            let fan = fans.number(corner);
            parts.extend(surface.sides_of(corner / 3).map(|side| Part { point: *point, side, fan }));
        }
    }
    parts.sort_unstable();
    parts.dedup();
    let mut joined = DisjointSets::new(parts.len());
    let place = |part: Part| u32::try_from(parts.binary_search(&part).ok()?).ok();
    for at in adjacency.non_manifold_edges() {
        let mut incidences: Vec<(Side, u32, u32)> = Vec::with_capacity(2 * at.len());
        for at in at {
            let corner = u32::from(at.corner);
            let corners = [3 * at.element + corner, 3 * at.element + (corner + 1) % 3];
            incidences.extend(surface.sides_of(at.element).into_iter().flat_map(|side| {
                corners.map(|corner| (side, triangles.as_flattened()[corner as usize], fans.number(corner)))
            }));
        }
        incidences.sort_unstable();
        for pair in incidences.windows(2).filter(|pair| (pair[0].0, pair[0].1) == (pair[1].0, pair[1].1)) {
            let [a, b] = [0, 1].map(|k| place(Part { point: pair[k].1, side: pair[k].0, fan: pair[k].2 }));
            if let (Some(a), Some(b)) = (a, b) {
                joined.join(a, b);
            }
        }
    }
    let mut faults = Vec::new();
    let mut first = 0u32;
    for group in parts.chunk_by(|a, b| (a.point, a.side) == (b.point, b.side)) {
        let members = (first..).take(group.len());
        let fans = members.filter(|part| joined.root(*part) == *part).count();
        first += u32::try_from(group.len()).expect("ids fit 32 bits");
        if let (Side::Grain(grain), 2..) = (group[0].side, fans) {
            faults.push(Fault::PinchedPoint { point: group[0].point, grain, fans });
        }
    }
    faults
}

/// Points that more looks like than one fan on each side: a quick look that leaves few.
fn suspects(surface: &Surface<'_>, adjacency: &Adjacency, fans: &Fans<'_>) -> Vec<bool> {
    let (mut suspects, counts) = fans.points_of_several(surface.points.len());
    let mut open: Vec<OpenFan> = fans.open_fans(adjacency, &counts);
    open.par_sort_unstable_by_key(|fan| fan.point);
    for at in open.chunk_by(|a, b| a.point == b.point) {
        let point = at[0].point as usize;
        let corners: u32 = at.iter().map(|fan| fan.corners).sum();
        suspects[point] = corners != counts[point] || !hang_together(surface, at);
    }
    suspects
}

/// A fan that does not go all around its point.
#[derive(Debug, Clone, Copy)]
struct OpenFan {
    point: u32,
    /// One of its triangles.
    element: u32,
    /// The edges where it begins and ends.
    edges: [u32; 2],
    /// How many triangles it has.
    corners: u32,
}

/// Whether those fans around a point that have a grain on one side hang together at edges, for each grain.
fn hang_together(surface: &Surface<'_>, fans: &[OpenFan]) -> bool {
    if fans.len() > 64 {
        return false;
    }
    let has_side = |fan: &OpenFan, side: Side| surface.sides_of(fan.element).contains(&side);
    let meet = |a: &OpenFan, b: &OpenFan| a.edges.iter().any(|edge| b.edges.contains(edge));
    fans.iter().enumerate().all(|(first, fan)| {
        surface.sides_of(fan.element).into_iter().filter(|side| side.grain().is_some()).all(|side| {
            // The first fan of a grain looks at all others.
            if fans[..first].iter().any(|fan| has_side(fan, side)) {
                return true;
            }
            let mut reached = 1u64 << first;
            let mut left = 0u64;
            (first + 1..fans.len()).filter(|at| has_side(&fans[*at], side)).for_each(|at| left |= 1 << at);
            while left != 0 {
                let members = |set: u64| (0..fans.len()).filter(move |at| set >> at & 1 == 1);
                let next = members(left).find(|at| members(reached).any(|by| meet(&fans[by], &fans[*at])));
                let Some(next) = next else { return false };
                reached |= 1 << next;
                left &= !(1 << next);
            }
            true
        })
    })
}

/// A fan of triangles of one boundary around a point, as one of its sides has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Part {
    point: u32,
    side: Side,
    fan: u32,
}

/// No triangle lies beyond an edge within the boundary.
const NONE: u32 = u32::MAX;

/// How triangles of one boundary follow each other around points.
///
/// Corner `k` of triangle `t` has the number `3 t + k`, and so has the edge from there to the triangle's next corner.
struct Fans<'a> {
    triangles: &'a [[u32; 3]],
    /// For each edge, the same edge as the triangle beyond runs along it.
    beyond: Vec<u32>,
}

impl<'a> Fans<'a> {
    fn within_boundaries(triangles: &'a [[u32; 3]], inner: &[[u32; 2]]) -> Self {
        let mut beyond = vec![NONE; 3 * triangles.len()];
        for [one, other] in inner {
            let corners = triangles[*other as usize];
            for (k, [from, to]) in (0u32..).zip(edges(triangles[*one as usize])) {
                if let Some((corner, _)) = (0u32..).zip(edges(corners)).find(|(_, edge)| *edge == [to, from])
                {
                    let [edge, back] = [3 * one + k, 3 * other + corner];
                    beyond[edge as usize] = back;
                    beyond[back as usize] = edge;
                }
            }
        }
        Self { triangles, beyond }
    }

    /// The corner after one at its point, if the fan does not end there.
    fn next(&self, corner: u32) -> Option<u32> {
        Some(self.beyond[edge_before(corner) as usize]).filter(|corner| *corner != NONE)
    }

    /// The number of the fan that a corner belongs to: its last corner, or the lowest where it goes all around.
    fn number(&self, corner: u32) -> u32 {
        let mut lowest = corner;
        let mut at = corner;
        while let Some(next) = self.next(at) {
            if next == corner {
                return lowest;
            }
            lowest = lowest.min(next);
            at = next;
        }
        at
    }

    /// The fans that begin and end at adjacency; points have so many corners.
    fn open_fans(&self, adjacency: &Adjacency, counts: &[u32]) -> Vec<OpenFan> {
        // Most pages of it are never touched.
        let mut edge_of = vec![0; self.beyond.len()];
        let edge = |at: &Incidence| 3 * at.element + u32::from(at.corner);
        adjacency.incidences.iter().for_each(|at| edge_of[edge(at) as usize] = at.edge);
        let fan_from = |at: &Incidence| {
            let first = edge(at);
            let point = self.triangles.as_flattened()[first as usize];
            let mut last = first;
            let mut corners = 1;
            while let Some(next) = self.next(last)
                && corners <= counts[point as usize]
            {
                last = next;
                corners += 1;
            }
            let edges = [at.edge, edge_of[edge_before(last) as usize]];
            OpenFan { point, element: at.element, edges, corners }
        };
        adjacency.incidences.par_iter().map(fan_from).collect()
    }

    /// Whether each point has other corners than those of one fan that goes all around it, and how many it has.
    fn points_of_several(&self, point_count: usize) -> (Vec<bool>, Vec<u32>) {
        let mut first = vec![NONE; point_count];
        let mut counts = vec![0u32; point_count];
        for (corner, point) in (0u32..).zip(self.triangles.as_flattened()) {
            first[*point as usize] = corner;
            counts[*point as usize] += 1;
        }
        let goes_round = |(first, count): (&u32, &u32)| {
            let mut at = *first;
            for _ in 1..*count {
                match self.next(at) {
                    Some(next) if next != *first => at = next,
                    _ => return false,
                }
            }
            true
        };
        let several = first.par_iter().zip(&counts).map(|at| *at.1 > 0 && !goes_round(at)).collect();
        (several, counts)
    }
}

/// The edge that ends at a corner, in its triangle.
fn edge_before(corner: u32) -> u32 {
    if corner.is_multiple_of(3) { corner + 2 } else { corner - 1 }
}

/// The edges of a triangle, each from the corner with the same index.
fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}
