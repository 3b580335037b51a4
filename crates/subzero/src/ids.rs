//! Ids of elements, and conversions between ids and indices.
//!
//! A vertex is its index into the slice of points beside the mesh, a plain `u32` as in files and in vertex buffers. What indexes
//! nothing that callers hold has a type of its own.

use std::fmt;

/// "No such half-edge"; never leaves this crate.
pub(crate) const NONE: u32 = u32::MAX;

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);

        impl $name {
            /// The id as an index.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.fmt(out)
            }
        }
    };
}

id!(
    /// An edge of a mesh, or a segment of a curve, counted from 0.
    EdgeId
);
id!(
    /// A face, counted from 0.
    FaceId
);
id!(
    /// A half-edge: an edge as one of its faces runs along it, counted from 0.
    HalfEdgeId
);

impl HalfEdgeId {
    /// What stands for none in arrays of half-edges.
    pub(crate) const NONE: Self = Self(NONE);

    /// The triangle whose side this is, in a mesh of triangles.
    pub fn triangle(self) -> FaceId {
        FaceId(self.0 / 3)
    }

    /// The half-edge after this one in its triangle.
    #[must_use]
    pub fn next(self) -> Self {
        Self(next(self.0))
    }

    /// The half-edge before this one in its triangle.
    pub(crate) fn prev(self) -> Self {
        Self(prev(self.0))
    }

    /// The id, unless it stands for none.
    pub(crate) fn some(self) -> Option<Self> {
        (self != Self::NONE).then_some(self)
    }
}

/// The id of an index into an array whose length was checked against `u32` when its mesh was made or refined.
#[allow(clippy::cast_possible_truncation)]
pub(crate) fn id(index: usize) -> u32 {
    debug_assert!(u32::try_from(index).is_ok(), "index {index} does not fit an id");
    index as u32
}

/// The half-edge after `h` in its triangle.
pub(crate) fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The half-edge before `h` in its triangle.
pub(crate) fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}
