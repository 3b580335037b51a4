//! Cells that come one after another: time by the clock and peak memory.
//!
//! `README.md` beside this file says how to run it, and what it gave.
#![expect(clippy::print_stdout, reason = "a bench prints what it measured")]

use std::fs;
use std::time::Instant;

use voronoi::{Domain, Tessellation};

mod inputs;
use inputs::random_seeds;

const COUNTS: [u32; 3] = [100_000, 1_000_000, 10_000_000];

fn main() {
    // Without the argument, these are tests: they need not run.
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        return;
    }
    let wanted = |count: &u32| {
        arguments.iter().all(|argument| argument.starts_with('-') || *argument == count.to_string())
    };
    println!("{:>10}{:>10}{:>14}{:>14}{:>10}", "cells", "s", "us a cell", "volume - 1", "peak GB");
    for count in COUNTS.into_iter().filter(wanted) {
        let seeds = random_seeds(count, false);
        let start = Instant::now();
        let cells = Tessellation::stream(&Domain::unit_cube(), &seeds, None).map(|cells| {
            cells
                .iter()
                .map(|cell| (cell.measure.volume, cell.neighbors.len()))
                .fold((0.0, 0), |a, b| (a.0 + b.0, a.1 + b.1))
        });
        let (volume, _) = cells.expect("seeds are good");
        let seconds = start.elapsed().as_secs_f64();
        let per_cell = 1e6 * seconds / f64::from(count);
        println!("{count:>10}{seconds:>10.2}{per_cell:>14.3}{:>14.1e}{:>10}", volume - 1.0, peak_memory());
    }
}

/// The most that the program has held so far, in gigabytes; nothing where the system does not tell.
fn peak_memory() -> String {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let kilobytes = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:")?.strip_suffix("kB")?.trim().parse::<f64>().ok());
    kilobytes.map_or_else(String::new, |kilobytes| format!("{:.2}", 1e-6 * kilobytes))
}
