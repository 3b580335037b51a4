//! Bad input is refused with an error that names the place.
#![allow(clippy::cast_possible_truncation)] // Meshes of tests are small.

use glam::DVec3;
use proptest::prelude::*;
use subzero::{
    Crease, CurveMesh, EdgeId, FaceId, Features, HalfEdgeMesh, LoopWeights, MeshError, PolygonMesh,
    TriangleMesh, check_finite,
};

fn triangle_error(vertex_count: usize, triangles: &[[u32; 3]], features: &Features) -> MeshError {
    TriangleMesh::new(vertex_count, triangles.to_vec(), features).expect_err("the mesh is bad")
}

#[test]
fn triangle_meshes() {
    let none = Features::default();
    assert_eq!(
        triangle_error(3, &[[0, 1, 2], [0, 2, 3]], &none),
        MeshError::VertexOutOfRange { what: "triangle", index: 1, vertex: 3, vertex_count: 3 }
    );
    assert_eq!(
        triangle_error(3, &[[0, 1, 1]], &none),
        MeshError::Degenerate { what: "triangle", index: 0, vertex: 1 }
    );
    assert_eq!(
        triangle_error(4, &[[0, 1, 2], [0, 2, 3], [2, 1, 0]], &none),
        MeshError::DuplicateFace { first: FaceId(0), second: FaceId(2) }
    );
    let turned = [[0, 1, 2], [1, 3, 2], [0, 1, 4]];
    assert_eq!(
        triangle_error(5, &turned, &none),
        MeshError::Winding { first: FaceId(0), second: FaceId(2), ends: [0, 1] }
    );
    let crease = [Crease::infinite([1, 0])];
    let creased = Features { creases: &crease, ..none };
    assert!(TriangleMesh::new(5, turned.to_vec(), &creased).is_ok_and(|mesh| mesh.is_crease(EdgeId(0))));

    let crease = [Crease::infinite([0, 1]), Crease::infinite([0, 3])];
    assert_eq!(
        triangle_error(4, &[[0, 1, 2]], &Features { creases: &crease, ..none }),
        MeshError::CreaseWithoutEdge { index: 1, ends: [0, 3] }
    );
    let crease = [Crease { ends: [0, 1], sharpness: f32::NAN }];
    let error = triangle_error(3, &[[0, 1, 2]], &Features { creases: &crease, ..none });
    assert_eq!(error.to_string(), "the sharpness of crease 0 is NaN: it must be 0 or more");
    assert_eq!(
        triangle_error(3, &[[0, 1, 2]], &Features { corners: &[7], ..none }),
        MeshError::VertexOutOfRange { what: "corner", index: 0, vertex: 7, vertex_count: 3 }
    );
}

#[test]
fn what_a_task_needs() {
    let open = TriangleMesh::new(3, vec![[0, 1, 2]], &Features::default());
    assert_eq!(open.and_then(|mesh| mesh.check_closed()), Err(MeshError::Open { ends: [0, 1] }));
    let error = check_finite(&[DVec3::ZERO, DVec3::new(0.0, f64::NAN, 1.0)]).expect_err("NaN is not finite");
    assert_eq!(error.to_string(), "vertex 1 is at [0.0, NaN, 1.0]: every coordinate must be finite");

    let crease = [Crease { ends: [0, 1], sharpness: 1.5 }];
    let features = Features { creases: &crease, ..Features::default() };
    let soft = TriangleMesh::new(4, vec![[0, 1, 2], [1, 0, 3]], &features);
    let limits = soft.and_then(|mesh| mesh.loop_limits(LoopWeights::Loop));
    assert_eq!(limits, Err(MeshError::SemiSharp { vertex: 0 }));
}

