//! Writing the network of 200 and of 2000 grains at level 3, beside a plain write of the same bytes.
#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may panic and has no users")]

use std::fs;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use grainsmooth::{Config, Output, SeedSource, make_polycrystal};
use polycrystal::Relaxation;

fn writing(criterion: &mut Criterion) {
    let directory = tempfile::tempdir().unwrap();
    let mut group = criterion.benchmark_group("writing");
    group.sample_size(10);
    for grains in [200, 2000] {
        let config = Config {
            seeds: SeedSource::Random { count: grains },
            relaxation: Some(Relaxation::Time(0.01)),
            ..Config::default()
        };
        let polycrystal = make_polycrystal(&config, &|_, _, _| ()).unwrap();
        let path = directory.path().join("grains.vtp");
        let output = Output::check(&path).unwrap();
        polycrystal.write(&output).unwrap();
        let bytes = fs::read(&path).unwrap();
        group.throughput(Throughput::Bytes(bytes.len() as u64));
        // Both make a new file, so that both touch the same number of fresh pages.
        let removed = || drop(fs::remove_file(&path));
        group.bench_function(BenchmarkId::new("grains", grains), |bencher| {
            bencher.iter_batched(
                removed,
                |()| polycrystal.write(&output).unwrap(),
                criterion::BatchSize::PerIteration,
            );
        });
        group.bench_function(BenchmarkId::new("plain", grains), |bencher| {
            bencher.iter_batched(
                removed,
                |()| fs::write(&path, &bytes).unwrap(),
                criterion::BatchSize::PerIteration,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, writing);
criterion_main!(benches);
