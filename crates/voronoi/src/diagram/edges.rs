//! Edges of a tessellation, which it does not store.

use rayon::prelude::*;

use crate::{PeriodicPair, Tessellation, Translation, VertexId};

/// Faces whose edges one task lists.
const FACES_PER_TASK: usize = 1024;

/// The edges of a tessellation, each once.
#[derive(Debug, Clone, PartialEq)]
pub struct Edges {
    /// The two ends of each edge, smaller id first; sorted.
    pub ends: Vec<[VertexId; 2]>,
    /// For each corner of each face, in the order of the faces, the edge from it to the next corner.
    pub of_corner: Vec<u32>,
}

impl Edges {
    fn new(tessellation: &Tessellation) -> Self {
        let faces = (0..tessellation.face_count()).into_par_iter().with_min_len(FACES_PER_TASK);
        let uses_of = |face: usize| {
            let first = tessellation.face_starts[face];
            let corners = &tessellation.face_corners[first..tessellation.face_starts[face + 1]];
            let ends = corners.iter().zip(corners.iter().cycle().skip(1));
            ends.zip(first..).map(|((&from, &to), corner)| ([from.min(to), from.max(to)], corner))
        };
        let mut uses: Vec<([VertexId; 2], usize)> = faces.flat_map_iter(uses_of).collect();
        uses.par_sort_unstable();
        let mut edges = Self { ends: Vec::new(), of_corner: vec![0; uses.len()] };
        for same in uses.chunk_by(|left, right| left.0 == right.0) {
            let edge = u32::try_from(edges.ends.len()).expect("edge ids fit 32 bits");
            edges.ends.push(same[0].0);
            for (_, corner) in same {
                edges.of_corner[*corner] = edge;
            }
        }
        edges
    }

    fn periodic_pairs(&self, vertices: &[PeriodicPair<VertexId>]) -> Vec<PeriodicPair<u32>> {
        let Some(first_secondary) = vertices.first().map(|pair| pair.secondary) else { return Vec::new() };
        let primary = |vertex: VertexId| match vertex.0.checked_sub(first_secondary.0) {
            None => (vertex, Translation::ZERO),
            Some(place) => (vertices[place as usize].primary, vertices[place as usize].translation),
        };
        // An edge of the torus is a primary vertex, another one, and the translation of the other as seen from the first.
        let mut places: Vec<_> = (0u32..)
            .zip(&self.ends)
            .map(|(edge, ends)| {
                let [(a, at_a), (b, at_b)] = ends.map(primary);
                let (name, translation) = ((a, b, at_b - at_a), at_a).min(((b, a, at_a - at_b), at_b));
                (name, edge, translation)
            })
            .collect();
        places.sort_unstable();
        let same = places.chunk_by(|left, right| left.0 == right.0);
        let mut pairs: Vec<PeriodicPair<u32>> = same
            .flat_map(|same| {
                let (_, primary, at_primary) = same[0];
                let pair = move |&(_, secondary, translation): &_| PeriodicPair {
                    secondary,
                    primary,
                    translation: translation - at_primary,
                };
                same[1..].iter().map(pair)
            })
            .collect();
        pairs.sort_unstable_by_key(|pair| pair.secondary);
        pairs
    }
}

impl Tessellation {
    /// The edges between corners of the faces (three dimensions), or the faces' own (in the plane).
    pub fn edges(&self) -> Edges {
        Edges::new(self)
    }

    /// Of the given edges, those that are others moved by whole periods, in order.
    pub fn periodic_edges(&self, edges: &Edges) -> Vec<PeriodicPair<u32>> {
        edges.periodic_pairs(&self.periodic_vertices)
    }
}
