//! Vertices of a complex that has each of them once, where a period or more lies between.

use crate::{PeriodicPair, Shift, Tessellation, VertexId};

/// A vertex, moved by whole periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Corner {
    /// Number of the vertex.
    pub vertex: u32,
    /// How far from its own place it is.
    pub shift: Shift,
}

impl Corner {
    /// The vertex moved by more periods.
    #[must_use]
    pub fn moved(self, shift: Shift) -> Self {
        Self { shift: self.shift + shift, ..self }
    }
}

impl Tessellation {
    /// The vertex of which a vertex is a copy, moved to where that is; itself where it is none.
    pub fn primary_corner(&self, vertex: VertexId) -> Corner {
        // Copies have the last numbers.
        let first_copy = self.vertices().len() - self.periodic_vertices().len();
        match vertex.index().checked_sub(first_copy) {
            None => Corner { vertex: vertex.0, shift: Shift::NONE },
            Some(copy) => {
                let PeriodicPair { primary, shift, .. } = self.periodic_vertices()[copy];
                Corner { vertex: primary.0, shift }
            }
        }
    }
}
