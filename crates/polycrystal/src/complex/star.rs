//! What lies around an edge or a triangle where all is in general position.

use smallvec::SmallVec;
use voronoi::{FaceId, PeriodicVertex, Side, Translation};

use crate::complex::cell_complex::{CellComplex, cell_of};
use crate::complex::edge::ComplexEdge;

/// What lies around an edge, or a triangle that may take its place.
///
/// Three sides meet at the edge, a fourth at either end of it: five cells or walls, seen from one place, where a cell is an
/// [`Side::Image`] even if it is not moved. The triangle is the face between the two end sides. Line k, of three on either side,
/// is where an end side meets the two around other than k.
#[derive(Debug, Clone)]
pub struct Star {
    /// The sides around the edge; each shares an edge with the triangle.
    pub around: [Side; 3],
    /// The sides at the start and the end of the edge.
    pub ends: [Side; 2],
    /// At each end, the other ends of the lines 0, 1 and 2.
    pub outer: [[PeriodicVertex; 3]; 2],
    /// The faces between two sides around: face k is not at side k. None between walls.
    pub(super) between: [Option<FaceAt>; 3],
    /// At each end, the faces between its side and those around. None between walls.
    pub(super) beyond: [[Option<FaceAt>; 3]; 2],
}

/// A face seen from where a star is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FaceAt {
    pub(super) face: u32,
    /// Translation from the place of the face's first side.
    pub(super) offset: Translation,
}

/// What lies around a vertex where four sides meet: the sides, faces by pairs and edges by triples of them.
struct VertexStar {
    sides: SmallVec<[Side; 12]>,
    faces: SmallVec<[(FaceAt, [Side; 2]); 6]>,
    /// Other ends of edges.
    edges: SmallVec<[(PeriodicVertex, SmallVec<[Side; 6]>); 4]>,
}

impl VertexStar {
    /// The side that is not among some.
    fn beyond(&self, others: &[Side]) -> Option<Side> {
        let mut rest = self.sides.iter().filter(|side| !others.contains(side));
        let side = *rest.next()?;
        rest.next().is_none().then_some(side)
    }

    fn face(&self, first: Side, second: Side) -> Option<FaceAt> {
        let is_between = |sides: &[Side; 2]| sides.contains(&first) && sides.contains(&second);
        self.faces.iter().find(|(_, sides)| is_between(sides)).map(|(face, _)| *face)
    }

    fn edge(&self, sides: [Side; 3]) -> Option<PeriodicVertex> {
        let found = self.edges.iter().find(|(_, at)| sides.iter().all(|side| at.contains(side)));
        found.map(|(end, _)| *end)
    }

    fn sides_of_edge(&self, end: PeriodicVertex) -> Option<[Side; 3]> {
        let (_, sides) = self.edges.iter().find(|(other, _)| *other == end)?;
        sides.as_slice().try_into().ok()
    }
}

impl CellComplex {
    /// What lies around an edge; nothing where other than three sides meet at it, or other than four at its ends.
    pub fn star_of_edge(&self, edge: ComplexEdge) -> Option<Star> {
        let places = [PeriodicVertex { vertex: edge.start, translation: Translation::ZERO }, edge.end];
        let [start, end] = [self.simple_star(places[0])?, self.simple_star(places[1])?];
        let around = start.sides_of_edge(places[1])?;
        if end.edge(around)? != places[0] {
            return None;
        }
        let ends = [start.beyond(&around)?, end.beyond(&around)?];
        let stars = [&start, &end];
        let outer = [0, 1].map(|end| {
            let others = |k: usize| [ends[end], around[(k + 1) % 3], around[(k + 2) % 3]];
            [0, 1, 2].map(|k| stars[end].edge(others(k)))
        });
        let star = Star {
            around,
            ends,
            outer: [all(outer[0])?, all(outer[1])?],
            between: [0, 1, 2].map(|k| start.face(around[(k + 1) % 3], around[(k + 2) % 3])),
            beyond: [0, 1].map(|end| [0, 1, 2].map(|k| stars[end].face(ends[end], around[k]))),
        };
        (ends[0] != ends[1]).then_some(star)
    }

