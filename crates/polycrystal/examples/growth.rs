//! What becomes of grains that grow with other numbers than the tuned ones: the tables of docs/relaxation.md, in the plane, or with `--space`.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a command that prints, for developers")]

use std::f64::consts::FRAC_PI_3;
use std::time::Instant;

use glam::{BVec3, DVec3};
use polycrystal::{
    Boundary, FaceMesh, GrowthRecipe, GrowthTuning, Junctions, Measures, Moving, NetworkError, NetworkRecipe,
    RelaxationStep, grow_cells_tuned, measure_network,
};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use voronoi::{Dimension, Domain, Tessellation};

/// How many networks there are.
const NETWORKS: u64 = 5;

/// From when on rates are those of boundaries at rest at junctions.
const SETTLED: f64 = 0.1;

/// What grows, and for how long.
struct Setting {
    domain: Domain,
    grains: usize,
    time: f64,
}

fn main() -> Result<(), NetworkError> {
    let usual = GrowthTuning::default();
    let in_space = std::env::args().any(|word| word == "--space");
    let (setting, rows) = if in_space {
        let rows = vec![
            ("base", usual),
            ("error 3e-4", GrowthTuning { largest_error_in_space: 3e-4, ..usual }),
            ("error 3e-3", GrowthTuning { largest_error_in_space: 3e-3, ..usual }),
            ("vanished 5e-4", GrowthTuning { vanished: 5e-4, ..usual }),
            ("vanished 1e-2", GrowthTuning { vanished: 1e-2, ..usual }),
        ];
        (Setting { domain: Domain::unit_cube(), grains: 100, time: 0.6 }, rows)
    } else {
        let rows = vec![
            ("base", usual),
            ("spacing 0.05", GrowthTuning { spacing: 0.05, ..usual }),
            ("spacing 0.2", GrowthTuning { spacing: 0.2, ..usual }),
            ("error 1e-3", GrowthTuning { largest_error_in_plane: 1e-3, ..usual }),
            ("error 1e-2", GrowthTuning { largest_error_in_plane: 1e-2, ..usual }),
            ("short 0.025", GrowthTuning { short: 0.025, ..usual }),
            ("short 0.1", GrowthTuning { short: 0.1, ..usual }),
            ("vanished 5e-4", GrowthTuning { vanished: 5e-4, ..usual }),
            ("vanished 1e-2", GrowthTuning { vanished: 1e-2, ..usual }),
        ];
        (Setting { domain: Domain::unit_square(), grains: 200, time: 2.0 }, rows)
    };
    let [one, two, three] = setting.times();
    println!("| change | failures | left at {one}, {two}, {three} | rate off: median, 90 % | steps | s |");
    println!("|---|---|---|---|---|---|");
    for (name, tuning) in rows {
        let start = Instant::now();
        let mut sum = Outcome::default();
        for random_seed in 1..=NETWORKS {
            grow(&setting, random_seed, &tuning, &mut sum)?;
        }
        sum.errors.sort_by(f64::total_cmp);
        let [median, most] = [2, 10].map(|part| sum.errors[sum.errors.len() - 1 - sum.errors.len() / part]);
        println!(
            "| {name} | {} | {} {} {} | {:.2} %, {:.1} % | {} | {:.1} |",
            sum.failures,
            sum.left[0],
            sum.left[1],
            sum.left[2],
            100.0 * median,
            100.0 * most,
            sum.steps,
            start.elapsed().as_secs_f64()
        );
    }
    Ok(())
}

impl Setting {
    /// Times at which grains that are left are counted.
    fn times(&self) -> [f64; 3] {
        [0.25, 0.5, 1.0].map(|share| share * self.time)
    }
}

/// Of all networks together.
#[derive(Default)]
struct Outcome {
    failures: usize,
    left: [usize; 3],
    /// How far rates are off the law of von Neumann and Mullins, or of MacPherson and Srolovitz, of grains that keep the number of their boundaries for a step.
    errors: Vec<f64>,
    steps: usize,
}

/// A grain: how many boundaries it has, its area or volume, and how fast that grows by the law.
#[derive(Clone, Copy, Default)]
struct Grain {
    boundaries: usize,
    size: f64,
    law: f64,
}

fn grow(
    setting: &Setting,
    random_seed: u64,
    tuning: &GrowthTuning,
    sum: &mut Outcome,
) -> Result<(), NetworkError> {
    let domain = setting.domain.clone().with_periods(BVec3::TRUE);
    let is_in_space = domain.dimension() == Dimension::Three;
    let mut random = ChaCha8Rng::seed_from_u64(random_seed);
    let mut coordinate = || f64::from(random.next_u32()) / 2f64.powi(32);
    let mut seed = || DVec3::new(coordinate(), coordinate(), if is_in_space { coordinate() } else { 0.0 });
    let seeds: Vec<DVec3> = (0..setting.grains).map(|_| seed()).collect();
    let cells = Tessellation::new(&domain, &seeds).expect("seeds in the domain");
    let tension = |_: &Boundary| 1.0;
    let network = NetworkRecipe {
        face_mesh: FaceMesh::Fan,
        junctions: Junctions::Crease,
        levels: if is_in_space { 0 } else { 1 },
        tension: &tension,
    };
    let recipe = GrowthRecipe { network, mobility: &tension };
    let unit = domain.dimension().cube_edge(1.0 / setting.grains as f64).powi(2);
    let mut last: Option<(f64, Vec<Grain>)> = None;
    let mut failed = None;
    let mut watch = |step: RelaxationStep<'_>| {
        let Moving::Grains(make) = step.now else { unreachable!("grains grow") };
        let (network, points) = match make() {
            Ok(made) => made,
            Err(error) => return failed = Some(error),
        };
        let mut now = vec![Grain::default(); setting.grains];
        match measure_network(&network, &network.subdivide(&points)) {
            Measures::Plane(measures) => measures.grains.iter().for_each(|grain| {
                let law = FRAC_PI_3 * (grain.side_count as f64 - 6.0);
                now[grain.grain.index()] = Grain { boundaries: grain.side_count, size: grain.area, law };
            }),
            Measures::Space(measures) => measures.grains.iter().for_each(|grain| {
                let law = grain.growth_rate.expect("no walls");
                now[grain.grain.index()] = Grain { boundaries: grain.face_count, size: grain.volume, law };
            }),
        }
        if let Some((before, grains)) = &last
            && *before > SETTLED
        {
            let passed = (step.time - before) * unit;
            for (before, after) in grains.iter().zip(&now) {
                let law = 0.5 * (before.law + after.law);
                if before.boundaries == after.boundaries && law != 0.0 {
                    sum.errors.push(((after.size - before.size) / passed / law - 1.0).abs());
                }
            }
        }
        last = Some((step.time, now));
    };
    match grow_cells_tuned(&cells, &recipe, setting.time, tuning, &mut watch) {
        Ok(grown) => {
            sum.steps += grown.cells.relaxed.steps;
            for (left, time) in sum.left.iter_mut().zip(setting.times()) {
                *left += setting.grains - grown.vanished.iter().filter(|grain| grain.time <= time).count();
            }
        }
        Err(_) => sum.failures += 1,
    }
    failed.map_or(Ok(()), Err)
}
