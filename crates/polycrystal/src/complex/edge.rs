use voronoi::{Corner, Shift};

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