    /// What lies around a face with three corners, and its corners: corner k is not at side k of those around. Nothing where
    /// other than four sides meet at one of them.
    pub fn star_of_triangle(&self, face: FaceId) -> Option<(Star, [PeriodicVertex; 3])> {
        let corners: [PeriodicVertex; 3] = self.corners(face).try_into().ok()?;
        let stars =
            [self.simple_star(corners[0])?, self.simple_star(corners[1])?, self.simple_star(corners[2])?];
        let ends = self.sides_at(FaceAt { face: face.0, offset: Translation::ZERO });
        let across = [0, 1, 2].map(|k| {
            let sides = stars[(k + 1) % 3].sides_of_edge(corners[(k + 2) % 3])?;
            sides.into_iter().find(|side| !ends.contains(side))
        });
        let around = all(across)?;
        let others = |k: usize| [around[(k + 1) % 3], around[(k + 2) % 3]];
        let outer = [0, 1].map(|end: usize| {
            [0, 1, 2].map(|k: usize| {
                let [a, b] = others(k);
                stars[k].edge([ends[end], a, b])
            })
        });
        let is_distinct = around[0] != around[1] && around[1] != around[2] && around[2] != around[0];
        let star = Star {
            around,
            ends,
            outer: [all(outer[0])?, all(outer[1])?],
            between: [0, 1, 2].map(|k| {
                let [a, b] = others(k);
                stars[k].face(a, b)
            }),
            beyond: ends.map(|end| [0, 1, 2].map(|k| stars[(k + 1) % 3].face(end, around[k]))),
        };
        is_distinct.then_some((star, corners))
    }

    /// The sides of a face where a star sees it.
    pub(super) fn sides_at(&self, at: FaceAt) -> [Side; 2] {
        self.faces[at.face as usize].sides.map(|side| match side {
            Side::Cell(cell) => Side::Image(cell, at.offset),
            Side::Image(cell, translation) => Side::Image(cell, translation + at.offset),
            Side::Wall(_) => side,
        })
    }

    /// The corners of a face where a star sees it.
    pub(super) fn corners_at(&self, at: FaceAt) -> impl Iterator<Item = PeriodicVertex> {
        let corners = self.faces[at.face as usize].corners.iter();
        corners.map(move |corner| PeriodicVertex { translation: corner.translation + at.offset, ..*corner })
    }

    /// Whether four sides meet at a corner, each two of them in a face (walls aside).
    pub(super) fn is_general(&self, corner: PeriodicVertex) -> bool {
        self.vertex_star(corner).is_some()
    }

    /// As [`Self::vertex_star`], of faces that come to the vertex once each.
    fn simple_star(&self, place: PeriodicVertex) -> Option<VertexStar> {
        let star = self.vertex_star(place)?;
        star.faces.windows(2).all(|pair| pair[0].0.face != pair[1].0.face).then_some(star)
    }

    /// What lies around a vertex in general position. A face may come to it twice: that of a cell that meets itself beyond a period.
    fn vertex_star(&self, place: PeriodicVertex) -> Option<VertexStar> {
        let faces = self.faces_at(&[place.vertex]);
        let mut star = VertexStar { sides: SmallVec::new(), faces: SmallVec::new(), edges: SmallVec::new() };
        for FaceId(face) in faces {
            let corners = &self.faces[face as usize].corners;
            for k in (0..corners.len()).filter(|k| corners[*k].vertex == place.vertex) {
                let at = FaceAt { face, offset: place.translation - corners[k].translation };
                let sides = self.sides_at(at);
                star.sides.extend(sides);
                star.faces.push((at, sides));
                for k in [k + 1, k + corners.len() - 1] {
                    let other = corners[k % corners.len()];
                    let other = PeriodicVertex { translation: other.translation + at.offset, ..other };
                    let known = star.edges.iter().position(|(end, _)| *end == other).unwrap_or_else(|| {
                        star.edges.push((other, SmallVec::new()));
                        star.edges.len() - 1
                    });
                    star.edges[known].1.extend(sides);
                }
            }
        }
        star.sides.sort_unstable();
        star.sides.dedup();
        for (_, sides) in &mut star.edges {
            sides.sort_unstable();
            sides.dedup();
        }
        let wall_count = star.sides.iter().filter(|side| cell_of(**side).is_none()).count();
        // No face lies between two walls.
        let face_count = 6 - wall_count * wall_count.saturating_sub(1) / 2;
        let is_general = star.sides.len() == 4
            && star.faces.len() == face_count
            && star.edges.len() == 4
            && star.edges.iter().all(|(_, sides)| sides.len() == 3);
        is_general.then_some(star)
    }

    /// Whether a face lies between two sides; never between walls.
    pub(super) fn meet(&self, first: Side, second: Side) -> bool {
        let ([Side::Image(cell, translation), other] | [other, Side::Image(cell, translation)]) =
            [first, second]
        else {
            return false;
        };
        let sides = [Side::Image(cell, translation), other];
        self.faces_of[cell.index()].iter().any(|&face| {
            let own = self.sides_at(FaceAt { face, offset: Translation::ZERO });
            let places = own.into_iter().filter_map(|side| match side {
                Side::Image(known, at) if known == cell => Some(translation - at),
                _ => None,
            });
            let mut seen = places.map(|offset| self.sides_at(FaceAt { face, offset }));
            seen.any(|seen| sides.iter().all(|side| seen.contains(side)))
        })
    }
}

fn all<T: Copy>(three: [Option<T>; 3]) -> Option<[T; 3]> {
    Some([three[0]?, three[1]?, three[2]?])
}
