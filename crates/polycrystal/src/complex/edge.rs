use voronoi::{PeriodicVertex, Translation};

/// An edge of a complex: from a vertex in its own place to another vertex, or a moved one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ComplexEdge {
    /// Where it starts.
    pub start: u32,
    /// Where it ends.
    pub end: PeriodicVertex,
}

impl ComplexEdge {
    /// The edge between two corners that are joined by one; the same for all its copies.
    pub fn between([from, to]: [PeriodicVertex; 2]) -> Self {
        let seen = |a: PeriodicVertex, b: PeriodicVertex| Self {
            start: a.vertex,
            end: PeriodicVertex { vertex: b.vertex, translation: b.translation - a.translation },
        };
        seen(from, to).min(seen(to, from))
    }

    /// The vertices at its ends; twice the same where it leads from a vertex to its own copy.
    pub fn vertices(self) -> [u32; 2] {
        [self.start, self.end.vertex]
    }

    /// Both ends as seen from one of them in its own place, which comes first: from the end, or from the start.
    pub(crate) fn across(self, from_end: bool) -> [PeriodicVertex; 2] {
        let unmoved = |vertex| PeriodicVertex { vertex, translation: Translation::ZERO };
        if from_end {
            let back =
                PeriodicVertex { vertex: self.start, translation: Translation::ZERO - self.end.translation };
            [unmoved(self.end.vertex), back]
        } else {
            [unmoved(self.start), self.end]
        }
    }
}
