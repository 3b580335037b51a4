//! Fewer and longer segments for lines that many small ones make up.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;
use voronoi::{Domain, PeriodicVertex, Side, Translation};

/// Collapses segments shorter than the limits of both ends, as [`coarsened`](super::coarsening::coarsened) does with edges: points inside a boundary go. Where boundaries
/// meet nothing moves.
pub(crate) fn coarsened_segments(
    domain: &Domain,
    points: &[DVec3],
    limits: &[Option<f64>],
    segments: &[[PeriodicVertex; 2]],
    sides: &[[Side; 2]],
) -> Vec<Option<[PeriodicVertex; 2]>> {
    let mut at_points = vec![Vec::new(); points.len()];
    for (segment, ends) in (0u32..).zip(segments) {
        ends.iter().for_each(|end| at_points[end.vertex as usize].push(segment));
    }
    let mut left: Vec<Option<[PeriodicVertex; 2]>> = segments.iter().copied().map(Some).collect();
    let length = |ends: [PeriodicVertex; 2]| {
        let [from, to] = ends.map(|end| points[end.vertex as usize] + end.translation.vector(domain));
        from.distance(to)
    };
    let mut queue: BinaryHeap<Reverse<(u64, u32)>> = BinaryHeap::new();
    let push = |queue: &mut BinaryHeap<_>, segment: u32, ends: [PeriodicVertex; 2]| {
        let [from, to] = ends.map(|end| limits[end.vertex as usize]);
        if from.zip(to).is_some_and(|(from, to)| length(ends) < from.min(to)) {
            queue.push(Reverse((length(ends).to_bits(), segment)));
        }
    };
    (0u32..).zip(segments).for_each(|(segment, ends)| push(&mut queue, segment, *ends));
    while let Some(Reverse((bits, segment))) = queue.pop() {
        let Some(ends) = left[segment as usize].filter(|ends| length(*ends).to_bits() == bits) else {
            continue;
        };
        let [first, second] = ends;
        for [from, to] in [[first, second], [second, first]] {
            let [one, other] = at_points[from.vertex as usize][..] else { continue };
            let next = if one == segment { other } else { one };
            let Some(beyond) = left[next as usize] else { continue };
            let is_start = beyond[0].vertex == from.vertex;
            let (near, far) = if is_start { (beyond[0], beyond[1]) } else { (beyond[1], beyond[0]) };
            // By how much the next segment is moved from where this one is.
            let apart = near.translation - from.translation;
            let is_beside = |segment: &u32| {
                left[*segment as usize].is_some_and(|ends| ends.iter().any(|end| end.vertex == to.vertex))
            };
            let meets = far.vertex == to.vertex || at_points[far.vertex as usize].iter().any(is_beside);
            let beside = sides[next as usize].map(|side| side.moved(Translation::ZERO - apart));
            if sides[segment as usize] != beside || meets {
                continue;
            }
            left[segment as usize] = None;
            let there = to.moved(apart);
            let moved = if is_start { [there, far] } else { [far, there] };
            left[next as usize] = Some(moved);
            at_points[from.vertex as usize].clear();
            let at_end = &mut at_points[to.vertex as usize];
            at_end.iter_mut().filter(|own| **own == segment).for_each(|own| *own = next);
            push(&mut queue, next, moved);
            break;
        }
    }
    left
}
