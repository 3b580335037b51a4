//! What each mechanism of relaxation in space is worth: the table of docs/relaxation.md.
//!
//! ```text
//! cargo run --release -p grainsmooth-polycrystal --example ablation [-- [--equilibrium] [ROW...]]
//! ```
//!
//! Each row changes one number of the tuning and relaxes the same networks; a ROW given by the beginning of its name is
//! printed alone. Runs are of one thread, and processor time counts. Random numbers and results are the same everywhere.
#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a command that prints, for developers")]

#[allow(dead_code, reason = "tests use the rest")]
#[path = "../tests/common/mod.rs"]
mod common;

use std::time::Duration;

use common::random_seeds;
use glam::{BVec3, DVec3};
use polycrystal::{
    Attempt, FaceMesh, Junctions, Network, NetworkError, NetworkRecipe, Relaxation, RelaxedCells, Tuning,
    Volumes, dihedral_angles, measure_network, regular_cells_tuned, relax_cells_tuned, relax_tuned, validate,
};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rustix::time::{ClockId, clock_gettime};
use voronoi::{Domain, Tessellation};

/// A change of the tuning, or of what is asked for.
struct Row {
    name: &'static str,
    change: fn(&mut Tuning),
    relaxation: Relaxation,
    /// The topology is kept but for edges shorter than this.
    regularize: Option<f64>,
}

fn row(name: &'static str, change: fn(&mut Tuning)) -> Row {
    Row { name, change, relaxation: Relaxation::USUAL, regularize: None }
}

fn for_a_time(name: &'static str, time: f64) -> Row {
    Row { relaxation: Relaxation::Time(time), ..row(name, |_| ()) }
}

fn regularized(name: &'static str, length: f64, change: fn(&mut Tuning)) -> Row {
    Row { relaxation: Relaxation::KEPT_TOPOLOGY, regularize: Some(length), ..row(name, change) }
}

fn to_rest(name: &'static str, change: fn(&mut Tuning)) -> Row {
    Row { relaxation: Relaxation::Equilibrium, ..row(name, change) }
}

fn rows() -> Vec<Row> {
    vec![
        row("base", |_| ()),
        for_a_time("time 0.3", 0.3),
        for_a_time("time 0.6", 0.6),
        for_a_time("time 0.9", 0.9),
        for_a_time("time 3", 3.0),
        row("steps of 0.15", |tuning| tuning.cell_step_time = 0.15),
        row("steps of 0.3", |tuning| tuning.cell_step_time = 0.3),
        row("junctions as stiff", |tuning| tuning.junction_softness = 1.0),
        row("junctions softer", |tuning| tuning.junction_softness = 3.0),
        row("no merged lines", |tuning| tuning.merged_length = 0.0),
        row("merged 0.12", |tuning| tuning.merged_length = 0.12),
        row("no slow small grains", |tuning| tuning.small_grain = 0.0),
        row("no widening", |tuning| tuning.widening = 0.0),
        row("level 0 only", |tuning| tuning.finest_moved = 0),
        row("settled steps 3", |tuning| tuning.settled_steps = 3),
        row("settled steps 4", |tuning| tuning.settled_steps = 4),
        row("settled steps 6", |tuning| tuning.settled_steps = 6),
        row("tolerance 1e-2", |tuning| tuning.tolerance = 1e-2),
        row("tolerance 1e-1", |tuning| tuning.tolerance = 1e-1),
        row("cotangent 5", |tuning| tuning.largest_cotangent = 5.0),
        regularized("regularize 0", 0.0, |_| ()),
        regularized("regularize 0.05", 0.05, |_| ()),
        regularized("regularize 0.15", 0.15, |_| ()),
        regularized("kept, 3 steps", 0.15, |tuning| tuning.coarse_steps = 3),
        regularized("kept, 10 steps", 0.15, |tuning| tuning.coarse_steps = 10),
        regularized("kept, cotangent 5", 0.15, |tuning| tuning.largest_cotangent = 5.0),
        regularized("kept, forecast of 10 steps", 0.15, |tuning| tuning.forecast_steps = 10),
        regularized("kept, no rigid edges", 0.15, |tuning| tuning.rigid_length = 0.0),
        regularized("kept, no centering", 0.15, |tuning| tuning.centering = 0.0),
        regularized("kept, tolerance 1e-1", 0.15, |tuning| tuning.tolerance = 1e-1),
    ]
}

