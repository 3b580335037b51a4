use glam::DVec3;
use rayon::prelude::*;

use crate::{Level, Mesh};

/// Normal of a triangle, or normal of a segment in the plane, as long as twice its area or as its length.
pub(crate) fn element_normals(level: &Level, points: &[DVec3]) -> Vec<DVec3> {
    let at = |vertex: u32| points[vertex as usize];
    match &level.mesh {
        Mesh::Triangles(mesh) => {
            let normal = |corners: &[u32; 3]| {
                let [a, b, c] = corners.map(at);
                (b - a).cross(c - a)
            };
            mesh.triangles().par_iter().map(normal).collect()
        }
        Mesh::Segments(mesh) => {
            let normal = |ends: &[u32; 2]| (at(ends[1]) - at(ends[0])).cross(DVec3::Z);
            mesh.segments().par_iter().map(normal).collect()
        }
    }
}

/// Pairs of neighbouring elements of one boundary whose normals are more than the angle apart whose cosine is given.
///
/// 0 finds folds over 90 degrees. Elements without area count as folded.
pub fn folded_edges(level: &Level, points: &[DVec3], cosine: f64) -> Vec<[u32; 2]> {
    let unit: Vec<DVec3> =
        element_normals(level, points).into_par_iter().map(|normal| normal.normalize_or_zero()).collect();
    let is_folded = |pair: &[u32; 2]| {
        let [a, b] = pair.map(|element| element as usize);
        let apart = unit[a].dot(unit[b]) < cosine || unit[a] == DVec3::ZERO || unit[b] == DVec3::ZERO;
        apart && level.boundary_of[a] == level.boundary_of[b]
    };
    match &level.mesh {
        Mesh::Triangles(mesh) => {
            let edges = 0..u32::try_from(mesh.edge_count()).expect("edge ids fit 32 bits");
            edges.into_par_iter().filter_map(|edge| mesh.edge_triangles(edge)).filter(is_folded).collect()
        }
        Mesh::Segments(mesh) => {
            let vertices = 0..u32::try_from(mesh.vertex_count()).expect("vertex ids fit 32 bits");
            vertices
                .into_par_iter()
                .filter_map(|vertex| mesh.vertex_segments(vertex))
                .filter(is_folded)
                .collect()
        }
    }
}
