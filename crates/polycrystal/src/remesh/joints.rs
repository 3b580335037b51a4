//! Edges and triangles that two boundaries would both have.

use std::collections::BTreeMap;

use rayon::prelude::*;
use voronoi::Translation;

use crate::remesh::lines::DividedLine;
use crate::remesh::outline::Numbering;
use crate::remesh::shaping::Shaping;
use crate::remesh::size_field::Surroundings;
use crate::remesh::torus::{Moved, seen_from_least};

/// A boundary's triangles, and the new points on its outline.
pub(crate) type Shaped<'a> = (Shaping<'a>, BTreeMap<u32, Moved<u32>>);

fn key<const N: usize>(points: [Moved<u32>; N]) -> [Moved<u32>; N] {
    seen_from_least(points).0
}

/// Gives boundaries that have an edge or a triangle between points of lines in common, on the torus, points of their own there.
pub(crate) fn separate_joints(
    shaped: &mut [Shaped<'_>],
    around: &Surroundings<'_>,
    lines: &[DividedLine],
    numbering: &Numbering,
) {
    let mut edges: BTreeMap<[Moved<u32>; 2], usize> = BTreeMap::new();
    let mut triangles: BTreeMap<[Moved<u32>; 3], usize> = BTreeMap::new();
    for occurrence in
        around.skeleton.occurrences.iter().filter(|occurrence| occurrence.translation == Translation::ZERO)
    {
        let along = numbering.along(around, occurrence, lines[occurrence.line as usize].points.len());
        for ends in along.windows(2) {
            *edges.entry(key([ends[0], ends[1]])).or_default() += 1;
        }
    }
    for (shaping, keys) in shaped.iter() {
        for (_, edge) in joints(shaping, keys) {
            *edges.entry(edge).or_default() += 1;
        }
        if let Some(triangle) = lone_triangle(shaping, keys) {
            *triangles.entry(triangle).or_default() += 1;
        }
    }
    shaped.par_iter_mut().for_each(|(shaping, keys)| {
        let twice: Vec<[u32; 2]> =
            joints(shaping, keys).filter(|(_, edge)| edges[edge] > 1).map(|(ends, _)| ends).collect();
        if !twice.is_empty() {
            shaping.separate(&twice);
        }
        if lone_triangle(shaping, keys)
            .is_some_and(|triangle| triangles.get(&triangle).is_some_and(|count| *count > 1))
        {
            shaping.add_middle();
        }
    });
}

/// The edges inside a boundary that join points of its outline.
fn joints<'a>(
    shaping: &'a Shaping<'_>,
    keys: &'a BTreeMap<u32, Moved<u32>>,
) -> impl Iterator<Item = ([u32; 2], [Moved<u32>; 2])> + 'a {
    let both = |ends: [u32; 2]| Some((ends, key([*keys.get(&ends[0])?, *keys.get(&ends[1])?])));
    shaping.patch.inner_edges().into_iter().filter_map(both)
}

/// The only triangle of a boundary.
fn lone_triangle(shaping: &Shaping<'_>, keys: &BTreeMap<u32, Moved<u32>>) -> Option<[Moved<u32>; 3]> {
    let mut all = shaping.patch.all();
    let corners = all.next().filter(|_| all.next().is_none())?;
    Some(key([*keys.get(&corners[0])?, *keys.get(&corners[1])?, *keys.get(&corners[2])?]))
}
