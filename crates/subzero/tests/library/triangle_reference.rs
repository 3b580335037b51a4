//! Triangle schemes against numbers from independent programs.
#![allow(clippy::cast_possible_truncation)] // Meshes of tests are small.

use crate::common::{TriangleReference, as_set, assert_close, load, map_vertices};
use glam::DVec3;
use subzero::{LoopLimits, LoopWeights, MeshError, Refinement, Sector, TriangleMesh};

/// Runs a scheme over all levels of a reference file and compares points and triangles.
fn check_levels(
    name: &str,
    tolerance: f64,
    refine: impl Fn(&TriangleMesh) -> Result<Refinement<TriangleMesh>, MeshError>,
) {
    let reference: TriangleReference = load(name);
    let mut mesh = reference.mesh();
    let mut points = reference.vertices.clone();
    let mut ids: Vec<u32> = (0..points.len() as u32).collect();
    for (level, expected) in reference.levels.iter().enumerate() {
        let refined = refine(&mesh).expect("a small mesh");
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

#[test]
fn sector_weights_match() {
    check_levels("loop_blz_open_edge", 1e-12, |mesh| mesh.loop_refine_with(LoopWeights::BiermannLevinZorin));
}

#[test]
fn butterflies_match() {
    check_levels("butterfly_cube_presplit", 1e-12, TriangleMesh::butterfly_refine);
    for name in ["mbutterfly_tetrahedron", "mbutterfly_torus", "mbutterfly_cube_presplit", "mbutterfly_open"]
    {
        check_levels(name, 1e-12, TriangleMesh::modified_butterfly_refine);
    }
}

/// Compares limit positions and normals on each level that has them, and sector normals on level 0.
fn check_limits(name: &str, tolerance: f64) {
    let reference: TriangleReference = load(name);
    let mut mesh = reference.mesh();
    let mut points = reference.vertices.clone();
    let mut ids: Vec<u32> = (0..points.len() as u32).collect();
    for level in 0..=reference.levels.len() {
        if let Some(expected) = reference.limits.iter().find(|limits| limits.level == level) {
            let limits = mesh.loop_limits(LoopWeights::Loop).expect("all sharpness has run out");
            let positions = limits.project(&points);
            let normals = limits.vertex_normals(&points);
            for (v, &ours) in ids.iter().enumerate() {
                let what = format!("{name} level {level} vertex {v} of kind {}", expected.kind[v]);
                assert_close(positions[ours as usize], expected.position_exact[v], tolerance, &what);
                match expected.normal_exact[v] {
                    [Some(x), Some(y), Some(z)] => {
                        let normal = normals[ours as usize].expect(&what);
                        assert_close(normal, DVec3::new(x, y, z), tolerance, &what);
                    }
                    _ => assert_eq!(normals[ours as usize], None, "{what}"),
                }
            }
            if level == 0 {
                check_sectors(name, &reference, &mesh, &limits, tolerance);
            }
        }
        if let Some(next) = reference.levels.get(level) {
            let refined = mesh.loop_refine().expect("a small mesh");
            ids = map_vertices(&mesh, &ids, &next.parents);
            points = refined.stencils.apply(&points);
            mesh = refined.mesh;
        }
    }
}

fn check_sectors(
    name: &str,
    reference: &TriangleReference,
    mesh: &TriangleMesh,
    limits: &LoopLimits,
    tolerance: f64,
) {
    let normals = limits.sector_normals(&reference.vertices);
    for expected in &reference.sector_normals_level0 {
        let is_it =
            |sector: &Sector| sector.vertex == expected.v && mesh.sector_ring(*sector) == expected.ring;
        let what = format!("{name} sector {:?} of vertex {}", expected.ring, expected.v);
        let found = limits.sectors.iter().position(is_it).expect(&what);
        assert_close(normals[found].expect(&what), expected.normal, tolerance, &what);
    }
}

#[test]
fn loop_limits_match() {
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
        check_limits(name, 1e-12);
    }
}
