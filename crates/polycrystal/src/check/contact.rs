//! Whether two elements meet where they should not, decided exactly: by the signs of Shewchuk's adaptive predicates (1997).
//!
//! Elements that share points may meet in these, or in the edge between them, and nowhere else.

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D};

/// Whether two triangles have a point in common other than the corners that they share and, when they share two, the
/// edge between these. Triangles with the same three corners are left to others.
pub(crate) fn triangles_cross(points: &[DVec3], first: [u32; 3], second: [u32; 3]) -> bool {
    let shared = |corner: &u32| second.contains(corner);
    let at = |triangle: [u32; 3]| triangle.map(|corner| points[corner as usize]);
    match first.iter().filter(|corner| shared(corner)).count() {
        0 => apart_triangles_cross(at(first), at(second)),
        1 => {
            let start = first.iter().position(shared).expect("one corner is shared");
            let [common, a, b] = [0, 1, 2].map(|k| first[(start + k) % 3]);
            let other = second.iter().position(|corner| *corner == common).expect("one corner is shared");
            let [_, c, d] = [0, 1, 2].map(|k| second[(other + k) % 3]);
            fans_cross(at([common, a, b]), at([common, c, d]))
        }
        2 => {
            let start = first.iter().position(|corner| !shared(corner)).expect("two corners are shared");
            let [apex, from, to] = at([0, 1, 2].map(|k| first[(start + k) % 3]));
            // A triangle with a corner twice has no area, which is told elsewhere.
            let Some(other) = second.iter().find(|corner| !first.contains(corner)) else { return false };
            let other = points[*other as usize];
            if volume_sign([from, to, apex], other) != 0 {
                return false;
            }
            let flat = flattening([from, to, apex]);
            let [from, to] = [flat(from), flat(to)];
            area_sign(from, to, flat(apex)) * area_sign(from, to, flat(other)) > 0
        }
        _ => false,
    }
}

/// Whether two segments in the plane have a point in common other than an end that they share.
pub(crate) fn segments_cross(points: &[DVec3], first: [u32; 2], second: [u32; 2]) -> bool {
    let at = |ends: [u32; 2]| ends.map(|end| points[end as usize].truncate());
    let common = first.iter().position(|end| second.contains(end));
    let Some(common) = common else {
        return flat_segments_meet(at(first), at(second));
    };
    let [from, a] = at([first[common], first[1 - common]]);
    let other = if second[0] == first[common] { second[1] } else { second[0] };
    if other == first[1 - common] {
        // Both ends are shared: the same segment twice.
        return false;
    }
    let b = points[other as usize].truncate();
    let same_way = |axis: usize| (a[axis] > from[axis]) == (b[axis] > from[axis]) && a[axis] != from[axis];
    area_sign(from, a, b) == 0 && if a.x == from.x { same_way(1) } else { same_way(0) }
}

/// Triangles without a common corner.
fn apart_triangles_cross(first: [DVec3; 3], second: [DVec3; 3]) -> bool {
    let signs = second.map(|corner| volume_sign(first, corner));
    if on_one_side(&signs) {
        return false;
    }
    let other_signs = first.map(|corner| volume_sign(second, corner));
    if on_one_side(&other_signs) {
        return false;
    }
    let edges_meet = |triangle: [DVec3; 3], signs: [i32; 3], other: [DVec3; 3]| {
        [[0, 1], [1, 2], [2, 0]]
            .into_iter()
            .any(|[a, b]| segment_meets_triangle([triangle[a], triangle[b]], [signs[a], signs[b]], other))
    };
    edges_meet(second, signs, first) || edges_meet(first, other_signs, second)
}

/// Triangles whose first corner is the same point: if they meet elsewhere, then on the opposite edge of one of them.
fn fans_cross(first: [DVec3; 3], second: [DVec3; 3]) -> bool {
    let signs = [second[1], second[2]].map(|corner| volume_sign(first, corner));
    if on_one_side(&signs) {
        return false;
    }
    let other_signs = [first[1], first[2]].map(|corner| volume_sign(second, corner));
    if on_one_side(&other_signs) {
        return false;
    }
    segment_meets_triangle([second[1], second[2]], signs, first)
        || segment_meets_triangle([first[1], first[2]], other_signs, second)
}

fn on_one_side(signs: &[i32]) -> bool {
    signs.iter().all(|sign| *sign > 0) || signs.iter().all(|sign| *sign < 0)
}

