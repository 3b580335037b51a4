//! How cells come together and part: an edge becomes a triangle between the cells at its ends, and the other way round.
//!
//! In the dual complex of tetrahedra these are the flips of two into three and three into two. The complex stays one
//! of closed balls as long as what comes in is not there yet (Okuda, Inoue, Eiraku, Sasai and Adachi 2013 call them I-H and H-I).

use glam::DVec3;
use smallvec::SmallVec;
use voronoi::{FaceId, PeriodicVertex, Side, Translation};

use crate::complex::cell_complex::{CellComplex, Corners, Face, cell_of};
use crate::complex::edge::ComplexEdge;
use crate::complex::star::{FaceAt, Star};
use crate::mesh::id::id;

/// Fewest corners of a face that loses one: no face may be left with two.
const FEWEST_CORNERS: usize = 4;

/// Fewest faces of a cell that loses one: no cell may be left with three.
const FEWEST_FACES: usize = 5;

impl CellComplex {
    /// What lies around an edge, if a triangle can take its place.
    ///
    /// It cannot where the complex is not in general position, where the sides at its ends meet already or are both walls, or where a
    /// face around it is a triangle.
    pub fn reconnectable_edge(&self, edge: ComplexEdge) -> Option<Star> {
        let star = self.star_of_edge(edge)?;
        let has_enough = |at: &FaceAt| self.faces[at.face as usize].corners.len() >= FEWEST_CORNERS;
        let is_cell = |side: &Side| cell_of(*side).is_some();
        let [start, end] = star.ends;
        let is_allowed = star.ends.iter().any(is_cell)
            && !self.meet(start, end)
            && star.between.iter().flatten().all(has_enough);
        is_allowed.then_some(star)
    }

    /// What lies around a face with three corners, if an edge can take its place, and its corners: corner k is not at side k of
    /// those around.
    ///
    /// It cannot where the complex is not in general position, where the sides around meet in an edge already or are all walls, or
    /// where it would leave a face with two corners or a cell with three faces.
    pub fn reconnectable_triangle(&self, face: FaceId) -> Option<(Star, [PeriodicVertex; 3])> {
        let (star, corners) = self.star_of_triangle(face)?;
        let has_enough = |at: &FaceAt| self.faces[at.face as usize].corners.len() >= FEWEST_CORNERS;
        let mut cells = star.ends.iter().filter_map(|side| cell_of(*side));
        let is_allowed = star.around.iter().any(|side| cell_of(*side).is_some())
            && star.beyond.iter().flatten().flatten().all(has_enough)
            && cells.all(|cell| self.faces_of[cell.index()].len() >= FEWEST_FACES)
            && [[0, 1], [1, 2], [2, 0]].into_iter().all(|pair| self.are_apart(pair.map(|k| star.between[k])));
        is_allowed.then_some((star, corners))
    }

    /// Whether two faces have no corner in common.
    fn are_apart(&self, faces: [Option<FaceAt>; 2]) -> bool {
        let [Some(first), Some(second)] = faces else { return true };
        let corners: Corners = self.corners_at(second).collect();
        self.corners_at(first).all(|corner| !corners.contains(&corner))
    }

    /// Puts a triangle between the sides at the ends of an edge in its place, with corner k, not at side k around, in `places[k]`.
    ///
    /// Gives the new face, or nothing where that is not possible: see [`Self::reconnectable_edge`].
    pub fn edge_to_triangle(&mut self, edge: ComplexEdge, positions: [DVec3; 3]) -> Option<FaceId> {
        let star = self.reconnectable_edge(edge)?;
        Some(self.put_triangle(edge, &star, positions))
    }

    /// As [`Self::edge_to_triangle`], given what [`Self::reconnectable_edge`] found.
    pub(crate) fn put_triangle(&mut self, edge: ComplexEdge, star: &Star, positions: [DVec3; 3]) -> FaceId {
        let ends = [PeriodicVertex { vertex: edge.start, translation: Translation::ZERO }, edge.end];
        let corners = positions.map(|position| self.add_vertex(position));
        let mut loops: [SmallVec<[_; 3]>; 2] = [SmallVec::new(), SmallVec::new()];
        for (end, place) in ends.into_iter().enumerate() {
            for (k, at) in star.beyond[end].iter().enumerate() {
                let Some(at) = at else { continue };
                let pair = [(k + 1) % 3, (k + 2) % 3];
                let pair = if self.previous_corner(*at, place) == star.outer[end][pair[0]] {
                    pair
                } else {
                    [pair[1], pair[0]]
                };
                self.replace(*at, &[place], &pair.map(|k| corners[k]));
                loops[end].push((pair, self.sides_at(*at)[0] == star.ends[end]));
            }
        }
        for (at, corner) in star.between.iter().zip(corners) {
            if let Some(at) = at {
                self.replace(*at, &ends, &[corner]);
            }
        }
        // The triangle runs along each of its edges the other way round than the other face of the same cell.
        let first = usize::from(cell_of(star.ends[0]).is_none());
        let (pair, is_outward) = loops[first][0];
        let runs_up = (pair[1] == (pair[0] + 1) % 3) != is_outward;
        let corners = if runs_up { corners } else { [corners[0], corners[2], corners[1]] };
        let face = self.face_between([star.ends[first], star.ends[1 - first]], Corners::from_slice(&corners));
        self.add_face(face);
        FaceId(id(self.faces.len() - 1))
    }

