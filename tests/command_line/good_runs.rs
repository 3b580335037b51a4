use std::fmt::Write;

use glam::DVec3;
use grainsmooth::random_seeds;
use predicates::prelude::*;
use predicates::str::contains;
use voronoi::Domain;

use grainsmooth::vtk::{field_bytes, field_text};

use crate::surface_file::SurfaceFile;
use crate::workplace::Workplace;

fn made_by(workplace: &Workplace, arguments: &str) -> SurfaceFile {
    workplace.run(arguments);
    SurfaceFile::read(&workplace.path("grains.vtp"))
}

/// A seed file with all digits of the seeds.
fn seed_lines(seeds: impl IntoIterator<Item = DVec3>) -> String {
    seeds.into_iter().fold("x,y,z\n".to_owned(), |mut lines, DVec3 { x, y, z }| {
        writeln!(lines, "{x},{y},{z}").unwrap();
        lines
    })
}

/// Largest distance of a boundary's points from the plane through their middle, square to their area.
fn thickness(triangles: &[[DVec3; 3]]) -> f64 {
    let area: DVec3 = triangles.iter().map(|[a, b, c]| (b - a).cross(c - a)).sum();
    let points = triangles.as_flattened();
    let middle = points.iter().sum::<DVec3>() / points.len() as f64;
    let distance = |point: &DVec3| (point - middle).dot(area.normalize()).abs();
    points.iter().map(distance).fold(0.0, f64::max)
}

fn thickest_boundary(surface: &SurfaceFile) -> f64 {
    let boundaries = 0..surface.boundary_count();
    boundaries.map(|boundary| thickness(&surface.corners_of(boundary))).fold(0.0, f64::max)
}

#[test]
fn result_goes_to_grains_vtp_unless_told() {
    let workplace = Workplace::new();
    let said = workplace.run("--seeds 3 -n 0");
    assert!(said.ends_with("written     grains.vtp\n"), "{said}");
    assert!(workplace.bytes("grains.vtp").starts_with(b"<VTKFile"), "an earlier result is replaced");

    let said = workplace.run("--seeds 3 -n 0 -o other.VTU");
    assert!(said.ends_with("written     other.VTU\n"), "{said}");
    assert!(workplace.path("other.VTU").is_file());
}

#[test]
fn summary_counts_what_the_file_holds() {
    let workplace = Workplace::new();
    let said = workplace.run("--seeds 20 -n 2");
    let file = SurfaceFile::read(&workplace.path("grains.vtp"));
    let walls = file.face_labels.iter().zip(&file.boundary_ids).filter(|(labels, _)| labels[1] == -1);
    let mut walls: Vec<i32> = walls.map(|(_, id)| *id).collect();
    walls.sort_unstable();
    walls.dedup();
    for line in [
        "grains      20 in [0, 1] x [0, 1] x [0, 1]".to_owned(),
        format!(
            "boundaries  {} between grains, {} on the walls",
            file.boundary_count() - walls.len(),
            walls.len()
        ),
        format!("mesh        {} points, {} triangles at level 2", file.points.len(), file.cells.len()),
    ] {
        assert!(said.lines().any(|said| said == line), "{line}\nis not in\n{said}");
    }
    let first_words = said.lines().map(|line| line.split(' ').next().unwrap());
    let expected = [
        "grains",
        "diameters",
        "sizes",
        "",
        "boundaries",
        "junctions",
        "mesh",
        "angles",
        "residual",
        "triangles",
        "topology",
        "volumes",
        "validation",
        "time",
        "written",
    ];
    assert!(first_words.eq(expected), "{said}");
    for stage in ["seeds", "cells", "relaxation", "validation", "writing"] {
        let times = said.lines().find(|line| line.starts_with("time ")).unwrap();
        let time = times.split(&format!(" {stage} ")).nth(1).and_then(|rest| rest.split(' ').next());
        assert!(time.is_some_and(|time| time.parse::<f64>().is_ok()), "{stage} has no time in\n{said}");
    }
}

#[test]
fn summary_speaks_of_areas_in_the_plane() {
    let said = Workplace::new().run("--seeds 30 --dim 2");
    assert!(contains(" of 3 grains); ").and(contains(" segments at level ")).eval(&said), "{said}");
    assert!(contains("areas ").and(contains("triang").not()).eval(&said), "{said}");
}

#[test]
fn quiet_run_says_nothing() {
    let workplace = Workplace::new();
    assert_eq!(workplace.run("--seeds 5 -n 1 --quiet"), "");
    assert!(workplace.bytes("grains.vtp").starts_with(b"<VTKFile"));
}

