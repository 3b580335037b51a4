//! What holds for every mesh.
#![allow(clippy::cast_possible_truncation, clippy::unwrap_used)] // Meshes of tests are small and good.

use crate::common::assert_close;
use glam::{DMat3, DVec3};
use proptest::prelude::*;
use rayon::ThreadPoolBuilder;
use subzero::{
    BoundaryRule, Crease, CurveMesh, DooSabinWeights, EdgeId, FaceId, Features, HalfEdgeId, HalfEdgeMesh,
    LoopHierarchy, LoopWeights, PolygonMesh, Refinement, StencilTable, TriangleMesh, VertexRule,
};

const WEIGHTS: [LoopWeights; 3] = [LoopWeights::Loop, LoopWeights::Warren, LoopWeights::BiermannLevinZorin];

/// A mesh to try: triangles, points, and features.
#[derive(Clone, Debug)]
struct Example {
    triangles: Vec<[u32; 3]>,
    points: Vec<DVec3>,
    creases: Vec<Crease>,
    corners: Vec<u32>,
    boundary: BoundaryRule,
}

impl Example {
    fn mesh(&self) -> TriangleMesh {
        let features = Features {
            creases: &self.creases,
            corners: &self.corners,
            boundary: self.boundary,
            ..Features::default()
        };
        TriangleMesh::new(self.points.len(), self.triangles.clone(), &features).unwrap()
    }

    fn polygon_mesh(&self) -> PolygonMesh {
        let faces: Vec<Vec<u32>> = self.triangles.iter().map(|triangle| triangle.to_vec()).collect();
        let features = Features { creases: &self.creases, corners: &self.corners, ..Features::default() };
        PolygonMesh::new(self.points.len(), &faces, &features).unwrap()
    }
}

/// An octahedron, or a square of two by two cells, changed by random splits and flips; random points on it, creases with
/// a sharpness from `sharpness`, and corners.
fn examples(sharpness: impl Strategy<Value = f32>) -> impl Strategy<Value = Example> {
    let edits = prop::collection::vec((any::<bool>(), any::<prop::sample::Index>()), 0..25);
    let noise = prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 64);
    let creases = prop::collection::vec((any::<prop::sample::Index>(), sharpness), 0..6);
    let corners = prop::collection::vec(any::<prop::sample::Index>(), 0..2);
    (any::<bool>(), edits, noise, creases, corners, any::<bool>()).prop_map(
        |(open, edits, noise, creases, corners, fix_corners)| {
            let triangles: Vec<[u32; 3]> = if open {
                (0..2)
                    .flat_map(|i| (0..2).map(move |j| 3 * i + j))
                    .flat_map(|v| [[v, v + 3, v + 4], [v, v + 4, v + 1]])
                    .collect()
            } else {
                (0..4).flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]]).collect()
            };
            let mut mesh = HalfEdgeMesh::new(if open { 9 } else { 6 }, &triangles).unwrap();
            for (split, choice) in edits {
                let h = HalfEdgeId(choice.index(mesh.half_edge_count()) as u32);
                // A flip may be refused; the mesh is as good without it.
                let _ = if split { mesh.split(h).map(|_| ()) } else { mesh.flip(h) };
            }
            let edges: Vec<[u32; 2]> = mesh.edges().map(|h| [mesh.start(h), mesh.end(h)]).collect();
            let vertex_count = mesh.vertex_count();
            Example {
                triangles: mesh.triangles().map(|t| t.1).collect(),
                points: noise[..vertex_count].iter().map(|&p| DVec3::from_array(p)).collect(),
                creases: creases
                    .into_iter()
                    .map(|(choice, sharpness)| Crease { ends: edges[choice.index(edges.len())], sharpness })
                    .collect(),
                corners: corners.into_iter().map(|choice| choice.index(vertex_count) as u32).collect(),
                boundary: if fix_corners { BoundaryRule::EdgeCorner } else { BoundaryRule::Edge },
            }
        },
    )
}

/// One step of every scheme for triangles.
fn refinements(mesh: &TriangleMesh) -> Vec<Refinement<TriangleMesh>> {
    let mut all = WEIGHTS.map(|weights| mesh.loop_refine_with(weights).unwrap()).to_vec();
    all.extend([
        mesh.butterfly_refine().unwrap(),
        mesh.modified_butterfly_refine().unwrap(),
        mesh.midpoint_refine().unwrap(),
    ]);
    all
}

