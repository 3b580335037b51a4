//! Boundaries and grains in connected pieces: where the box cuts a periodic network, some are in several.

use std::ops::Range;

use glam::DVec3;
use polycrystal::BoundaryId;
use rayon::prelude::*;

use super::surface::{Part, Surface};

/// A surface whose parts are connected, and the boundary that each belongs to.
pub(crate) struct ConnectedParts<'a> {
    /// The first part of each boundary has its number; the others follow.
    pub(crate) surface: Surface<'a>,
    pub(crate) boundaries: Vec<BoundaryId>,
}

impl<'a> ConnectedParts<'a> {
    pub(crate) fn of(surface: &'a Surface<'a>) -> Self {
        let split = |part: &Part| split(surface, part);
        let mut first_of_parts: Vec<Vec<Vec<u32>>> = surface.parts.par_iter().map(split).collect();
        let firsts = first_of_parts.iter_mut().map(|pieces| pieces.remove(0)).collect::<Vec<_>>();
        let others = surface.parts.iter().zip(first_of_parts);
        let others = others.flat_map(|(part, pieces)| pieces.into_iter().map(move |piece| (part, piece)));
        let pieces: Vec<(&Part, Vec<u32>)> = surface.parts.iter().zip(firsts).chain(others).collect();
        let boundaries = pieces.iter().map(|(part, _)| part.boundary).collect();
        let numbered = (0u32..).map(BoundaryId).zip(pieces);
        let parts = numbered.map(|(id, (part, triangles))| (id, part.sides, triangles)).collect();
        Self { surface: surface.with_parts(parts), boundaries }
    }
}

/// The triangles of a part, by number, in connected pieces.
fn split(surface: &Surface<'_>, part: &Part) -> Vec<Vec<u32>> {
    let numbers = surface.numbers_of(part);
    let mut edges: Vec<([u32; 2], usize)> = Vec::with_capacity(3 * numbers.len());
    for (index, triangle) in surface.triangles_of(part).enumerate() {
        edges.extend(edges_of(triangle).map(|edge| (edge, index)));
    }
    let pieces = connected(numbers.len(), edges);
    pieces.into_iter().map(|piece| piece.into_iter().map(|index| numbers[index]).collect()).collect()
}

/// The parts of a grain's surface, true for those whose normals point inward, by connected piece of the grain. A closed surface
/// around a hole belongs to the piece that it lies in.
pub(crate) fn pieces_of_grain(surface: &Surface<'_>, parts: &[(usize, bool)]) -> Vec<Vec<(usize, bool)>> {
    let mut edges = Vec::new();
    for (index, (part, _)) in parts.iter().enumerate() {
        let mut of_part: Vec<[u32; 2]> =
            surface.triangles_of(&surface.parts[*part]).flat_map(edges_of).collect();
        of_part.sort_unstable();
        // On the rim, an edge has one triangle of the part.
        let rim = of_part.chunk_by(|a, b| a == b).filter(|edge| edge.len() == 1);
        edges.extend(rim.map(|edge| (edge[0], index)));
    }
    let shells = connected(parts.len(), edges).into_iter();
    let shells: Vec<Vec<(usize, bool)>> =
        shells.map(|shell| shell.into_iter().map(|index| parts[index]).collect()).collect();
    let (mut pieces, holes): (Vec<_>, Vec<_>) =
        shells.into_iter().partition(|shell| volume(surface, shell) > 0.0);
    for hole in holes {
        let inner = bounds(surface, &hole);
        let holds = |piece: &&mut Vec<(usize, bool)>| {
            let outer = bounds(surface, piece);
            outer.start.cmple(inner.start).all() && outer.end.cmpge(inner.end).all()
        };
        match pieces.iter_mut().find(holds) {
            Some(piece) => piece.extend(hole),
            None => pieces.push(hole),
        }
    }
    pieces
}

/// The volume within a closed surface.
pub(crate) fn volume(surface: &Surface<'_>, shell: &[(usize, bool)]) -> f64 {
    // Near the surface, so that no digits cancel far from the origin.
    let origin = bounds(surface, shell).start;
    let of_part = |&(part, is_inward): &(usize, bool)| {
        let triangles = surface.triangles_of(&surface.parts[part]);
        let triangles = triangles.map(|triangle| surface.corners(triangle).map(|corner| corner - origin));
        let cones: f64 = triangles.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
        if is_inward { -cones } else { cones }
    };
    shell.iter().map(of_part).sum()
}

/// The corners of the box around a closed surface.
pub(crate) fn bounds(surface: &Surface<'_>, shell: &[(usize, bool)]) -> Range<DVec3> {
    let points = shell.iter().flat_map(|(part, _)| surface.triangles_of(&surface.parts[*part]).flatten());
    let points = points.map(|point| surface.points[point as usize]);
    let (lower, upper) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lower, upper), point| {
        (lower.min(point), upper.max(point))
    });
    lower..upper
}

fn edges_of([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(|[from, to]| [from.min(to), from.max(to)])
}

/// Elements grouped by the edges that they share, groups and elements in order.
fn connected(count: usize, mut edges: Vec<([u32; 2], usize)>) -> Vec<Vec<usize>> {
    edges.sort_unstable();
    let mut leaders: Vec<usize> = (0..count).collect();
    let leader = |leaders: &mut [usize], mut element: usize| {
        while leaders[element] != element {
            leaders[element] = leaders[leaders[element]];
            element = leaders[element];
        }
        element
    };
    for pair in edges.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        let [a, b] = [pair[0].1, pair[1].1].map(|element| leader(&mut leaders, element));
        // The smaller one leads, so groups are in order.
        leaders[a.max(b)] = a.min(b);
    }
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); count];
    for element in 0..count {
        let leader = leader(&mut leaders, element);
        groups[leader].push(element);
    }
    groups.retain(|group| !group.is_empty());
    groups
}
