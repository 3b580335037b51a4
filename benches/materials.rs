//! What is demanded of sizes, shapes and textures of grains, row by row, beside what is reached.
//!
//! `README.md` beside this file says how to run it, and what it gave.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    missing_docs,
    reason = "a bench prints, may panic, and has no users"
)]

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use glam::{BVec3, DVec3};
use grainsmooth::{
    Config, Polycrystal, SeedSource, SizeOptions, SizeSource, SummaryRecord, Tessellated, TextureOptions,
    TextureSource, make_polycrystal, tessellate,
};
use polycrystal::measure_network;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rustix::time::{ClockId, clock_gettime};
use serde_json::Value;
use sizes::Spec;
use texture::{CrystalSymmetry, IpfKey, Kernel, Orientation, RandomDisorientations, Texture};
use voronoi::volumes::{PowerDiagram, place_spheres};
use voronoi::{Domain, Tessellation};

const NARROW: &str = "lognormal(mean=1, cv=0.35)";
const WIDE: &str = "lognormal(mean=1, cv=1)";
const BIMODAL: &str = "0.98*equal(1) + 0.02*equal(10)";

/// Names of the groups of rows, and what prints them.
const GROUPS: [(&str, fn()); 9] = [
    ("volumes", volumes),
    ("times", times),
    ("program", program),
    ("steps", steps),
    ("cut", cut),
    ("morphology", morphology),
    ("stretch", stretch),
    ("texture", texture_rows),
    ("misorientations", misorientations),
];

fn main() {
    // Without the argument, these are tests: they need not run.
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        return;
    }
    let filter = arguments.iter().find(|argument| !argument.starts_with('-'));
    println!("{:52}{:>12}{:>12}", "", "reached", "demanded");
    for (name, rows) in GROUPS {
        if filter.is_none_or(|filter| name.contains(filter)) {
            rows();
        }
    }
}

/// A row whose figure is to be no larger than demanded.
fn at_most(name: &str, reached: f64, demanded: f64) {
    let verdict = if reached <= demanded { "" } else { "  FAILS" };
    println!("{name:52}{reached:>12.4}{demanded:>12.4}{verdict}");
}

/// The same of errors.
fn error_at_most(name: &str, reached: f64, demanded: f64) {
    let verdict = if reached <= demanded { "" } else { "  FAILS" };
    println!("{name:52}{reached:>12.1e}{demanded:>12.1e}{verdict}");
}

/// A row whose figure is to be near one.
fn near(name: &str, reached: f64, demanded: f64, tolerance: f64) {
    let verdict = if (reached - demanded).abs() <= tolerance { "" } else { "  FAILS" };
    println!("{name:52}{reached:>12.4}{demanded:>12.4} +- {tolerance}{verdict}");
}

/// Periodic grains of diameters in words.
fn config(count: usize, diameters: &str, steps: u32) -> Config {
    Config {
        seeds: SeedSource::Packed { count },
        sizes: SizeOptions {
            source: Some(SizeSource::Diameters(diameters.parse().unwrap())),
            ..SizeOptions::default()
        },
        lloyd_steps: Some(steps),
        periodic: BVec3::TRUE,
        levels: 0,
        ..Config::default()
    }
}

fn cells(config: &Config) -> Tessellated {
    tessellate(config, &|_, _, _| ()).unwrap()
}

fn made(config: &Config) -> Polycrystal {
    make_polycrystal(config, &|_, _, _| ()).unwrap().stretched_if_asked()
}

fn sizes_of(polycrystal: &Polycrystal) -> Value {
    serde_json::to_value(SummaryRecord::new(polycrystal, Vec::new())).unwrap()["sizes"].clone()
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or(f64::NAN)
}

/// Of all threads, in seconds.
fn processor_time() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// What some work takes in seconds of processor time, and by the clock.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64, f64) {
    let (start, clock) = (processor_time(), Instant::now());
    let result = work();
    (result, processor_time() - start, clock.elapsed().as_secs_f64())
}

