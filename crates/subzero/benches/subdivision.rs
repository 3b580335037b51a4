//! Loop subdivision of 20 000 triangles to level 4, from scratch and for new points, Catmull-Clark and Doo-Sabin to level 3, and
//! half-edge edits.
//!
//! `README.md` beside this file says how to run it, and what it gave.
#![allow(missing_docs)] // criterion's macros

mod sphere;

use std::hint::black_box;
use std::time::Duration;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use rayon::{ThreadPool, ThreadPoolBuilder};
use sphere::{Random, sphere_hull, sphere_hull_along_curve};
use subzero::{
    DooSabinWeights, Features, HalfEdgeId, HalfEdgeMesh, LoopHierarchy, LoopWeights, PolygonMesh,
    TriangleMesh,
};

const POINTS: u32 = 10_002;
const LEVELS: usize = 4;
/// Of polygons.
const POLYGON_LEVELS: usize = 3;
/// Edits of each kind in one round, on 320 000 triangles.
const EDITS: usize = 20_000;

fn pool(threads: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start")
}

/// Triangles and points.
type Hull = (Vec<[u32; 3]>, Vec<DVec3>);

/// The base mesh in both orders.
fn hulls() -> [(&'static str, Hull); 2] {
    [("random order", sphere_hull(POINTS)), ("along a curve", sphere_hull_along_curve(POINTS))]
}

fn base_mesh(points: usize, triangles: &[[u32; 3]]) -> TriangleMesh {
    TriangleMesh::new(points, triangles.to_vec(), &Features::default()).expect("the mesh is good")
}

fn from_scratch(c: &mut Criterion) {
    let mut group = c.benchmark_group("Loop to level 4 from scratch");
    for (name, (triangles, points)) in hulls() {
        group.throughput(Throughput::Elements(triangles.len() as u64 * 256));
        for threads in [1, 2] {
            let pool = pool(threads);
            group.bench_function(BenchmarkId::new(name, threads), |b| {
                let run = || {
                    base_mesh(points.len(), &triangles)
                        .loop_subdivide(&points, LEVELS, LoopWeights::Loop)
                        .expect("a small mesh")
                };
                b.iter_with_large_drop(|| pool.install(run));
            });
        }
    }
}

/// Refines triangles and their points, and counts the faces that come out.
type Refine = fn(&[Vec<u32>], &[DVec3]) -> usize;

fn catmull_clark(triangles: &[Vec<u32>], points: &[DVec3]) -> usize {
    let mut mesh = polygon_mesh(points.len(), triangles);
    let mut points = points.to_vec();
    for _ in 1..POLYGON_LEVELS {
        points = mesh.catmull_clark_step(&points);
        mesh = mesh.catmull_clark_connectivity().expect("a small mesh");
    }
    points = mesh.catmull_clark_step(&points);
    black_box((mesh.catmull_clark_quads().expect("a small mesh"), points)).0.len()
}

fn doo_sabin(triangles: &[Vec<u32>], points: &[DVec3]) -> usize {
    let mut mesh = polygon_mesh(points.len(), triangles);
    let mut points = points.to_vec();
    for _ in 0..POLYGON_LEVELS {
        points = mesh.doo_sabin_step(&points, DooSabinWeights::DooSabin);
        mesh = mesh.doo_sabin_connectivity().expect("a small mesh");
    }
    black_box((mesh, points)).0.face_count()
}

fn polygon_mesh(points: usize, faces: &[Vec<u32>]) -> PolygonMesh {
    PolygonMesh::new(points, faces, &Features::default()).expect("the mesh is good")
}

fn polygons(c: &mut Criterion) {
    let mut group = c.benchmark_group("polygons to level 3 from scratch");
    let (triangles, points) = sphere_hull_along_curve(POINTS);
    let triangles: Vec<Vec<u32>> = triangles.iter().map(|triangle| triangle.to_vec()).collect();
    let schemes: [(&str, Refine); 2] = [("Catmull-Clark", catmull_clark), ("Doo-Sabin", doo_sabin)];
    for (name, refined) in schemes {
        group.throughput(Throughput::Elements(refined(&triangles, &points) as u64));
        for threads in [1, 2] {
            let pool = pool(threads);
            group.bench_function(BenchmarkId::new(name, threads), |b| {
                b.iter(|| pool.install(|| refined(&triangles, &points)));
            });
        }
    }
}

fn new_points(c: &mut Criterion) {
    let mut group = c.benchmark_group("new points at level 4");
    for (name, (triangles, points)) in hulls() {
        let hierarchy = LoopHierarchy::new(base_mesh(points.len(), &triangles), LEVELS, LoopWeights::Loop)
            .expect("a small mesh");
        let mut levels = hierarchy.buffers();
        group.throughput(Throughput::Elements(hierarchy.finest().vertex_count() as u64));
        for threads in [1, 2] {
            let pool = pool(threads);
            group.bench_function(BenchmarkId::new(name, threads), |b| {
                b.iter(|| pool.install(|| hierarchy.apply_into(&points, &mut levels)));
            });
        }
    }
}

fn tables(c: &mut Criterion) {
    let mut group = c.benchmark_group("new points at level 4 through tables");
    let (triangles, mut points) = sphere_hull_along_curve(POINTS);
    let mut mesh = base_mesh(points.len(), &triangles);
    for _ in 1..LEVELS {
        let refined = mesh.loop_refine().expect("a small mesh");
        points = refined.stencils.apply(&points);
        mesh = refined.mesh;
    }
    let table = mesh.loop_refine().expect("a small mesh").stencils;
    let mut finest = table.apply(&points);
    group.throughput(Throughput::Elements(table.len() as u64));
    for threads in [1, 2] {
        let pool = pool(threads);
        group.bench_function(BenchmarkId::new("last level", threads), |b| {
            b.iter(|| pool.install(|| table.apply_into(&points, &mut finest)));
        });
    }
}

fn edits(c: &mut Criterion) {
    let (triangles, points) = sphere_hull_along_curve(POINTS);
    let levels =
        LoopHierarchy::new(base_mesh(points.len(), &triangles), 2, LoopWeights::Loop).expect("a small mesh");
    let mesh = HalfEdgeMesh::from_triangle_mesh(levels.finest()).expect("the mesh is manifold");
    // One half-edge in so many, in order, and of each in turn one of its triangle's three.
    let step = mesh.half_edge_count() / EDITS;
    let in_order: Vec<u32> =
        (0..EDITS).map(|i| u32::try_from(i * step + i % 3).expect("ids are u32")).collect();
    let mut shuffled = in_order.clone();
    let mut random = Random(2);
    for i in (1..shuffled.len()).rev() {
        shuffled.swap(i, usize::try_from(random.bits() % (i as u64 + 1)).expect("indices are usize"));
    }
    let mut group = c.benchmark_group("half-edge edits on 320 000 triangles");
    group.throughput(Throughput::Elements(EDITS as u64));
    let mut bench = |name: &str, edit: fn(&mut HalfEdgeMesh, u32)| {
        for (order, picks) in [("in order", &in_order), ("shuffled", &shuffled)] {
            group.bench_function(BenchmarkId::new(name, order), |b| {
                let run = |mut mesh: HalfEdgeMesh| {
                    picks.iter().for_each(|&h| edit(&mut mesh, h));
                    mesh
                };
                b.iter_batched(|| mesh.clone(), run, BatchSize::PerIteration);
            });
        }
    };
    // What an edit before made impossible is refused; that is rare among so many edges.
    bench("flip", |mesh, h| drop(mesh.flip(HalfEdgeId(h))));
    bench("split", |mesh, h| drop(mesh.split(HalfEdgeId(h))));
    bench("collapse", |mesh, h| drop(mesh.collapse(HalfEdgeId(h))));
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(Duration::from_secs(4));
    targets = from_scratch, polygons, new_points, tables, edits
}
criterion_main!(benches);
