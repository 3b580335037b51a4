//! Numbering along a space-filling curve, so that what is near in space is near in memory.

use glam::DVec3;

use crate::Point;
use crate::ids::id;

/// Bits of a place on the curve that each coordinate gives; three times as many fit 64 bits.
const BITS_PER_AXIS: u32 = 21;

/// An order of the vertices and triangles of a mesh along Morton's curve (Morton 1966) through its bounding cube.
///
/// Refinement keeps what is near in the base mesh near in memory, so that a mesh numbered this way takes new points faster
/// than one numbered at random.
///
/// ```
/// use glam::DVec3;
/// use subzero::CurveOrder;
///
/// let points = [DVec3::ZERO, DVec3::splat(9.), DVec3::X, DVec3::new(9., 8., 9.), DVec3::Y];
/// let triangles = [[0, 1, 2], [2, 1, 3], [0, 2, 4]];
///
/// let order = CurveOrder::new(&points, &triangles);
/// assert_eq!(order.vertices(), [0, 2, 4, 3, 1]);
/// assert_eq!(order.points(&points)[4], points[1]);
/// assert_eq!(order.renumbered(&triangles)[0], [0, 1, 2]);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CurveOrder {
    vertices: Vec<u32>,
    triangles: Vec<u32>,
}

impl CurveOrder {
    /// The order of `triangles` over `points`. What shares a place on the curve stays in the order given.
    ///
    /// # Panics
    /// If a triangle names a vertex that has no point, or if ids do not fit 32 bits.
    pub fn new(points: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let low = points.iter().copied().reduce(DVec3::min).unwrap_or_default();
        let high = points.iter().copied().reduce(DVec3::max).unwrap_or_default();
        let edge = (high - low).max_element();
        let place = |point: DVec3| place_on_curve((point - low) / edge);
        let centre = |triangle: &[u32; 3]| triangle.iter().map(|&v| points[v as usize]).sum::<DVec3>() / 3.0;
        Self {
            vertices: sorted_by_place(points.iter().map(|&point| place(point))),
            triangles: sorted_by_place(triangles.iter().map(|triangle| place(centre(triangle)))),
        }
    }

    /// The given id of each vertex, in the new order.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// The given id of each triangle, in the new order.
    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// The points in the new order.
    ///
    /// # Panics
    /// If there are fewer points than vertices.
    pub fn points<P: Point>(&self, points: &[P]) -> Vec<P> {
        self.vertices.iter().map(|&v| points[v as usize]).collect()
    }

    /// The triangles in the new order, with the new ids of their vertices.
    ///
    /// # Panics
    /// If these are not triangles over the vertices of this order.
    pub fn renumbered(&self, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let mut new_ids = vec![0; self.vertices.len()];
        for (new, &old) in self.vertices.iter().enumerate() {
            new_ids[old as usize] = id(new);
        }
        self.triangles.iter().map(|&t| triangles[t as usize].map(|v| new_ids[v as usize])).collect()
    }
}

/// Indices of places, lowest place first.
fn sorted_by_place(places: impl Iterator<Item = u64>) -> Vec<u32> {
    let mut sorted: Vec<(u64, u32)> = places.zip(0..).collect();
    sorted.sort_unstable();
    sorted.into_iter().map(|(_, index)| index).collect()
}

/// The place of a point of the unit cube on Morton's curve: the bits of its coordinates, in turn.
fn place_on_curve(point: DVec3) -> u64 {
    let cells = f64::from(1_u32 << BITS_PER_AXIS);
    // Casts saturate, so that the faces of the cube and meshes of one point have places too.
    let cell = (point * cells).as_u64vec3().min(glam::U64Vec3::splat((1 << BITS_PER_AXIS) - 1));
    let spread = |x: u64| (0..BITS_PER_AXIS).map(|bit| (x >> bit & 1) << (3 * bit)).sum::<u64>();
    spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
}