fn volumes() {
    for (name, diameters, flat) in
        [("cv 0.35", NARROW, 1e-12), ("cv 1", WIDE, 1e-10), ("1:10", BIMODAL, 1e-10)]
    {
        // Of 500, 2 % are the large ones.
        let count = if diameters == BIMODAL { 500 } else { 2000 };
        let polycrystal = made(&config(count, diameters, 10));
        let sizes = sizes_of(&polycrystal);
        let name = format!("volumes, {count} grains, {name}");
        error_at_most(&format!("{name}, cells"), number(&sizes, "largest_volume_error_of_cells"), flat);
        error_at_most(&format!("{name}, relaxed"), number(&sizes, "largest_volume_error"), 1e-10);
        let distance = number(&sizes, "cdf_distance") - 0.5 / count as f64;
        error_at_most(&format!("{name}, CDF distance over 1/(2N)"), distance, 1e-12);
        near(&format!("{name}, grains"), polycrystal.network.grain_count() as f64, count as f64, 0.0);
    }
}

fn times() {
    let rows: [(usize, &str, u32, f64); 8] = [
        (200, NARROW, 0, 0.1),
        (200, NARROW, 10, 0.3),
        (2000, NARROW, 10, 1.0),
        (20_000, NARROW, 10, 10.0),
        (20_000, BIMODAL, 0, 15.0),
        (20_000, WIDE, 0, 30.0),
        (100_000, NARROW, 0, 30.0),
        (100_000, NARROW, 10, 60.0),
    ];
    for (count, diameters, steps, demanded) in rows {
        let (_, processor, clock) = timed(|| cells(&config(count, diameters, steps)));
        let name = format!("{count} grains, {diameters}, {steps} steps");
        at_most(&format!("{name}: s"), processor, demanded);
        println!("{:52}{clock:>12.4}", "  by the clock");
    }
}

/// Whole runs of the program, as users have them.
fn program() {
    let directory = tempfile::tempdir().unwrap();
    let rows: [(&str, f64); 4] = [
        ("--seeds 20000 --diameters lognormal(mean=1,cv=0.35) --lloyd 0 --no-mesh --cells-csv c.csv", 10.0),
        ("--seeds 20000 --diameters lognormal(mean=1,cv=0.35) --no-mesh --cells-csv c.csv", 10.0),
        ("--seeds 20000 --diameters lognormal(mean=1,cv=0.35) --relax 0 -n 0", 20.0),
        (
            "--seeds 1000 --texture goss(15) --phase a:0.8 --phase b:0.2 --periodic x,y,z -n 1 --voxels 64 64 64 -o g.vtm -o g.vti -o material.yaml --report g.html",
            10.0,
        ),
    ];
    for (arguments, demanded) in rows {
        let clock = Instant::now();
        let status = Command::new(env!("CARGO_BIN_EXE_grainsmooth"))
            .args(arguments.split(' '))
            .arg("--quiet")
            .current_dir(&directory)
            .status();
        assert!(status.unwrap().success());
        println!("{arguments}");
        at_most("  s by the clock", clock.elapsed().as_secs_f64(), demanded);
    }
}

fn volumes_of(diameters: &str, count: u32) -> Vec<f64> {
    let distribution = diameters.parse::<Spec>().unwrap().distribution(3);
    let cube = |k: u32| distribution.quantile((f64::from(k) + 0.5) / f64::from(count)).powi(3);
    let cubes: Vec<f64> = (0..count).map(cube).collect();
    let sum: f64 = cubes.iter().sum();
    cubes.into_iter().map(|cube| cube / sum).collect()
}

fn placed(volumes: &[f64]) -> PowerDiagram {
    let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    let seeds = place_spheres(&domain, volumes, || (generator.next_u64() >> 11) as f64 / (1u64 << 53) as f64)
        .unwrap();
    PowerDiagram::with_volumes(&domain, &seeds, volumes).unwrap()
}

fn steps() {
    for (name, diameters, demanded) in
        [("cv 0.35", NARROW, 8.0), ("cv 1", WIDE, 15.0), ("1:10", BIMODAL, 15.0)]
    {
        for count in [2000, 20_000] {
            let diagram = placed(&volumes_of(diameters, count));
            at_most(
                &format!("Newton steps, {count} grains, {name}"),
                diagram.newton_steps() as f64,
                demanded,
            );
        }
    }
}