/// Whether they have a point in common; `signs` say on which sides of the triangle's plane the ends lie.
fn segment_meets_triangle(ends: [DVec3; 2], signs: [i32; 2], triangle: [DVec3; 3]) -> bool {
    match signs {
        [0, 0] => {
            let flat = flattening(triangle);
            let ends = ends.map(&flat);
            let [a, b, c] = triangle.map(&flat);
            let turns = [[a, b], [b, c], [c, a]].map(|[from, to]| area_sign(from, to, ends[0]));
            let inside = !turns.contains(&1) || !turns.contains(&-1);
            let has_area = area_sign(a, b, c) != 0;
            (has_area && inside)
                || [[a, b], [b, c], [c, a]].into_iter().any(|edge| flat_segments_meet(ends, edge))
        }
        [a, b] if a == b => false,
        _ => {
            let [a, b, c] = triangle;
            let turns = [[a, b], [b, c], [c, a]].map(|[from, to]| volume_sign([ends[0], ends[1], from], to));
            !turns.contains(&1) || !turns.contains(&-1)
        }
    }
}

fn flat_segments_meet(first: [DVec2; 2], second: [DVec2; 2]) -> bool {
    let signs = second.map(|end| area_sign(first[0], first[1], end));
    let other_signs = first.map(|end| area_sign(second[0], second[1], end));
    if on_one_side(&signs) || on_one_side(&other_signs) {
        return false;
    }
    // On one line only boxes can tell.
    let apart = |axis: usize| {
        let [a, b] = first.map(|end| end[axis]);
        let [c, d] = second.map(|end| end[axis]);
        a.max(b) < c.min(d) || c.max(d) < a.min(b)
    };
    !(apart(0) || apart(1))
}

/// Whether a ray along x passes a triangle, 1 in the direction of its normal, -1 against it; 0 if it does not.
///
/// The triangle does not contain the start. A ray passes through no edge: it lies off it by an infinitesimal along y, and a smaller one along z
/// (simulation of simplicity, Edelsbrunner and Mücke 1990). So it passes as many triangles of a closed surface as it should.
pub(crate) fn ray_through_triangle(start: DVec3, corners: [DVec3; 3]) -> i32 {
    if corners.iter().all(|corner| corner.x < start.x) {
        return 0;
    }
    let flat = |point: DVec3| DVec2::new(point.y, point.z);
    let [a, b, c] = corners.map(flat);
    let side = |from: DVec2, to: DVec2| match area_sign(from, to, flat(start)) {
        0 if from.y == to.y => sign(to.x - from.x),
        0 => sign(from.y - to.y),
        turn => turn,
    };
    let turn = side(a, b);
    let is_passed = turn != 0 && turn == side(b, c) && turn == side(c, a);
    if is_passed && volume_sign(corners, start) == turn { turn } else { 0 }
}

/// The same of a segment in the plane, whose normal points to its right.
pub(crate) fn ray_through_segment(start: DVec3, [a, b]: [DVec3; 2]) -> i32 {
    let is_above = |end: DVec3| end.y > start.y;
    let up = i32::from(is_above(b)) - i32::from(is_above(a));
    // Of a segment that goes up the start is on the left, if the ray passes it.
    if up != 0 && area_sign(a.truncate(), b.truncate(), start.truncate()) == up { up } else { 0 }
}

/// A projection along the axis that is steepest to the triangle: exact, as it only leaves out a coordinate.
fn flattening([a, b, c]: [DVec3; 3]) -> impl Fn(DVec3) -> DVec2 {
    let axis = (b - a).cross(c - a).abs().max_position();
    move |point| match axis {
        0 => DVec2::new(point.y, point.z),
        1 => DVec2::new(point.z, point.x),
        _ => DVec2::new(point.x, point.y),
    }
}

/// On which side of a triangle's plane a point lies: 1, -1, or 0 in the plane.
fn volume_sign([a, b, c]: [DVec3; 3], point: DVec3) -> i32 {
    // In a plane across an axis, as many walls are: filters of rounding errors would not see it, and exact arithmetic takes its time.
    if (a.cmpeq(b) & b.cmpeq(c) & c.cmpeq(point)).any() {
        return 0;
    }
    let exact = |DVec3 { x, y, z }| Coord3D { x, y, z };
    sign(robust::orient3d(exact(a), exact(b), exact(c), exact(point)))
}

