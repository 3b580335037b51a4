//! Doo-Sabin against numbers from CGAL, Catmull-Clark against known values and tensor-product splines.
#![allow(clippy::cast_possible_truncation)] // Meshes of tests are small.

use std::collections::HashMap;

use crate::common::{assert_close, load};
use glam::DVec3;
use serde::Deserialize;
use subzero::{Crease, CurveMesh, DooSabinWeights, EdgeId, FaceId, Features, PolygonMesh, VertexRule};

#[derive(Deserialize)]
struct DooSabinReference {
    vertices: Vec<DVec3>,
    faces: Vec<Vec<u32>>,
    levels: Vec<DooSabinLevel>,
    level1_catmull_clark_1978_weights_numpy_only: Vec<DVec3>,
}

#[derive(Deserialize)]
struct DooSabinLevel {
    vertices: Vec<DVec3>,
    faces: Vec<Vec<u32>>,
    corners: Vec<[u32; 2]>,
    limit_face_point: Vec<DVec3>,
    limit_face_normal: Vec<DVec3>,
}

/// A face turned so that its lowest vertex comes first.
fn canonical(mut face: Vec<u32>) -> Vec<u32> {
    let lowest = face.iter().enumerate().min_by_key(|&(_, v)| v).map_or(0, |(i, _)| i);
    face.rotate_left(lowest);
    face
}

fn mesh_of(vertex_count: usize, faces: &[Vec<u32>]) -> PolygonMesh {
    PolygonMesh::new(vertex_count, faces, &Features::default()).expect("the mesh is good")
}

#[test]
fn doo_sabin_matches_cgal() {
    for name in ["doosabin_cube", "doosabin_tetrahedron", "doosabin_open_grid"] {
        let reference: DooSabinReference = load(name);
        let mut mesh = mesh_of(reference.vertices.len(), &reference.faces);
        let mut points = reference.vertices.clone();
        // Our vertex, and our face, of each of theirs.
        let mut vertex_ids: Vec<u32> = (0..points.len() as u32).collect();
        let mut face_ids: Vec<u32> = (0..reference.faces.len() as u32).collect();
        for (level, expected) in reference.levels.iter().enumerate() {
            if level == 0 {
                let means = mesh.doo_sabin_refine(DooSabinWeights::Means).unwrap().stencils.apply(&points);
                for (&ours, &theirs) in
                    means.iter().zip(&reference.level1_catmull_clark_1978_weights_numpy_only)
                {
                    assert_close(ours, theirs, 1e-12, name);
                }
            }
            let refined = mesh.doo_sabin_refine(DooSabinWeights::DooSabin).unwrap();
            points = refined.stencils.apply(&points);
            assert_eq!(points.len(), expected.vertices.len());
            // Corner k of face f is the vertex that counts the corners before it.
            let mut starts = vec![0];
            for face in mesh.faces() {
                starts.push(starts[starts.len() - 1] + face.len() as u32);
            }
            vertex_ids = expected
                .corners
                .iter()
                .map(|&[face, vertex]| {
                    let face = face_ids[face as usize];
                    let corner =
                        mesh.face(FaceId(face)).iter().position(|&v| v == vertex_ids[vertex as usize]);
                    starts[face as usize] + corner.expect(name) as u32
                })
                .collect();
            mesh = refined.mesh;
            for (&ours, &theirs) in vertex_ids.iter().zip(&expected.vertices) {
                assert_close(points[ours as usize], theirs, 1e-12, name);
            }
            let by_corners: HashMap<Vec<u32>, u32> =
                mesh.faces().enumerate().map(|(f, face)| (canonical(face.to_vec()), f as u32)).collect();
            assert_eq!(by_corners.len(), expected.faces.len(), "{name} level {}", level + 1);
            let in_ours = |face: &Vec<u32>| canonical(face.iter().map(|&v| vertex_ids[v as usize]).collect());
            face_ids = expected.faces.iter().map(|face| by_corners[&in_ours(face)]).collect();

            let limits = mesh.doo_sabin_limits();
            let positions = limits.positions.apply(&points);
            let normals = limits.normals(&points);
            for (f, &ours) in face_ids.iter().enumerate() {
                assert_close(positions[ours as usize], expected.limit_face_point[f], 1e-12, name);
                let normal = normals[ours as usize].expect(name);
                assert_close(normal, expected.limit_face_normal[f], 1e-12, name);
            }
        }
    }
}