#[test]
fn nothing_moves_on_the_screen_without_a_terminal() {
    let said = Workplace::new().run("--seeds 100 -n 3");
    assert!(!said.contains(['\r', '\x1b']), "{said:?}");
}

#[test]
fn run_is_good_although_nobody_listens() {
    let workplace = Workplace::new();
    let program = workplace.command("").get_program().to_owned();
    if cfg!(target_os = "linux") {
        let mut shell = assert_cmd::Command::new("sh");
        shell.current_dir(workplace.path("")).arg("-c").arg("\"$0\" --seeds 3 -n 0 2>/dev/full").arg(program);
        shell.assert().success();
    }
}

#[test]
fn help_tells_defaults_units_examples_and_exit_codes() {
    let help = Workplace::new().command("--help").assert().success().stderr("").get_output().stdout.clone();
    // Lines break where the terminal is narrow.
    let help = String::from_utf8(help).unwrap().split_whitespace().collect::<Vec<_>>().join(" ");
    for text in [
        "--seeds <N> Number of grains [default: 200, or what --diameters or --volumes ask for] Example: --seeds 5000",
        "--box <X> <Y> [Z]... Side lengths of the box in your unit of length",
        "[default: 1 1 1, or those of a .tess file]",
        "--rng-seed <S>",
        "in units of the mean grain size squared, or `equilibrium`; 0 keeps boundaries flat [default: 1.2, in 2D equilibrium; 0 with lamellae, 0.05 for grains of several cells, 0.3 with --free or --regularize, in 2D with --edge-length too] Example: --relax 0.1",
        "-n, --levels <LEVELS>",
        "[default: 3]",
        "[default: crease] [possible values: crease, corner]",
        "[default: grains.vtp]",
        "[default: all processors]",
        "grainsmooth --seeds 200 -n 3 ",
        "Exit status: 0 good, 1 the run failed or its result is invalid, 2 a mistake on the command line.",
    ] {
        assert!(help.contains(text), "{text}\nis not in\n{help}");
    }
}

#[test]
fn number_of_threads_does_not_change_the_file() {
    let workplace = Workplace::new();
    for arguments in [
        "--seeds 40 -n 2 -o X.vtp",
        "--seeds 40 -n 2 -o X.vtu",
        "--seeds 40 -n 2 -o X.vtk",
        "--seeds 90 --dim 2 -o X.vtp",
    ] {
        let [one, two] = [1, 2].map(|threads| {
            let name = format!("{threads}.{}", &arguments[arguments.len() - 3..]);
            workplace.run(&format!("{arguments} --threads {threads}").replace("X.", &format!("{threads}.")));
            workplace.bytes(&name)
        });
        assert!(one == two, "{arguments}");
    }
}

#[test]
fn file_says_how_it_was_made() {
    let workplace = Workplace::new();
    workplace.run("--seeds 4 --rng-seed 77 --box 2 1 0.5 --junctions corner -n 1 --relax 0.1 --threads 1");
    let file = workplace.bytes("grains.vtp");
    let version = concat!("grainsmooth ", env!("CARGO_PKG_VERSION"));
    assert_eq!(field_text(&file, "Version").as_deref(), Some(version));
    assert_eq!(field_bytes(&file, "RandomSeed").as_deref(), Some(&77u64.to_ne_bytes()[..]));
    let command_line = field_text(&file, "CommandLine").unwrap();
    let arguments = command_line.strip_prefix("grainsmooth ").unwrap();
    assert!(arguments.contains("--seeds 4 --seeding packed --rng-seed 77"), "{arguments}");

    workplace.run(arguments);
    assert!(workplace.bytes("grains.vtp") == file, "the command line in the file makes the file again");
}

#[test]
fn boundaries_are_flat_without_relaxation_and_curved_with_it() {
    let workplace = Workplace::new();
    assert!(thickest_boundary(&made_by(&workplace, "--seeds 60 -n 3 --relax 0")) < 1e-12);
    // Grains are a quarter wide.
    assert!(thickest_boundary(&made_by(&workplace, "--seeds 60 -n 3")) > 0.02);
    // The box is the measure: a small one is as flat.
    let small = made_by(&workplace, "--seeds 20 -n 2 --relax 0 --box 1e-8 1e-8 1e-8");
    assert!(thickest_boundary(&small) < 1e-20);
}

#[test]
fn same_seeds_from_a_file_give_the_same_geometry() {
    let workplace = Workplace::new();
    let seeds = random_seeds(25, &Domain::unit_cube(), 5);
    workplace.put("seeds.csv", seed_lines(seeds));
    let drawn = made_by(&workplace, "--seeds 25 --seeding random --rng-seed 5 -n 1");
    let read = made_by(&workplace, "--seeds-file seeds.csv -n 1");
    assert!(drawn == read);
}