fn assert_rows_sum_to(table: &StencilTable, sum: f64) {
    for i in 0..table.len() {
        let (ids, weights) = table.stencil(i);
        assert_eq!(ids.len(), weights.len());
        assert!((weights.iter().sum::<f64>() - sum).abs() < 1e-13, "stencil {i}: {weights:?}");
    }
}

fn euler_characteristic(mesh: &TriangleMesh) -> i64 {
    let [vertices, edges, triangles] = [mesh.vertex_count(), mesh.edge_count(), mesh.triangles().len()]
        .map(|count| i64::try_from(count).expect("few"));
    vertices - edges + triangles
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn weights_sum_to_one(example in examples(0.0..11.0_f32)) {
        let mesh = example.mesh();
        for refined in refinements(&mesh) {
            assert_rows_sum_to(&refined.stencils, 1.0);
            prop_assert_eq!(refined.stencils.len(), refined.mesh.vertex_count());
            prop_assert_eq!(euler_characteristic(&refined.mesh), euler_characteristic(&mesh));
        }
        let polygons = example.polygon_mesh();
        assert_rows_sum_to(&polygons.catmull_clark_refine().unwrap().stencils, 1.0);
        for weights in [DooSabinWeights::DooSabin, DooSabinWeights::Means] {
            assert_rows_sum_to(&polygons.doo_sabin_refine(weights).unwrap().stencils, 1.0);
        }
    }

    #[test]
    fn points_of_polygons_without_tables_are_those_of_the_tables(example in examples(0.0..3.0_f32)) {
        let (mut mesh, mut points) = (example.polygon_mesh(), example.points.clone());
        for _ in 0..3 {
            let refined = mesh.catmull_clark_refine().unwrap();
            let expected = refined.stencils.apply(&points);
            let quads: Vec<[u32; 4]> = mesh.catmull_clark_quads().unwrap();
            prop_assert!(refined.mesh.faces().eq(quads.iter().map(|quad| &quad[..])));
            points = mesh.catmull_clark_step(&points);
            for (point, expected) in points.iter().zip(&expected) {
                prop_assert!(point.distance(*expected) < 1e-13, "{point} instead of {expected}");
            }
            mesh = refined.mesh;
        }
        let (mut mesh, mut points) = (example.polygon_mesh(), example.points.clone());
        for weights in [DooSabinWeights::DooSabin, DooSabinWeights::Means, DooSabinWeights::DooSabin] {
            let refined = mesh.doo_sabin_refine(weights).unwrap();
            prop_assert_eq!(refined.stencils.apply(&points), mesh.doo_sabin_step(&points, weights));
            points = mesh.doo_sabin_step(&points, weights);
            mesh = refined.mesh;
        }
    }

    #[test]
    fn affine_maps_commute_with_subdivision(
        example in examples(0.0..11.0_f32),
        entries in prop::array::uniform9(-2.0..2.0_f64),
        shift in prop::array::uniform3(-5.0..5.0_f64),
    ) {
        let map = |p: DVec3| DMat3::from_cols_array(&entries) * p + DVec3::from_array(shift);
        let mapped: Vec<DVec3> = example.points.iter().map(|&p| map(p)).collect();
        for refined in refinements(&example.mesh()) {
            let after = refined.stencils.apply(&example.points);
            for (ours, before) in refined.stencils.apply(&mapped).into_iter().zip(after) {
                assert_close(ours, map(before), 1e-12, "mapped point");
            }
        }
    }

    #[test]
    fn turning_triangles_and_renaming_vertices_changes_nothing(example in examples(0.0..11.0_f32), turn in 0..3_usize) {
        let count = example.points.len() as u32;
        let rename = |v: u32| (v * 2) % count + u32::from(count.is_multiple_of(2) && v >= count / 2);
        let mut renamed = example.clone();
        for triangle in &mut renamed.triangles {
            triangle.rotate_left(turn);
            *triangle = triangle.map(rename);
        }
        renamed.triangles.rotate_left(1);
        renamed.creases.iter_mut().for_each(|crease| crease.ends = crease.ends.map(rename));
        renamed.corners.iter_mut().for_each(|corner| *corner = rename(*corner));
        for v in 0..count {
            renamed.points[rename(v) as usize] = example.points[v as usize];
        }
        let [ours, theirs] = [&example, &renamed].map(|example| {
            let mesh = example.mesh();
            refinements(&mesh).into_iter().map(|refined| refined.stencils.apply(&example.points)).collect::<Vec<_>>()
        });
        for (ours, theirs) in ours.iter().zip(&theirs) {
            for v in 0..count {
                assert_close(theirs[rename(v) as usize], ours[v as usize], 1e-14, "old vertex");
            }
            // New vertices are others' under other names: the same points all the same.
            for &point in ours {
                prop_assert!(theirs.iter().any(|&other| (other - point).abs().max_element() < 1e-13));
            }
        }
    }

    #[test]
    fn composed_tables_do_what_their_parts_do(example in examples(0.0..11.0_f32)) {
        let first = example.mesh().loop_refine().unwrap();
        let second = first.mesh.loop_refine().unwrap();
        let third = second.mesh.loop_refine().unwrap();
        let composed = first.stencils.then(&second.stencils).then(&third.stencils);
        assert_rows_sum_to(&composed, 1.0);
        let sequential =
            third.stencils.apply(&second.stencils.apply(&first.stencils.apply(&example.points)));
        let mut in_place = vec![DVec3::ZERO; composed.len()];
        composed.apply_into(&example.points, &mut in_place);
        prop_assert_eq!(&composed.apply(&example.points), &in_place);
        for (ours, theirs) in in_place.into_iter().zip(sequential) {
            assert_close(ours, theirs, 1e-13, "composed");
        }
    }

    #[test]
    fn points_straight_from_connectivity_are_those_of_the_tables(example in examples(0.0..11.0_f32)) {
        for weights in WEIGHTS {
            let mut mesh = example.mesh();
            let hierarchy = LoopHierarchy::new(mesh.clone(), 4, weights).unwrap();
            let mut levels = hierarchy.buffers();
            hierarchy.apply_into(&example.points, &mut levels);
            let (triangles, points) = mesh.clone().loop_subdivide(&example.points, 4, weights).unwrap();
            prop_assert_eq!(&points, &levels[3]);
            prop_assert_eq!(&points, &hierarchy.apply(&example.points));
            let mut expected = example.points.clone();
            for level in levels {
                let refined = mesh.loop_refine_with(weights).unwrap();
                expected = refined.stencils.apply(&expected);
                mesh = refined.mesh;
                for (ours, &theirs) in level.into_iter().zip(&expected) {
                    assert_close(ours, theirs, 1e-13, "point");
                }
            }
            prop_assert!(*hierarchy.finest() == mesh);
            prop_assert_eq!(triangles.as_slice(), mesh.triangles());
        }
    }

    #[test]
    fn what_depends_on_a_point_is_written_again(
        example in examples(0.0..11.0_f32),
        moved in any::<prop::sample::Index>(),
        by in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        for weights in WEIGHTS {
            let hierarchy = LoopHierarchy::new(example.mesh(), 2, weights).unwrap();
            let mut points = example.points.clone();
            let mut levels = hierarchy.buffers_beyond();
            hierarchy.apply_into(&points, &mut levels);
            let before = levels[2].clone();
            prop_assert_eq!(&before, &LoopHierarchy::new(example.mesh(), 3, weights).unwrap().apply(&points));
            let vertex = moved.index(points.len());
            points[vertex] += DVec3::from_array(by);
            let written = hierarchy.apply_around(vertex as u32, &points, &mut levels);
            let mut expected = hierarchy.buffers_beyond();
            hierarchy.apply_into(&points, &mut expected);
            for (ours, theirs) in levels.iter().flatten().zip(expected.iter().flatten()) {
                assert_close(*ours, *theirs, 1e-13, "point");
            }
            prop_assert!(written.is_sorted());
            for (v, (before, after)) in before.iter().zip(&expected[2]).enumerate() {
                prop_assert!(before == after || written.binary_search(&(v as u32)).is_ok(), "{}", v);
            }
        }
    }

    #[test]
    fn limits_stay_put(example in examples(prop_oneof![Just(10.0_f32), Just(f32::INFINITY)])) {
        for weights in WEIGHTS {
            let mut mesh = example.mesh();
            let mut points = example.points.clone();
            let limits = mesh.loop_limits(weights).unwrap();
            assert_rows_sum_to(&limits.positions, 1.0);
            assert_rows_sum_to(&limits.tangents, 0.0);
            let (positions, normals) = (limits.project(&points), limits.sector_normals(&points));
            for _ in 0..3 {
                let refined = mesh.loop_refine_with(weights).unwrap();
                points = refined.stencils.apply(&points);
                mesh = refined.mesh;
                let finer = mesh.loop_limits(weights).unwrap();
                for (v, point) in finer.project(&points).into_iter().take(positions.len()).enumerate() {
                    assert_close(point, positions[v], 1e-12, "limit position");
                }
                let finer_normals = finer.sector_normals(&points);
                for (i, sector) in limits.sectors.iter().enumerate() {
                    // The same sector: as many edges, and the first towards the same neighbour's new vertex.
                    let same = limits.sectors.iter().filter(|other| other.vertex == sector.vertex);
                    let rank = same.clone().position(|other| other == sector).unwrap();
                    let found = finer.sectors.iter().enumerate().filter(|(_, other)| other.vertex == sector.vertex);
                    let candidates: Vec<usize> = found.map(|(j, _)| j).collect();
                    prop_assert_eq!(candidates.len(), same.count());
                    if let (Some(normal), Some(finer)) = (normals[i], finer_normals[candidates[rank]]) {
                        // Points at random make tangents that nearly coincide; those have no sharp normal.
                        if tangents_are_apart(&limits.tangents, i, &example.points) {
                            assert_close(finer, normal, 1e-9, "limit normal");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn interpolating_schemes_keep_old_points(example in examples(0.0..11.0_f32)) {
        let mesh = example.mesh();
        for refined in [mesh.butterfly_refine().unwrap(), mesh.modified_butterfly_refine().unwrap(), mesh.midpoint_refine().unwrap()] {
            let points = refined.stencils.apply(&example.points);
            prop_assert_eq!(&points[..example.points.len()], &example.points[..]);
        }
    }

    #[test]
    fn curves_are_smooth_and_stay_put(
        points in prop::collection::vec(-1.0..1.0_f64, 3..12),
        closed in any::<bool>(),
        corner in any::<prop::sample::Index>(),
    ) {
        let count = points.len() as u32;
        let segments: Vec<[u32; 2]> =
            (0..count - u32::from(!closed)).map(|i| [i, (i + 1) % count]).collect();
        let curve = CurveMesh::new(points.len(), segments, &[corner.index(points.len()) as u32]).unwrap();
        let refined = curve.refine().unwrap();
        assert_rows_sum_to(&refined.stencils, 1.0);
        assert_rows_sum_to(&curve.limit_tangents(), 0.0);
        let finer = refined.stencils.apply(&points);
        let limits = refined.mesh.limit_positions().apply(&finer);
        for (ours, theirs) in limits.into_iter().zip(curve.limit_positions().apply(&points)) {
            prop_assert!((ours - theirs).abs() < 1e-14);
        }
        // Half the step, half the derivative with respect to it; the first half starts where the whole did.
        let fine_tangents = refined.mesh.limit_tangents().apply(&finer);
        for (s, tangent) in curve.limit_tangents().apply(&points).chunks_exact(2).enumerate() {
            prop_assert!((2.0 * fine_tangents[4 * s] - tangent[0]).abs() < 1e-14);
            prop_assert!((2.0 * fine_tangents[4 * s + 3] - tangent[1]).abs() < 1e-14);
        }
    }
}

/// Whether the tangents of sector `i` are far from parallel.
fn tangents_are_apart(tangents: &StencilTable, i: usize, points: &[DVec3]) -> bool {
    let [t1, t2] = [2 * i, 2 * i + 1].map(|row| {
        let (ids, weights) = tangents.stencil(row);
        ids.iter().zip(weights).fold(DVec3::ZERO, |sum, (&id, &weight)| sum + points[id as usize] * weight)
    });
    t1.cross(t2).length() > 1e-2
}

#[test]
fn threads_do_not_change_a_bit() {
    let reference: crate::common::TriangleReference = crate::common::load("loop_nonmanifold_2grains");
    let run = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut mesh = reference.mesh();
            let mut points = reference.vertices.clone();
            let mut tables = Vec::new();
            for _ in 0..4 {
                let refined = mesh.loop_refine().unwrap();
                points = refined.stencils.apply(&points);
                mesh = refined.mesh;
                tables.push(refined.stencils);
            }
            let (triangles, direct) =
                reference.mesh().loop_subdivide(&reference.vertices, 4, LoopWeights::Loop).unwrap();
            assert_eq!(triangles, mesh.triangles());
            let limits = mesh.loop_limits(LoopWeights::Loop).unwrap();
            let normals = limits.sector_normals(&points);
            points.extend(direct);
            (mesh, tables, points, normals, limits)
        })
    };
    let bits = |points: &[DVec3]| -> Vec<[u64; 3]> {
        points.iter().map(|p| p.to_array().map(f64::to_bits)).collect()
    };
    let [one, two] = [1, 2].map(run);
    assert!(one.0.triangles().len() > 10 * 2048, "there must be several tasks");
    assert_eq!(bits(&one.2), bits(&two.2));
    assert!(one == two);
}

#[test]
fn a_hierarchy_knows_generations_and_ancestors() {
    let reference: crate::common::TriangleReference = crate::common::load("loop_crease_inf");
    let hierarchy = LoopHierarchy::new(reference.mesh(), 3, LoopWeights::Loop).unwrap();
    let counts: Vec<usize> = hierarchy.meshes().iter().map(TriangleMesh::vertex_count).collect();
    for (vertex, level) in [(0, 0), (counts[0] - 1, 0), (counts[0], 1), (counts[1], 2), (counts[3] - 1, 3)] {
        assert_eq!(hierarchy.generation(vertex as u32), level);
    }
    // The centre of an ancestor's descendants is near its own: with midpoints they would lie in it.
    let mut points = reference.vertices.clone();
    for mesh in &hierarchy.meshes()[..3] {
        points = mesh.midpoint_refine().unwrap().stencils.apply(&points);
    }
    for (t, corners) in hierarchy.finest().triangles().iter().enumerate() {
        let [a, b, c] = reference.faces[hierarchy.ancestor(FaceId(t as u32)).index()]
            .map(|v| reference.vertices[v as usize]);
        let centre = corners.iter().map(|&v| points[v as usize]).sum::<DVec3>() / 3.0;
        let normal = (b - a).cross(c - a);
        let inside = [[a, b], [b, c], [c, a]].map(|[p, q]| (q - p).cross(centre - p).dot(normal) > 0.0);
        assert_eq!(inside, [true; 3], "triangle {t}");
        assert!((centre - a).dot(normal).abs() < 1e-12, "triangle {t}");
    }
    let composed = hierarchy.stencils();
    assert_rows_sum_to(&composed, 1.0);
    for (ours, theirs) in
        composed.apply(&reference.vertices).into_iter().zip(hierarchy.apply(&reference.vertices))
    {
        assert_close(ours, theirs, 1e-14, "composed");
    }
}

#[test]
fn sheets_meet_without_a_gap() {
    // Of three sheets at a triple line, each refined alone has the same points there, bit by bit.
    let reference: crate::common::TriangleReference = crate::common::load("loop_nonmanifold_triple_line");
    let mesh = reference.mesh();
    let together = mesh.loop_refine().unwrap();
    let counts = mesh.edge_triangle_counts();
    for e in (0..mesh.counts().edges).map(EdgeId) {
        if counts[e.index()] > 2 {
            let stencil = together.stencils.stencil(mesh.counts().edge_vertex(e) as usize);
            assert_eq!(stencil, (&mesh.edge(e)[..], &[0.5, 0.5][..]));
            for end in mesh.edge(e) {
                let (ids, _) = together.stencils.stencil(end as usize);
                assert!(matches!(
                    (ids.len(), mesh.vertex_rule(end)),
                    (3, VertexRule::Crease) | (1, VertexRule::Corner)
                ));
            }
        }
    }
}
