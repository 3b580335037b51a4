//! Power cells of given volumes: seeds, weights and centroid steps.
//!
//! `README.md` beside this file says how to run it, and what it gave.
#![expect(clippy::print_stdout, reason = "a bench prints what it measured")]

use std::time::Instant;

use glam::BVec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rustix::time::{ClockId, clock_gettime};
use voronoi::Domain;
use voronoi::volumes::{PowerDiagram, place_spheres};

/// Name, number of grains, coefficient of variation of lognormal diameters, centroid steps.
const KINDS: [(&str, u32, f64, usize); 6] = [
    ("cv 0.35", 200, 0.35, 0),
    ("cv 0.35", 200, 0.35, 10),
    ("cv 1", 2000, 1.0, 0),
    ("cv 0.35", 20_000, 0.35, 10),
    ("cv 1", 20_000, 1.0, 0),
    ("cv 0.35", 100_000, 0.35, 10),
];

fn main() {
    // Without the argument, these are tests: they need not run.
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        return;
    }
    let filter = arguments.iter().find(|argument| !argument.starts_with('-'));
    println!(
        "{:10}{:>8}{:>7}{:>10}{:>12}{:>14}{:>10}",
        "", "grains", "steps", "s seeds", "s processor", "s wall clock", "error"
    );
    for (name, count, variation, steps) in KINDS {
        if filter.is_none_or(|filter| format!("volumes/{name}/{count}/{steps}").contains(filter)) {
            measure(name, count, variation, steps);
        }
    }
}

fn measure(name: &str, count: u32, variation: f64, steps: usize) {
    let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    let mut fraction = || (generator.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    let spread = (1.0 + variation * variation).ln().sqrt();
    let cubes: Vec<f64> = (0..count)
        .map(|_| {
            let (radius, angle) =
                ((-2.0 * (1.0 - fraction()).ln()).sqrt(), std::f64::consts::TAU * fraction());
            (3.0 * spread * radius * angle.cos()).exp()
        })
        .collect();
    let sum: f64 = cubes.iter().sum();
    let volumes: Vec<f64> = cubes.iter().map(|cube| cube / sum).collect();
    let (start, clock) = (processor_time(), Instant::now());
    let seeds = place_spheres(&domain, &volumes, fraction).expect("volumes fill the cube");
    let placed = processor_time() - start;
    let diagram =
        PowerDiagram::with_volumes(&domain, &seeds, &volumes).and_then(|diagram| diagram.lloyd(steps));
    let measures = diagram.expect("volumes are reached").tessellation().cell_measures();
    let (processor, wall_clock) = (processor_time() - start, clock.elapsed().as_secs_f64());
    let error = measures
        .iter()
        .zip(&volumes)
        .map(|(cell, volume)| (cell.volume / volume - 1.0).abs())
        .fold(0.0, f64::max);
    println!("{name:10}{count:>8}{steps:>7}{placed:>10.3}{processor:>12.3}{wall_clock:>14.3}{error:>10.0e}");
}

/// Of all threads, in seconds.
fn processor_time() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}
