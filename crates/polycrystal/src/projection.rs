//! A quick proof that a piece of surface does not cross itself.
//!
//! Project the piece along a direction. If every triangle keeps its orientation, then each point of the plane is covered as
//! often as the projected rim winds around it; so if the rim is one closed curve that does not cross itself, no point is
//! covered twice, and the piece is a graph over the plane. Volino and Magnenat-Thalmann 1994 use the same for cloth.

use glam::{DVec2, DVec3};

use crate::box_tree::{Bounds, BoxTree};

/// Whether triangles are proved not to cross each other. `false` says nothing.
///
/// `rim` are the edges that are not between two of the triangles, as their triangles run along them.
pub(crate) fn is_graph(points: &[DVec3], triangles: &[[u32; 3]], rim: &[[u32; 2]]) -> bool {
    let Some(rim) = closed_curve(rim) else { return false };
    let at = |corner: u32| points[corner as usize];
    let normal = |corners: [u32; 3]| {
        let [a, b, c] = corners.map(at);
        (b - a).cross(c - a)
    };
    let Some(along) = triangles.iter().map(|triangle| normal(*triangle)).sum::<DVec3>().try_normalize()
    else {
        return false;
    };
    let (right, up) = along.any_orthonormal_pair();
    let origin = at(rim[0]);
    let flat = |corner: u32| {
        let from_origin = at(corner) - origin;
        DVec2::new(from_origin.dot(right), from_origin.dot(up))
    };
    let extent = triangles.iter().flatten().map(|corner| at(*corner).abs().max_element()).fold(0.0, f64::max);
    // Rounding moves projected points by a few last places of coordinates up to twice this.
    let plane = Plane { rounding: 16.0 * f64::EPSILON * extent };
    let keeps_orientation = |corners: &[u32; 3]| plane.turn(corners.map(flat)) > 0;
    triangles.iter().all(keeps_orientation) && plane.is_simple(&rim.into_iter().map(flat).collect::<Vec<_>>())
}

/// The points of directed edges in order, if they are one closed curve through distinct points.
fn closed_curve(edges: &[[u32; 2]]) -> Option<Vec<u32>> {
    let mut next: Vec<[u32; 2]> = edges.to_vec();
    next.sort_unstable();
    let first = next.first()?[0];
    if next.windows(2).any(|pair| pair[0][0] == pair[1][0]) {
        return None;
    }
    let mut curve = Vec::with_capacity(next.len());
    let mut at = first;
    loop {
        curve.push(at);
        at = next[next.binary_search_by_key(&at, |edge| edge[0]).ok()?][1];
        if at == first {
            return (curve.len() == next.len()).then_some(curve);
        }
        if curve.len() == next.len() {
            return None;
        }
    }
}

/// The plane of projection, whose points are known but for some rounding.
struct Plane {
    rounding: f64,
}

impl Plane {
    /// 1 if three points turn left for certain, -1 if right, 0 if rounding may decide.
    fn turn(&self, [a, b, c]: [DVec2; 3]) -> i32 {
        let (to_b, to_c) = (b - a, c - a);
        let twice_area = to_b.perp_dot(to_c);
        let bound = 8.0 * self.rounding * (to_b.abs().element_sum() + to_c.abs().element_sum());
        i32::from(twice_area > bound) - i32::from(twice_area < -bound)
    }

    /// Whether a closed polygon for certain does not cross or touch itself.
    fn is_simple(&self, polygon: &[DVec2]) -> bool {
        let count = polygon.len();
        let at = |index: usize| polygon[index % count];
        let side = |index: usize| [at(index), at(index + 1)];
        let boxes = (0..count)
            .map(|index| Bounds::around(side(index).map(|end| end.extend(0.0))).widened(self.rounding));
        let mut simple = true;
        BoxTree::new(boxes).overlaps_within(&mut |a, b| {
            let [first, second] = [a.min(b) as usize, a.max(b) as usize];
            let is_good = if second == first + 1 {
                self.turns_ahead([at(first), at(second), at(second + 1)])
            } else if first == 0 && second == count - 1 {
                self.turns_ahead([at(second), at(first), at(first + 1)])
            } else {
                self.are_apart(side(first), side(second))
            };
            simple &= is_good;
        });
        simple
    }

    /// Whether the second of two consecutive sides does not run back over the first.
    fn turns_ahead(&self, [from, through, to]: [DVec2; 3]) -> bool {
        (through - from).dot(to - through) > 0.0 || self.turn([from, through, to]) != 0
    }

    fn are_apart(&self, first: [DVec2; 2], second: [DVec2; 2]) -> bool {
        let same_side = |[a, b]: [DVec2; 2], ends: [DVec2; 2]| {
            let [one, other] = ends.map(|end| self.turn([a, b, end]));
            one * other > 0
        };
        same_side(first, second) || same_side(second, first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of triangles along a helix: `turns` times around, on a cone so that no triangle lies over the next.
    fn helix(turns: f64) -> (Vec<DVec3>, Vec<[u32; 3]>, Vec<[u32; 2]>) {
        let steps = 60u32;
        let mut points = Vec::new();
        for step in 0..=steps {
            let (angle, height) =
                (std::f64::consts::TAU * turns * f64::from(step) / f64::from(steps), 0.01 * f64::from(step));
            points.extend([1.0, 2.0].map(|r| DVec3::new(r * angle.cos(), r * angle.sin(), height)));
        }
        let triangles =
            (0..steps).flat_map(|i| [[2 * i, 2 * i + 1, 2 * i + 2], [2 * i + 1, 2 * i + 3, 2 * i + 2]]);
        let mut rim: Vec<[u32; 2]> =
            (0..steps).flat_map(|i| [[2 * i + 2, 2 * i], [2 * i + 1, 2 * i + 3]]).collect();
        rim.extend([[0, 1], [2 * steps + 1, 2 * steps]]);
        (points, triangles.collect(), rim)
    }

    #[test]
    fn part_of_a_turn_is_a_graph_and_more_than_one_is_not() {
        for (turns, expected) in [(0.5, true), (0.95, true), (1.05, false), (1.6, false)] {
            let (points, triangles, rim) = helix(turns);
            assert_eq!(is_graph(&points, &triangles, &rim), expected, "{turns} turns");
        }
    }

    #[test]
    fn a_rim_of_two_curves_or_none_proves_nothing() {
        let (points, triangles, mut rim) = helix(0.5);
        rim.pop();
        assert!(!is_graph(&points, &triangles, &rim));
        assert!(!is_graph(&points, &triangles, &[]));
    }

    #[test]
    fn a_folded_piece_is_no_graph() {
        let (mut points, triangles, rim) = helix(0.5);
        points[20] += DVec3::new(0.5, 0.0, 0.0);
        assert!(!is_graph(&points, &triangles, &rim));
    }
}