/// 1 if three points of the plane turn left, -1 if right, 0 if they lie on one line.
fn area_sign(a: DVec2, b: DVec2, c: DVec2) -> i32 {
    let exact = |DVec2 { x, y }| Coord { x, y };
    sign(robust::orient2d(exact(a), exact(b), exact(c)))
}

fn sign(value: f64) -> i32 {
    i32::from(value > 0.0) - i32::from(value < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f64; 3]; 11] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.25, 0.25, -1.0],
        [0.25, 0.25, 1.0],
        [2.0, 2.0, 0.5],
        [0.2, 0.2, 0.0],
        [0.5, -1.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.25, 0.25, 0.0],
        [0.25, 0.25, 1e-300],
    ];

    fn cross(first: [u32; 3], second: [u32; 3]) -> bool {
        let points = CORNERS.map(DVec3::from_array);
        let found = triangles_cross(&points, first, second);
        // Neither order nor winding matters.
        for turn in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|k| second[(k + turn) % 3]);
            assert_eq!(triangles_cross(&points, first, [c, b, a]), found);
            assert_eq!(triangles_cross(&points, [a, b, c], first), found);
        }
        found
    }

    #[test]
    fn triangles_meet_or_not() {
        let base = [0, 1, 2];
        assert!(cross(base, [3, 4, 5]), "pierced");
        assert!(!cross(base, [4, 5, 10]), "above by the smallest of margins");
        assert!(cross(base, [4, 5, 9]), "touched from above");
        assert!(cross(base, [0, 3, 4]), "a common corner, and the edge opposite pierces");
        assert!(!cross(base, [0, 4, 5]), "a common corner alone");
        assert!(cross(base, [0, 9, 4]), "a common corner and more");
        assert!(!cross(base, [0, 1, 4]), "a common edge");
        assert!(!cross(base, [0, 1, 7]), "a common edge in one plane, side by side");
        assert!(cross(base, [0, 1, 6]), "a common edge in one plane, one over the other");
        assert!(!cross(base, [1, 2, 8]), "two halves of a square");
        assert!(cross(base, [0, 6, 8]), "in one plane, one from a corner into the other");
        assert!(!cross(base, [2, 1, 0]), "the same corners");
        assert!(!cross(base, [0, 1, 1]), "no area");
    }

    #[test]
    fn rays_pass_closed_surfaces_once() {
        // Through the middle, an edge and a corner of an octahedron.
        let corner = |axis: usize, up: bool| DVec3::AXES[axis] * if up { 1.0 } else { -1.0 };
        let passed = |start: DVec3| -> i32 {
            let of_octant = |octant: usize| {
                let up = [0, 1, 2].map(|axis| octant >> axis & 1 == 1);
                let [a, b, c] = [0, 1, 2].map(|axis| corner(axis, up[axis]));
                let is_odd = up.iter().filter(|up| **up).count() % 2 == 0;
                ray_through_triangle(start, if is_odd { [a, c, b] } else { [a, b, c] })
            };
            (0..8).map(of_octant).sum()
        };
        for [y, z] in [[0.2, 0.3], [0.0, 0.3], [0.3, 0.0], [0.0, 0.0], [-0.5, 0.0]] {
            let passed = [-2.0, 0.1, 2.0].map(|x| passed(DVec3::new(x, y, z)));
            assert_eq!(passed, [0, 1, 0], "{y} {z}");
        }
        // A square, through an edge and a corner.
        let corners = [DVec3::NEG_Y, DVec3::X, DVec3::Y, DVec3::NEG_X];
        for y in [0.3, 0.0, -0.3] {
            let passed = [-2.0, 0.1, 2.0].map(|x| -> i32 {
                let start = DVec3::new(x, y, 0.0);
                (0..4).map(|side| ray_through_segment(start, [corners[side], corners[(side + 1) % 4]])).sum()
            });
            assert_eq!(passed, [0, 1, 0], "{y}");
        }
    }

    #[test]
    fn segments_meet_or_not() {
        let points = CORNERS.map(DVec3::from_array);
        let cross = |a, b| segments_cross(&points, a, b);
        assert!(cross([0, 8], [1, 2]));
        assert!(!cross([0, 6], [1, 2]));
        assert!(!cross([0, 8], [8, 1]));
        assert!(cross([0, 8], [0, 6]), "one on the other");
        assert!(!cross([6, 0], [6, 8]), "on one line, away from each other");
        assert!(cross([0, 9], [6, 8]), "on one line, overlapping");
    }
}
