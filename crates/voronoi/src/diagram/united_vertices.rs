use crate::diagram::torus::TorusFaces;
use crate::{PeriodicVertex, Side, Tessellation, Translation, VertexId};

/// Vertices of the torus joined where exact ties made them one point: a forest in which each knows its parent and how it
/// is moved relative to it.
pub(crate) struct UnitedVertices {
    parents: Vec<PeriodicVertex>,
}

impl UnitedVertices {
    pub(crate) fn new(count: usize) -> Self {
        let parents =
            (0u32..).take(count).map(|vertex| PeriodicVertex { vertex, translation: Translation::ZERO });
        Self { parents: parents.collect() }
    }

    fn root(&mut self, of: PeriodicVertex) -> PeriodicVertex {
        let mut at = of;
        loop {
            let parent = self.parents[at.vertex as usize];
            if parent.vertex == at.vertex {
                return at;
            }
            let grandparent = self.parents[parent.vertex as usize];
            let skipped =
                PeriodicVertex { translation: parent.translation + grandparent.translation, ..grandparent };
            self.parents[at.vertex as usize] = skipped;
            at = PeriodicVertex { translation: at.translation + skipped.translation, ..skipped };
        }
    }

    pub(crate) fn unite(&mut self, v: PeriodicVertex, w: PeriodicVertex) {
        let (v, w) = (self.root(v), self.root(w));
        // The smaller number stays, so the result does not depend on the order of the pairs.
        let (kept, joined) = if v.vertex < w.vertex { (v, w) } else { (w, v) };
        if kept.vertex != joined.vertex {
            self.parents[joined.vertex as usize] =
                PeriodicVertex { translation: kept.translation - joined.translation, ..kept };
        }
    }

    /// The faces of a complex, each once, with the vertices that now stand for theirs.
    pub(crate) fn faces(self, cells: &Tessellation) -> TorusFaces {
        let roots = self.roots();
        let root = |vertex: &VertexId| {
            let PeriodicVertex { vertex, translation } = cells.periodic_vertex(*vertex);
            let root = roots[vertex as usize];
            PeriodicVertex { translation: root.translation + translation, ..root }
        };
        let mut faces = TorusFaces::new(cells.domain().dimension());
        for face in cells.faces().take(cells.face_count() - cells.periodic_faces().len()) {
            faces.push(cells.face_sides(face).map(Side::end), cells.face_corners(face).iter().map(root));
        }
        faces
    }

    pub(crate) fn roots(mut self) -> Vec<PeriodicVertex> {
        let vertices = (0u32..).take(self.parents.len());
        vertices.map(|vertex| self.root(PeriodicVertex { vertex, translation: Translation::ZERO })).collect()
    }
}
