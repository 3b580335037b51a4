//! How cells of the plane come together and part, where a face is an edge with two corners: an edge shrinks to a point, and a point
//! opens to an edge. One after the other they make neighbours switch (the T1 process of foams).

use voronoi::{CellId, Corner, FaceId, Shift, Side};

use crate::complex::cell_complex::{CellComplex, Face, cell_of, id};
use crate::complex::star::FaceAt;

/// An end of an edge in the plane, as the vertex there sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Spoke {
    /// The edge.
    pub face: FaceId,
    /// Which of the edge's two corners the vertex is.
    pub end: usize,
    /// What lies to the right and to the left on the way from the vertex; a cell is a [`Side::Image`] even if it is not moved.
    pub sides: [Side; 2],
}

impl CellComplex {
    /// The edges at a vertex of the plane, counter-clockwise; where walls meet there, from wall to wall.
    pub fn spokes(&self, vertex: u32) -> Vec<Spoke> {
        let ends = self.faces_at(&[vertex]).into_iter().flat_map(|face| [(face, 0), (face, 1)]);
        let at_vertex = ends.filter(|(face, end)| self.corners(*face)[*end].vertex == vertex);
        let mut spokes: Vec<Spoke> = at_vertex
            .map(|(face, end)| {
                let offset = Shift::NONE - self.corners(face)[end].shift;
                let [left, right] = self.sides_at(FaceAt { face: face.0, offset });
                Spoke { face, end, sides: if end == 0 { [right, left] } else { [left, right] } }
            })
            .collect();
        if let Some(first) = spokes.iter().position(|spoke| matches!(spoke.sides[0], Side::Wall(_))) {
            spokes.swap(0, first);
        }
        for known in 1..spokes.len() {
            let left = spokes[known - 1].sides[1];
            let next = spokes[known..].iter().position(|spoke| spoke.sides[0] == left);
            spokes.swap(known, known + next.expect("cells lie around a vertex without a gap"));
        }
        spokes
    }

    /// The edges round a cell of the plane; one between a cell and its own image comes twice.
    pub fn edges_of_cell(&self, cell: CellId) -> impl ExactSizeIterator<Item = FaceId> {
        self.faces_of[cell.index()].iter().copied().map(FaceId)
    }

    /// The cells on either side of an edge of the plane.
    pub fn cells_beside(&self, edge: FaceId) -> impl Iterator<Item = CellId> {
        self.sides(edge).into_iter().filter_map(cell_of)
    }

    /// Draws an edge of the plane together into one of its ends, which stays in its place. The other vertex is gone.
    ///
    /// # Panics
    /// When the edge joins a vertex to itself, a period away.
    pub fn edge_to_point(&mut self, edge: FaceId, kept_end: usize) {
        let [kept, gone] = [kept_end, 1 - kept_end].map(|end| self.corners(edge)[end]);
        assert_ne!(kept.vertex, gone.vertex, "an edge from a vertex to itself is not to shrink");
        self.remove_face(edge.0);
        let by = kept.shift - gone.shift;
        let faces = std::mem::take(&mut self.faces_at[gone.vertex as usize]);
        for number in &faces {
            for corner in &mut self.faces[*number as usize].corners {
                if corner.vertex == gone.vertex {
                    *corner = Corner { vertex: kept.vertex, shift: corner.shift + by };
                }
            }
        }
        self.faces_at[kept.vertex as usize].extend(faces);
    }

    /// Gives some of the edges at a vertex, which follow each other counter-clockwise, a vertex of their own in the same place, and
    /// joins the two by an edge that has these sides to its right and left on the way to the new vertex.
    ///
    /// The sides are those to the right of the first edge and to the left of the last; at a corner of the domain, the one
    /// of two walls along which the new edge lies. The new vertex is the last of all, and so is the new edge.
    ///
    /// # Panics
    /// When both sides are walls.
    pub fn point_to_edge(&mut self, vertex: u32, spokes: &[Spoke], [right, left]: [Side; 2]) -> FaceId {
        let old = Corner { vertex, shift: Shift::NONE };
        let new = self.add_vertex(self.vertices[vertex as usize]);
        for Spoke { face, end, .. } in spokes {
            self.faces[face.index()].corners[*end].vertex = new.vertex;
            let faces = &mut self.faces_at[vertex as usize];
            let place = faces.iter().position(|other| *other == face.0).expect("the edge ends here");
            faces.remove(place);
            self.faces_at[new.vertex as usize].push(face.0);
        }
        let face: Face = if cell_of(left).is_some() {
            self.face_between([left, right], vec![old, new])
        } else {
            self.face_between([right, left], vec![new, old])
        };
        let number = FaceId(id(self.faces.len()));
        self.add_face(face);
        number
    }
}
