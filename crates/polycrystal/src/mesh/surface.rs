use std::collections::BTreeSet;

use glam::DVec3;

use crate::mesh::rounding::last_place;
use crate::{BoundaryId, Elements, GrainId, LevelView, Side};

/// A labelled surface in space, or labelled lines in the plane z = 0: what a network is on one level, or what a file holds.
///
/// Nothing is promised about how the elements fit together; [`certify`](crate::certify) finds out.
#[derive(Debug, Clone, Copy)]
pub struct Surface<'a> {
    /// Positions, by the ids that the elements use.
    pub points: &'a [DVec3],
    /// Triangles or segments.
    pub elements: Elements<'a>,
    /// The boundary of each element; of refined ones, that of each triangle of the mesh that they come from.
    pub boundary_of: &'a [BoundaryId],
    /// The two sides of each boundary. Normals point from first to second; segments have their first side on the left.
    pub sides: &'a [[Side; 2]],
}

impl<'a> Surface<'a> {
    /// The surface of one level of a network; `sides` are those of [`Network::sides`](crate::Network::sides).
    pub fn of_level(level: impl Into<LevelView<'a>>, points: &'a [DVec3], sides: &'a [[Side; 2]]) -> Self {
        let level = level.into();
        Self { points, elements: level.elements(), boundary_of: level.labels(), sides }
    }

    /// The boundary of an element.
    ///
    /// # Panics
    /// If there is no such element.
    #[inline]
    pub fn boundary(&self, element: u32) -> BoundaryId {
        self.boundary_of[self.elements.labelled(element) as usize]
    }

    /// How far double precision keeps points from where they should be: a last place of the largest coordinate.
    pub fn last_place(&self) -> f64 {
        last_place(self.points)
    }

    /// The same surface, refined so many times at most.
    pub(crate) fn refined_at_most(&self, levels: usize) -> Self {
        let elements = self.elements.refined_at_most(levels);
        let points = match elements {
            Elements::Refined(mesh) => &self.points[..mesh.counts().vertices as usize],
            Elements::Triangles(_) | Elements::Segments(_) => self.points,
        };
        Self { points, elements, ..*self }
    }

    /// The grains beside two elements, in order.
    pub(crate) fn grains_at(&self, elements: [u32; 2]) -> Vec<GrainId> {
        let sides = elements.map(|element| self.sides_of(element));
        let grains: BTreeSet<GrainId> = sides.iter().flatten().filter_map(|side| side.grain()).collect();
        grains.into_iter().collect()
    }

    /// The sides of an element.
    ///
    /// # Panics
    /// If there is no such element.
    pub fn sides_of(&self, element: u32) -> [Side; 2] {
        self.sides[self.boundary(element).index()]
    }

    /// The mean of an element's corners.
    ///
    /// # Panics
    /// If there is no such element.
    pub fn middle(&self, element: u32) -> DVec3 {
        let corners = self.elements.corners(element);
        corners.iter().map(|corner| self.points[*corner as usize]).sum::<DVec3>() / corners.len() as f64
    }

    /// All grains, in order of their numbers, which need not be consecutive.
    pub fn grains(&self) -> Vec<GrainId> {
        let sides = self.sides.iter().flatten();
        let mut grains: Vec<GrainId> = sides.filter_map(|side| side.grain()).collect();
        grains.sort_unstable();
        grains.dedup();
        grains
    }
}
