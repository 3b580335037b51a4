//! Meshes of any connectivity with any features: what is accepted refines to what its numbers promise, and stays manifold under
//! edits. What is refused must be refused with an error.
#![no_main]

use libfuzzer_sys::arbitrary::{self, Arbitrary};
use libfuzzer_sys::fuzz_target;
use subzero::{
    BoundaryRule, Crease, DooSabinWeights, EdgeId, FaceId, Features, HalfEdgeId, HalfEdgeMesh, LoopHierarchy, LoopWeights, MeshError, PolygonMesh,
    Refinement, StencilTable, TriangleMesh,
};

/// Faces at most: larger meshes only take longer.
const FACES: usize = 48;

#[derive(Arbitrary, Debug)]
struct Input {
    vertices: u8,
    shape: Shape,
    /// Faces of the shape that are left out, cyclically.
    holes: Vec<bool>,
    creases: Vec<(u8, u8, u8)>,
    corners: Vec<u8>,
    soft_corners: Vec<(u8, u8)>,
    edge_corner: bool,
    weights: Weights,
    edits: Vec<(Edit, u16)>,
}

#[derive(Arbitrary, Debug)]
enum Shape {
    Triangles(Vec<[u8; 3]>),
    Polygons(Vec<Vec<u8>>),
    /// So many columns and rows of squares, closed to a torus or open.
    Grid { columns: u8, rows: u8, closed: bool, quads: bool },
}

#[derive(Arbitrary, Debug)]
enum Weights {
    Loop,
    Warren,
    BiermannLevinZorin,
}

#[derive(Arbitrary, Debug)]
enum Edit {
    Flip,
    Split,
    Collapse,
}

impl Input {
    /// The number of vertices, and the faces; an id may be one too large.
    fn faces(&self) -> (usize, Vec<Vec<u32>>) {
        let count = u32::from(self.vertices % 24);
        let id = |v: u8| u32::from(v) % (count + 1);
        let (count, mut faces) = match &self.shape {
            Shape::Triangles(list) => (count, list.iter().map(|face| face.map(id).to_vec()).collect()),
            Shape::Polygons(list) => {
                (count, list.iter().map(|face| face.iter().map(|&v| id(v)).collect()).collect())
            }
            &Shape::Grid { columns, rows, closed, quads } => grid(columns % 6, rows % 6, closed, quads),
        };
        let mut index = 0;
        faces.retain(|_| {
            index += 1;
            self.holes.is_empty() || !self.holes[(index - 1) % self.holes.len()]
        });
        faces.truncate(FACES);
        (count as usize, faces)
    }
}

fn grid(columns: u8, rows: u8, closed: bool, quads: bool) -> (u32, Vec<Vec<u32>>) {
    let [columns, rows] = [columns, rows].map(u32::from);
    let width = if closed { columns } else { columns + 1 };
    let height = if closed { rows } else { rows + 1 };
    let at = |x: u32, y: u32| (y % height) * width + x % width;
    let mut faces = Vec::new();
    for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
        let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
        if quads {
            faces.push(vec![a, b, c, d]);
        } else {
            faces.extend([vec![a, b, c], vec![a, c, d]]);
        }
    }
    (width * height, faces)
}

fuzz_target!(|input: Input| {
    let (vertices, faces) = input.faces();
    let id = |v: u8| u32::from(v) % 32;
    let creases: Vec<Crease> = (input.creases.iter().take(16))
        .map(|&(a, b, sharpness)| Crease { ends: [id(a), id(b)], sharpness: f32::from(sharpness) / 16.0 - 0.1 })
        .collect();
    let corners: Vec<u32> = input.corners.iter().take(8).map(|&v| id(v)).collect();
    let soft_corners: Vec<(u32, f32)> =
        input.soft_corners.iter().take(8).map(|&(v, sharpness)| (id(v), f32::from(sharpness) / 16.0)).collect();
    let boundary = if input.edge_corner { BoundaryRule::EdgeCorner } else { BoundaryRule::Edge };
    let weights = match input.weights {
        Weights::Loop => LoopWeights::Loop,
        Weights::Warren => LoopWeights::Warren,
        Weights::BiermannLevinZorin => LoopWeights::BiermannLevinZorin,
    };
    let all = Features { creases: &creases, corners: &corners, soft_corners: &soft_corners, boundary };
    // Creases that are no edges are common among random ones, and refused.
    for features in [all, Features { creases: &[], corners: &[], soft_corners: &[], boundary }] {
        if let Ok(mesh) = PolygonMesh::new(vertices, &faces, &features) {
            check_polygons(&mesh);
        }
        let triangles: Option<Vec<[u32; 3]>> = faces.iter().map(|face| face[..].try_into().ok()).collect();
        if let Some(mesh) = triangles.and_then(|list| TriangleMesh::new(vertices, list, &features).ok()) {
            check_triangles(&mesh, weights);
            if let Ok(mesh) = HalfEdgeMesh::from_triangle_mesh(&mesh) {
                check_edits(mesh, &input.edits);
            }
        }
    }
});

