//! Quick proofs that pieces of surface do not cross themselves or each other.
//!
//! Project a surface along a direction. If every triangle keeps its orientation, then each point of the plane is covered as
//! often as the projected rim winds around it; so if the rim is one closed curve that does not cross itself, no point is
//! covered twice, and the surface is a graph over the plane. Volino and Magnenat-Thalmann 1994 use the same for cloth.
//!
//! The surface is a boundary, or two that share a line and are glued there: at 120 degrees the second goes on from the first with a
//! bend of 60 degrees, which nearly always leaves a direction from which all triangles of both are seen from the same side.

use glam::{DVec2, DVec3};

use crate::check::box_tree::{Bounds, BoxTree};
use crate::check::normal_cone::NormalCone;

/// The triangles of one boundary.
#[derive(Debug)]
pub(crate) struct Piece<'a> {
    /// What is known of the triangles' normals.
    pub(crate) normals: NormalCone,
    /// The edges that are not between two of the triangles, sorted by place.
    pub(crate) rim: &'a [RimEdge],
    /// The box around the triangles.
    pub(crate) bounds: Bounds,
}

/// An edge on the rim of a piece.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct RimEdge {
    /// Number of the edge, the same for all pieces.
    pub(crate) edge: u32,
    /// The edge as the piece's triangle runs along it.
    pub(crate) ends: [u32; 2],
}

/// Whether the triangles of a piece are proved not to cross each other. `false` says nothing.
pub(crate) fn is_graph(points: &[DVec3], piece: &Piece<'_>) -> bool {
    let rim: Vec<[u32; 2]> = piece.rim.iter().map(|edge| edge.ends).collect();
    let middle = middle(points, &rim);
    let Some(projection) = Projection::new(piece.normals.axis(), middle, piece.bounds) else { return false };
    projection.sees_front(piece, 1.0) && projection.is_simple_curve(points, &rim, &mut Vec::new())
}

/// Whether the triangles of two pieces that share edges are proved not to cross each other. `false` says nothing.
pub(crate) fn are_one_graph(
    points: &[DVec3],
    [first, second]: [&Piece<'_>; 2],
    Room { rim, flat }: &mut Room,
) -> bool {
    let Some(is_alike) = shared_edges(first, second).next().map(|[a, b]| a.ends == b.ends) else {
        return false;
    };
    // Where both run along their line the same way, the second is turned over.
    let sign = if is_alike { -1.0 } else { 1.0 };
    rim.clear();
    rim.extend(shared_edges(first, second).map(|[edge, _]| edge.ends));
    let middle = middle(points, rim);
    rim.clear();
    add_common_rim(first, second, is_alike, rim);
    let bounds = first.bounds.with(second.bounds);
    let direction = first.normals.axis() + sign * second.normals.axis();
    let Some(projection) = Projection::new(direction, middle, bounds) else {
        return false;
    };
    projection.sees_front(first, 1.0)
        && projection.sees_front(second, sign)
        && projection.is_simple_curve(points, rim, flat)
}

/// Room to work in.
#[derive(Debug, Default)]
pub(crate) struct Room {
    rim: Vec<[u32; 2]>,
    flat: Vec<[DVec2; 2]>,
}

/// The edges that are on the rims of both pieces, as each has them.
fn shared_edges<'a>(first: &Piece<'a>, second: &Piece<'a>) -> impl Iterator<Item = [&'a RimEdge; 2]> {
    let [mut rest, mut other_rest] = [first.rim, second.rim];
    std::iter::from_fn(move || {
        while let ([edge, after @ ..], [other, other_after @ ..]) = (rest, other_rest) {
            let order = edge.edge.cmp(&other.edge);
            if order.is_le() {
                rest = after;
            }
            if order.is_ge() {
                other_rest = other_after;
            }
            if order.is_eq() {
                return Some([edge, other]);
            }
        }
        None
    })
}

/// The rim of two pieces together: the edges of both, without those along which one runs as the other runs back. If `is_turned`, the
/// second runs along all its edges the other way.
fn add_common_rim(first: &Piece<'_>, second: &Piece<'_>, is_turned: bool, rim: &mut Vec<[u32; 2]>) {
    let turned = |[from, to]: [u32; 2]| if is_turned { [to, from] } else { [from, to] };
    let [mut rest, mut other_rest] = [first.rim, second.rim];
    while let ([edge, after @ ..], [other, other_after @ ..]) = (rest, other_rest) {
        let order = edge.edge.cmp(&other.edge);
        let [ends, other_ends] = [edge.ends, turned(other.ends)];
        let cancels = order.is_eq() && ends == [other_ends[1], other_ends[0]];
        if order.is_le() {
            rest = after;
            rim.extend((!cancels).then_some(ends));
        }
        if order.is_ge() {
            other_rest = other_after;
            rim.extend((!cancels).then_some(other_ends));
        }
    }
    rim.extend(rest.iter().map(|edge| edge.ends));
    rim.extend(other_rest.iter().map(|edge| turned(edge.ends)));
}

