//! Build a network once, then move its control points as often as you like: connectivity is not touched again. And animate a
//! relaxation for ParaView.
//!
//!     cargo run --release --example move_control_points
#![allow(clippy::print_stdout, reason = "an example shows its result")]

use std::error::Error;
use std::num::NonZeroU32;

use glam::DVec3;
use grainsmooth::{Config, SeedSource, Series, SeriesOutput, smooth_watched, tessellate, write_together};
use polycrystal::{Relaxed, measure_network};

fn main() -> Result<(), Box<dyn Error>> {
    let config = Config { seeds: SeedSource::Random { count: 12 }, levels: 2, ..Config::default() };
    let mut series = Series::new(NonZeroU32::MIN);
    let cells = tessellate(&config, &|_, _, _| ())?;
    let mut added = Ok(());
    let mut polycrystal = smooth_watched(&config, cells, &|_, _, _| (), |step| {
        if added.is_ok() {
            added = series.add(&step);
        }
    })?;
    added?;

    let network = &polycrystal.network;
    let Relaxed { level, points: control_points, .. } =
        &polycrystal.synthesis().expect("made from cells").relaxed;
    let (level, finest) = (*level, network.level_count());
    for height in [0.0, 0.5, 1.0] {
        // Everything goes up but what lies on the bottom and the top: grains become flat above and long below.
        let stretched = |point: &DVec3| *point + DVec3::Z * (height * point.z * (1.0 - point.z));
        let moved: Vec<DVec3> = control_points.iter().map(stretched).collect();
        let points = network.subdivide_between(level, finest, &moved);
        let Some(measures) = measure_network(network, &points).in_space() else { continue };
        let area: f64 = measures.boundaries.iter().map(|boundary| boundary.area).sum();
        println!("moved by {height:.2}: boundaries have an area of {area:.3}");
    }

    let folder = std::env::temp_dir().join("grainsmooth_series");
    std::fs::create_dir_all(&folder)?;
    let output = SeriesOutput::check(&folder.join("relaxation.pvd"))?;
    write_together(|files| series.stage(&mut polycrystal, &output, files))?;
    println!("open {} in ParaView", output.path().display());
    Ok(())
}
