//! Editing a half-edge mesh.
#![allow(clippy::cast_possible_truncation, clippy::unwrap_used)] // Meshes of tests are small and good.

use crate::common::{TriangleReference, as_set, assert_close, load};
use glam::DVec3;
use proptest::prelude::*;
use subzero::{FaceId, Features, HalfEdgeId, HalfEdgeMesh, MeshError, TriangleMesh};

/// A square grid of `n` x `n` cells, each cut along a diagonal.
fn grid(n: u32) -> HalfEdgeMesh {
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let triangles: Vec<[u32; 3]> = cells
        .flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        })
        .collect();
    HalfEdgeMesh::new(((n + 1) * (n + 1)) as usize, &triangles).unwrap()
}

fn reference_mesh(name: &str) -> (HalfEdgeMesh, Vec<DVec3>) {
    let reference: TriangleReference = load(name);
    (HalfEdgeMesh::new(reference.vertices.len(), &reference.faces).unwrap(), reference.vertices)
}

/// Vertices in use less edges plus triangles.
fn euler_characteristic(mesh: &HalfEdgeMesh) -> i64 {
    let vertices = (0..mesh.vertex_count() as u32).filter(|&v| mesh.outgoing_half_edges(v).next().is_some());
    let [vertices, edges, triangles] = [vertices.count(), mesh.edges().count(), mesh.triangles().count()]
        .map(|count| i64::try_from(count).expect("few"));
    vertices - edges + triangles
}

/// Asserts that the mesh is what a search through its triangles would build.
fn assert_consistent(mesh: &HalfEdgeMesh) {
    let triangles: Vec<[u32; 3]> = mesh.triangles().map(|(_, corners)| corners).collect();
    let searched = HalfEdgeMesh::new(mesh.vertex_count(), &triangles).expect("edits keep the mesh manifold");
    assert_eq!(mesh.edges().count(), searched.edges().count());
    for h in (0..mesh.half_edge_count() as u32).map(HalfEdgeId).filter(|&h| mesh.exists(h)) {
        if let Some(twin) = mesh.twin(h) {
            assert_eq!(mesh.twin(twin), Some(h));
            assert_eq!([mesh.start(h), mesh.end(h)], [mesh.end(twin), mesh.start(twin)]);
        }
    }
    for v in 0..mesh.vertex_count() as u32 {
        assert_eq!(mesh.is_boundary_vertex(v), searched.is_boundary_vertex(v), "vertex {v}");
        assert!(mesh.outgoing_half_edges(v).all(|h| mesh.start(h) == v));
        let [mut ours, mut theirs]: [Vec<u32>; 2] =
            [mesh, &searched].map(|mesh| mesh.neighbours(v).collect());
        if mesh.is_boundary_vertex(v) {
            assert_eq!(ours, theirs, "vertex {v}");
        }
        ours.sort_unstable();
        theirs.sort_unstable();
        assert_eq!(ours, theirs, "vertex {v}");
    }
}

proptest! {
    #[test]
    fn edits_keep_a_manifold_and_its_topology(
        open in any::<bool>(),
        edits in prop::collection::vec((0..3_u8, any::<prop::sample::Index>()), 1..60),
    ) {
        let mut mesh = if open { grid(3) } else { reference_mesh("loop_cube_presplit").0 };
        let characteristic = euler_characteristic(&mesh);
        for (edit, choice) in edits {
            let h = HalfEdgeId(choice.index(mesh.half_edge_count()) as u32);
            let before = mesh.clone();
            let done = match edit {
                0 => mesh.flip(h),
                1 => mesh.split(h).map(|_| ()),
                _ => mesh.collapse(h),
            };
            if done.is_err() {
                prop_assert_eq!(&mesh, &before);
            }
            assert_consistent(&mesh);
            prop_assert_eq!(euler_characteristic(&mesh), characteristic);
        }
    }

    #[test]
    fn flipping_twice_gives_the_same_triangles(choice in any::<prop::sample::Index>()) {
        let mut mesh = grid(4);
        let h = HalfEdgeId(choice.index(mesh.half_edge_count()) as u32);
        let before = as_set(mesh.triangles().map(|t| t.1));
        if mesh.flip(h).is_ok() {
            prop_assert_ne!(&as_set(mesh.triangles().map(|t| t.1)), &before);
            mesh.flip(h).unwrap();
        }
        prop_assert_eq!(as_set(mesh.triangles().map(|t| t.1)), before);
    }

    #[test]
    fn collapsing_a_split_undoes_it(choice in any::<prop::sample::Index>()) {
        let mut mesh = grid(4);
        let h = HalfEdgeId(choice.index(mesh.half_edge_count()) as u32);
        let before = as_set(mesh.triangles().map(|t| t.1));
        let end = mesh.end(h);
        let middle = mesh.split(h).unwrap();
        let back = mesh.outgoing_half_edges(middle).find(|&h| mesh.end(h) == end).unwrap();
        mesh.collapse(back).unwrap();
        prop_assert_eq!(as_set(mesh.triangles().map(|t| t.1)), before);
    }
}

