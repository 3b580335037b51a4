//! How a cell in space gives way to a neighbour.

use voronoi::{CellId, FaceId, PeriodicVertex, Side, Translation};

use crate::complex::cell_complex::{CellComplex, Corners, Face};
use crate::complex::edge::ComplexEdge;
use crate::complex::star::FaceAt;

/// Fewest corners of a face.
const FEWEST_CORNERS: usize = 3;

impl CellComplex {
    /// Gives all of a cell in space to the one beyond one of its faces, and so takes out the cell, the face and its corners: what met at an edge of
    /// the face becomes one face, and what met at a corner one edge. A face that would be left with two corners closes. A cell of four faces so
    /// becomes a point, whichever of its faces goes.
    ///
    /// Whether that was possible. Nothing happens where the cell touches itself, or the neighbour in another face too, where corners of the face
    /// are not in general position, and where a face would go round a hole. `allows_second_faces` lets the neighbour touch others in more than one
    /// face.
    pub fn cell_to_neighbor_across(&mut self, cell: CellId, face: FaceId, allows_second_faces: bool) -> bool {
        let Some(at) = self.seen_from(cell, face) else { return false };
        let own = Side::Image(cell, Translation::ZERO);
        let beyond = |complex: &Self, at: FaceAt| {
            let [first, second] = complex.sides_at(at);
            if first == own { second } else { first }
        };
        let Side::Image(neighbor, place) = beyond(self, at) else { return false };
        let numbers = self.faces_of[cell.index()].clone();
        let Some(others) = numbers
            .iter()
            .filter(|other| **other != face.0)
            .map(|other| self.seen_from(cell, FaceId(*other)))
            .collect::<Option<Vec<FaceAt>>>()
        else {
            return false;
        };
        let rim: Vec<PeriodicVertex> = self.corners_at(at).collect();
        let touches_rim = |other: &FaceAt| self.corners_at(*other).any(|corner| rim.contains(&corner));
        let is_met = |other: &FaceAt| {
            let side = beyond(self, *other);
            side == Side::Image(neighbor, place)
                || (!allows_second_faces
                    && !touches_rim(other)
                    && self.meet(Side::Image(neighbor, place), side))
        };
        if neighbor == cell || others.iter().any(is_met) || rim.iter().any(|corner| !self.is_general(*corner))
        {
            return false;
        }
        let before = self.clone();
        self.remove_face(face.0);
        for other in others {
            let corners: Corners = self.corners_at(other).collect();
            let sides = self
                .sides_at(other)
                .map(|side| if side == own { Side::Image(neighbor, place) } else { side });
            let relabelled = self.face_between(sides, corners);
            self.put_face(other.face, relabelled);
        }
        let edges = rim.iter().zip(rim.iter().cycle().skip(1));
        let is_done = edges.into_iter().all(|(start, end)| self.join_faces([*start, *end], &numbers))
            && rim.iter().all(|corner| self.drop_corner(corner.vertex))
            && self.close_faces_of_two_corners(neighbor);
        if !is_done {
            *self = before;
        }
        is_done
    }

    /// A face where a cell of its own stands in its own place; nothing where that is so of two places.
    fn seen_from(&self, cell: CellId, face: FaceId) -> Option<FaceAt> {
        let own = self.sides_at(FaceAt { face: face.0, offset: Translation::ZERO });
        let mut offsets = own.into_iter().filter_map(|side| match side {
            Side::Image(known, at) if known == cell => Some(Translation::ZERO - at),
            _ => None,
        });
        let offset = offsets.next()?;
        offsets.next().is_none().then_some(FaceAt { face: face.0, offset })
    }

    /// Puts a face in the place of another one of the same number.
    fn put_face(&mut self, number: u32, face: Face) {
        self.remove_face(number);
        self.register(number, &face);
        self.faces[number as usize] = face;
    }

    /// Makes one face of the only two that are left at an edge between two corners. It has the number that is not among some. Whether it could.
    fn join_faces(&mut self, [start, end]: [PeriodicVertex; 2], numbers: &[u32]) -> bool {
        let edge = ComplexEdge::between([start, end]);
        let &[one, other] = self.faces_of_edge(edge).as_slice() else { return false };
        let [kept, gone] = if numbers.contains(&one.0) { [other, one] } else { [one, other] };
        // Of each its corners where the edge stands, from that behind the edge on: first those between, then the ends of the edge.
        let seen = [kept, gone].map(|face| {
            let corners = &self.faces[face.index()].corners;
            let count = corners.len();
            // A cell beyond a period from itself has corners of its faces twice, but each edge once.
            let ends = |k: &usize| ComplexEdge::between([corners[(k + count - 1) % count], corners[*k]]);
            let mut found = (0..count).filter(|k| ends(k) == edge);
            let last = found.next()?;
            if found.next().is_some() || start.vertex == end.vertex {
                return None;
            }
            let place = if corners[last].vertex == end.vertex { end } else { start };
            let at = FaceAt { face: face.0, offset: place.translation - corners[last].translation };
            let mut ring: Corners = self.corners_at(at).collect();
            ring.rotate_left((last + 1) % count);
            Some((self.sides_at(at), ring))
        });
        let [Some((sides, mut ring)), Some((other_sides, mut others))] = seen else { return false };
        if other_sides == [sides[1], sides[0]] {
            others.reverse();
            // Its ends come first now.
            others.rotate_left(2);
        } else if other_sides != sides {
            return false;
        }
        let ends = |ring: &[PeriodicVertex]| [ring[ring.len() - 2], ring[ring.len() - 1]];
        let [first, last] = ends(&ring);
        if ends(&others) != [last, first] {
            return false;
        }
        ring.truncate(ring.len() - 2);
        others.truncate(others.len() - 2);
        if ring.iter().any(|corner| others.contains(corner)) {
            return false;
        }
        ring.extend(others);
        let joined = self.face_between(sides, ring);
        self.remove_face(gone.0);
        self.put_face(kept.0, joined);
        true
    }

