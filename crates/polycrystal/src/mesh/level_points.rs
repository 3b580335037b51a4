//! The points of a level, as far as they are in memory.

use std::borrow::Cow;

use glam::DVec3;
use subzero::{FaceId, RefinedMesh, TriangleMesh};

use crate::Elements;

/// The points of a level, for all that looks at elements one after the other.
pub(crate) struct LevelPoints<'a> {
    elements: Elements<'a>,
    points: Points<'a>,
}

enum Points<'a> {
    Held(Cow<'a, [DVec3]>),
    /// Those of the level before, and where these go. The others follow, in each triangle of the mesh two levels before.
    Following {
        mesh: &'a TriangleMesh,
        before: Vec<DVec3>,
        moved: Vec<DVec3>,
    },
}

impl<'a> LevelPoints<'a> {
    /// Those of some elements, one for each vertex.
    pub(crate) fn held(elements: Elements<'a>, points: impl Into<Cow<'a, [DVec3]>>) -> Self {
        Self { elements, points: Points::Held(points.into()) }
    }

    /// Those of a mesh refined twice, given those of it refined once: a quarter of the memory.
    pub(crate) fn following(mesh: &'a TriangleMesh, before: Vec<DVec3>) -> Self {
        let moved = mesh.loop_moved_beyond(&before);
        let refined = RefinedMesh::new(mesh, 2).expect("ids were counted when the network was made");
        Self { elements: Elements::Refined(refined), points: Points::Following { mesh, before, moved } }
    }

    /// What the points are those of.
    pub(crate) fn elements(&self) -> Elements<'a> {
        self.elements
    }

    /// Those in an element that holds a label, in the order of [`Elements::for_each_vertex_in`]; in place of more than there are is the origin.
    #[inline(always)]
    pub(crate) fn of(&self, labelled: u32) -> [DVec3; 15] {
        match &self.points {
            Points::Held(points) => {
                let mut own = [DVec3::ZERO; 15];
                let mut count = 0;
                self.elements.for_each_vertex_in(labelled, |vertex| {
                    own[count] = points[vertex as usize];
                    count += 1;
                });
                own
            }
            Points::Following { mesh, before, moved } => {
                mesh.loop_points_beyond(FaceId(labelled), before, moved)
            }
        }
    }

    /// Looks at the corners of each element in one that holds a label, in order of their places.
    #[inline(always)]
    pub(crate) fn for_each_in(&self, labelled: u32, mut look_at: impl FnMut(&[DVec3])) {
        match (self.elements, &self.points) {
            (Elements::Triangles(triangles), Points::Held(points)) => {
                look_at(&triangles[labelled as usize].map(|corner| points[corner as usize]));
            }
            (Elements::Segments(segments), Points::Held(points)) => {
                look_at(&segments[labelled as usize].map(|end| points[end as usize]));
            }
            _ => {
                let own = self.of(labelled);
                for corners in self.elements.refined_triangle().triangles {
                    look_at(&corners.map(|corner| own[corner]));
                }
            }
        }
    }
}
