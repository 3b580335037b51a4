//! Loop subdivision of 20 000 triangles to level 4, from scratch and for new points, and half-edge edits.
#![allow(missing_docs)] // criterion's macros

mod sphere;

use criterion::{Criterion, criterion_group, criterion_main};
use rayon::ThreadPoolBuilder;
use sphere::sphere_hull;
use subzero::{Features, TriangleMesh};

fn from_scratch(c: &mut Criterion) {
    let (triangles, points) = sphere_hull(10_002);
    for threads in [1, 2] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        c.bench_function(&format!("loop to level 4 from scratch, {threads} threads"), |b| {
            b.iter(|| {
                pool.install(|| {
                    let mut mesh = TriangleMesh::new(points.len(), triangles.clone(), &Features::default())
                        .expect("a good mesh");
                    let mut points = points.clone();
                    for _ in 0..4 {
                        let refined = mesh.loop_refine();
                        points = refined.stencils.apply(&points);
                        mesh = refined.mesh;
                    }
                    (mesh, points)
                })
            });
        });
    }
}

fn re_apply(c: &mut Criterion) {
    let (triangles, points) = sphere_hull(10_002);
    let mut mesh = TriangleMesh::new(points.len(), triangles, &Features::default()).expect("a good mesh");
    let mut tables = Vec::new();
    for _ in 0..4 {
        let refined = mesh.loop_refine();
        tables.push(refined.stencils);
        mesh = refined.mesh;
    }
    let mut levels: Vec<_> = tables.iter().map(|table| vec![glam::DVec3::ZERO; table.len()]).collect();
    for threads in [1, 2] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        c.bench_function(&format!("new points to level 4, {threads} threads"), |b| {
            b.iter(|| {
                pool.install(|| {
                    tables[0].apply_into(&points, &mut levels[0]);
                    for k in 1..4 {
                        let (coarse, fine) = levels.split_at_mut(k);
                        tables[k].apply_into(&coarse[k - 1], &mut fine[0]);
                    }
                });
            });
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).measurement_time(std::time::Duration::from_secs(3)).warm_up_time(std::time::Duration::from_secs(1));
    targets = from_scratch, re_apply
}
criterion_main!(benches);
