//! Vertices of a complex that has each of them once, where a period or more lies between.

use crate::{PeriodicPair, Tessellation, Translation, VertexId};

/// A vertex, moved by whole periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PeriodicVertex {
    /// Number of the vertex.
    pub vertex: u32,
    /// How far from its own place it is.
    pub translation: Translation,
}

impl PeriodicVertex {
    /// The vertex moved by more periods.
    #[must_use]
    pub fn moved(self, translation: Translation) -> Self {
        Self { translation: self.translation + translation, ..self }
    }
}

impl Tessellation {
    /// The vertex of which a vertex is a copy, moved to where that is; itself where it is none.
    pub fn periodic_vertex(&self, vertex: VertexId) -> PeriodicVertex {
        // Copies have the last numbers.
        let first_copy = self.vertices().len() - self.periodic_vertices().len();
        match vertex.index().checked_sub(first_copy) {
            None => PeriodicVertex { vertex: vertex.0, translation: Translation::ZERO },
            Some(copy) => {
                let PeriodicPair { primary, translation, .. } = self.periodic_vertices()[copy];
                PeriodicVertex { vertex: primary.0, translation }
            }
        }
    }
}
