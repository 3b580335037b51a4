//! Winding made to agree.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use glam::DVec3;
use proptest::prelude::*;
use subzero::{HalfEdgeMesh, MeshError, orient};

const TETRAHEDRON: [[u32; 3]; 4] = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];

fn faces(triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    triangles.iter().map(|triangle| triangle.to_vec()).collect()
}

fn oriented(vertex_count: usize, faces: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut faces = faces.to_vec();
    orient(vertex_count, &faces).unwrap().apply(&mut faces);
    faces
}

/// SubZero's own example: triangles around point 2 that wind as they were typed.
#[test]
fn the_fan_of_the_first_subzero() {
    let typed = faces(&[[6, 5, 2], [4, 3, 2], [2, 4, 5], [6, 7, 2]]);
    let oriented = oriented(9, &typed);
    let triangles: Vec<[u32; 3]> = oriented.iter().map(|face| face[..].try_into().unwrap()).collect();
    HalfEdgeMesh::new(9, &triangles).unwrap();
    // The first runs 5-2 and 2-6, as do the third and the fourth; the third would run 2-4 as the second does.
    assert_eq!(triangles, [[6, 5, 2], [4, 3, 2], [2, 5, 4], [6, 2, 7]]);
}

#[test]
fn most_faces_stay() {
    let mut typed = faces(&TETRAHEDRON);
    typed[0].swap(1, 2);
    let orientation = orient(4, &typed).unwrap();
    assert_eq!(orientation.reversed(), [true, false, false, false]);
    assert_eq!(orientation.is_closed(), [true]);
    assert_eq!(oriented(4, &typed), faces(&TETRAHEDRON));
}

#[test]
fn components_are_turned_by_themselves_and_outward_if_closed() {
    let mut typed = faces(&TETRAHEDRON);
    // A second one inside out, and an open triangle.
    typed.extend(TETRAHEDRON.iter().map(|t| t.iter().rev().map(|v| v + 4).collect()));
    typed.push(vec![8, 9, 10]);
    let mut orientation = orient(11, &typed).unwrap();
    assert_eq!(orientation.component_of(), [0, 0, 0, 0, 1, 1, 1, 1, 2]);
    assert_eq!(orientation.is_closed(), [true, true, false]);
    assert!(!orientation.reversed().contains(&true), "what agrees stays as it is");
    let corner = |v: u32| match v % 4 {
        0 => DVec3::NEG_ONE,
        1 => DVec3::new(1.0, -1.0, 1.0),
        2 => DVec3::new(-1.0, 1.0, 1.0),
        _ => DVec3::new(1.0, 1.0, -1.0),
    };
    // Far out, where a volume about the origin has lost its digits.
    let points: Vec<DVec3> = (0..11).map(|v| corner(v) * 1e-3 + DVec3::splat(1e6)).collect();
    orientation.face_outward(&points, &typed);
    let turned: Vec<bool> = [vec![false; 4], vec![true; 4], vec![false]].concat();
    assert_eq!(orientation.reversed(), turned);
}

#[test]
fn one_side_only() {
    // A Moebius strip of five triangles.
    let strip = faces(&[[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]]);
    let error = orient(5, &strip).unwrap_err();
    assert!(matches!(error, MeshError::NotOrientable { .. }), "{error}");
    assert!(error.to_string().contains("only one side"));
}

#[test]
fn edges_of_three_faces_join_nothing() {
    let book = faces(&[[0, 1, 2], [0, 1, 3], [0, 1, 4]]);
    let orientation = orient(5, &book).unwrap();
    assert_eq!(orientation.component_of(), [0, 1, 2]);
    assert!(!orientation.reversed().contains(&true));
}

proptest! {
    /// Whatever faces of a torus are turned, it becomes a manifold mesh again, with fewer than half of its faces turned.
    #[test]
    fn any_faces_turned(turned in prop::collection::vec(any::<bool>(), 24)) {
        let vertex = |i: u32, j: u32| 4 * (i % 3) + j % 4;
        let mut squares = Vec::new();
        for (i, j) in (0..3).flat_map(|i| (0..4).map(move |j| (i, j))) {
            squares.push(vec![vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)]);
            squares.push(vec![vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
        }
        for (face, _) in squares.iter_mut().zip(&turned).filter(|(_, turned)| **turned) {
            face.reverse();
        }
        let orientation = orient(12, &squares).unwrap();
        prop_assert!(2 * orientation.reversed().iter().filter(|turned| **turned).count() <= 24);
        orientation.apply(&mut squares);
        let triangles: Vec<[u32; 3]> = squares.iter().map(|face| face[..].try_into().unwrap()).collect();
        prop_assert!(HalfEdgeMesh::new(12, &triangles).is_ok());
    }
}