    /// Puts an edge in the place of a face with three corners; it starts at `positions[0]`, at the face's first side.
    ///
    /// Gives the new edge, or nothing where that is not possible: see [`Self::reconnectable_triangle`].
    pub fn triangle_to_edge(&mut self, face: FaceId, positions: [DVec3; 2]) -> Option<ComplexEdge> {
        let (star, corners) = self.reconnectable_triangle(face)?;
        Some(self.put_edge(face, (&star, corners), positions))
    }

    /// As [`Self::triangle_to_edge`], given what [`Self::reconnectable_triangle`] found.
    pub(crate) fn put_edge(
        &mut self,
        face: FaceId,
        (star, corners): (&Star, [PeriodicVertex; 3]),
        positions: [DVec3; 2],
    ) -> ComplexEdge {
        let ends = positions.map(|position| self.add_vertex(position));
        for (k, at) in star.between.iter().enumerate() {
            let Some(at) = at else { continue };
            let [start, end] = ends;
            let starts_above = self.previous_corner(*at, corners[k]) == star.outer[0][k];
            self.replace(*at, &[corners[k]], &if starts_above { [start, end] } else { [end, start] });
        }
        for (beyond, end) in star.beyond.iter().zip(ends) {
            for (k, at) in beyond.iter().enumerate() {
                if let Some(at) = at {
                    self.replace(*at, &[corners[(k + 1) % 3], corners[(k + 2) % 3]], &[end]);
                }
            }
        }
        self.remove_face(face.0);
        ComplexEdge { start: ends[0].vertex, end: ends[1] }
    }

    /// The corner of a face before another one.
    fn previous_corner(&self, at: FaceAt, corner: PeriodicVertex) -> PeriodicVertex {
        let corners: Corners = self.corners_at(at).collect();
        let place = corners.iter().position(|other| *other == corner).expect("a face has its corners");
        corners[(place + corners.len() - 1) % corners.len()]
    }

    /// Replaces one or two corners of a face that follow each other, in either order.
    fn replace(&mut self, at: FaceAt, old: &[PeriodicVertex], new: &[PeriodicVertex]) {
        let mut corners: Corners = self.corners_at(at).collect();
        // The face may begin between the two.
        while !old.contains(&corners[0]) || old.contains(&corners[corners.len() - 1]) {
            corners.rotate_left(1);
        }
        corners.drain(..old.len());
        corners.insert_from_slice(0, new);
        for corner in old {
            self.faces_at[corner.vertex as usize].retain(|face| *face != at.face);
        }
        for corner in new {
            self.faces_at[corner.vertex as usize].push(at.face);
        }
        let own =
            |corner: PeriodicVertex| PeriodicVertex { translation: corner.translation - at.offset, ..corner };
        self.faces[at.face as usize].corners = corners.into_iter().map(own).collect();
    }

    /// A face between a cell and another side, whose corners are in the order in which the cell sees them.
    pub(super) fn face_between(&self, sides: [Side; 2], mut corners: Corners) -> Face {
        let [Side::Image(mut first, mut from), mut second] = sides else {
            unreachable!("a face has a cell on its first side")
        };
        if let Side::Image(cell, translation) = second
            && (cell, translation) < (first, from)
        {
            second = Side::Image(first, from);
            (first, from) = (cell, translation);
            corners.reverse();
        }
        let second = match second {
            Side::Image(cell, translation) if translation == from => Side::Cell(cell),
            Side::Image(cell, translation) => Side::Image(cell, translation - from),
            side => side,
        };
        corners.iter_mut().for_each(|corner| corner.translation = corner.translation - from);
        Face { sides: [Side::Cell(first), second], corners }
    }
}
