use std::ops::Deref;

use glam::DVec3;
use rayon::prelude::*;
use subzero::{FaceId, RefinedMesh, RefinedTriangle};
use voronoi::Dimension;

use crate::Mesh;

/// The elements of a [`Surface`](crate::Surface).
#[derive(Debug, Clone, Copy)]
pub enum Elements<'a> {
    /// In space.
    Triangles(&'a [[u32; 3]]),
    /// In space, triangles that are known without being held.
    Refined(RefinedMesh<'a>),
    /// In the plane.
    Segments(&'a [[u32; 2]]),
}

/// The points of an element: three of a triangle, two of a segment.
#[derive(Debug, Clone, Copy)]
pub struct Corners {
    points: [u32; 3],
    count: usize,
}

impl Deref for Corners {
    type Target = [u32];

    #[inline]
    fn deref(&self) -> &[u32] {
        &self.points[..self.count]
    }
}

impl<'a> Elements<'a> {
    /// Number of elements.
    pub fn len(self) -> usize {
        match self {
            Self::Triangles(triangles) => triangles.len(),
            Self::Refined(mesh) => mesh.counts().triangles as usize,
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
            Self::Triangles(_) | Self::Refined(_) => Dimension::Three,
            Self::Segments(_) => Dimension::Two,
        }
    }

    /// The points of an element.
    ///
    /// # Panics
    /// If there is no such element.
    #[inline]
    pub fn corners(self, element: u32) -> Corners {
        match self {
            Self::Triangles(triangles) => Corners { points: triangles[element as usize], count: 3 },
            Self::Refined(mesh) => Corners { points: mesh.triangle(FaceId(element)), count: 3 },
            Self::Segments(segments) => {
                let [start, end] = segments[element as usize];
                Corners { points: [start, end, end], count: 2 }
            }
        }
    }

    /// The points of an element of which it is known how many it has.
    ///
    /// # Panics
    /// If there is no such element, or it has another number of points.
    #[inline]
    pub(crate) fn points<const COUNT: usize>(self, element: u32) -> [u32; COUNT] {
        <[u32; COUNT]>::try_from(&*self.corners(element)).expect("an element of as many points")
    }

    /// The same elements, refined so many times at most.
    pub(crate) fn refined_at_most(self, levels: usize) -> Self {
        match self {
            Self::Refined(mesh) if mesh.levels() > levels => Self::Refined(mesh.at(levels)),
            _ => self,
        }
    }

    /// What each triangle that holds a label is refined to.
    #[inline]
    pub(crate) fn refined_triangle(self) -> &'static RefinedTriangle {
        match self {
            Self::Triangles(_) | Self::Segments(_) => &RefinedTriangle::OF_LEVELS[0],
            Self::Refined(mesh) => mesh.refined_triangle(),
        }
    }

    /// Looks at the vertices in an element that holds a label; of a triangle, in the order of [`RefinedMesh::vertices_in`].
    ///
    /// # Panics
    /// If there is no such element.
    #[inline(always)]
    pub(crate) fn for_each_vertex_in(self, labelled: u32, look_at: impl FnMut(u32)) {
        match self {
            Self::Triangles(triangles) => triangles[labelled as usize].into_iter().for_each(look_at),
            Self::Segments(segments) => segments[labelled as usize].into_iter().for_each(look_at),
            Self::Refined(mesh) => {
                let vertices = mesh.vertices_in(FaceId(labelled));
                vertices.into_iter().take(mesh.refined_triangle().vertices).for_each(look_at);
            }
        }
    }

    /// The element at a place in one that holds a label.
    #[inline]
    pub(crate) fn element_in(self, labelled: u32, place: usize) -> u32 {
        match self {
            Self::Triangles(_) | Self::Segments(_) => labelled,
            Self::Refined(mesh) => mesh.triangle_in(FaceId(labelled), place).0,
        }
    }

    /// The element that holds the label of an element: itself, or what it was refined from.
    #[inline]
    pub(crate) fn labelled(self, element: u32) -> u32 {
        match self {
            Self::Triangles(_) | Self::Segments(_) => element,
            Self::Refined(mesh) => mesh.ancestor(FaceId(element)).0,
        }
    }

    /// Normal of a triangle, as long as twice its area; or of a segment in the plane, as long as it is.
    #[inline]
    pub(crate) fn normal(self, points: &[DVec3], element: u32) -> DVec3 {
        let corners = self.corners(element);
        let count = corners.count;
        normal(&corners.points.map(|corner| points[corner as usize])[..count])
    }

    /// The normals of all elements.
    pub(crate) fn normals(self, points: &[DVec3]) -> Vec<DVec3> {
        let elements = 0..u32::try_from(self.len()).expect("ids fit 32 bits");
        elements.into_par_iter().map(|element| self.normal(points, element)).collect()
    }
}

/// The normal of an element with these corners, as of [`Elements::normal`].
///
/// # Panics
/// If there are neither three nor two.
#[inline(always)]
pub(crate) fn normal(corners: &[DVec3]) -> DVec3 {
    match *corners {
        [a, b, c] => (b - a).cross(c - a),
        [a, b] => (b - a).cross(DVec3::Z),
        _ => unreachable!("elements have two or three points"),
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
