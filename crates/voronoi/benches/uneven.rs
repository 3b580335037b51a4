//! Cells of seeds that are spread unevenly, beside as many uniform ones: what they cost must not explode.
//!
//! `README.md` beside this file says how to run it, and what it gave.
#![expect(clippy::print_stdout, reason = "a bench prints what it measured")]

use glam::DVec3;
use rayon::ThreadPoolBuilder;
use rustix::time::{ClockId, clock_gettime};
use voronoi::{Domain, Tessellation};

mod inputs;
use inputs::random_seeds;

/// A name, numbers of seeds, and what to make of such a number.
type Kind<'a> = (&'a str, &'a [u32], fn(u32) -> Input);

const COUNTS: [u32; 3] = [10_000, 100_000, 400_000];

const KINDS: [Kind; 6] = [
    ("uniform", &COUNTS, uniform),
    ("one heavy weight", &COUNTS, heavy_weight),
    ("cluster of 1e-6 and two far seeds", &COUNTS, cluster),
    ("gradient x^6", &COUNTS, gradient),
    ("octant of a shell", &[5000], octant),
    ("6252 walls", &[10_000], many_walls),
];

/// How often each number of seeds is measured, of which the median counts.
const ROUNDS: usize = 5;

fn main() {
    // Without the argument, these are tests: they need not run.
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        return;
    }
    let filter = arguments.iter().find(|argument| !argument.starts_with('-'));
    let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("threads start");
    println!("{:36}{:>9}{:>10}{:>12}{:>10}", "", "seeds", "s", "us a seed", "uniform");
    for (name, counts, input) in KINDS {
        for &count in counts {
            if filter.is_none_or(|filter| format!("uneven/{name}/{count}").contains(filter)) {
                let (seconds, ratio) = pool.install(|| measure(&input(count), &uniform(count)));
                let per_seed = 1e6 * seconds / f64::from(count);
                println!("{name:36}{count:>9}{seconds:>10.4}{per_seed:>12.2}{ratio:>10.2}");
            }
        }
    }
}

/// Processor time of cells and their measures, and in units of what others take at the same time: medians.
fn measure(input: &Input, uniform: &Input) -> (f64, f64) {
    let times: Vec<[f64; 2]> = (0..ROUNDS).map(|_| [input, uniform].map(seconds)).collect();
    let median = |value: fn(&[f64; 2]) -> f64| {
        let mut values: Vec<f64> = times.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        values[ROUNDS / 2]
    };
    (median(|[own, _]| *own), median(|[own, uniform]| own / uniform))
}

/// Processor time, as other work on the machine would count by the clock.
fn seconds(Input { domain, seeds, weights }: &Input) -> f64 {
    let start = processor_time();
    let tessellation = match weights {
        Some(weights) => Tessellation::power(domain, seeds, weights),
        None => Tessellation::new(domain, seeds),
    };
    std::hint::black_box(tessellation.expect("seeds are good").cell_measures());
    processor_time() - start
}

/// Of this thread, in seconds.
fn processor_time() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
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
