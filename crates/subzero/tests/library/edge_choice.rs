//! Edges chosen by how they lie.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use glam::{DMat3, DVec3};
use subzero::HalfEdgeMesh;

/// The unit cube, its squares cut along one diagonal each.
fn cube() -> (Vec<DVec3>, HalfEdgeMesh) {
    let bit = |v: u32, k: u32| f64::from(v >> k & 1);
    let points = (0..8).map(|v| DVec3::new(bit(v, 0), bit(v, 1), bit(v, 2))).collect();
    let triangles = [
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];
    (points, HalfEdgeMesh::new(8, &triangles).unwrap())
}

fn sorted(mut edges: Vec<[u32; 2]>) -> Vec<[u32; 2]> {
    edges.iter_mut().for_each(|edge| edge.sort_unstable());
    edges.sort_unstable();
    edges
}

#[test]
fn diagonals_of_a_cube_are_flat_and_longest() {
    let (points, mesh) = cube();
    let diagonals = [[0, 3], [0, 5], [0, 6], [1, 7], [2, 7], [4, 7]];
    // Turned, so that no coordinate is exact.
    let turned = DMat3::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, -0.7);
    let turned: Vec<DVec3> = points.iter().map(|point| turned * *point + DVec3::splat(0.1)).collect();
    for points in [points, turned] {
        assert_eq!(sorted(mesh.flat_edges(&points)), diagonals);
        assert_eq!(sorted(mesh.longest_edges(&points)), diagonals);
    }
    assert_eq!(mesh.edge_ends().len(), 18);
}

#[test]
fn sides_as_long_as_the_longest_count_too() {
    let [a, b] = [60_f64, 120.0].map(|angle| angle.to_radians().sin_cos());
    let points = [DVec3::ZERO, DVec3::X, DVec3::new(a.1, a.0, 0.0), DVec3::new(b.1, b.0, 0.0)];
    let mesh = HalfEdgeMesh::new(4, &[[0, 1, 2], [0, 2, 3]]).unwrap();
    assert_eq!(mesh.longest_edges(&points).len(), 5);
    assert_eq!(mesh.flat_edges(&points), [[2, 0]]);
}

/// Squares in one plane keep the sides between them.
#[test]
fn diagonals_alone_of_polygons_in_one_plane() {
    let points: Vec<DVec3> = (0..6).map(|v| DVec3::new(f64::from(v % 3), f64::from(v / 3), 0.5)).collect();
    let mesh = HalfEdgeMesh::new(6, &[[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]]).unwrap();
    assert_eq!(sorted(mesh.flat_edges(&points)), [[0, 4], [1, 5]]);
}

#[test]
fn what_folds_back_is_not_flat() {
    let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.3, 0.3, 0.0)];
    let mesh = HalfEdgeMesh::new(4, &[[0, 1, 2], [1, 0, 3]]).unwrap();
    assert!(mesh.flat_edges(&points).is_empty());
}