fn rows_of_equilibrium() -> Vec<Row> {
    vec![
        to_rest("base", |_| ()),
        to_rest("10 coarse steps", |tuning| tuning.coarse_steps = 10),
        to_rest("steps of 0.15", |tuning| tuning.cell_step_time = 0.15),
        to_rest("junctions as stiff", |tuning| tuning.junction_softness = 1.0),
        to_rest("junctions softer", |tuning| tuning.junction_softness = 3.0),
        to_rest("no merged lines", |tuning| tuning.merged_length = 0.0),
        to_rest("merged 0.12", |tuning| tuning.merged_length = 0.12),
        to_rest("no widening", |tuning| tuning.widening = 0.0),
        to_rest("levels 0 and 1 only", |tuning| tuning.finest_balanced = 1),
        to_rest("cotangent 5", |tuning| tuning.largest_cotangent = 5.0),
        to_rest("tolerance 1e-2", |tuning| tuning.tolerance = 1e-2),
        to_rest("tolerance 1e-1", |tuning| tuning.tolerance = 1e-1),
    ]
}

/// Networks of one kind, by their cells.
struct Family {
    name: &'static str,
    cells: Vec<Tessellation>,
    levels: usize,
}

fn families() -> Vec<Family> {
    let cube = Domain::unit_cube();
    let periodic = cube.clone().with_periods(BVec3::TRUE);
    let random = |domain: &Domain| -> Vec<Tessellation> {
        (1..=10).map(|seed| of_seeds(domain, &random_seeds(domain, 60, seed))).collect()
    };
    let family = |name, cells| Family { name, cells, levels: 2 };
    vec![
        family("box", random(&cube)),
        family("per", random(&periodic)),
        family("latt", lattices()),
        family("pow", (1..=5).map(|seed| of_spheres(&cube, 60, seed)).collect()),
    ]
}

fn families_of_equilibrium() -> Vec<Family> {
    let cube = Domain::unit_cube();
    let periodic = cube.clone().with_periods(BVec3::TRUE);
    let random = |domain: &Domain, count| {
        (1..=12).map(move |seed| of_seeds(domain, &random_seeds(domain, count, seed))).collect()
    };
    vec![
        Family { name: "box", cells: random(&cube, 30), levels: 3 },
        Family { name: "per", cells: random(&periodic, 60), levels: 2 },
    ]
}

fn of_seeds(domain: &Domain, seeds: &[DVec3]) -> Tessellation {
    Tessellation::new(domain, seeds).unwrap()
}

