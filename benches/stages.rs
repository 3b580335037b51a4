//! Every stage of `grainsmooth --seeds 200 -n 3` by itself, and the whole.
#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may panic and has no users")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use grainsmooth::{Config, Output, make_polycrystal, random_seeds};
use polycrystal::{Network, Relaxation, relax, validate};
use voronoi::Tessellation;

fn stages(criterion: &mut Criterion) {
    let config = Config::default();
    let levels = config.levels as usize;
    let domain = config.domain().unwrap();
    let draw = || random_seeds(200, &domain, config.random_seed);
    let seeds = draw();
    let cut = || Tessellation::new(&domain, &seeds).unwrap();
    let tessellation = cut();
    let build = || Network::new(&tessellation, config.junctions, levels).unwrap();
    let (network, flat) = build();
    let relax = || relax(&network, &flat, &Relaxation::KEPT_TOPOLOGY, |_, _| ()).unwrap();
    let relaxed = relax();
    let subdivide = || relaxed.finest_points(&network);
    let points = subdivide();
    let directory = tempfile::tempdir().unwrap();
    let output = Output::check(directory.path().join("grains.vtp")).unwrap();
    let make = || make_polycrystal(&config, &|_, _, _| ()).unwrap();
    let polycrystal = make();
    let write = || polycrystal.write(&output).unwrap();

    let mut group = criterion.benchmark_group("200 grains, 3 levels");
    group.sample_size(20);
    group.bench_function("seeds", |bencher| bencher.iter(|| black_box(draw())));
    group.bench_function("cells", |bencher| bencher.iter(|| black_box(cut())));
    group.bench_function("network", |bencher| bencher.iter(|| black_box(build())));
    group.bench_function("relaxation", |bencher| bencher.iter(|| black_box(relax())));
    group.bench_function("subdivision", |bencher| bencher.iter(|| black_box(subdivide())));
    group.bench_function("validation", |bencher| bencher.iter(|| validate(&network, &points).unwrap()));
    group.bench_function("writing", |bencher| bencher.iter(write));
    group.bench_function("whole", |bencher| bencher.iter(|| make().write(&output).unwrap()));
    group.finish();
}

criterion_group!(benches, stages);
criterion_main!(benches);
