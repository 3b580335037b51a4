//! Triangles by their corners, which may be points moved by whole periods.

use voronoi::{PeriodicVertex, Side, Translation};

/// The edges of a triangle, the end of smaller number first, as seen from there.
pub(super) fn edges([a, b, c]: [PeriodicVertex; 3]) -> impl Iterator<Item = [PeriodicVertex; 2]> {
    [[a, b], [b, c], [c, a]].into_iter().map(|[from, to]| {
        let [first, second] = [from.min(to), from.max(to)];
        [first, second].map(|end| end.moved(Translation::ZERO - first.translation))
    })
}

/// How far a triangle's corner at a point is moved from the point.
pub(super) fn translation_of(corners: [PeriodicVertex; 3], point: u32) -> Translation {
    let own = corners.into_iter().find(|corner| corner.vertex == point);
    own.expect("the triangle is at this point").translation
}

/// The corners of a triangle as seen from one of its points.
pub(super) fn seen_from(corners: [PeriodicVertex; 3], point: u32) -> [PeriodicVertex; 3] {
    let moved = translation_of(corners, point);
    corners.map(|corner| corner.moved(Translation::ZERO - moved))
}

/// The corners of a triangle with one point put where another is, as seen from the first.
pub(super) fn with_corner_moved(
    corners: [PeriodicVertex; 3],
    from: u32,
    to: PeriodicVertex,
) -> [PeriodicVertex; 3] {
    corners.map(|corner| if corner.vertex == from { to.moved(corner.translation) } else { corner })
}

/// Whether segments, all with the same first part, make up one closed line that passes no point twice.
pub(super) fn is_cycle(segments: &[(Side, [PeriodicVertex; 2])]) -> bool {
    let mut ends: Vec<[PeriodicVertex; 2]> =
        segments.iter().flat_map(|(_, [from, to])| [[*from, *to], [*to, *from]]).collect();
    ends.sort_unstable();
    let others = |of: PeriodicVertex| {
        let first = ends.partition_point(|[from, _]| *from < of);
        let mut others = ends[first..].iter().take_while(|[from, _]| *from == of).map(|[_, to]| *to);
        let [Some(one), Some(other), None] = std::array::from_fn(|_| others.next()) else { return None };
        Some([one, other])
    };
    let start = ends[0][0];
    let (mut before, mut at, mut count) = (start, ends[0][1], 1);
    while at != start {
        let Some([one, other]) = others(at) else { return false };
        let next = if one == before { other } else { one };
        (before, at) = (at, next);
        count += 1;
    }
    count == segments.len() && count > 2 && others(start).is_some()
}
