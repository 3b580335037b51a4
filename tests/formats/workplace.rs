//! A small polycrystal and a directory to write it into.

use std::num::NonZeroU32;
use std::path::PathBuf;
use std::sync::LazyLock;

use glam::{BVec3, DVec3};
use grainsmooth::{Config, FileOptions, Output, Polycrystal, SeedSource, make_polycrystal};
use polycrystal::Relaxation;
use tempfile::TempDir;
use voronoi::Dimension;

/// A flat box of 12 grains with sides that tell the axes apart.
pub const BOX: DVec3 = DVec3::new(2.0, 1.5, 1.0);
pub const GRAINS: usize = 12;

pub static SPACE: LazyLock<Polycrystal> = LazyLock::new(|| make(Dimension::Three, 0.3));
pub static PLANE: LazyLock<Polycrystal> = LazyLock::new(|| make(Dimension::Two, 0.3));

/// The same seeds without walls, flat.
pub static TORUS: LazyLock<Polycrystal> = LazyLock::new(|| {
    make_polycrystal(&Config { periodic: BVec3::TRUE, ..config(Dimension::Three, 0.0) }, &|_, _, _| ())
        .unwrap()
});

pub fn make(dimension: Dimension, time: f64) -> Polycrystal {
    make_polycrystal(&config(dimension, time), &|_, _, _| ()).unwrap()
}

pub fn config(dimension: Dimension, time: f64) -> Config {
    Config {
        seeds: SeedSource::Random { count: GRAINS },
        dimension,
        box_size: BOX,
        relaxation: Some(Relaxation::Time(time)),
        // What is not relaxed is to stay flat.
        regularize: None,
        levels: 2,
        file: FileOptions {
            voxels: Some([20, 15, 10].map(|n| NonZeroU32::new(n).unwrap())),
            ..FileOptions::default()
        },
        ..Config::default()
    }
}

/// Writes the polycrystal and returns the folder, which goes when dropped, and the file.
pub fn write(polycrystal: &Polycrystal, name: &str) -> (TempDir, PathBuf) {
    let directory = TempDir::new().unwrap();
    let path = directory.path().join(name);
    polycrystal.write(&Output::check(&path).unwrap()).unwrap();
    (directory, path)
}

/// The volume within a closed, outward triangle soup.
pub fn volume(triangles: impl IntoIterator<Item = [DVec3; 3]>) -> f64 {
    triangles.into_iter().map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}
