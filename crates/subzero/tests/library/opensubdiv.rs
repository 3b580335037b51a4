//! Catmull-Clark's scheme and Loop's with creases, semi-sharp creases, darts, corners and boundaries against OpenSubdiv.
#![allow(clippy::cast_possible_truncation, clippy::unwrap_used)] // Meshes of tests are small and good.

use std::collections::HashMap;

use crate::common::{assert_close, load_from, map_vertices, with_features};
use glam::DVec3;
use serde::Deserialize;
use subzero::{EdgeId, LoopWeights, PolygonMesh, TriangleMesh, VertexRule};

#[derive(Deserialize)]
struct Reference {
    boundary: String,
    vertices: Vec<DVec3>,
    faces: Vec<Vec<u32>>,
    creases: Vec<(u32, u32, f32)>,
    corners: Vec<(u32, f32)>,
    levels: Vec<Level>,
    limit_of_level_3: Vec<DVec3>,
}

#[derive(Deserialize)]
struct Level {
    vertices: Vec<DVec3>,
    parents: Vec<Vec<u32>>,
}

/// Asserts that each of our points is where they have theirs, and names the place.
#[track_caller]
fn assert_same(ours: &[DVec3], ids: &[u32], theirs: &[DVec3], what: &str) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    for (v, (&id, &theirs)) in ids.iter().zip(theirs).enumerate() {
        assert_close(ours[id as usize], theirs, 1e-12, &format!("{what} vertex {v}"));
    }
}

#[test]
fn loop_matches() {
    for name in ["loop_cube_loop", "loop_cube_soft", "loop_cube_darts", "loop_open", "loop_open_corner"] {
        let reference: Reference = load_from("opensubdiv", name);
        let faces = reference.faces.iter().map(|face| face[..].try_into().unwrap()).collect();
        let mut points = reference.vertices;
        let mut mesh =
            with_features(&reference.creases, &reference.corners, Some(&reference.boundary), |features| {
                TriangleMesh::new(points.len(), faces, features).unwrap()
            });
        let mut ids: Vec<u32> = (0..points.len() as u32).collect();
        for level in &reference.levels {
            let parents: Vec<[u32; 2]> =
                level.parents.iter().map(|pair| pair[..].try_into().unwrap()).collect();
            ids = map_vertices(&mesh, &ids, &parents);
            let refined = mesh.loop_refine().unwrap();
            points = refined.stencils.apply(&points);
            mesh = refined.mesh;
            assert_same(&points, &ids, &level.vertices, name);
        }
        let limits = mesh.loop_limits(LoopWeights::Loop).unwrap().project(&points);
        let theirs = ids.iter().zip(&reference.limit_of_level_3);
        // OpenSubdiv moves darts by the smooth mask, which is not where its own refinement takes them.
        for (&id, &theirs) in theirs.filter(|&(&id, _)| mesh.vertex_rule(id) != VertexRule::Dart) {
            assert_close(limits[id as usize], theirs, 1e-12, name);
        }
    }
}

#[test]
fn catmull_clark_matches() {
    for name in [
        "catmull_clark_mixed",
        "catmull_clark_mixed_creases",
        "catmull_clark_cube_loop",
        "catmull_clark_cube_soft",
        "catmull_clark_cube_darts",
        "catmull_clark_open",
        "catmull_clark_open_corner",
    ] {
        let reference: Reference = load_from("opensubdiv", name);
        let mut points = reference.vertices;
        let mut mesh =
            with_features(&reference.creases, &reference.corners, Some(&reference.boundary), |features| {
                PolygonMesh::new(points.len(), &reference.faces, features).unwrap()
            });
        let mut ids: Vec<u32> = (0..points.len() as u32).collect();
        for level in &reference.levels {
            ids = map_polygon_vertices(&mesh, &ids, &level.parents);
            let refined = mesh.catmull_clark_refine().unwrap();
            points = refined.stencils.apply(&points);
            mesh = refined.mesh;
            assert_same(&points, &ids, &level.vertices, name);
        }
        let limits = mesh.catmull_clark_limits().unwrap().positions.apply(&points);
        let theirs = ids.iter().zip(&reference.limit_of_level_3);
        for (&id, &theirs) in theirs.filter(|&(&id, _)| mesh.vertex_rule(id) != VertexRule::Dart) {
            assert_close(limits[id as usize], theirs, 1e-12, name);
        }
    }
}

