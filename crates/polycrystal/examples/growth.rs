//! What becomes of grains that grow in the plane with other numbers than the tuned ones: the table of docs/relaxation.md.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a command that prints, for developers")]

use std::f64::consts::FRAC_PI_3;
use std::time::Instant;

use glam::{BVec3, DVec3};
use polycrystal::{
    Boundary, FaceMesh, GrowthRecipe, GrowthTuning, Junctions, Moving, NetworkError, NetworkRecipe,
    RelaxationStep, grow_cells_tuned, measure_network,
};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use voronoi::{Domain, Tessellation};

/// Grains of each network.
const GRAINS: usize = 200;

/// How many networks there are.
const NETWORKS: u64 = 5;

/// For how long they grow.
const TIME: f64 = 2.0;

/// From when on rates are those of boundaries at rest at triple points.
const SETTLED: f64 = 0.1;

fn main() -> Result<(), NetworkError> {
    let usual = GrowthTuning::default();
    let rows = [
        ("base", usual),
        ("spacing 0.05", GrowthTuning { spacing: 0.05, ..usual }),
        ("spacing 0.2", GrowthTuning { spacing: 0.2, ..usual }),
        ("error 1e-3", GrowthTuning { largest_error: 1e-3, ..usual }),
        ("error 1e-2", GrowthTuning { largest_error: 1e-2, ..usual }),
        ("short 0.025", GrowthTuning { short: 0.025, ..usual }),
        ("short 0.1", GrowthTuning { short: 0.1, ..usual }),
        ("vanished 5e-4", GrowthTuning { vanished: 5e-4, ..usual }),
        ("vanished 1e-2", GrowthTuning { vanished: 1e-2, ..usual }),
    ];
    println!("| change | failures | left at 0.5, 1, 2 | rate off: median, 90 % | steps | s |");
    println!("|---|---|---|---|---|---|");
    for (name, tuning) in rows {
        let start = Instant::now();
        let mut sum = Outcome::default();
        for random_seed in 1..=NETWORKS {
            grow(random_seed, &tuning, &mut sum)?;
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

/// Of all networks together.
#[derive(Default)]
struct Outcome {
    failures: usize,
    left: [usize; 3],
    /// How far rates are off the law of von Neumann and Mullins, of grains that keep their sides for a step.
    errors: Vec<f64>,
    steps: usize,
}

fn grow(random_seed: u64, tuning: &GrowthTuning, sum: &mut Outcome) -> Result<(), NetworkError> {
    let domain = Domain::unit_square().with_periods(BVec3::TRUE);
    let mut random = ChaCha8Rng::seed_from_u64(random_seed);
    let mut coordinate = || f64::from(random.next_u32()) / 2f64.powi(32);
    let seeds: Vec<DVec3> = (0..GRAINS).map(|_| DVec3::new(coordinate(), coordinate(), 0.0)).collect();
    let cells = Tessellation::new(&domain, &seeds).expect("seeds in the square");
    let tension = |_: &Boundary| 1.0;
    let network = NetworkRecipe {
        face_mesh: FaceMesh::Fan,
        junctions: Junctions::Crease,
        levels: 1,
        tension: &tension,
    };
    let recipe = GrowthRecipe { network, mobility: &tension };
    let mut last: Option<(f64, Vec<(usize, f64)>)> = None;
    let mut failed = None;
    let watch = |step: RelaxationStep<'_>| {
        let Moving::Grains(make) = step.now else { unreachable!("grains grow") };
        let (network, points) = match make() {
            Ok(made) => made,
            Err(error) => return failed = Some(error),
        };
        let measures = measure_network(&network, &network.subdivide(&points))
            .in_plane()
            .expect("a network in the plane");
        let mut now = vec![(0, 0.0); GRAINS];
        for grain in &measures.grains {
            now[grain.grain.index()] = (grain.side_count, grain.area);
        }
        if let Some((before, sides_and_areas)) = &last
            && *before > SETTLED
        {
            let passed = (step.time - before) / GRAINS as f64;
            for ((sides, before), (sides_now, area)) in sides_and_areas.iter().zip(&now) {
                if sides == sides_now && *sides > 0 && *sides != 6 {
                    let law = FRAC_PI_3 * (*sides as f64 - 6.0);
                    sum.errors.push(((area - before) / passed / law - 1.0).abs());
                }
            }
        }
        last = Some((step.time, now));
    };
    match grow_cells_tuned(&cells, &recipe, TIME, tuning, watch) {
        Ok(grown) => {
            sum.steps += grown.cells.relaxed.steps;
            for (left, time) in sum.left.iter_mut().zip([0.5, 1.0, 2.0]) {
                *left += GRAINS - grown.vanished.iter().filter(|grain| grain.time <= time).count();
            }
        }
        Err(_) => sum.failures += 1,
    }
    failed.map_or(Ok(()), Err)
}
