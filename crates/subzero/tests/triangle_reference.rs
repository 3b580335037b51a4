//! Triangle schemes against numbers from independent programs.
#![allow(clippy::cast_possible_truncation)] // Meshes of tests are small.

mod common;

use common::{TriangleReference, as_set, assert_close, load, map_vertices};
use subzero::{LoopWeights, Refinement, TriangleMesh};

/// Runs a scheme over all levels of a reference file and compares points and triangles.
fn check_levels(name: &str, tolerance: f64, refine: impl Fn(&TriangleMesh) -> Refinement<TriangleMesh>) {
    let reference: TriangleReference = load(name);
    let mut mesh = reference.mesh();
    let mut points = reference.vertices.clone();
    let mut ids: Vec<u32> = (0..points.len() as u32).collect();
    for (level, expected) in reference.levels.iter().enumerate() {
        let refined = refine(&mesh);
        let finer_ids = map_vertices(&mesh, &ids, &expected.parents);
        points = refined.stencils.apply(&points);
        mesh = refined.mesh;
        assert_eq!(points.len(), expected.vertices.len(), "{name} level {}", level + 1);
        for (v, &theirs) in expected.vertices.iter().enumerate() {
            let what = format!("{name} level {} vertex {v}", level + 1);
            assert_close(points[finer_ids[v] as usize], theirs, tolerance, &what);
        }
        if !expected.faces.is_empty() {
            let theirs = expected.faces.iter().map(|face| face.map(|v| finer_ids[v as usize]));
            let ours = mesh.triangles().iter().copied();
            assert_eq!(as_set(ours), as_set(theirs), "{name} level {}", level + 1);
        }
        ids = finer_ids;
    }
}

#[test]
fn loop_matches_opensubdiv() {
    for name in [
        "loop_tetrahedron",
        "loop_torus",
        "loop_cube_asym",
        "loop_cube_presplit",
        "loop_open_edge",
        "loop_open_edge_corner",
        "loop_crease_inf",
        "loop_crease_semi",
        "loop_nonmanifold_triple_line",
        "loop_nonmanifold_2grains",
    ] {
        check_levels(name, 1e-12, TriangleMesh::loop_refine);
    }
}

#[test]
fn warren_weights_match_libigl() {
    check_levels("loop_warren_open_edge", 1e-12, |mesh| mesh.loop_refine_with(LoopWeights::Warren));
}
