use crate::diagram::torus::TorusFaces;
use crate::{Corner, Shift, Side, Tessellation, VertexId};

/// Vertices of the torus joined where exact ties made them one point: a forest in which each knows its parent and how it
/// is moved relative to it.
pub(crate) struct UnitedVertices {
    parents: Vec<Corner>,
}

impl UnitedVertices {
    pub(crate) fn new(count: usize) -> Self {
        let parents = (0u32..).take(count).map(|vertex| Corner { vertex, shift: Shift::NONE });
        Self { parents: parents.collect() }
    }

    fn root(&mut self, of: Corner) -> Corner {
        let mut at = of;
        loop {
            let parent = self.parents[at.vertex as usize];
            if parent.vertex == at.vertex {
                return at;
            }
            let grandparent = self.parents[parent.vertex as usize];
            let skipped = Corner { shift: parent.shift + grandparent.shift, ..grandparent };
            self.parents[at.vertex as usize] = skipped;
            at = Corner { shift: at.shift + skipped.shift, ..skipped };
        }
    }

    pub(crate) fn unite(&mut self, v: Corner, w: Corner) {
        let (v, w) = (self.root(v), self.root(w));
        // The smaller number stays, so the result does not depend on the order of the pairs.
        let (kept, joined) = if v.vertex < w.vertex { (v, w) } else { (w, v) };
        if kept.vertex != joined.vertex {
            self.parents[joined.vertex as usize] = Corner { shift: kept.shift - joined.shift, ..kept };
        }
    }

    /// The faces of a complex, each once, with the vertices that now stand for theirs.
    pub(crate) fn faces(self, cells: &Tessellation) -> TorusFaces {
        let roots = self.roots();
        let root = |vertex: &VertexId| {
            let Corner { vertex, shift } = cells.primary_corner(*vertex);
            let root = roots[vertex as usize];
            Corner { shift: root.shift + shift, ..root }
        };
        let mut faces = TorusFaces::new(cells.domain().dimension());
        for face in cells.faces().take(cells.face_count() - cells.periodic_faces().len()) {
            faces.push(cells.face_sides(face).map(Side::end), cells.face_corners(face).iter().map(root));
        }
        faces
    }

    pub(crate) fn roots(mut self) -> Vec<Corner> {
        let vertices = (0u32..).take(self.parents.len());
        vertices.map(|vertex| self.root(Corner { vertex, shift: Shift::NONE })).collect()
    }
}