/// Random spheres whose radii are log-normal: one standard deviation is a factor of 1.4. What has no cell is left out.
fn of_spheres(domain: &Domain, count: usize, random_seed: u64) -> Tessellation {
    let mut generator = ChaCha8Rng::seed_from_u64(1000 + random_seed);
    let mut fraction = || (generator.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    // The sum of twelve is nearly normal.
    let mut radius = || 0.4 * (0.34 * ((0..12).map(|_| fraction()).sum::<f64>() - 6.0)).exp();
    let size = (domain.measure() / count as f64).cbrt();
    let mut spheres: Vec<(DVec3, f64)> = random_seeds(domain, count, random_seed)
        .into_iter()
        .map(|seed| (seed, (radius() * size).powi(2)))
        .collect();
    loop {
        let (seeds, weights): (Vec<DVec3>, Vec<f64>) = spheres.iter().copied().unzip();
        let cells = Tessellation::power(domain, &seeds, &weights).unwrap();
        let empty = cells.empty_cells();
        if empty.is_empty() {
            return cells;
        }
        empty.iter().rev().for_each(|cell| {
            spheres.remove(cell.index());
        });
    }
}

/// Kelvin's lattice and the face-centred one between walls, Kelvin's and Weaire and Phelan's periodic, and Kelvin's a little off.
fn lattices() -> Vec<Tessellation> {
    let cube = Domain::unit_cube();
    let periodic = cube.clone().with_periods(BVec3::TRUE);
    let of = |cells: u32, basis: &[[f64; 3]]| -> Vec<DVec3> {
        let corners = (0..cells.pow(3)).map(|i| {
            DVec3::new(f64::from(i % cells), f64::from(i / cells % cells), f64::from(i / cells / cells))
        });
        let places = corners.flat_map(|corner| basis.iter().map(move |at| corner + DVec3::from(*at)));
        places.map(|place| (place + 0.125) / f64::from(cells)).collect()
    };
    let centred = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.5]];
    let faces = [[0.0, 0.0, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]];
    let a15 = [
        [0.0, 0.0, 0.0],
        [0.5, 0.5, 0.5],
        [0.25, 0.5, 0.0],
        [0.75, 0.5, 0.0],
        [0.0, 0.25, 0.5],
        [0.0, 0.75, 0.5],
        [0.5, 0.0, 0.25],
        [0.5, 0.0, 0.75],
    ];
    let noise = random_seeds(&cube, 128, 1);
    let jittered = of(4, &centred).into_iter().zip(noise);
    let jittered: Vec<DVec3> = jittered.map(|(seed, noise)| seed + (noise - 0.5) * 0.04).collect();
    vec![
        of_seeds(&cube, &of(4, &centred)),
        of_seeds(&cube, &of(4, &faces)),
        of_seeds(&periodic, &of(4, &centred)),
        of_seeds(&periodic, &of(2, &a15)),
        of_seeds(&cube, &jittered),
    ]
}

/// What a network came to.
struct Outcome {
    deviation: f64,
    first_percentile: f64,
    thin: usize,
    /// The share of the points where five grains or more meet.
    higher_order: f64,
    faces: f64,
}

fn relax(cells: &Tessellation, family: &Family, row: &Row) -> (Duration, Result<Outcome, String>) {
    let mut tuning = Tuning::default();
    (row.change)(&mut tuning);
    let start = clock_gettime(ClockId::ProcessCPUTime);
    let finished = match row.regularize {
        Some(length) => keep_topology(cells, length, family, row, &tuning),
        None => change_topology(cells, family, row, &tuning),
    };
    let taken = clock_gettime(ClockId::ProcessCPUTime) - start;
    let taken = Duration::try_from(taken).unwrap();
    let outcome = finished.and_then(|(network, points)| {
        let certificate = validate(&network, &points).map_err(|fault| fault.to_string())?;
        let triangles = certificate.triangles.unwrap();
        let angles = dihedral_angles(&network, network.finest(), &points).unwrap();
        let measures = measure_network(&network, &points).in_space().unwrap();
        let higher_order = measures.quadruple_points.iter().filter(|point| point.sides.len() > 4).count();
        let faces: usize = measures.grains.iter().map(|grain| grain.neighbors.len()).sum();
        Ok(Outcome {
            deviation: angles.standard_deviation,
            first_percentile: triangles.first_percentile,
            thin: triangles.thin,
            higher_order: higher_order as f64 / measures.quadruple_points.len() as f64,
            faces: faces as f64 / measures.grains.len() as f64,
        })
    });
    (taken, outcome)
}

fn change_topology(
    cells: &Tessellation,
    family: &Family,
    row: &Row,
    tuning: &Tuning,
) -> Result<(Network, Vec<DVec3>), String> {
    let recipe = NetworkRecipe {
        face_mesh: FaceMesh::Fan,
        junctions: Junctions::Crease,
        levels: family.levels,
        tension: &|boundary| if boundary.wall.is_none() { 1.0 } else { 0.0 },
    };
    let relaxed = relax_cells_tuned(cells, &recipe, &row.relaxation, tuning, &mut |_| ());
    let RelaxedCells { network, relaxed, points, attempts, .. } =
        relaxed.map_err(|error| error.to_string())?;
    check_nothing_given_up(attempts.first().or(relaxed.given_up.first()))?;
    Ok((network, points))
}

