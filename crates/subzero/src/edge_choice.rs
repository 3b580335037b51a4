//! Edges chosen by how they lie: all, the longest of each triangle, those that are flat.

use glam::DVec3;

use crate::{HalfEdgeId, HalfEdgeMesh};

/// How much shorter than the longest side of a triangle another may be that counts as longest too: equal lengths differ by rounding.
const EQUAL_LENGTHS: f64 = 1e-9;

/// The largest angle in radians by which the triangles of a flat edge may differ: files with six decimals bend what was flat.
const FLAT_ANGLE: f64 = 1e-4;

impl HalfEdgeMesh {
    /// The ends of each edge.
    pub fn edge_ends(&self) -> Vec<[u32; 2]> {
        self.edges().map(|h| [self.start(h), self.end(h)]).collect()
    }

    /// The ends of the edges that are the longest side of one of their triangles; sides as long as that (to 1e-9 of their length)
    /// count too.
    ///
    /// # Panics
    /// If `points` has fewer points than the mesh has vertices.
    pub fn longest_edges(&self, points: &[DVec3]) -> Vec<[u32; 2]> {
        let length = |h: HalfEdgeId| points[self.start(h) as usize].distance(points[self.end(h) as usize]);
        let is_longest = |h: HalfEdgeId| {
            let longest = self.face_half_edges(h).into_iter().map(length).fold(0.0, f64::max);
            length(h) >= longest * (1.0 - EQUAL_LENGTHS)
        };
        let chosen = self.edges().filter(|&h| is_longest(h) || self.twin(h).is_some_and(is_longest));
        chosen.map(|h| [self.start(h), self.end(h)]).collect()
    }

    /// The ends of the diagonals of polygons that were cut: edges whose two triangles lie in one plane, to 1e-4 radians, and that are the
    /// longest such edge of both (to 1e-9 of their length). Polygons that lie in one plane themselves so keep their sides.
    ///
    /// # Panics
    /// If `points` has fewer points than the mesh has vertices.
    pub fn flat_edges(&self, points: &[DVec3]) -> Vec<[u32; 2]> {
        let normal = |h: HalfEdgeId| {
            let [a, b, c] = [self.start(h), self.end(h), self.start(h.prev())].map(|v| points[v as usize]);
            (b - a).cross(c - a).normalize_or_zero()
        };
        let is_flat = |h: HalfEdgeId| {
            self.twin(h).is_some_and(|twin| {
                let [one, other] = [normal(h), normal(twin)];
                one.dot(other) > 0.0 && one.cross(other).length() <= FLAT_ANGLE
            })
        };
        let length = |h: HalfEdgeId| points[self.start(h) as usize].distance(points[self.end(h) as usize]);
        let is_longest = |h: HalfEdgeId| {
            let flat = self.face_half_edges(h).into_iter().filter(|&side| is_flat(side));
            length(h) >= flat.map(length).fold(0.0, f64::max) * (1.0 - EQUAL_LENGTHS)
        };
        let is_diagonal =
            |&h: &HalfEdgeId| is_flat(h) && is_longest(h) && self.twin(h).is_some_and(is_longest);
        self.edges().filter(is_diagonal).map(|h| [self.start(h), self.end(h)]).collect()
    }
}