/// Refines twice by every scheme, and checks what comes out.
fn check_triangles(mesh: &TriangleMesh, weights: LoopWeights) {
    check_limits(mesh, weights);
    let first = mesh.loop_refine_with(weights).unwrap();
    check_refined(mesh, &first);
    let second = first.mesh.loop_refine_with(weights).unwrap();
    check_refined(&first.mesh, &second);
    check_limits(&second.mesh, weights);
    for refinement in [mesh.butterfly_refine().unwrap(), mesh.modified_butterfly_refine().unwrap(), mesh.midpoint_refine().unwrap()] {
        check_refined(mesh, &refinement);
        assert_eq!(refinement.mesh, first.mesh);
    }

    // Three ways to the same points.
    let points: Vec<f64> = (0..mesh.vertex_count()).map(|v| ((v * v * 7 + 3 * v) % 31) as f64).collect();
    let third = second.mesh.loop_refine_with(weights).unwrap();
    let one_by_one = third.stencils.apply(&second.stencils.apply(&first.stencils.apply(&points)));
    let hierarchy = LoopHierarchy::new(mesh.clone(), 3, weights).unwrap();
    check_same(&one_by_one, &hierarchy.apply(&points));
    check_same(&one_by_one, &hierarchy.stencils().apply(&points));
    let (triangles, subdivided) = mesh.clone().loop_subdivide(&points, 3, weights).unwrap();
    check_same(&one_by_one, &subdivided);
    assert_eq!(triangles, third.mesh.triangles());
}

fn check_refined(coarse: &TriangleMesh, Refinement { mesh, stencils }: &Refinement<TriangleMesh>) {
    let counts = coarse.counts().refined().expect("small meshes can be refined");
    assert_eq!(mesh.counts(), counts);
    let euler = |mesh: &TriangleMesh| {
        let counts = mesh.counts();
        i64::from(counts.vertices) - i64::from(counts.edges) + i64::from(counts.triangles)
    };
    assert_eq!(euler(coarse), euler(mesh));
    check_rows(stencils, coarse.vertex_count(), Some(1.0));
    // Found anew, the edges are as many, and each is where it was said to be.
    let creases: Vec<Crease> = (0..counts.edges)
        .map(EdgeId)
        .filter(|&edge| mesh.edge_triangles(edge).is_none())
        .map(|edge| Crease::infinite(mesh.edge(edge)))
        .collect();
    let features = Features { creases: &creases, ..Features::default() };
    let rebuilt = TriangleMesh::new(mesh.vertex_count(), mesh.triangles().to_vec(), &features)
        .expect("a refined mesh is a good mesh");
    assert_eq!(rebuilt.edge_count(), mesh.edge_count());
    for (t, &[a, b, c]) in (0..).zip(mesh.triangles()) {
        for (edge, mut ends) in mesh.triangle_edges(FaceId(t)).into_iter().zip([[a, b], [b, c], [c, a]]) {
            let mut found = mesh.edge(edge);
            found.sort_unstable();
            ends.sort_unstable();
            assert_eq!(found, ends);
        }
    }
}

fn check_limits(mesh: &TriangleMesh, weights: LoopWeights) {
    match mesh.loop_limits(weights) {
        Ok(limits) => {
            check_rows(&limits.positions, mesh.vertex_count(), Some(1.0));
            check_rows(&limits.tangents, mesh.vertex_count(), None);
        }
        Err(error) => assert!(matches!(error, MeshError::SemiSharp { .. }), "{error}"),
    }
}

fn check_polygons(mesh: &PolygonMesh) {
    let euler = |mesh: &PolygonMesh| {
        mesh.vertex_count() as i64 - mesh.edge_count() as i64 + mesh.face_count() as i64
    };
    let refined = mesh.catmull_clark_refine().unwrap();
    check_rows(&refined.stencils, mesh.vertex_count(), Some(1.0));
    assert_eq!(euler(mesh), euler(&refined.mesh));
    check_faces(&refined.mesh);
    let again = refined.mesh.catmull_clark_refine().unwrap();
    check_rows(&again.stencils, refined.mesh.vertex_count(), Some(1.0));
    check_faces(&again.mesh);
    match mesh.catmull_clark_limits() {
        Ok(limits) => {
            check_rows(&limits.positions, mesh.vertex_count(), Some(1.0));
            check_rows(&limits.tangents, mesh.vertex_count(), Some(0.0));
        }
        Err(error) => assert!(matches!(error, MeshError::SemiSharp { .. }), "{error}"),
    }
    check_rows(&mesh.doo_sabin_limits().positions, mesh.vertex_count(), Some(1.0));
    for weights in [DooSabinWeights::DooSabin, DooSabinWeights::Means] {
        match mesh.doo_sabin_refine(weights) {
            Ok(refined) => {
                check_rows(&refined.stencils, mesh.vertex_count(), Some(1.0));
                check_faces(&refined.mesh);
                if let Ok(again) = refined.mesh.doo_sabin_refine(weights) {
                    check_rows(&again.stencils, refined.mesh.vertex_count(), Some(1.0));
                    check_faces(&again.mesh);
                }
            }
            Err(error) => assert!(matches!(error, MeshError::ValenceTwo { .. }), "{error}"),
        }
    }
}

