use std::collections::BTreeSet;

use glam::DVec3;
use rayon::prelude::*;
use voronoi::Dimension;

use crate::mesh::grouped::Grouped;
use crate::mesh::rounding::last_place;
use crate::{BoundaryId, GrainId, Level, Mesh, Side};

/// A labelled surface in space, or labelled lines in the plane z = 0: what a network is on one level, or what a file holds.
///
/// Nothing is promised about how the elements fit together; [`certify`](crate::certify) finds out.
#[derive(Debug, Clone, Copy)]
pub struct Surface<'a> {
    /// Positions, by the ids that the elements use.
    pub points: &'a [DVec3],
    /// Triangles or segments.
    pub elements: Elements<'a>,
    /// The boundary of each element.
    pub boundary_of: &'a [BoundaryId],
    /// The two sides of each boundary. Normals point from first to second; segments have their first side on the left.
    pub sides: &'a [[Side; 2]],
}

/// The elements of a [`Surface`].
#[derive(Debug, Clone, Copy)]
pub enum Elements<'a> {
    /// In space.
    Triangles(&'a [[u32; 3]]),
    /// In the plane.
    Segments(&'a [[u32; 2]]),
}

impl<'a> Elements<'a> {
    /// Number of elements.
    pub fn len(self) -> usize {
        match self {
            Self::Triangles(triangles) => triangles.len(),
            Self::Segments(segments) => segments.len(),
        }
    }

    /// Whether there is no element.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// That of the domain which the elements divide.
    pub fn dimension(self) -> Dimension {
        match self {
            Self::Triangles(_) => Dimension::Three,
            Self::Segments(_) => Dimension::Two,
        }
    }

    /// The points of an element.
    ///
    /// # Panics
    /// If there is no such element.
    pub fn corners(self, element: u32) -> &'a [u32] {
        match self {
            Self::Triangles(triangles) => &triangles[element as usize],
            Self::Segments(segments) => &segments[element as usize],
        }
    }

    /// Normals of triangles, as long as twice their area; or of segments in the plane, as long as they are.
    pub(crate) fn normals(self, points: &[DVec3]) -> Vec<DVec3> {
        let at = |vertex: u32| points[vertex as usize];
        match self {
            Self::Triangles(triangles) => {
                let normal = |corners: &[u32; 3]| {
                    let [a, b, c] = corners.map(at);
                    (b - a).cross(c - a)
                };
                triangles.par_iter().map(normal).collect()
            }
            Self::Segments(segments) => {
                let normal = |ends: &[u32; 2]| (at(ends[1]) - at(ends[0])).cross(DVec3::Z);
                segments.par_iter().map(normal).collect()
            }
        }
    }
}

impl<'a> From<&'a Mesh> for Elements<'a> {
    fn from(mesh: &'a Mesh) -> Self {
        match mesh {
            Mesh::Triangles(mesh) => Self::Triangles(mesh.triangles()),
            Mesh::Segments(mesh) => Self::Segments(mesh.segments()),
        }
    }
}

impl<'a> Surface<'a> {
    /// The surface of one level of a network; `sides` are those of [`Network::sides`](crate::Network::sides).
    pub fn of_level(level: &'a Level, points: &'a [DVec3], sides: &'a [[Side; 2]]) -> Self {
        Self { points, elements: (&level.mesh).into(), boundary_of: &level.boundary_of, sides }
    }

    /// How far double precision keeps points from where they should be: a last place of the largest coordinate.
    pub fn last_place(&self) -> f64 {
        last_place(self.points)
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
        self.sides[self.boundary_of[element as usize].index()]
    }

    /// The mean of an element's corners.
    ///
    /// # Panics
    /// If there is no such element.
    pub fn middle(&self, element: u32) -> DVec3 {
        let corners = self.elements.corners(element);
        corners.iter().map(|corner| self.points[*corner as usize]).sum::<DVec3>() / corners.len() as f64
    }

    /// The elements of each boundary.
    pub(crate) fn elements_by_boundary(&self) -> Grouped<u32> {
        let elements = (0u32..).zip(self.boundary_of).take(self.elements.len());
        Grouped::new(self.sides.len(), elements.map(|(element, boundary)| (boundary.index(), element)))
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