/// Eight cubes meet in a point and four in an edge: nothing is in general position.
#[test]
fn simple_cubic_lattice_stays_as_it_is() {
    let workplace = Workplace::new();
    let cube = |i: u32| DVec3::new(f64::from(i % 4), f64::from(i / 4 % 4), f64::from(i / 16));
    workplace.put("seeds.csv", seed_lines((0..64).map(|i| (cube(i) + 0.5) / 4.0)));
    for relax in ["--relax 0", ""] {
        let lattice = made_by(&workplace, &format!("--seeds-file seeds.csv -n 2 {relax}"));
        // Three planes of 16 squares each way, and 16 on each of six walls.
        assert_eq!((lattice.grain_count(), lattice.boundary_count()), (64, 9 * 16 + 6 * 16));
        assert!(thickest_boundary(&lattice) < 1e-12);
    }
}

#[test]
fn levels_add_triangles_and_generations() {
    let workplace = Workplace::new();
    let coarse = made_by(&workplace, "--seeds 10 -n 0");
    let fine = made_by(&workplace, "--seeds 10 -n 3");
    assert_eq!(fine.cells.len(), 64 * coarse.cells.len());
    assert_eq!(fine.boundary_count(), coarse.boundary_count());
    assert_eq!(fine.generations.iter().max(), Some(&3));
    assert!(coarse.generations.iter().all(|generation| *generation == 0));
}

#[test]
fn plane_holds_one_polyline_for_each_boundary() {
    let workplace = Workplace::new();
    let [coarse, fine] =
        ["-n 0", "-n 3"].map(|n| made_by(&workplace, &format!("--dim 2 --seeds 40 --relax 0.3 {n}")));
    for file in [&coarse, &fine] {
        assert_eq!(file.grain_count(), 40);
        assert_eq!(file.cells.len(), file.boundary_count());
        let mut boundaries = file.boundary_ids.clone();
        boundaries.sort_unstable();
        boundaries.dedup();
        assert_eq!(boundaries.len(), file.cells.len());
        assert!(file.points.iter().all(|point| point.z == 0.0));
        assert_area_is_filled(file);
    }
    let segments = |file: &SurfaceFile| file.cells.iter().map(|cell| cell.len() - 1).sum::<usize>();
    assert_eq!(segments(&fine), 8 * segments(&coarse));
}

/// Grains' outlines, walked with the grain on the left, enclose the unit square together.
fn assert_area_is_filled(file: &SurfaceFile) {
    let mut areas = vec![0.0; file.grain_count()];
    for (cell, labels) in file.cells.iter().zip(&file.face_labels) {
        let walked: f64 = cell
            .windows(2)
            .map(|ends| file.points[ends[0]].truncate().perp_dot(file.points[ends[1]].truncate()) / 2.0)
            .sum();
        for (label, sign) in labels.iter().zip([1.0, -1.0]) {
            if let Ok(grain) = usize::try_from(*label) {
                areas[grain] += sign * walked;
            }
        }
    }
    assert!(areas.iter().all(|area| *area > 0.0), "{areas:?}");
    assert!((areas.iter().sum::<f64>() - 1.0).abs() < 1e-12);
}

/// Regularisation once left faces folded that it had let fold because they would close, and did not.
#[test]
fn thin_faces_that_did_not_close_are_not_folded() {
    let workplace = Workplace::new();
    let said = workplace.run("--seeds 2000 -n 0 -o many.vtp");
    assert!(said.contains("validation  good"), "{said}");
}

/// Four seeds off a face-centred lattice by 1e-8: opposite grains share faces 1e-16 wide, whose triangles have no direction.
#[test]
fn seeds_a_little_off_a_lattice_make_networks() {
    let workplace = Workplace::new();
    let offsets = [[0.1, 1.7, 1.0], [0.1, -2.3, 0.5], [1.8, 0.9, -2.1], [-1.5, 1.0, 1.3]];
    let lattice = [[0.25, 0.25, 0.25], [0.25, 0.75, 0.75], [0.75, 0.25, 0.75], [0.75, 0.75, 0.25]];
    let seeds = lattice.iter().zip(&offsets).map(|(seed, off)| DVec3::from(*seed) + DVec3::from(*off) * 1e-8);
    workplace.put("seeds.csv", seed_lines(seeds));
    for options in ["", "--relax equilibrium", "--regularize 0", "--relax 0"] {
        let said = workplace.run(&format!("--seeds-file seeds.csv --periodic x,y,z -n 1 {options}"));
        assert!(said.contains("12.00 faces a grain"), "{said}");
    }
}
