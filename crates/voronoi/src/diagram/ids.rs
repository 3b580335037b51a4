//! Numbers of what a tessellation has.

use crate::Translation;

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);

        impl $name {
            /// The id as an index into the arrays of a [`Tessellation`](crate::Tessellation).
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// Number of a cell: its seed's place in the input.
    CellId
);
id!(
    /// Number of a vertex.
    VertexId
);
id!(
    /// Number of a face (in the plane: of an edge between two cells).
    FaceId
);

/// A vertex, edge or face that is another one moved by whole periods: `secondary = primary + translation`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PeriodicPair<Id> {
    /// The moved one.
    pub secondary: Id,
    /// The one that stands for all of its kind.
    pub primary: Id,
    /// How far the secondary is from the primary.
    pub translation: Translation,
}
