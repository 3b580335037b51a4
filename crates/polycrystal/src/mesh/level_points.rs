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

    /// Those in an element that holds a label, as of [`Elements::points_in`].
    #[inline(always)]
    pub(crate) fn of(&self, labelled: u32) -> [DVec3; 15] {
        match &self.points {
            Points::Held(points) => self.elements.points_in(points, labelled),
            Points::Following { mesh, before, moved } => {
                mesh.loop_points_beyond(FaceId(labelled), before, moved)
            }
        }
    }
}
