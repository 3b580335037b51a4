//! Cells of random seeds in the cube and the square: their making, with all measures.
//!
//! `README.md` beside this file says how to run it, and what it gave.
#![allow(missing_docs)] // criterion's macros

use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::BVec3;
use rayon::{ThreadPool, ThreadPoolBuilder};
use spade::{DelaunayTriangulation, Point2, Triangulation};
use voronoi::{CellMeasure, Domain, Tessellation};

mod inputs;
use inputs::random_seeds;

/// Squares of radii from 0 to half the mean distance of seeds.
fn random_weights(count: u32) -> Vec<f64> {
    let largest = 0.5 * f64::from(count).powf(-1.0 / 3.0);
    random_seeds(count, true).iter().map(|seed| (seed.x * largest).powi(2)).collect()
}

fn pool(threads: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start")
}

type Cells = (Tessellation, Vec<CellMeasure>);

fn with_measures(tessellation: Tessellation) -> Cells {
    let measures = tessellation.cell_measures();
    (tessellation, measures)
}

fn bench(c: &mut Criterion, name: &str, counts: &[u32], cut: impl Fn(u32) -> Box<dyn Fn() -> Cells + Sync>) {
    let mut group = c.benchmark_group(name);
    for &count in counts {
        let cut = cut(count);
        group.throughput(Throughput::Elements(count.into()));
        for threads in [1, 2] {
            let pool = pool(threads);
            group.bench_function(BenchmarkId::new(count.to_string(), threads), |b| {
                b.iter_with_large_drop(|| pool.install(&cut));
            });
        }
    }
}

fn cube(c: &mut Criterion) {
    bench(c, "cube", &[1000, 10_000, 100_000, 1_000_000], |count| {
        let seeds = random_seeds(count, false);
        Box::new(move || {
            with_measures(Tessellation::new(&Domain::unit_cube(), &seeds).expect("seeds are good"))
        })
    });
}

fn periodic_cube(c: &mut Criterion) {
    bench(c, "periodic cube", &[100_000], |count| {
        let (seeds, domain) = (random_seeds(count, false), Domain::unit_cube().with_periods(BVec3::TRUE));
        Box::new(move || with_measures(Tessellation::new(&domain, &seeds).expect("seeds are good")))
    });
}

fn power_cells(c: &mut Criterion) {
    bench(c, "power cells", &[100_000], |count| {
        let (seeds, weights) = (random_seeds(count, false), random_weights(count));
        Box::new(move || {
            let tessellation = Tessellation::power(&Domain::unit_cube(), &seeds, &weights);
            with_measures(tessellation.expect("seeds are good"))
        })
    });
}

fn square(c: &mut Criterion) {
    bench(c, "square", &[1_000_000], |count| {
        let seeds = random_seeds(count, true);
        Box::new(move || {
            with_measures(Tessellation::new(&Domain::unit_square(), &seeds).expect("seeds are good"))
        })
    });
}

/// What the square is measured against: the Delaunay triangulation alone.
fn spade(c: &mut Criterion) {
    let points: Vec<_> =
        random_seeds(1_000_000, true).iter().map(|seed| Point2::new(seed.x, seed.y)).collect();
    c.bench_function("spade/1000000", |b| {
        b.iter_with_large_drop(|| {
            DelaunayTriangulation::<Point2<f64>>::bulk_load(points.clone()).expect("points are good")
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(Duration::from_millis(500));
    targets = cube, periodic_cube, power_cells, square, spade
}
criterion_main!(benches);
