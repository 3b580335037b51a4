//! Shows why smoothing needs relaxation: subdivision moves no point of a Voronoi boundary out of its plane.
//!
//!     cargo run --release --example flat_stays_flat
#![allow(clippy::print_stdout, reason = "an example shows its result")]

use glam::DVec3;
use grainsmooth::{Config, Polycrystal, SeedSource, make_polycrystal};
use polycrystal::{BoundaryId, Mesh, Relaxation};

fn main() -> Result<(), grainsmooth::Error> {
    for time in [0.0, 1.2] {
        let seeds = SeedSource::Random { count: 50 };
        let relaxation = Relaxation::Time(time);
        let config = Config { seeds, relaxation: Some(relaxation), ..Config::default() };
        let polycrystal = make_polycrystal(&config, &|_, _, _| ())?;
        let bulge = largest_bulge(&polycrystal);
        println!("--relax {time}: boundaries bulge by up to {bulge:.1e} of the box");
    }
    Ok(())
}

/// Largest distance of a point from the mean plane of its boundary.
fn largest_bulge(polycrystal: &Polycrystal) -> f64 {
    let level = polycrystal.network.finest_level();
    let Mesh::Triangles(mesh) = &level.mesh else { return 0.0 };
    let mut boundaries = vec![Vec::new(); polycrystal.network.boundaries().len()];
    for (triangle, BoundaryId(boundary)) in mesh.triangles().iter().zip(&level.boundary_of) {
        boundaries[*boundary as usize].push(triangle.map(|vertex| polycrystal.points[vertex as usize]));
    }
    boundaries.iter().map(|triangles| bulge(triangles)).fold(0.0, f64::max)
}

fn bulge(triangles: &[[DVec3; 3]]) -> f64 {
    let area: DVec3 = triangles.iter().map(|[a, b, c]| (b - a).cross(c - a)).sum();
    let points = triangles.as_flattened();
    let middle = points.iter().sum::<DVec3>() / points.len() as f64;
    let distance = |point: &DVec3| (point - middle).dot(area.normalize()).abs();
    points.iter().map(distance).fold(0.0, f64::max)
}
