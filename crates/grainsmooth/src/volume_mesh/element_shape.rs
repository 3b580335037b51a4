//! The elements that fill grains: triangles in the plane, tetrahedra in space. Numbers are those of their corners.

use polycrystal::{BoundaryId, Corners, Elements, Level};

/// A shape of elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum ElementShape {
    Triangle,
    #[default]
    Tetrahedron,
}

/// The edges of a triangle and of a tetrahedron, by the corners that they join, in the order of their middle nodes in Abaqus, CalculiX, Nastran and VTK.
pub(crate) const TRIANGLE_EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];
pub(crate) const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]];

/// The faces of a triangle and of a tetrahedron, in the order of Abaqus and CalculiX: from S1 on. Abaqus Analysis User's Guide, "Two-dimensional solid element library",
/// "Three-dimensional solid element library".
const TRIANGLE_FACES: [&[usize]; 3] = [&[0, 1], &[1, 2], &[2, 0]];
pub(crate) const FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

impl ElementShape {
    /// Number of axes of the space that elements fill.
    pub(crate) fn axes(self) -> usize {
        self.corner_count() - 1
    }

    /// An element, several of them, and a face of one, in words.
    pub(crate) fn words(self) -> [&'static str; 3] {
        match self {
            Self::Triangle => ["triangle", "triangles", "edge"],
            Self::Tetrahedron => ["tetrahedron", "tetrahedra", "face"],
        }
    }

    /// Number of corners.
    pub(crate) fn corner_count(self) -> usize {
        match self {
            Self::Triangle => 3,
            Self::Tetrahedron => 4,
        }
    }

    /// The edges.
    pub(crate) fn edges(self) -> &'static [[usize; 2]] {
        match self {
            Self::Triangle => &TRIANGLE_EDGES,
            Self::Tetrahedron => &EDGES,
        }
    }

    /// The faces, in the plane the edges.
    pub(crate) fn faces(self) -> impl Iterator<Item = &'static [usize]> {
        let (in_plane, in_space): (&[&[usize]], &[[usize; 3]]) = match self {
            Self::Triangle => (&TRIANGLE_FACES, &[]),
            Self::Tetrahedron => (&[], &FACES),
        };
        in_plane.iter().copied().chain(in_space.iter().map(|face| &face[..]))
    }
}

/// A face of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ElementFace {
    /// The element, by number.
    pub(crate) element: usize,
    /// Which of its shape's faces.
    pub(crate) face: usize,
}

/// The corners of a face in order, whatever way it is seen; two of an edge in the plane.
pub(crate) fn face_key(corners: &[u32]) -> [u32; 3] {
    let mut key = [u32::MAX; 3];
    key[..corners.len()].copy_from_slice(corners);
    key.sort_unstable();
    key
}

/// The corners of a face by its key.
pub(crate) fn corners_of_key(key: &[u32; 3]) -> &[u32] {
    if key[2] == u32::MAX { &key[..2] } else { key }
}

/// The edges around a face: three of a triangle, one of a segment.
pub(crate) fn edges_around(corners: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    let count = if corners.len() == 2 { 1 } else { corners.len() };
    (0..count).map(|k| [corners[k], corners[(k + 1) % corners.len()]])
}

/// The corners of each element of a network's boundaries, with the boundary.
pub(crate) fn boundary_elements(level: &Level) -> impl Iterator<Item = (BoundaryId, Corners)> + '_ {
    let elements = Elements::from(&level.mesh);
    (0u32..).zip(&level.boundary_of).map(move |(element, boundary)| (*boundary, elements.corners(element)))
}