    /// Takes a vertex out of the only face that is left there, if any. Whether it could.
    fn drop_corner(&mut self, vertex: u32) -> bool {
        let faces = std::mem::take(&mut self.faces_at[vertex as usize]);
        let [face] = faces.as_slice() else { return faces.is_empty() };
        self.faces[*face as usize].corners.retain(|corner| corner.vertex != vertex);
        true
    }

    /// Closes all faces of two corners at the faces of a cell, one after the other. Whether it could.
    fn close_faces_of_two_corners(&mut self, cell: CellId) -> bool {
        loop {
            let corners =
                self.faces_of[cell.index()].iter().flat_map(|face| &self.faces[*face as usize].corners);
            let vertices: Vec<u32> = corners.map(|corner| corner.vertex).collect();
            let around = self.faces_at(&vertices);
            let count = |face: &&FaceId| self.faces[face.index()].corners.len();
            if around.iter().any(|face| count(&face) < 2) {
                return false;
            }
            match around.iter().find(|face| count(face) < FEWEST_CORNERS) {
                None => return true,
                Some(face) if !self.close_face_of_two_corners(*face) => return false,
                Some(_) => {}
            }
        }
    }

    /// Takes out a face of two corners. What its two edges lie in, beside it, passes between its sides from then on, so that the lines that end at
    /// the two corners become two that pass, and the faces there one. Whether it could.
    fn close_face_of_two_corners(&mut self, face: FaceId) -> bool {
        let &[first, second] = self.faces[face.index()].corners.as_slice() else { return false };
        let own = self.sides_at(FaceAt { face: face.0, offset: Translation::ZERO });
        if first.vertex == second.vertex {
            return false;
        }
        // At either corner the face that does not touch the sides of this one; none where it would lie between walls.
        let beyond = |corner: PeriodicVertex| {
            let at = |face: &u32| {
                let corners = &self.faces[*face as usize].corners;
                let place = corners.iter().position(|other| other.vertex == corner.vertex)?;
                Some(FaceAt { face: *face, offset: corner.translation - corners[place].translation })
            };
            let faces = self.faces_at[corner.vertex as usize].iter().filter_map(at);
            let mut apart = faces.filter(|at| !self.sides_at(*at).iter().any(|side| own.contains(side)));
            (apart.next(), apart.next().is_none())
        };
        let [(one, is_only), (other, is_other_only)] = [first, second].map(beyond);
        if !is_only || !is_other_only {
            return false;
        }
        let joined = match (one, other) {
            (None, None) => None,
            (Some(one), Some(other)) if one.face != other.face => {
                let sides = self.sides_at(one);
                let from = |at: FaceAt, corner: PeriodicVertex| -> Vec<PeriodicVertex> {
                    let mut ring: Vec<PeriodicVertex> = self.corners_at(at).collect();
                    if self.sides_at(at) != sides {
                        ring.reverse();
                    }
                    let place = ring.iter().position(|other| *other == corner).expect("it has this corner");
                    ring.rotate_left(place);
                    ring
                };
                let is_same = {
                    let others = self.sides_at(other);
                    others == sides || others == [sides[1], sides[0]]
                };
                if !is_same {
                    return false;
                }
                let rings = [from(one, first), from(other, second)];
                let ring: Corners = rings.iter().flat_map(|ring| &ring[1..]).copied().collect();
                let is_twice = rings[0][1..].iter().any(|corner| rings[1][1..].contains(corner));
                if is_twice {
                    return false;
                }
                Some((one.face, other.face, self.face_between(sides, ring)))
            }
            _ => return false,
        };
        self.remove_face(face.0);
        if let Some((kept, gone, joined)) = joined {
            self.remove_face(gone);
            self.put_face(kept, joined);
        }
        for vertex in [first.vertex, second.vertex] {
            for face in std::mem::take(&mut self.faces_at[vertex as usize]) {
                self.faces[face as usize].corners.retain(|corner| corner.vertex != vertex);
            }
        }
        true
    }
}