fn keep_topology(
    cells: &Tessellation,
    regularize: f64,
    family: &Family,
    row: &Row,
    tuning: &Tuning,
) -> Result<(Network, Vec<DVec3>), String> {
    let text = |error: NetworkError| error.to_string();
    let regular = regular_cells_tuned(cells, regularize, tuning).map_err(text)?;
    let (network, flat) =
        Network::with_face_mesh(&regular.cells, FaceMesh::SparseFan, Junctions::Crease, family.levels)
            .map_err(text)?;
    let network = network.with_cell_volumes(cells.cell_measures().iter().map(|cell| cell.volume).collect());
    let relaxed =
        relax_tuned(&network, &flat, &row.relaxation, Volumes::Kept, tuning, &mut |_| ()).map_err(text)?;
    check_nothing_given_up(relaxed.given_up.first().or(regular.given_up.first()))?;
    let points = relaxed.finest_points(&network);
    Ok((network, points))
}

/// What falls back to something simpler counts as a failure.
fn check_nothing_given_up(attempt: Option<&Attempt>) -> Result<(), String> {
    attempt.map_or(Ok(()), |attempt| Err(format!("gave up {attempt}")))
}

fn print_row(row: &Row, families: &[Family]) {
    let (mut failures, mut all) = (Vec::new(), Duration::ZERO);
    let mut columns: [Vec<String>; 6] = Default::default();
    for family in families {
        let mut time = Duration::ZERO;
        let mut outcomes = Vec::new();
        for (number, cells) in (1..).zip(&family.cells) {
            let (taken, outcome) = relax(cells, family, row);
            time += taken;
            match outcome {
                Ok(outcome) => outcomes.push(outcome),
                Err(cause) => failures.push(format!("{} {number}: {cause}", family.name)),
            }
        }
        let mean = |of: fn(&Outcome) -> f64| outcomes.iter().map(of).sum::<f64>() / outcomes.len() as f64;
        columns[0].push(format!("{:.2}", mean(|outcome| outcome.deviation)));
        columns[1].push(format!("{:.1}", mean(|outcome| outcome.first_percentile)));
        columns[2].push(format!("{}", outcomes.iter().map(|outcome| outcome.thin).sum::<usize>()));
        columns[3].push(format!("{:.1}", 100.0 * mean(|outcome| outcome.higher_order)));
        columns[4].push(format!("{:.2}", mean(|outcome| outcome.faces)));
        columns[5].push(format!("{:.1}", time.as_secs_f64()));
        all += time;
    }
    let [deviations, percentiles, thin, higher_order, faces, times] =
        columns.map(|column| column.join(" / "));
    let (name, count, all) = (row.name, failures.len(), all.as_secs_f64());
    println!(
        "| {name} | {count} | {deviations} | {percentiles} | {thin} | {higher_order} | {faces} | {times} | {all:.1} |"
    );
    failures.iter().for_each(|failure| println!("  {failure}"));
}

fn main() {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_to_rest = arguments.iter().any(|argument| argument == "--equilibrium");
    arguments.retain(|argument| argument != "--equilibrium");
    let (families, rows) =
        if is_to_rest { (families_of_equilibrium(), rows_of_equilibrium()) } else { (families(), rows()) };
    let names: Vec<&str> = families.iter().map(|family| family.name).collect();
    let names = names.join(" / ");
    println!(
        "| change | failures | sd {names} | p1 | thin | points % | faces | CPU s | all |\n|---|---|---|---|---|---|---|---|---|"
    );
    let is_asked =
        |row: &&Row| arguments.is_empty() || arguments.iter().any(|name| row.name.starts_with(name));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for row in rows.iter().filter(is_asked) {
        pool.install(|| print_row(row, &families));
    }
}