fn cut() {
    for (name, diameters, demanded) in [("cv 0.35", NARROW, 2.0), ("cv 1", WIDE, 4.0)] {
        let diagram = placed(&volumes_of(diameters, 20_000));
        let (domain, seeds) = (diagram.tessellation().domain(), diagram.tessellation().seeds());
        // In turn, as others use the machine too.
        let mut ratios: Vec<f64> = (0..5)
            .map(|_| {
                let (_, plain, _) = timed(|| Tessellation::new(domain, seeds).unwrap());
                let (_, power, _) = timed(|| Tessellation::power(domain, seeds, diagram.weights()).unwrap());
                power / plain
            })
            .collect();
        ratios.sort_by(f64::total_cmp);
        at_most(&format!("cells with weights, 20000 grains, {name}: times"), ratios[2], demanded);
    }
}

fn morphology() {
    let (mut faces, mut sphericities) = (Vec::new(), Vec::new());
    for random_seed in 1..=3 {
        let cells = cells(&Config { random_seed, ..config(2000, NARROW, 10) });
        let measures = cells.tessellation.cell_measures();
        let mean = |value: &dyn Fn(&voronoi::CellMeasure) -> f64| {
            measures.iter().map(value).sum::<f64>() / measures.len() as f64
        };
        faces.push(mean(&|cell| cell.face_count as f64));
        sphericities.push(mean(&|cell| {
            std::f64::consts::PI.cbrt() * (6.0 * cell.volume).powf(2.0 / 3.0) / cell.area
        }));
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    near("faces a grain, 2000 grains, cv 0.35, 10 steps", mean(&faces), 13.72, 0.15);
    near("sphericity", mean(&sphericities), 0.855, 0.006);
}

fn stretch() {
    for ratio in [[2.0, 1.0, 1.0], [3.0, 1.0, 1.0], [1.0, 1.0, 4.0], [4.0, 4.0, 1.0]] {
        let aspect_ratio = DVec3::from_array(ratio);
        // As many grains along each axis.
        let config = Config { aspect_ratio, box_size: aspect_ratio, levels: 1, ..config(300, NARROW, 10) };
        let polycrystal = made(&config);
        let measures = measure_network(&polycrystal.network, &polycrystal.points).in_space().unwrap();
        let mut sum = DVec3::ZERO;
        for grain in &measures.grains {
            let inertia = DVec3::new(grain.inertia.x_axis.x, grain.inertia.y_axis.y, grain.inertia.z_axis.z);
            sum += (0.5 * inertia.element_sum() - inertia) / grain.volume.powf(5.0 / 3.0);
        }
        let lengths = DVec3::new(sum.x.sqrt(), sum.y.sqrt(), sum.z.sqrt());
        let worst = (lengths / aspect_ratio / (lengths / aspect_ratio).element_product().cbrt() - 1.0).abs();
        let name = format!("stretch {ratio:?}");
        at_most(&format!("{name}: off the ratio"), worst.max_element(), 0.03);
        error_at_most(
            &format!("{name}: volumes"),
            number(&sizes_of(&polycrystal), "largest_volume_error"),
            1e-10,
        );
    }
}

fn reference(name: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/texture/tests/data").join(name);
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn angles(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|place| value[place].as_f64().unwrap())
}

fn texture_rows() {
    let rows = reference("orientations.json");
    let rows: Vec<Orientation> = rows["orientations"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| Orientation::from_euler_degrees(angles(&row["euler"])))
        .collect();
    let pairs = reference("disorientations.json");
    let mut worst: f64 = 0.0;
    for symmetry in CrystalSymmetry::ALL {
        let exact = pairs["groups"][symmetry.rotation_group()]["pairs"].as_array().unwrap();
        for (pair, exact) in pairs["pairs"].as_array().unwrap().iter().zip(exact) {
            let [a, b] = [0, 1].map(|place| rows[usize::try_from(pair[place].as_u64().unwrap()).unwrap()]);
            worst = worst.max((symmetry.disorientation_angle(a, b) - exact.as_f64().unwrap()).abs());
        }
    }
    error_at_most("disorientations: degrees", worst, 1e-9);
    let colors: BTreeMap<String, BTreeMap<String, Vec<[f64; 3]>>> =
        serde_json::from_value(reference("ipf_colors.json")["laue"].clone()).unwrap();
    let mut worst: f64 = 0.0;
    for (laue, of_direction) in &colors {
        let key = IpfKey::new(laue.parse().unwrap());
        for (name, direction) in [("X", DVec3::X), ("Y", DVec3::Y), ("Z", DVec3::Z)] {
            for (row, theirs) in rows.iter().zip(&of_direction[name]) {
                let ours = key.color(row.to_crystal(direction));
                worst = ours.into_iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(worst, f64::max);
            }
        }
    }
    at_most("inverse pole figure colours", worst, 0.01);
    let drawn = |spec: &str, volumes: &[f64]| {
        spec.parse::<Texture>().unwrap().draw(volumes, &mut ChaCha8Rng::seed_from_u64(1)).unwrap()
    };
    let count = 2000;
    let modes = drawn("euler(30 45 60, 10)", &vec![1.0; count]).orientations;
    let mode = Orientation::from_euler_degrees([30.0, 45.0, 60.0]);
    let angle = |one: &Orientation| CrystalSymmetry::Triclinic.disorientation_angle(*one, mode);
    let mut angles: Vec<f64> = modes.iter().map(angle).collect();
    angles.sort_by(f64::total_cmp);
    let kernel = Kernel::new(10.0).unwrap();
    let off = (0..count).map(|k| (kernel.share_within(angles[k]) - (k as f64 + 0.5) / count as f64).abs());
    at_most("quantiles of a kernel, 2000 orientations", off.fold(0.0, f64::max), 4.0 / (count as f64).sqrt());
    let random = drawn("random", &vec![1.0; count]).orientations;
    let cubic = CrystalSymmetry::Octahedral;
    let mut bins = [0.0; 13];
    for (place, one) in random.iter().enumerate() {
        for other in &random[..place] {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 12")]
            let bin = (cubic.disorientation_angle(*one, *other) / 5.0) as usize;
            bins[bin] += 2.0 / (count as f64 * (count as f64 - 1.0));
        }
    }
    let mackenzie = RandomDisorientations::new(cubic);
    let share = |bin: usize| {
        mackenzie.share_below(5.0 * (bin as f64 + 1.0)) - mackenzie.share_below(5.0 * bin as f64)
    };
    let off = (0..13).map(|bin| (bins[bin] - share(bin)).abs());
    at_most("Mackenzie's distribution, a bin of 5 degrees", off.fold(0.0, f64::max), 0.002);
    for count in [200, 1000] {
        let volumes = volumes_of(NARROW, count);
        let mixed = drawn("goss(10)*0.3 + cube(5)*0.25 + random*0.45", &volumes);
        let mut shares = [0.0; 3];
        mixed.components.iter().zip(&volumes).for_each(|(component, volume)| shares[*component] += volume);
        let off = shares.iter().zip([0.3, 0.25, 0.45]).map(|(share, asked)| (share - asked).abs());
        at_most(&format!("volumes of components, {count} grains"), off.fold(0.0, f64::max), 0.01);
    }
}

fn misorientations() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("angles.csv");
    // Twice as much below 15 degrees as random neighbours have.
    std::fs::write(&file, "15, 0.063\n30, 0.1\n45, 0.387\n62.8, 0.45\n").unwrap();
    let textured = |misorientations| Config {
        texture: TextureOptions {
            source: Some(TextureSource::Words("random".to_owned())),
            misorientations,
            ..TextureOptions::default()
        },
        ..config(2000, NARROW, 10)
    };
    let of_fit = |config: &Config| {
        let cells = cells(config);
        timed(|| grainsmooth::smooth(config, cells, &|_, _, _| ()).unwrap())
    };
    let flat = |config: Config| Config { relaxation: Some(polycrystal::Relaxation::Time(0.0)), ..config };
    let (polycrystal, with, _) = of_fit(&flat(textured(Some(file))));
    let (_, without, _) = of_fit(&flat(textured(None)));
    let fit = polycrystal.grains().texture.as_ref().and_then(|texture| texture.fit()).unwrap();
    at_most("disorientations of neighbours, 20 N swaps", fit.after, 0.01);
    at_most("  s for 2000 grains", with - without, 1.0);
}