#[test]
fn refined_polygon_meshes_agree_with_a_search() {
    for name in ["doosabin_cube", "doosabin_tetrahedron", "doosabin_open_grid"] {
        let reference: DooSabinReference = load(name);
        let mut mesh = mesh_of(reference.vertices.len(), &reference.faces);
        for step in 0..4 {
            mesh = if step % 2 == 0 {
                mesh.doo_sabin_refine(DooSabinWeights::default()).unwrap().mesh
            } else {
                mesh.catmull_clark_refine().unwrap().mesh
            };
            let faces: Vec<Vec<u32>> = mesh.faces().map(<[u32]>::to_vec).collect();
            let searched = mesh_of(mesh.vertex_count(), &faces);
            assert_eq!(searched.edge_count(), mesh.edge_count(), "{name}");
            for (f, face) in faces.iter().enumerate() {
                let pairs = mesh.face_edges(FaceId(f as u32)).zip(searched.face_edges(FaceId(f as u32)));
                for (k, (ours, theirs)) in pairs.enumerate() {
                    let mut ends = [face[k], face[(k + 1) % face.len()]];
                    ends.sort_unstable();
                    let [mut a, mut b] = [mesh.edge(ours), searched.edge(theirs)];
                    a.sort_unstable();
                    b.sort_unstable();
                    assert_eq!((a, b), (ends, ends), "{name}");
                    assert_eq!(mesh.is_boundary(ours), searched.is_boundary(theirs));
                    assert_eq!(mesh.is_crease(ours), searched.is_crease(theirs));
                }
            }
            for v in 0..mesh.vertex_count() as u32 {
                assert_eq!(mesh.vertex_rule(v), searched.vertex_rule(v), "{name} step {step} vertex {v}");
            }
        }
    }
}

/// A grid of quads that closes in both directions, and a point of it as the product of two closed curves.
fn torus(m: u32, n: u32) -> PolygonMesh {
    let at = |i: u32, j: u32| (i % m) * n + j % n;
    let quad = |i, j| vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
    let faces: Vec<Vec<u32>> = (0..m).flat_map(|i| (0..n).map(move |j| quad(i, j))).collect();
    mesh_of((m * n) as usize, &faces)
}

#[test]
fn catmull_clark_is_the_bicubic_spline_on_a_regular_grid() {
    let closed =
        |n: u32| CurveMesh::new(n as usize, (0..n).map(|i| [i, (i + 1) % n]).collect(), &[]).unwrap();
    let (m, n) = (5, 7);
    let a: Vec<f64> = (0..m).map(|i| (1.3 * f64::from(i)).sin() + f64::from(i * i)).collect();
    let b: Vec<f64> = (0..n).map(|j| (0.7 * f64::from(j)).cos() - f64::from(j)).collect();
    let product = |a: &[f64], b: &[f64]| -> Vec<f64> {
        a.iter().flat_map(|&a| b.iter().map(move |&b| a * b)).collect()
    };
    let mesh = torus(m, n);
    let refined = mesh.catmull_clark_refine().unwrap();
    let points = refined.stencils.apply(&product(&a, &b));
    let [fine_a, fine_b] = [(&a, m), (&b, n)].map(|(x, n)| closed(n).refine().unwrap().stencils.apply(x));
    // Old vertices, then edges, then faces: each the product of what lies over it.
    for v in 0..m * n {
        let expected = fine_a[(v / n) as usize] * fine_b[(v % n) as usize];
        assert!((points[v as usize] - expected).abs() < 1e-12);
    }
    for e in 0..mesh.edge_count() as u32 {
        let [start, end] = mesh.edge(EdgeId(e));
        let between = |start: u32, end: u32, n: u32| if (start + 1) % n == end { n + start } else { n + end };
        let expected = if start / n == end / n {
            fine_a[(start / n) as usize] * fine_b[between(start % n, end % n, n) as usize]
        } else {
            fine_a[between(start / n, end / n, m) as usize] * fine_b[(start % n) as usize]
        };
        assert!((points[(m * n + e) as usize] - expected).abs() < 1e-12);
    }
    for f in 0..m * n {
        let expected = fine_a[(m + f / n) as usize] * fine_b[(n + f % n) as usize];
        assert!((points[mesh.vertex_count() + mesh.edge_count() + f as usize] - expected).abs() < 1e-12);
    }
    let limits = mesh.catmull_clark_limits().unwrap().positions.apply(&product(&a, &b));
    let [limit_a, limit_b] = [(&a, m), (&b, n)].map(|(x, n)| closed(n).limit_positions().apply(x));
    for (ours, expected) in limits.iter().zip(product(&limit_a, &limit_b)) {
        assert!((ours - expected).abs() < 1e-12);
    }
}

