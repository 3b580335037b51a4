//! How cells of the plane come together and part, where a face is an edge with two corners: an edge shrinks to a point, and a point
//! opens to an edge. One after the other they make neighbours switch (the T1 process of foams).

use voronoi::{CellId, FaceId, PeriodicVertex, Side, Translation, Wall};

use crate::complex::cell_complex::{CellComplex, Corners, Face, cell_of};
use crate::complex::star::FaceAt;
use crate::mesh::id::id;

/// An end of an edge in the plane, as the vertex there sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OutgoingHalfEdge {
    /// The edge.
    pub face: FaceId,
    /// Which of the edge's two corners the vertex is.
    pub end: usize,
    /// What lies to the right and to the left on the way from the vertex; a cell is a [`Side::Image`] even if it is not moved.
    pub sides: [Side; 2],
}

impl CellComplex {
    /// The edges at a vertex of the plane, counter-clockwise; where walls meet there, from wall to wall.
    pub fn outgoing_half_edges(&self, vertex: u32) -> Vec<OutgoingHalfEdge> {
        let ends = self.faces_at(&[vertex]).into_iter().flat_map(|face| [(face, 0), (face, 1)]);
        let at_vertex = ends.filter(|(face, end)| self.corners(*face)[*end].vertex == vertex);
        let mut outgoing: Vec<OutgoingHalfEdge> = at_vertex
            .map(|(face, end)| {
                let offset = Translation::ZERO - self.corners(face)[end].translation;
                let [left, right] = self.sides_at(FaceAt { face: face.0, offset });
                OutgoingHalfEdge { face, end, sides: if end == 0 { [right, left] } else { [left, right] } }
            })
            .collect();
        if let Some(first) = outgoing.iter().position(|half_edge| matches!(half_edge.sides[0], Side::Wall(_)))
        {
            outgoing.swap(0, first);
        }
        for known in 1..outgoing.len() {
            let left = outgoing[known - 1].sides[1];
            let next = outgoing[known..].iter().position(|half_edge| half_edge.sides[0] == left);
            outgoing.swap(known, known + next.expect("cells lie around a vertex without a gap"));
        }
        outgoing
    }

