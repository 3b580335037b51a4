//! Points where the surface of a grain touches itself, with no edge in common.

use rayon::prelude::*;
use subzero::{HalfEdgeId, RefinedMesh};

use crate::check::fault::Fault;
use crate::mesh::adjacency::{Adjacency, Incidence, Inner};
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::id::id;
use crate::{BoundaryId, Elements, Side, Surface};

/// The points of closed surfaces in space where the triangles of a grain are not one fan around the point but several.
///
/// In the plane, where places are points, that is what closing tells.
pub(crate) fn pinched_points(surface: &Surface<'_>, adjacency: &Adjacency<'_>) -> Vec<Fault> {
    if let Elements::Segments(_) = surface.elements {
        return Vec::new();
    }
    let fans = Fans { elements: surface.elements, half_edges: HalfEdges::new(surface.elements, adjacency) };
    let suspects = suspects(surface, adjacency, &fans);
    if !suspects.contains(&true) {
        return Vec::new();
    }
    let mut parts: Vec<Part> = Vec::new();
    for corner in fans.corners() {
        let point = fans.point(corner);
        if suspects[point as usize] {
            let fan = fans.number(corner);
            parts.extend(surface.sides_of(corner / 3).map(|side| Part { point, side, fan }));
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
            incidences.extend(
                surface
                    .sides_of(at.element)
                    .into_iter()
                    .flat_map(|side| corners.map(|corner| (side, fans.point(corner), fans.number(corner)))),
            );
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
fn suspects(surface: &Surface<'_>, adjacency: &Adjacency<'_>, fans: &Fans<'_>) -> Vec<bool> {
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

/// How triangles of one boundary meet at their edges. The edge from corner `k` of triangle `t` to the next has the number `3 t + k`.
enum HalfEdges<'a> {
    /// As it follows from a mesh whose triangles have these boundaries.
    OfMesh { mesh: RefinedMesh<'a>, boundary_of: &'a [BoundaryId] },
    /// For each edge, the same edge as the triangle beyond runs along it, and its number among all edges if it is not inside a boundary.
    Listed { beyond: Vec<u32>, numbers: Vec<u32> },
}

impl<'a> HalfEdges<'a> {
    fn new(elements: Elements<'a>, adjacency: &Adjacency<'a>) -> Self {
        let pairs = match &adjacency.inner {
            Inner::OfMesh { mesh, boundary_of } => return Self::OfMesh { mesh: *mesh, boundary_of },
            Inner::Listed(pairs) => pairs,
        };
        let mut beyond = vec![NONE; 3 * elements.len()];
        for [one, other] in pairs {
            let (corners, others) = (elements.corners(*one), elements.corners(*other));
            for k in 0..3 {
                let edge = [corners[k], corners[(k + 1) % 3]];
                if let Some(place) = (0..3).find(|place| [others[(place + 1) % 3], others[*place]] == edge) {
                    let [edge, back] = [3 * one + id(k), 3 * other + id(place)];
                    beyond[edge as usize] = back;
                    beyond[back as usize] = edge;
                }
            }
        }
        // Most pages of it are never touched.
        let mut numbers = vec![0; beyond.len()];
        adjacency.incidences.iter().for_each(|at| numbers[half_edge(at) as usize] = at.edge);
        Self::Listed { beyond, numbers }
    }

    /// The edge as the triangle beyond runs along it, if that is one of the same boundary.
    #[inline]
    fn beyond(&self, edge: u32) -> Option<u32> {
        match self {
            Self::Listed { beyond, .. } => Some(beyond[edge as usize]).filter(|beyond| *beyond != NONE),
            Self::OfMesh { mesh, boundary_of } => {
                let beyond = mesh.half_edge_beyond(HalfEdgeId(edge))?;
                let boundary = |edge: u32| boundary_of[mesh.ancestor(HalfEdgeId(edge).triangle()).index()];
                (boundary(beyond.0) == boundary(edge)).then_some(beyond.0)
            }
        }
    }

    /// The number of a non-manifold edge among all edges.
    fn number(&self, edge: u32) -> u32 {
        match self {
            Self::Listed { numbers, .. } => numbers[edge as usize],
            Self::OfMesh { mesh, .. } => mesh.edge_of(HalfEdgeId(edge)).0,
        }
    }
}

/// The edge that a use is one of.
fn half_edge(at: &Incidence) -> u32 {
    3 * at.element + u32::from(at.corner)
}

/// How triangles of one boundary follow each other around points. Corners are numbered as the edges that start there.
struct Fans<'a> {
    elements: Elements<'a>,
    half_edges: HalfEdges<'a>,
}

impl Fans<'_> {
    /// All corners.
    fn corners(&self) -> std::ops::Range<u32> {
        0..id(3 * self.elements.len())
    }

    /// The point of a corner.
    fn point(&self, corner: u32) -> u32 {
        self.elements.corners(corner / 3)[(corner % 3) as usize]
    }

    /// The corner after one at its point, if the fan does not end there.
    fn next(&self, corner: u32) -> Option<u32> {
        self.half_edges.beyond(edge_before(corner))
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
    fn open_fans(&self, adjacency: &Adjacency<'_>, counts: &[u32]) -> Vec<OpenFan> {
        let fan_from = |at: &Incidence| {
            let first = half_edge(at);
            let point = self.point(first);
            let mut last = first;
            let mut corners = 1;
            while let Some(next) = self.next(last)
                && corners <= counts[point as usize]
            {
                last = next;
                corners += 1;
            }
            let edges = [at.edge, self.half_edges.number(edge_before(last))];
            OpenFan { point, element: at.element, edges, corners }
        };
        adjacency.incidences.par_iter().map(fan_from).collect()
    }

    /// Whether each point has other corners than those of one fan that goes all around it, and how many it has.
    fn points_of_several(&self, point_count: usize) -> (Vec<bool>, Vec<u32>) {
        let mut first = vec![NONE; point_count];
        let mut counts = vec![0u32; point_count];
        for triangle in 0..id(self.elements.len()) {
            for (corner, point) in (3 * triangle..).zip(self.elements.corners(triangle).iter()) {
                first[*point as usize] = corner;
                counts[*point as usize] += 1;
            }
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
