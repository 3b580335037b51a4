//! The numbering of a refined mesh, as `MeshCounts` promises it.
#![allow(clippy::cast_possible_truncation)] // Meshes of tests are small.

use crate::common::{TriangleReference, load};
use subzero::{Crease, CurveMesh, EdgeId, EdgeParent, FaceId, Features, TriangleMesh, VertexParent};

const MESHES: [&str; 4] =
    ["loop_open_edge_corner", "loop_crease_inf", "loop_nonmanifold_triple_line", "loop_nonmanifold_2grains"];

fn sorted<const N: usize>(mut ids: [u32; N]) -> [u32; N] {
    ids.sort_unstable();
    ids
}

#[test]
fn children_lie_where_the_numbering_says() {
    for name in MESHES {
        let coarse = load::<TriangleReference>(name).mesh();
        let counts = coarse.counts();
        let fine = coarse.loop_refine().unwrap().mesh;
        assert_eq!(fine.counts(), counts.refined().unwrap());
        for e in (0..counts.edges).map(EdgeId) {
            let [a, b] = coarse.edge(e);
            let middle = counts.edge_vertex(e);
            assert_eq!(counts.vertex_parent(middle), VertexParent::Edge(e));
            assert_eq!(fine.edge(EdgeId(2 * e.0)), [a, middle]);
            assert_eq!(sorted(fine.edge(EdgeId(2 * e.0 + 1))), sorted([middle, b]));
            assert_eq!(counts.edge_parent(EdgeId(2 * e.0 + 1)), EdgeParent::Edge(e));
            for child in counts.edge_children(e) {
                assert_eq!(fine.is_crease(child), coarse.is_crease(e), "{name}: edge {e}");
            }
        }
        for t in 0..counts.triangles {
            let edges = coarse.triangle_edges(FaceId(t));
            for k in 0..3_u32 {
                let [here, before] =
                    [edges[k as usize], edges[(k as usize + 2) % 3]].map(|e| counts.edge_vertex(e));
                let corner = coarse.triangles()[t as usize][k as usize];
                assert_eq!(counts.vertex_parent(corner), VertexParent::Vertex(corner));
                assert_eq!(fine.triangles()[(3 * t + k) as usize], [corner, here, before]);
                assert_eq!(fine.triangles()[(3 * counts.triangles + t) as usize][k as usize], before);
                let inner = EdgeId(2 * counts.edges + 3 * t + k);
                assert_eq!(sorted(fine.edge(inner)), sorted([here, before]));
                assert_eq!(counts.edge_parent(inner), EdgeParent::Triangle(FaceId(t)));
                assert!(!fine.is_crease(inner));
            }
            for child in counts.triangle_children(FaceId(t)) {
                assert_eq!(counts.triangle_parent(child), FaceId(t));
            }
        }
    }
}

#[test]
fn arithmetic_agrees_with_a_search() {
    for name in MESHES {
        let fine =
            load::<TriangleReference>(name).mesh().loop_refine().unwrap().mesh.loop_refine().unwrap().mesh;
        let creases: Vec<Crease> = (0..fine.counts().edges)
            .map(EdgeId)
            .filter(|&e| fine.is_crease(e))
            .map(|e| Crease::infinite(fine.edge(e)))
            .collect();
        let corners: Vec<u32> = (0..fine.counts().vertices)
            .filter(|&v| fine.vertex_rule(v) == subzero::VertexRule::Corner)
            .collect();
        let features = Features { creases: &creases, corners: &corners, ..Features::default() };
        let searched = TriangleMesh::new(fine.vertex_count(), fine.triangles().to_vec(), &features).unwrap();
        assert_eq!(searched.counts(), fine.counts());
        for v in 0..fine.counts().vertices {
            assert_eq!(searched.vertex_rule(v), fine.vertex_rule(v), "{name}: vertex {v}");
        }
        for t in 0..fine.counts().triangles {
            let corners = fine.triangles()[t as usize];
            for k in 0..3 {
                let ends = sorted([corners[k], corners[(k + 1) % 3]]);
                assert_eq!(
                    sorted(fine.edge(fine.triangle_edges(FaceId(t))[k])),
                    ends,
                    "{name}: triangle {t}"
                );
                let [ours, searched_edge] = [&fine, &searched].map(|mesh| mesh.triangle_edges(FaceId(t))[k]);
                assert_eq!(fine.is_crease(ours), searched.is_crease(searched_edge));
            }
        }
        // The points of the next level agree too, each found through its edge.
        let positions: Vec<f64> = (0..fine.vertex_count()).map(|v| (v as f64 * 0.7).sin()).collect();
        let [ours, theirs] =
            [&fine, &searched].map(|mesh| mesh.loop_refine().unwrap().stencils.apply(&positions));
        for (v, (a, b)) in ours.iter().zip(&theirs).enumerate().take(fine.vertex_count()) {
            assert!((a - b).abs() < 1e-14, "{name}: vertex {v}");
        }
        for (t, corners) in fine.triangles().iter().enumerate() {
            let [a, b] = [&fine, &searched]
                .map(|mesh| mesh.triangle_edges(FaceId(t as u32))[0].index() + fine.vertex_count());
            assert!((ours[a] - theirs[b]).abs() < 1e-14, "{name}: edge of {corners:?}");
        }
    }
}

#[test]
fn curves_keep_direction_and_parents() {
    let curve = CurveMesh::new(5, vec![[0, 1], [1, 2], [3, 1], [3, 4]], &[]).unwrap();
    let refined = curve.refine().unwrap();
    assert_eq!(refined.mesh.segments(), [[0, 5], [5, 1], [1, 6], [6, 2], [3, 7], [7, 1], [3, 8], [8, 4]]);
    // Vertex 1 has three segments, 3 has two, the ends have one.
    assert_eq!(refined.stencils.stencil(1), (&[1][..], &[1.0][..]));
    assert_eq!(refined.stencils.stencil(3), (&[3, 1, 4][..], &[0.75, 0.125, 0.125][..]));
    assert_eq!(refined.stencils.stencil(8), (&[3, 4][..], &[0.5, 0.5][..]));
    assert_eq!(refined.mesh.neighbours(3), Some([7, 8]));
}
