//! How far points are from the boundaries of a surface.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::check::box_tree::{Bounds, BoxTree};
use crate::mesh::id::id;
use crate::mesh::nearest_point::nearest_in_triangle;
use crate::{Side, Surface};

/// The boundaries of a surface, to measure distances from.
#[derive(Debug)]
pub struct BoundaryDistances<'a> {
    surface: Surface<'a>,
    /// The elements between each two sides, and one of them. The smaller side comes first.
    elements: BTreeMap<[Side; 2], (u32, BoxTree)>,
}

impl<'a> BoundaryDistances<'a> {
    /// Those of a surface.
    pub fn new(surface: &Surface<'a>) -> Self {
        let surface = *surface;
        let mut between: BTreeMap<[Side; 2], Vec<u32>> = BTreeMap::new();
        for element in 0..id(surface.elements.len()) {
            let mut sides = surface.sides_of(element);
            sides.sort_unstable();
            between.entry(sides).or_default().push(element);
        }
        let bounds = |element| Bounds::around(corners(&surface, element));
        let tree =
            |(sides, elements): ([Side; 2], Vec<u32>)| (sides, (elements[0], BoxTree::new(elements, bounds)));
        Self { elements: between.into_iter().map(tree).collect(), surface }
    }

    /// All pairs of sides that have a boundary, each with the smaller side first.
    pub fn pairs(&self) -> impl Iterator<Item = [Side; 2]> {
        self.elements.keys().copied()
    }

    /// How far a point is from the boundary between two sides; nothing where they have none.
    pub fn distance(&self, mut sides: [Side; 2], point: DVec3) -> Option<f64> {
        sides.sort_unstable();
        let (first, tree) = self.elements.get(&sides)?;
        let squared = |element: u32| {
            nearest_in_triangle(corners(&self.surface, element), point).0.distance_squared(point)
        };
        Some(squared(tree.nearest(point, (*first, squared(*first)), squared)).sqrt())
    }
}

/// The corners of a triangle; of a segment, its end comes twice.
fn corners(surface: &Surface<'_>, element: u32) -> [DVec3; 3] {
    let corners = surface.elements.corners(element);
    [corners[0], corners[1], corners[corners.len() - 1]].map(|corner| surface.points[corner as usize])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BoundaryId, Elements, GrainId};

    #[test]
    fn distances_are_those_of_the_boundary_between_both_sides() {
        let grain = |number| Side::Grain(GrainId(number));
        let sides = [[grain(0), grain(1)], [grain(1), Side::Exterior]];
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let boundary_of = [BoundaryId(0), BoundaryId(1)];
        let point = DVec3::new(0.25, 0.25, 2.0);
        for (elements, expected) in [
            (Elements::Triangles(&[[0, 1, 2], [0, 1, 3]]), [2.0, 18.0f64.sqrt() / 4.0]),
            (Elements::Segments(&[[0, 1], [0, 3]]), [65.0f64.sqrt() / 4.0, 18.0f64.sqrt() / 4.0]),
        ] {
            let surface = Surface { points: &points, elements, boundary_of: &boundary_of, sides: &sides };
            let distances = BoundaryDistances::new(&surface);
            assert_eq!(distances.pairs().collect::<Vec<_>>(), sides);
            for (sides, expected) in sides.iter().zip(expected) {
                for sides in [*sides, [sides[1], sides[0]]] {
                    assert!((distances.distance(sides, point).unwrap() - expected).abs() < 1e-14);
                }
            }
            assert_eq!(distances.distance([grain(0), Side::Exterior], point), None);
        }
    }
}
