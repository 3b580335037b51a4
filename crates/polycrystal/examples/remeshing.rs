//! What remeshing makes of random networks: how many triangles, their angles, how far they are from the smooth surface, and the time.
//!
//! ```text
//! cargo run --release -p grainsmooth-polycrystal --example remeshing -- [GRAINS] [EDGES A DIAMETER] [LEVELS] [box|periodic|cut] [default|equilibrium|regularized]
//!     [FIRST SEED] [LAST SEED] [MOST REFINEMENTS] [OBJ FILE]
//! ```
#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a command that prints, for developers")]

#[allow(dead_code, reason = "tests use the rest")]
#[path = "../tests/common/mod.rs"]
mod common;

use std::fs::File;
use std::io::{BufWriter, Write};
use std::time::Instant;

use common::{network_of_regular, random_seeds};
use glam::{BVec3, DVec3};
use polycrystal::{
    BoxCut, ElementSize, FaceMesh, Junctions, Mesh, Network, NetworkRecipe, Relaxation, RemeshTuning,
    regular_cells, relax, relax_cells,
};
use voronoi::{Domain, Tessellation};

/// The smallest angle of each triangle, in degrees, in order.
fn angles(triangles: &[[u32; 3]], points: &[DVec3]) -> Vec<f64> {
    let least = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| points[corner as usize]);
        let angle = |at: DVec3, one: DVec3, other: DVec3| (one - at).angle_between(other - at).to_degrees();
        angle(a, b, c).min(angle(b, c, a)).min(angle(c, a, b))
    };
    let mut angles: Vec<f64> = triangles.iter().map(least).collect();
    angles.sort_by(f64::total_cmp);
    angles
}

fn smooth(domain: &Domain, grains: usize, seed: u64, levels: usize, way: &str) -> (Network, Vec<DVec3>) {
    let cells = Tessellation::new(domain, &random_seeds(domain, grains, seed)).unwrap();
    if way == "regularized" {
        let regular = regular_cells(&cells, 0.15).unwrap();
        let (network, flat) = network_of_regular(&regular.cells, &cells, levels);
        let relaxed = relax(&network, &flat, &Relaxation::KEPT_TOPOLOGY, |_, _| ()).unwrap();
        let points = relaxed.finest_points(&network);
        return (network, points);
    }
    let recipe = NetworkRecipe {
        face_mesh: FaceMesh::Fan,
        junctions: Junctions::Crease,
        levels,
        tension: &|boundary| if boundary.wall.is_none() { 1.0 } else { 0.0 },
    };
    let relaxation = if way == "equilibrium" { Relaxation::Equilibrium } else { Relaxation::USUAL };
    let relaxed = relax_cells(&cells, &recipe, &relaxation, |_| ()).unwrap();
    let points = relaxed.relaxed.finest_points(&relaxed.network);
    (relaxed.network, points)
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument =
        |number: usize, usual: &str| arguments.get(number).cloned().unwrap_or_else(|| usual.to_owned());
    let grains: usize = argument(0, "200").parse().unwrap();
    let per_diameter: f64 = argument(1, "5").parse().unwrap();
    let levels: usize = argument(2, "3").parse().unwrap();
    let (kind, way) = (argument(3, "box"), argument(4, "default"));
    let [first, last]: [u64; 2] = [argument(5, "1"), argument(6, "5")].map(|seed| seed.parse().unwrap());
    let refinements: usize = argument(7, "6").parse().unwrap();
    let domain = Domain::unit_cube().with_periods(BVec3::splat(kind != "box"));
    println!("seed  triangles  below20  below30  least  1%    mean  volumes  refined  edge/size  seconds");
    for seed in first..=last {
        let (mut network, mut points) = smooth(&domain, grains, seed, levels, &way);
        if kind == "cut" {
            let volumes = network.cell_volumes().to_vec();
            BoxCut { network, points, .. } = network.cut_at_box(&points, false).unwrap();
            network = network.with_cell_volumes(volumes);
        }
        let diameter = (6.0 / std::f64::consts::PI / grains as f64).cbrt();
        let size = ElementSize::new(diameter / per_diameter);
        let start = Instant::now();
        let remeshed = match network.remeshed_tuned(
            &points,
            &size,
            BVec3::splat(kind == "cut"),
            &RemeshTuning { refinements, ..RemeshTuning::default() },
        ) {
            Ok(remeshed) => remeshed,
            Err(error) => {
                println!("{seed:4}  {error}");
                continue;
            }
        };
        let taken = start.elapsed().as_secs_f64();
        let Mesh::Triangles(mesh) = &remeshed.network.finest().held().mesh else { unreachable!("in space") };
        let angles = angles(mesh.triangles(), &remeshed.points);
        let below = |angle: f64| angles.partition_point(|other| *other < angle);
        println!(
            "{seed:4}  {:9}  {:7}  {:7}  {:5.1}  {:4.1}  {:4.1}  {:7.1e}  {:7}  {:9.2}  {taken:7.1}",
            angles.len(),
            below(20.0),
            below(30.0),
            angles[0],
            angles[angles.len() / 100],
            angles.iter().sum::<f64>() / angles.len() as f64,
            remeshed.certificate.largest_volume_error,
            remeshed.refinements,
            network.mean_edge_length(&points) / size.length,
        );
        if let Some(path) = arguments.get(8) {
            let mut out = BufWriter::new(File::create(path).unwrap());
            for DVec3 { x, y, z } in &remeshed.points {
                writeln!(out, "v {x} {y} {z}").unwrap();
            }
            for [a, b, c] in mesh.triangles() {
                writeln!(out, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
            }
        }
    }
}