#[test]
fn polygon_meshes() {
    let error_of = |vertex_count: usize, faces: &[&[u32]]| {
        let faces: Vec<Vec<u32>> = faces.iter().map(|face| face.to_vec()).collect();
        PolygonMesh::new(vertex_count, &faces, &Features::default()).expect_err("the mesh is bad")
    };
    assert_eq!(error_of(2, &[&[0, 1]]), MeshError::TooFewCorners { face: FaceId(0), corners: 2 });
    assert_eq!(
        error_of(4, &[&[0, 1, 2, 4]]),
        MeshError::VertexOutOfRange { what: "face", index: 0, vertex: 4, vertex_count: 4 }
    );
    assert_eq!(error_of(4, &[&[0, 1, 2, 1]]), MeshError::Degenerate { what: "face", index: 0, vertex: 1 });
    assert_eq!(
        error_of(4, &[&[0, 1, 2, 3], &[2, 3, 0, 1]]),
        MeshError::DuplicateFace { first: FaceId(0), second: FaceId(1) }
    );
    assert_eq!(
        error_of(5, &[&[0, 1, 2], &[1, 0, 3], &[0, 1, 4]]),
        MeshError::NonManifoldEdge { ends: [0, 1], faces: 3 }
    );
    assert_eq!(
        error_of(4, &[&[0, 1, 2], &[0, 1, 3]]),
        MeshError::Winding { first: FaceId(0), second: FaceId(1), ends: [0, 1] }
    );
    assert_eq!(error_of(5, &[&[0, 1, 2], &[0, 3, 4]]), MeshError::NonManifoldVertex { vertex: 0 });
}

#[test]
fn curves() {
    let out_of_range = MeshError::VertexOutOfRange { what: "segment", index: 0, vertex: 2, vertex_count: 2 };
    assert_eq!(CurveMesh::new(2, vec![[0, 2]], &[]), Err(out_of_range));
    let degenerate = MeshError::Degenerate { what: "segment", index: 1, vertex: 1 };
    assert_eq!(CurveMesh::new(2, vec![[0, 1], [1, 1]], &[]), Err(degenerate));
}

proptest! {
    /// Whatever the triangles, there is an error or a mesh that refines.
    #[test]
    fn any_triangles_make_an_error_or_a_mesh(
        triangles in prop::collection::vec(prop::array::uniform3(0..8_u32), 0..16),
        creases in prop::collection::vec((prop::array::uniform2(0..8_u32), 0.0..12.0_f32), 0..3),
        corners in prop::collection::vec(0..8_u32, 0..3),
    ) {
        let creases: Vec<Crease> = creases.into_iter().map(|(ends, sharpness)| Crease { ends, sharpness }).collect();
        for features in [Features::default(), Features { creases: &creases, corners: &corners, ..Features::default() }] {
            // Without its bad triangles, more of the examples are meshes.
            let mut good: Vec<[u32; 3]> = Vec::new();
            for &[a, b, c] in &triangles {
                good.push([a, b, c]);
                if TriangleMesh::new(8, good.clone(), &Features::default()).is_err() {
                    good.pop();
                }
            }
            for triangles in [&triangles, &good] {
                if let Ok(mesh) = TriangleMesh::new(8, triangles.clone(), &features) {
                    for weights in [LoopWeights::Loop, LoopWeights::BiermannLevinZorin] {
                        let refined = mesh.loop_refine_with(weights).unwrap();
                        prop_assert_eq!(refined.mesh.vertex_count(), refined.stencils.len());
                        let _ = refined.mesh.loop_refine_with(weights).unwrap().mesh.loop_limits(weights);
                    }
                    mesh.modified_butterfly_refine().unwrap().mesh.butterfly_refine().unwrap();
                }
                let faces: Vec<Vec<u32>> = triangles.iter().map(|triangle| triangle.to_vec()).collect();
                if let Ok(mesh) = PolygonMesh::new(8, &faces, &features) {
                    prop_assert!(HalfEdgeMesh::new(8, triangles).is_ok());
                    let _ = mesh.catmull_clark_refine().unwrap().mesh.catmull_clark_limits();
                    let _ = mesh.doo_sabin_refine(subzero::DooSabinWeights::Means);
                }
            }
        }
    }
}