#[test]
fn split_and_flip_is_loop_subdivision() {
    for name in ["loop_tetrahedron", "loop_torus", "loop_cube_presplit", "loop_open_edge"] {
        let reference: TriangleReference = load(name);
        let mut arithmetic = reference.mesh();
        let mut expected = reference.vertices.clone();
        for level in 0..2 {
            let triangles: Vec<[u32; 3]> = arithmetic.triangles().to_vec();
            let mut edited = HalfEdgeMesh::new(expected.len(), &triangles).unwrap();
            let mut points = expected.clone();
            edited.loop_by_split_and_flip(&mut points).unwrap();
            // The same edges in the same order only where nothing has renumbered them.
            let renumbered = TriangleMesh::new(expected.len(), triangles, &Features::default()).unwrap();
            let refined = renumbered.loop_refine().unwrap();
            let ours = refined.stencils.apply(&expected);
            assert_eq!(
                as_set(edited.triangles().map(|t| t.1)),
                as_set(refined.mesh.triangles().iter().copied())
            );
            for (v, (&point, &expected)) in points.iter().zip(&ours).enumerate() {
                assert_close(point, expected, 1e-14, &format!("{name} level {level} vertex {v}"));
            }
            let refined = arithmetic.loop_refine().unwrap();
            expected = refined.stencils.apply(&expected);
            arithmetic = refined.mesh;
        }
    }
}

#[test]
fn splitting_the_diagonals_keeps_a_cube_symmetric() {
    let reference: TriangleReference = load("loop_cube_asym");
    let mut points = reference.vertices.clone();
    let mut cube = HalfEdgeMesh::new(8, &reference.faces).unwrap();
    let is_diagonal = |h: &HalfEdgeId| {
        let [a, b] = [points[cube.start(*h) as usize], points[cube.end(*h) as usize]];
        (a - b).length() > 2.1
    };
    let diagonals: Vec<[u32; 2]> =
        cube.edges().filter(is_diagonal).map(|h| [cube.start(h), cube.end(h)]).collect();
    assert_eq!(diagonals.len(), 6);
    cube.split_edges(&diagonals, &mut points).unwrap();

    let triangles: Vec<[u32; 3]> = cube.triangles().map(|t| t.1).collect();
    let mut mesh = TriangleMesh::new(points.len(), triangles, &Features::default()).unwrap();
    for _ in 0..3 {
        let refined = mesh.loop_refine().unwrap();
        points = refined.stencils.apply(&points);
        mesh = refined.mesh;
    }
    // The set of points is its own image under a quarter turn, a mirror and a turn about a diagonal.
    for symmetry in [
        |p: DVec3| DVec3::new(-p.y, p.x, p.z),
        |p: DVec3| DVec3::new(p.x, p.y, -p.z),
        |p: DVec3| DVec3::new(p.y, p.z, p.x),
    ] {
        for &point in &points {
            let image = symmetry(point);
            assert!(points.iter().any(|&other| (other - image).abs().max_element() < 1e-13), "{point}");
        }
    }
}

