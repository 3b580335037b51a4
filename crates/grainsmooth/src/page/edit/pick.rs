//! What a pointer is at.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::cage::Cage;

/// How near a point or an edge counts as pointed at, in pixels.
const NEAR: f64 = 8.0;

/// What hides a point must be nearer by so much of the distance: points lie on the faces around them.
const HIDDEN: f64 = 1e-3;

/// A line of sight, in the page's frame.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Ray {
    origin: [f64; 3],
    /// Of length 1.
    direction: [f64; 3],
    /// Width of a pixel at distance 1.
    pixel: f64,
    what: Wanted,
}

/// What may be picked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Wanted {
    Point,
    Edge,
    Face,
}

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Picked {
    Point(u32),
    Edge([u32; 2]),
    /// A triangle.
    Face([u32; 3]),
    Nothing,
}

/// Finds what a ray meets.
pub(super) fn pick(ray: Ray, Cage { points, edges, triangles }: &Cage) -> Picked {
    let [origin, direction] = [ray.origin, ray.direction].map(DVec3::from_array);
    let at = |point: u32| points[point as usize];
    // Where the nearest triangle is, which hides what is behind.
    let meets = |triangle: &[u32; 3]| Some((meeting(origin, direction, triangle.map(at))?, *triangle));
    let hit = triangles.iter().filter_map(meets).min_by(|a, b| a.0.total_cmp(&b.0));
    let wall = hit.map_or(f64::INFINITY, |(distance, _)| distance * (1.0 + HIDDEN) + ray.pixel * NEAR);
    match ray.what {
        Wanted::Face => hit.map_or(Picked::Nothing, |(_, triangle)| Picked::Face(triangle)),
        Wanted::Point => {
            let near = |(number, point): (u32, &DVec3)| {
                let along = (*point - origin).dot(direction);
                let beside = (origin + along * direction).distance(*point) / (along * ray.pixel);
                (along > 0.0 && along < wall && beside < NEAR).then_some((beside, number))
            };
            let found = (0..).zip(points).filter_map(near).min_by(|a, b| a.0.total_cmp(&b.0));
            found.map_or(Picked::Nothing, |(_, number)| Picked::Point(number))
        }
        Wanted::Edge => {
            let near = |ends: &[u32; 2]| {
                let (along, place) = nearest(origin, direction, ends.map(at));
                let beside = (origin + along * direction).distance(place) / (along * ray.pixel);
                (along > 0.0 && along < wall && beside < NEAR).then_some((beside, *ends))
            };
            let there = edges.iter().filter(|[start, end]| start != end);
            let found = there.filter_map(near).min_by(|a, b| a.0.total_cmp(&b.0));
            found.map_or(Picked::Nothing, |(_, ends)| Picked::Edge(ends))
        }
    }
}

/// How far along a ray a triangle is met, from either side (Moeller and Trumbore 1997).
fn meeting(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (first, second) = (b - a, c - a);
    let across = direction.cross(second);
    let determinant = first.dot(across);
    let from = origin - a;
    let u = from.dot(across) / determinant;
    let turned = from.cross(first);
    let v = direction.dot(turned) / determinant;
    let distance = second.dot(turned) / determinant;
    // Of a triangle without area these are not numbers, and nothing compares with them.
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
}

/// How far along a ray it is nearest to a segment, and where on that.
fn nearest(origin: DVec3, direction: DVec3, [a, b]: [DVec3; 2]) -> (f64, DVec3) {
    let side = b - a;
    let across = side - side.dot(direction) * direction;
    let from = origin - a;
    let square = across.length_squared();
    let share = if square > 0.0 { (from.dot(across) / square).clamp(0.0, 1.0) } else { 0.0 };
    let place = a + share * side;
    ((place - origin).dot(direction), place)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(x: f64, y: f64, what: Wanted) -> Ray {
        Ray { origin: [x, y, 5.0], direction: [0.0, 0.0, -1.0], pixel: 1e-3, what }
    }

    #[test]
    fn what_is_in_front_is_found() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let points: Vec<DVec3> =
            [1.0, 0.0].iter().flat_map(|z| corners.map(|[x, y]| DVec3::new(x, y, *z))).collect();
        let triangles = vec![[3, 4, 5], [0, 1, 2], [0; 3]];
        let edges = vec![[3, 4], [4, 5], [0, 0], [0, 1], [1, 2]];
        let cage = Cage { points, edges, triangles };
        let picked = |ray| pick(ray, &cage);
        assert_eq!(picked(ray(0.2, 0.2, Wanted::Face)), Picked::Face([0, 1, 2]));
        assert_eq!(picked(ray(0.5, 0.001, Wanted::Edge)), Picked::Edge([0, 1]));
        assert_eq!(picked(ray(0.999, 0.0, Wanted::Point)), Picked::Point(1));
        assert_eq!(picked(ray(0.2, 0.2, Wanted::Point)), Picked::Nothing);
        assert_eq!(picked(ray(2.0, 2.0, Wanted::Face)), Picked::Nothing);
        // From behind.
        let back =
            Ray { origin: [0.2, 0.2, -5.0], direction: [0.0, 0.0, 1.0], ..ray(0.0, 0.0, Wanted::Face) };
        assert_eq!(picked(back), Picked::Face([3, 4, 5]));
    }
}