/// The mean of the ends of some edges, the origin if there are none.
fn middle(points: &[DVec3], edges: &[[u32; 2]]) -> DVec3 {
    let ends = edges.as_flattened();
    let sum: DVec3 = ends.iter().map(|end| points[*end as usize]).sum();
    sum / ends.len().max(1) as f64
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

/// Bound on what rounding does to a product of two lengths that are at most the size of the surface, as a share of that size squared:
/// 450 times the distance of 1 from the next number. Error analysis asks for 66 times, for points up to three sizes away.
const ROUNDING: f64 = 1e-13;

/// Surfaces whose size squared is smaller than this are left alone: products of lengths lose digits as they become too small.
const SMALLEST_SQUARE: f64 = 1e-200;

/// Points from which a rim is looked at: one is enough for most, the second and third for nearly all others.
const CENTERS: usize = 6;

/// A map to the plane along a direction. What it finds it finds for certain: for the points without rounding too.
#[derive(Debug)]
struct Projection {
    right: DVec3,
    up: DVec3,
    /// The direction: how `right` turns into `up`.
    along: DVec3,
    /// The point that comes to lie in the plane's origin.
    origin: DVec3,
    /// What twice the area of a projected triangle has to be larger than to be positive for certain.
    bound: f64,
    /// How far points in the plane can be from where they should be.
    rounding: f64,
    /// The diagonal of the box.
    size: f64,
}

impl Projection {
    /// The projection along a direction of what lies in a box, and so does `origin`.
    fn new(direction: DVec3, origin: DVec3, bounds: Bounds) -> Option<Self> {
        let (right, up) = direction.try_normalize()?.any_orthonormal_pair();
        let square = bounds.size().length_squared();
        let size = square.sqrt();
        let size_is_good = square > SMALLEST_SQUARE && square < 1.0 / SMALLEST_SQUARE;
        size_is_good.then(|| Self {
            right,
            up,
            along: right.cross(up),
            origin,
            bound: ROUNDING * square,
            rounding: 16.0 * f64::EPSILON * size,
            size,
        })
    }

    #[inline]
    fn flat(&self, point: DVec3) -> DVec2 {
        let from_origin = point - self.origin;
        DVec2::new(from_origin.dot(self.right), from_origin.dot(self.up))
    }

    /// Whether it is known of all triangles of a piece, turned over if `sign` is -1, that they keep their orientation.
    fn sees_front(&self, piece: &Piece<'_>, sign: f64) -> bool {
        piece.normals.least_along(sign * self.along) > self.bound
    }

    /// Whether a rim is for certain one closed curve, counter-clockwise, that does not cross or touch itself. `flat` is room for its edges.
    fn is_simple_curve(&self, points: &[DVec3], rim: &[[u32; 2]], flat: &mut Vec<[DVec2; 2]>) -> bool {
        flat.clear();
        flat.extend(rim.iter().map(|edge| edge.map(|end| self.flat(points[end as usize]))));
        let mut center = DVec2::ZERO;
        for _ in 0..CENTERS {
            match self.goes_round(flat, center) {
                Ok(rounds) => return rounds == 1,
                Err(step) => center += step,
            }
            // Bounds are for what lies near.
            if center.length() > self.size || center.is_nan() {
                break;
            }
        }
        closed_curve(rim).is_some_and(|rim| {
            let rim: Vec<DVec2> = rim.into_iter().map(|point| self.flat(points[point as usize])).collect();
            self.is_simple(&rim)
        })
    }

    /// How often a rim goes around a point, if it goes to the left for certain on all its way, as seen from there: once means that it is
    /// one curve, and simple. Otherwise a step to where more of the rim may be seen so.
    ///
    /// A rim enters each of its points as often as it leaves it. So it is made of closed curves, and each that goes left all the
    /// way goes around at least once.
    fn goes_round(&self, rim: &[[DVec2; 2]], center: DVec2) -> Result<u32, DVec2> {
        let mut rounds = 0;
        let mut is_left = true;
        let (mut least, mut worst) = (f64::INFINITY, [DVec2::ZERO; 2]);
        for edge in rim {
            let [from, to] = edge.map(|end| end - center);
            let turn = from.perp_dot(to);
            is_left &= turn > self.bound;
            if turn < least {
                (least, worst) = (turn, *edge);
            }
            // Each time around, one edge comes up through the right half of the axis.
            rounds += u32::from(from.y < 0.0 && to.y >= 0.0);
        }
        if is_left {
            return Ok(rounds);
        }
        // Across the worst edge and as far again, or else a little.
        let along = worst[1] - worst[0];
        let across = along.perp() / along.length_squared();
        Err(across * (-2.0 * least + 0.5 * along.length_squared()))
    }

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
        let Ok(sides) = u32::try_from(count) else { return false };
        let bounds = |index: u32| {
            Bounds::around(side(index as usize).map(|end| end.extend(0.0))).widened(self.rounding)
        };
        let mut simple = true;
        BoxTree::new((0..sides).collect(), bounds).overlaps_within(bounds, &mut |a, b| {
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

    /// Points, triangles and a rim.
    type Parts = (Vec<DVec3>, Vec<[u32; 3]>, Vec<[u32; 2]>);

    fn normals(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
        let normal = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|corner| points[corner as usize]);
            (b - a).cross(c - a)
        };
        triangles.iter().map(normal).collect()
    }

    fn rim_edges(rim: &[[u32; 2]]) -> Vec<RimEdge> {
        // Points are few: an edge's number follows from its ends.
        let edge = |[from, to]: [u32; 2]| 1000 * from.min(to) + from.max(to);
        let mut rim: Vec<RimEdge> =
            rim.iter().map(|ends| RimEdge { edge: edge(*ends), ends: *ends }).collect();
        rim.sort_unstable_by_key(|edge| edge.edge);
        rim
    }

    fn piece<'a>(points: &[DVec3], rim: &'a [RimEdge], normals: &[DVec3]) -> Piece<'a> {
        Piece { normals: NormalCone::of(normals), rim, bounds: Bounds::around(points.iter().copied()) }
    }

    fn is_graph((points, triangles, rim): &Parts) -> bool {
        let normals = normals(points, triangles);
        super::is_graph(points, &piece(points, &rim_edges(rim), &normals))
    }

    /// A strip of triangles along a helix: `turns` times around, on a cone so that no triangle lies over the next.
    fn helix(turns: f64) -> Parts {
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
            assert_eq!(is_graph(&helix(turns)), expected, "{turns} turns");
        }
    }

    #[test]
    fn a_rim_of_two_curves_or_none_proves_nothing() {
        let mut parts = helix(0.5);
        parts.2.pop();
        assert!(!is_graph(&parts));
        parts.2.clear();
        assert!(!is_graph(&parts));
    }

    #[test]
    fn a_folded_piece_is_no_graph() {
        let mut parts = helix(0.5);
        parts.0[20] += DVec3::new(0.5, 0.0, 0.0);
        assert!(!is_graph(&parts));
    }

    /// Whether two rectangles are one graph that share the edge from the origin to (0, 1, 0); the second rises by `slope`, and `peak` is how
    /// far the middle of its other edge leans back over the first.
    fn rectangles_are_one_graph(slope: f64, peak: f64, is_turned: bool) -> bool {
        let [low, high] = [0.0, 1.0].map(|y| DVec3::new(0.0, y, 0.0));
        let across = DVec3::new(1.0, 0.0, slope);
        let top = DVec3::new(1.0 - peak, 0.5, slope);
        let points = [low, high, high - DVec3::X, low - DVec3::X, low + across, high + across, top];
        let mut triangles = vec![[0, 1, 2], [0, 2, 3], [1, 0, 6], [0, 4, 6], [5, 1, 6]];
        let mut rim = vec![[1, 0], [0, 4], [4, 6], [6, 5], [5, 1]];
        if is_turned {
            triangles[2..].iter_mut().for_each(|corners| corners.swap(0, 1));
            rim.iter_mut().for_each(|ends| ends.swap(0, 1));
        }
        let normals = normals(&points, &triangles);
        let rims = [rim_edges(&[[0, 1], [1, 2], [2, 3], [3, 0]]), rim_edges(&rim)];
        let first = piece(&points, &rims[0], &normals[..2]);
        let second = piece(&points, &rims[1], &normals[2..]);
        let room = &mut Room::default();
        let found = are_one_graph(&points, [&first, &second], room);
        assert_eq!(are_one_graph(&points, [&second, &first], room), found);
        found
    }

    #[test]
    fn two_pieces_with_a_bend_are_one_graph_however_they_wind() {
        for is_turned in [false, true] {
            for slope in [0.0, 1.7, -1.7, 20.0] {
                assert!(rectangles_are_one_graph(slope, 0.0, is_turned), "slope {slope}");
                assert!(rectangles_are_one_graph(slope, 0.3, is_turned), "slope {slope}");
            }
        }
    }

    #[test]
    fn two_pieces_one_of_which_reaches_through_the_other_are_no_graph() {
        for is_turned in [false, true] {
            assert!(!rectangles_are_one_graph(0.0, 1.5, is_turned));
        }
    }
}