/// Every edge of every face is the edge that it is said to be.
fn check_faces(mesh: &PolygonMesh) {
    for (f, face) in (0..).zip(mesh.faces()) {
        let after = face.iter().cycle().skip(1);
        for (edge, (&a, &b)) in mesh.face_edges(FaceId(f)).zip(face.iter().zip(after)) {
            let ends = mesh.edge(edge);
            assert!(ends == [a, b] || ends == [b, a], "face {f} runs from {a} to {b} along edge {ends:?}");
        }
    }
}

fn check_edits(mut mesh: HalfEdgeMesh, edits: &[(Edit, u16)]) {
    check_half_edges(&mesh);
    for (edit, pick) in edits.iter().take(64) {
        let count = u32::try_from(mesh.half_edge_count()).expect("small") + 1;
        let half_edge = HalfEdgeId(u32::from(*pick) % count);
        let before = mesh.clone();
        let done = match edit {
            Edit::Flip => mesh.flip(half_edge),
            Edit::Split => mesh.split(half_edge).map(drop),
            Edit::Collapse => mesh.collapse(half_edge),
        };
        if done.is_err() {
            assert_eq!(mesh, before);
            continue;
        }
        check_half_edges(&mesh);
        assert_eq!(euler(&mesh), euler(&before), "{edit:?} of half-edge {half_edge}");
    }
    let triangles: Vec<[u32; 3]> = mesh.triangles().map(|(_, corners)| corners).collect();
    HalfEdgeMesh::new(mesh.vertex_count(), &triangles).expect("edits keep a mesh manifold");
}

/// Euler's characteristic over the vertices that triangles use.
fn euler(mesh: &HalfEdgeMesh) -> i64 {
    let vertices = (0..).take(mesh.vertex_count()).filter(|&v| mesh.outgoing_half_edges(v).next().is_some()).count();
    vertices as i64 - mesh.edges().count() as i64 + mesh.triangles().count() as i64
}

fn check_half_edges(mesh: &HalfEdgeMesh) {
    let mut starting = vec![0; mesh.vertex_count()];
    for h in (0..).take(mesh.half_edge_count()).map(HalfEdgeId).filter(|&h| mesh.exists(h)) {
        starting[mesh.start(h) as usize] += 1;
        if let Some(twin) = mesh.twin(h) {
            assert!(mesh.exists(twin) && mesh.twin(twin) == Some(h));
            assert_eq!([mesh.start(twin), mesh.end(twin)], [mesh.end(h), mesh.start(h)]);
        }
    }
    for (v, &count) in (0..).zip(&starting) {
        let fan = mesh.outgoing_half_edges(v).take(count + 1);
        assert_eq!(fan.inspect(|&h| assert_eq!(mesh.start(h), v)).count(), count);
        let boundary = mesh.outgoing_half_edges(v).any(|h| mesh.twin(h).is_none());
        assert_eq!(boundary, mesh.is_boundary_vertex(v));
        let edges = if boundary { count + 1 } else { count };
        assert_eq!(mesh.neighbours(v).count(), edges);
    }
}

/// Every row averages points that are there, and its weights add up to `sum` if that is given.
fn check_rows(table: &StencilTable, points: usize, sum: Option<f64>) {
    for i in 0..table.len() {
        let (ids, weights) = table.stencil(i);
        assert!(ids.iter().all(|&id| (id as usize) < points));
        let total: f64 = weights.iter().sum();
        assert!(total.is_finite());
        if let Some(sum) = sum.filter(|_| !ids.is_empty()) {
            assert!((total - sum).abs() < 1e-12, "row {i} sums to {total}");
        }
    }
}

fn check_same(expected: &[f64], found: &[f64]) {
    assert_eq!(expected.len(), found.len());
    for (a, b) in expected.iter().zip(found) {
        // The points lie between 0 and 31.
        assert!((a - b).abs() < 1e-12 * 31.0, "{a} differs from {b}");
    }
}