#[test]
fn circulation_and_normals() {
    let mesh = grid(2);
    // The middle of the grid has six neighbours; they go round counter-clockwise.
    let ring: Vec<u32> = mesh.neighbours(4).collect();
    let from_seven = ring.iter().position(|&v| v == 7).unwrap();
    let turned: Vec<u32> = (0..6).map(|i| ring[(from_seven + i) % 6]).collect();
    assert_eq!(turned, [7, 8, 5, 1, 0, 3]);
    assert_eq!(mesh.neighbours(0).collect::<Vec<_>>(), [3, 4, 1]);
    let h = mesh.half_edge_between(4, 8).unwrap();
    let around = mesh.face_half_edges(h).map(|h| mesh.start(h));
    assert!(around == [4, 8, 5] || around == [8, 4, 7]);

    let (octahedron, points) = {
        let points = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        let triangles: Vec<[u32; 3]> =
            (0..4).flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]]).collect();
        (HalfEdgeMesh::new(7, &triangles).unwrap(), points)
    };
    let normals = octahedron.vertex_normals(&points);
    for (normal, &point) in normals.iter().zip(&points) {
        assert_close(normal.unwrap(), point, 1e-15, "octahedron");
    }
    assert_eq!(normals[6], None);
}

#[test]
fn what_would_break_the_mesh_is_refused() {
    const FIRST: HalfEdgeId = HalfEdgeId(0);
    let (mut tetrahedron, _) = reference_mesh("loop_tetrahedron");
    let ends = [tetrahedron.start(FIRST), tetrahedron.end(FIRST)];
    let refused = |edit, why| Err(MeshError::Edit { edit, ends, why });
    assert_eq!(tetrahedron.flip(FIRST), refused("flipped", "its far corners share an edge already"));
    assert_eq!(tetrahedron.collapse(FIRST), refused("collapsed", "a tetrahedron would fall flat"));
    assert_eq!(tetrahedron.flip(HalfEdgeId(99)), Err(MeshError::NoHalfEdge { half_edge: HalfEdgeId(99) }));
    assert_eq!(tetrahedron.half_edge_between(0, 9), Err(MeshError::NoEdge { ends: [0, 9] }));

    let mut square = grid(1);
    let diagonal = square.half_edge_between(0, 3).unwrap();
    assert!(square.collapse(diagonal).unwrap_err().to_string().contains("across the inside"));
    let side = square.half_edge_between(0, 2).unwrap();
    assert!(square.flip(side).unwrap_err().to_string().contains("boundary"));

    let bow_tie = HalfEdgeMesh::new(5, &[[0, 1, 2], [0, 3, 4]]);
    assert_eq!(bow_tie.unwrap_err(), MeshError::NonManifoldVertex { vertex: 0 });
    let fin = HalfEdgeMesh::new(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    assert_eq!(fin.unwrap_err(), MeshError::NonManifoldEdge { ends: [0, 1], faces: 3 });
    let turned = HalfEdgeMesh::new(4, &[[0, 1, 2], [0, 1, 3]]);
    assert_eq!(turned.unwrap_err(), MeshError::Winding { first: FaceId(0), second: FaceId(1), ends: [0, 1] });
}

#[test]
fn collapse_removes_the_vertex_that_is_named_first() {
    // Every edge of a grid in both directions; on the boundary one of them has no half-edge.
    let whole = grid(3);
    for h in whole.edges() {
        for [from, into] in [[whole.start(h), whole.end(h)], [whole.end(h), whole.start(h)]] {
            let mut mesh = whole.clone();
            let Ok(()) = mesh.collapse_into(from, into) else { continue };
            let triangles: Vec<[u32; 3]> = mesh.triangles().map(|(_, triangle)| triangle).collect();
            assert!(triangles.as_flattened().iter().all(|&v| v != from), "{from} into {into}");
            assert!(triangles.as_flattened().contains(&into));
            let rebuilt = HalfEdgeMesh::new(whole.vertex_count(), &triangles).unwrap();
            for v in 0..16 {
                assert_eq!(mesh.is_boundary_vertex(v), rebuilt.is_boundary_vertex(v));
                let [mut ours, mut theirs] =
                    [&mesh, &rebuilt].map(|mesh| mesh.neighbours(v).collect::<Vec<_>>());
                ours.sort_unstable();
                theirs.sort_unstable();
                assert_eq!(ours, theirs, "{from} into {into}: around {v}");
            }
        }
    }
}