    /// The corners of a cell of the plane where the cell stands, and the walls that each is on.
    pub fn corners_of_cell(&self, cell: CellId) -> Vec<(PeriodicVertex, Vec<Wall>)> {
        let mut corners: Vec<PeriodicVertex> = Vec::new();
        for edge in self.faces_of_cell(cell) {
            let [first, second] = self.sides(edge);
            let own = if first == Side::Cell(cell) { first } else { second };
            let back =
                own.cell().map_or(Translation::ZERO, |(_, translation)| Translation::ZERO - translation);
            corners.extend(self.corners(edge).iter().map(|corner| corner.moved(back)));
        }
        corners.sort_unstable();
        corners.dedup();
        corners.into_iter().map(|corner| (corner, self.walls_at(corner.vertex))).collect()
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
        let by = kept.translation - gone.translation;
        let faces = std::mem::take(&mut self.faces_at[gone.vertex as usize]);
        for number in &faces {
            for corner in &mut self.faces[*number as usize].corners {
                if corner.vertex == gone.vertex {
                    *corner = PeriodicVertex { vertex: kept.vertex, translation: corner.translation + by };
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
    pub fn point_to_edge(
        &mut self,
        vertex: u32,
        outgoing: &[OutgoingHalfEdge],
        [right, left]: [Side; 2],
    ) -> FaceId {
        let old = PeriodicVertex { vertex, translation: Translation::ZERO };
        let new = self.add_vertex(self.vertices[vertex as usize]);
        for OutgoingHalfEdge { face, end, .. } in outgoing {
            self.faces[face.index()].corners[*end].vertex = new.vertex;
            let faces = &mut self.faces_at[vertex as usize];
            let place = faces.iter().position(|other| *other == face.0).expect("the edge ends here");
            faces.remove(place);
            self.faces_at[new.vertex as usize].push(face.0);
        }
        let face: Face = if cell_of(left).is_some() {
            self.face_between([left, right], Corners::from_slice(&[old, new]))
        } else {
            self.face_between([right, left], Corners::from_slice(&[new, old]))
        };
        let number = FaceId(id(self.faces.len()));
        self.add_face(face);
        number
    }

    /// Draws all edges of a cell of the plane together into one vertex: the cell is gone (the T2 process of foams). What was an edge to it now
    /// ends in that vertex, which stays where it is.
    ///
    /// Gives the vertex, the one of the cell that is on most walls. Nothing happens, and nothing is given, where the cell is not a disc with
    /// a vertex of its own at each corner, lies on walls that its vertices are not all on, or holds a neighbour together or apart from itself
    /// that would then meet itself.
    pub fn cell_to_point(&mut self, cell: CellId) -> Option<u32> {
        let edges = self.faces_of[cell.index()].clone();
        let mut vertices: Vec<u32> = edges
            .iter()
            .flat_map(|edge| &self.faces[*edge as usize].corners)
            .map(|corner| corner.vertex)
            .collect();
        vertices.sort_unstable();
        vertices.dedup();
        let is_disc = edges.len() > 1 && vertices.len() == edges.len();
        let kept = *vertices.iter().max_by_key(|vertex| self.walls_at(**vertex).len())?;
        let walls = self.walls_at(kept);
        let may_go = |vertex: &u32| self.walls_at(*vertex).iter().all(|wall| walls.contains(wall));
        if !is_disc || !vertices.iter().all(may_go) {
            return None;
        }
        let snapshot = self.snapshot(&vertices);
        for edge in edges {
            let [start, end] = [0, 1].map(|end| self.faces[edge as usize].corners[end].vertex);
            if start == end {
                self.remove_face(edge);
            } else {
                self.edge_to_point(FaceId(edge), usize::from(end == kept));
            }
        }
        if self.meets_each_side_once(kept) {
            return Some(kept);
        }
        self.restore(snapshot);
        None
    }

    /// Gives all of a cell of the plane to the one beyond one of its edges. The cell and the edge are gone, and other edges of the cell are the
    /// neighbour's.
    ///
    /// Gives these, and whether each now runs the other way round. Nothing happens, and nothing is given, where no cell is beyond the edge, or
    /// the same one is beyond another edge too.
    pub fn cell_to_neighbor(&mut self, cell: CellId, edge: FaceId) -> Option<Vec<(FaceId, bool)>> {
        let beyond = |sides: [Side; 2]| match sides {
            [first, second] if first == Side::Cell(cell) => (second, Translation::ZERO),
            [first, second] => {
                let back = Translation::ZERO
                    - second.cell().map_or(Translation::ZERO, |(_, translation)| translation);
                (first.moved(back), back)
            }
        };
        let neighbor = beyond(self.sides(edge)).0.cell().filter(|(id, _)| *id != cell)?;
        let others: Vec<u32> =
            self.faces_of[cell.index()].iter().copied().filter(|other| *other != edge.0).collect();
        let is_taken = |other: &u32| {
            let other = beyond(self.faces[*other as usize].sides).0.cell();
            other.is_some_and(|(id, _)| id == cell) || other == Some(neighbor)
        };
        if others.iter().any(is_taken) {
            return None;
        }
        self.remove_face(edge.0);
        let image = |side: Side| side.cell().map_or(side, |(id, translation)| Side::Image(id, translation));
        let own = Side::Image(neighbor.0, neighbor.1);
        let mut changed = Vec::with_capacity(others.len());
        for number in others {
            let Face { sides, corners } = self.faces[number as usize].clone();
            let (other, back) = beyond(sides);
            let corners: Corners = corners.into_iter().map(|corner| corner.moved(back)).collect();
            let between =
                if sides[0] == Side::Cell(cell) { [own, image(other)] } else { [image(other), own] };
            let new = self.face_between(between, corners.clone());
            let along = |[start, end]: [PeriodicVertex; 2]| {
                (start.vertex, end.vertex, end.translation - start.translation)
            };
            let is_reversed = along([corners[0], corners[1]]) != along([new.corners[0], new.corners[1]]);
            self.faces[number as usize] = new;
            self.faces_of[neighbor.0.index()].push(number);
            changed.push((FaceId(number), is_reversed));
        }
        self.faces_of[cell.index()].clear();
        Some(changed)
    }

    /// Whether each cell and each wall at a vertex of the plane is there once, between two edges.
    fn meets_each_side_once(&self, vertex: u32) -> bool {
        let mut sides = Vec::new();
        for face in &self.faces_at[vertex as usize] {
            let ends = self.faces[*face as usize].corners.iter().filter(|corner| corner.vertex == vertex);
            let mut at_vertex = 0;
            for corner in ends {
                let offset = Translation::ZERO - corner.translation;
                sides.extend(self.sides_at(FaceAt { face: *face, offset }));
                at_vertex += 1;
            }
            if at_vertex > 1 {
                return false;
            }
        }
        sides.sort_unstable();
        sides.chunk_by(|one, other| one == other).all(|same| same.len() <= 2)
    }

    /// Makes one edge of the two at a vertex of the plane that lie between the same sides, and takes the vertex out.
    ///
    /// Gives the edge that is left, which led to the vertex before, and the one that is gone, which led on from it; nothing where there are
    /// no such edges.
    pub fn join_edges(&mut self, vertex: u32) -> Option<[FaceId; 2]> {
        let &[one, other] = self.faces_at[vertex as usize].as_slice() else { return None };
        let ends_here = |face: u32| self.faces[face as usize].corners[1].vertex == vertex;
        let [kept, gone] = if ends_here(one) { [one, other] } else { [other, one] };
        let [&[_, last], &[first, end]] =
            [kept, gone].map(|face| self.faces[face as usize].corners.as_slice())
        else {
            return None;
        };
        let is_line = kept != gone
            && [last.vertex, first.vertex] == [vertex; 2]
            && self.faces[kept as usize].sides == self.faces[gone as usize].sides;
        if !is_line {
            return None;
        }
        self.remove_face(gone);
        self.faces_at[vertex as usize].clear();
        self.faces[kept as usize].corners[1] = end.moved(last.translation - first.translation);
        self.faces_at[end.vertex as usize].push(kept);
        Some([kept, gone].map(FaceId))
    }
}