#[test]
fn catmull_clark_limits_stay_put() {
    let cube: DooSabinReference = load("doosabin_cube");
    let grid: DooSabinReference = load("doosabin_open_grid");
    // Creases: a dart that ends inside, and a closed loop around a face.
    let dart = [Crease::infinite([0, 1])];
    let ring: Vec<Crease> =
        (0..4).map(|k| Crease::infinite([cube.faces[0][k], cube.faces[0][(k + 1) % 4]])).collect();
    let cases = [(&cube, &[][..]), (&cube, &dart[..]), (&cube, &ring[..]), (&grid, &[][..])];
    for (reference, creases) in cases {
        let features = Features { creases, ..Features::default() };
        let mut mesh = PolygonMesh::new(reference.vertices.len(), &reference.faces, &features).unwrap();
        let mut points = reference.vertices.clone();
        let limits = mesh.catmull_clark_limits().unwrap();
        let (positions, normals) = (limits.positions.apply(&points), limits.vertex_normals(&points));
        for _ in 0..3 {
            let refined = mesh.catmull_clark_refine().unwrap();
            points = refined.stencils.apply(&points);
            mesh = refined.mesh;
            let limits = mesh.catmull_clark_limits().unwrap();
            let (finer, finer_normals) = (limits.positions.apply(&points), limits.vertex_normals(&points));
            for v in 0..positions.len() {
                assert_close(finer[v], positions[v], 1e-12, "limit position");
                // Creases inside have a normal on either side, those on the boundary one.
                let has_one = match mesh.vertex_rule(v as u32) {
                    VertexRule::Smooth | VertexRule::Dart => true,
                    _ => reference.vertices.len() == grid.vertices.len(),
                };
                assert_eq!(normals[v].is_some(), has_one);
                if let (Some(normal), Some(finer)) = (normals[v], finer_normals[v]) {
                    assert_close(finer, normal, 1e-12, "limit normal");
                }
            }
        }
    }
}

#[test]
fn catmull_clark_of_the_cube() {
    let cube: DooSabinReference = load("doosabin_cube");
    let mesh = mesh_of(8, &cube.faces);
    let points = mesh.catmull_clark_refine().unwrap().stencils.apply(&cube.vertices);
    // Corners move to 5/9, edge points to (3/4, 3/4, 0), face points stay at 1.
    for (&point, &corner) in points.iter().zip(&cube.vertices) {
        assert_close(point, corner * 5.0 / 9.0, 1e-15, "corner");
    }
    for (e, point) in points[8..20].iter().enumerate() {
        let [a, b] = mesh.edge(EdgeId(e as u32));
        assert_close(*point, (cube.vertices[a as usize] + cube.vertices[b as usize]) * 0.375, 1e-15, "edge");
    }
    assert!(points[20..].iter().all(|point| (point.length() - 1.0).abs() < 1e-15));
    let normals = mesh.catmull_clark_limits().unwrap().vertex_normals(&cube.vertices);
    for (normal, corner) in normals.iter().zip(&cube.vertices) {
        assert_close(normal.unwrap(), corner.normalize(), 1e-12, "normal");
    }
}
