use glam::DVec3;
use rayon::prelude::*;

use crate::mesh::adjacency::Adjacency;
use crate::{Elements, Level};

/// Normal of a triangle, or normal of a segment in the plane, as long as twice its area or as its length.
pub(crate) fn element_normals(level: &Level, points: &[DVec3]) -> Vec<DVec3> {
    Elements::from(&level.mesh).normals(points)
}

/// Pairs of neighbouring elements of one boundary whose normals are more than the angle apart whose cosine is given.
///
/// 0 finds folds over 90 degrees. Elements without area count as folded.
pub fn folded_edges(level: &Level, points: &[DVec3], cosine: f64) -> Vec<[u32; 2]> {
    folded_pairs(&Adjacency::of_level(level).inner, &element_normals(level, points), cosine)
}

/// Those of some pairs of elements that [`folded_edges`] finds, for normals of any length.
pub(crate) fn folded_pairs(pairs: &[[u32; 2]], normals: &[DVec3], cosine: f64) -> Vec<[u32; 2]> {
    let is_folded = |pair: &&[u32; 2]| {
        let [a, b] = pair.map(|element| normals[element as usize]);
        let dot = a.dot(b);
        // Nearly all pairs are told by this alone.
        if dot > 0.0 && cosine <= 0.0 {
            return false;
        }
        dot < cosine * (a.length() * b.length()) || a == DVec3::ZERO || b == DVec3::ZERO
    };
    pairs.par_iter().filter(is_folded).copied().collect()
}
