//! Cells of random seeds in the cube and the square: their making, with all measures.
//!
//! `README.md` beside this file says how to run it, and what it gave.
#![allow(missing_docs)] // criterion's macros

use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{BVec3, DVec3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rayon::{ThreadPool, ThreadPoolBuilder};
use spade::{DelaunayTriangulation, Point2, Triangulation};
use voronoi::{CellMeasure, Domain, Tessellation};

/// Seeds in the unit cube, or flat ones in the unit square.
fn random_seeds(count: u32, is_flat: bool) -> Vec<DVec3> {
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    let mut coordinate = || (generator.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    let mut seed = || DVec3::new(coordinate(), coordinate(), if is_flat { 0.0 } else { coordinate() });
    (0..count).map(|_| seed()).collect()
}

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

/// A name, numbers of seeds, and what to make of such a number.
type Kind<'a> = (&'a str, &'a [u32], fn(u32) -> Input);

/// Seeds and weights of several kinds, and as many uniform seeds: what is spread unevenly must not cost many times as much.
fn uneven(c: &mut Criterion) {
    let [shell, walls] = [5000, 10_000];
    let counts = [10_000, 100_000, 400_000];
    let kinds: [Kind; 6] = [
        ("one heavy weight", &counts, heavy_weight),
        ("cluster of 1e-6 and two far seeds", &counts, cluster),
        ("gradient x^6", &counts, gradient),
        ("octant of a shell", &[shell], octant),
        ("6252 walls", &[walls], many_walls),
        ("uniform", &[shell, 10_000, 100_000, 400_000], uniform),
    ];
    let pool = pool(1);
    let mut group = c.benchmark_group("uneven");
    for (name, counts, input) in kinds {
        for &count in counts {
            let Input { domain, seeds, weights } = input(count);
            group.throughput(Throughput::Elements(count.into()));
            group.bench_function(BenchmarkId::new(name, count), |b| {
                let cut = || {
                    let tessellation = match &weights {
                        Some(weights) => Tessellation::power(&domain, &seeds, weights),
                        None => Tessellation::new(&domain, &seeds),
                    };
                    with_measures(tessellation.expect("seeds are good"))
                };
                b.iter_with_large_drop(|| pool.install(cut));
            });
        }
    }
}

struct Input {
    domain: Domain,
    seeds: Vec<DVec3>,
    weights: Option<Vec<f64>>,
}

fn uniform(count: u32) -> Input {
    Input { domain: Domain::unit_cube(), seeds: random_seeds(count, false), weights: None }
}

/// A sphere of radius 0.3 among points.
fn heavy_weight(count: u32) -> Input {
    let Input { domain, mut seeds, .. } = uniform(count);
    seeds[0] = DVec3::splat(0.5);
    let mut weights = vec![0.0; seeds.len()];
    weights[0] = 0.09;
    Input { domain, seeds, weights: Some(weights) }
}

fn cluster(count: u32) -> Input {
    let mut input = uniform(count);
    input.seeds.iter_mut().for_each(|seed| *seed = 0.4 + *seed * 1e-6);
    (input.seeds[0], input.seeds[1]) = (DVec3::splat(0.1), DVec3::splat(0.9));
    input
}

fn gradient(count: u32) -> Input {
    let mut input = uniform(count);
    input.seeds.iter_mut().for_each(|seed| *seed = seed.powf(6.0));
    input
}

/// Seeds as far as one another from a seed in the corner.
fn octant(count: u32) -> Input {
    let mut input = uniform(count);
    input.seeds.iter_mut().for_each(|seed| *seed = 0.9 * seed.normalize());
    input.seeds.push(DVec3::ZERO);
    input
}

fn many_walls(count: u32) -> Input {
    let center = DVec3::splat(0.5);
    let domain = Domain::ball(center, 0.5, 1.6e-4).expect("few enough walls");
    let mut seeds = random_seeds(3 * count, false);
    seeds.retain(|seed| seed.distance(center) < 0.49);
    seeds.truncate(count as usize);
    Input { domain, seeds, weights: None }
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
    targets = cube, periodic_cube, power_cells, uneven, square, spade
}
criterion_main!(benches);