/// Our id on the finer level of each vertex of the reference, from those on the coarser level.
fn map_polygon_vertices(coarse: &PolygonMesh, coarse_ids: &[u32], parents: &[Vec<u32>]) -> Vec<u32> {
    let sorted = |ids: &[u32]| {
        let mut ids = ids.to_vec();
        ids.sort_unstable();
        ids
    };
    let vertices = (0..coarse.vertex_count() as u32).map(|v| vec![v, v]);
    let edges = (0..coarse.edge_count() as u32).map(|e| sorted(&coarse.edge(EdgeId(e))));
    let faces = coarse.faces().map(sorted);
    let children: HashMap<Vec<u32>, u32> = vertices
        .chain(edges)
        .chain(faces)
        .enumerate()
        .map(|(child, parents)| (parents, child as u32))
        .collect();
    let ours = |ids: &Vec<u32>| sorted(&ids.iter().map(|&v| coarse_ids[v as usize]).collect::<Vec<_>>());
    parents.iter().map(|ids| children[&ours(ids)]).collect()
}

/// The limit positions around a vertex of a fine mesh lie in the planes that the coarse mesh's limits predict.
#[test]
fn catmull_clark_normals_are_those_of_a_fine_mesh() {
    let mut compared = HashMap::new();
    for name in ["mixed", "mixed_creases", "cube_loop", "cube_darts", "open_corner"] {
        let reference: Reference = load_from("opensubdiv", &format!("catmull_clark_{name}"));
        // What is semi-sharp has no limits.
        let creases: Vec<_> = reference.creases.into_iter().filter(|crease| crease.2 >= 10.0).collect();
        let corners: Vec<_> = reference.corners.into_iter().filter(|corner| corner.1 >= 10.0).collect();
        let mut points = reference.vertices;
        let mesh = with_features(&creases, &corners, Some(&reference.boundary), |features| {
            PolygonMesh::new(points.len(), &reference.faces, features).unwrap()
        });
        let limits = mesh.catmull_clark_limits().unwrap();
        let normals = limits.sector_normals(&points);
        let mut finest = mesh.clone();
        for _ in 0..6 {
            let refined = finest.catmull_clark_refine().unwrap();
            points = refined.stencils.apply(&points);
            finest = refined.mesh;
        }
        let finest_limits = finest.catmull_clark_limits().unwrap();
        let on_surface = finest_limits.positions.apply(&points);
        let finest_normals = finest_limits.sector_normals(&points);
        for (index, (sector, normal)) in limits.sectors.iter().zip(&normals).enumerate() {
            let rule = mesh.vertex_rule(sector.vertex);
            let what = format!("{name} vertex {} {rule:?}", sector.vertex);
            // Old vertices come first on every level, and so do their sectors.
            let fine_sector = finest_limits.sectors[index];
            assert_eq!(fine_sector.vertex, sector.vertex);
            let Some(normal) = *normal else {
                assert_eq!(rule, VertexRule::Corner, "{what}");
                continue;
            };
            assert_close(finest_normals[index].unwrap(), normal, 1e-9, &what);
            for neighbour in finest.sector_ring(fine_sector) {
                let spoke = on_surface[neighbour as usize] - on_surface[sector.vertex as usize];
                // The sine of an angle; at a crease with three faces it falls by no more than a fifth a level.
                let slope = spoke.normalize().dot(normal);
                assert!(slope.abs() < 0.1, "{what}: {slope}");
            }
            *compared.entry(rule).or_insert(0) += 1;
        }
    }
    assert_eq!(compared.len(), 4, "every rule occurs: {compared:?}");
}
