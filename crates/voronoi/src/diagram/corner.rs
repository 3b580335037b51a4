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

/// An edge of a complex: from a vertex in its own place to another vertex, or a moved one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ComplexEdge {
    /// Where it starts.
    pub start: u32,
    /// Where it ends.
    pub end: Corner,
}

impl ComplexEdge {
    /// The edge between two corners that are joined by one; the same for all its copies.
    pub fn between([from, to]: [Corner; 2]) -> Self {
        let seen = |a: Corner, b: Corner| Self {
            start: a.vertex,
            end: Corner { vertex: b.vertex, shift: b.shift - a.shift },
        };
        seen(from, to).min(seen(to, from))
    }

    /// The vertices at its ends; twice the same where it leads from a vertex to its own copy.
    pub fn vertices(self) -> [u32; 2] {
        [self.start, self.end.vertex]
    }

    /// Both ends as seen from one of them in its own place, which comes first: from the end, or from the start.
    pub(crate) fn across(self, from_end: bool) -> [Corner; 2] {
        let unmoved = |vertex| Corner { vertex, shift: Shift::NONE };
        if from_end {
            let back = Corner { vertex: self.start, shift: Shift::NONE - self.end.shift };
            [unmoved(self.end.vertex), back]
        } else {
            [unmoved(self.start), self.end]
        }
    }
}

impl Tessellation {
    /// The vertex of which a vertex is a copy, moved to where that is; itself where it is none.
    pub(crate) fn primary_corner(&self, vertex: VertexId) -> Corner {
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
