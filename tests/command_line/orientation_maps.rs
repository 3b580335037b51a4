//! `grainsmooth smooth`: grains of orientation maps.

use std::fmt::Write as _;

use grainsmooth::{MapOptions, MeasuredMap, read_map};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::programs;
use crate::workplace::{FAILED, USAGE, Workplace};

/// A point: x, y, Euler angles in degrees, image quality, confidence.
type Point = ([f64; 2], [f64; 3], [f64; 2]);

const HEAD: &str = "# Phase 1\n# MaterialName  Nickel\n# Symmetry  43\n#\n# GRID: SqrGrid\n# XSTEP: 9\n# NCOLS_ODD: 7\n# NCOLS_EVEN: 7\n# NROWS: 5\n#\n";

fn ang(head: &str, points: impl IntoIterator<Item = Point>) -> String {
    let mut text = head.to_owned();
    for ([x, y], angles, [quality, confidence]) in points {
        let [phi1, phi, phi2] = angles.map(f64::to_radians);
        writeln!(text, " {phi1:.5} {phi:.5} {phi2:.5} {x:.5} {y:.5} {quality:.1} {confidence:.3} 0 1 0.8")
            .unwrap();
    }
    text
}

/// Points of a square grid, the angles and figures of each by column and row.
fn square(
    [columns, rows]: [u32; 2],
    step: f64,
    point: impl Fn(u32, u32) -> ([f64; 3], [f64; 2]) + Copy,
) -> impl Iterator<Item = Point> {
    (0..rows).flat_map(move |row| {
        (0..columns).map(move |column| {
            let (angles, figures) = point(column, row);
            ([f64::from(column) * step, f64::from(row) * step], angles, figures)
        })
    })
}

const GOOD: [f64; 2] = [100.0, 0.9];

/// Of points without a solution, as TSL writes them.
const NONE: ([f64; 3], [f64; 2]) = ([720.0; 3], [10.0, -1.0]);

fn read(workplace: &Workplace, name: &str, options: &MapOptions) -> MeasuredMap {
    read_map(&workplace.path(name), options).unwrap_or_else(|error| panic!("{error}"))
}

fn text(workplace: &Workplace, name: &str) -> String {
    String::from_utf8(workplace.bytes(name)).unwrap()
}

/// How the summary describes the map.
fn line<'a>(said: &'a str, name: &str) -> &'a str {
    said.lines()
        .find_map(|line| line.strip_prefix(name))
        .unwrap_or_else(|| panic!("no {name} in {said}"))
        .trim()
}

#[test]
fn maps_that_this_program_writes_give_their_grains_back() {
    let workplace = Workplace::new();
    workplace.run("--dim 2 --seeds 12 --rng-seed 4 --box 3 2 --texture random --crystal-symmetry hexagonal --voxels 90 60 -o a.ctf -o a.ang -o a.vtp --stats a.json");
    let numbers = |value: &serde_json::Value| -> Vec<f64> {
        value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
    };
    let made = workplace.json("a.json");
    for name in ["a.ctf", "a.ang"] {
        let said = workplace
            .run(&format!("smooth {name} -o b.vtp --stats b.json --report b.html -o b.{}", &name[2..]));
        assert_eq!(line(&said, "map"), "90 x 60 points on a square grid, step 0.0333333, in 12 grains");
        assert!(line(&said, "spread").starts_with("0.00 degrees"), "{said}");
        let found = workplace.json("b.json");
        let mut matched = 0;
        for grain in found["grains"].as_array().unwrap() {
            let area = grain["area"].as_f64().unwrap();
            let voxels = grain["VoxelCount"].as_f64().unwrap();
            assert!((area * 900.0 / voxels - 1.0).abs() < 1e-9, "{grain}");
            assert_eq!(grain["Phase"], 1);
            // The grain that was made there, by its orientation.
            let quaternion = numbers(&grain["Quaternion"]);
            let same = made["grains"].as_array().unwrap().iter().filter(|other| {
                let dot: f64 =
                    numbers(&other["Quaternion"]).iter().zip(&quaternion).map(|(a, b)| a * b).sum();
                dot.abs() > 1.0 - 1e-9
            });
            for other in same {
                matched += 1;
                assert!((area / other["area"].as_f64().unwrap() - 1.0).abs() < 0.05);
                for axis in ["centroid_x", "centroid_y"] {
                    let [here, there] = [grain, other].map(|grain| grain[axis].as_f64().unwrap());
                    // Rows of the file go down, those of the box up; points of the map stand in the middle of pixels.
                    assert!((here + 0.5 / 30.0 - there).abs() < 0.01, "{axis}: {here} {there}");
                }
            }
        }
        assert_eq!(matched, 12);
        // The map as cleaned, at its own points, has the same angles everywhere.
        let extension = &name[2..];
        let angles = |name: &str| -> Vec<f64> {
            let all = text(&workplace, name);
            let rows = all
                .lines()
                .filter(|line| !line.starts_with('#'))
                .map(|line| line.split_whitespace().collect::<Vec<_>>());
            let first = if extension == "ang" { 0 } else { 5 };
            let rows = rows.filter(|row| row.len() >= 10 && row[0] != "Phase" && row[0] != "Euler");
            rows.flat_map(|row| {
                row[first..first + 3].iter().map(|angle| angle.parse().unwrap()).collect::<Vec<f64>>()
            })
            .collect()
        };
        let [made, found] = [name, &format!("b.{extension}")].map(angles);
        assert_eq!([made.len(), found.len()], [3 * 90 * 60; 2]);
        assert!(made.iter().zip(&found).all(|(a, b)| (a - b).abs() < 2.1e-5), "{name}");
    }
}

#[test]
fn steps_and_counts_come_from_points_alone() {
    let workplace = Workplace::new();
    let two = |column: u32, _| ([if column < 4 { 0.0 } else { 30.0 }, 0.0, 0.0], GOOD);
    let points: Vec<Point> = square([10, 6], 0.4, two).collect();
    workplace.put("a.ang", ang(HEAD, points.clone()));
    let said = workplace.run("smooth a.ang -o a.vtp");
    assert_eq!(
        line(&said, "map"),
        "10 x 6 points on a square grid, step 0.4, in 2 grains; its head says 7 x 5 points, step 9, which its points do not bear out"
    );
    assert_eq!(line(&said, "grains"), "2 in [-0.2, 3.8] x [-0.2, 2.2]");
    // In any order, with rounded coordinates and points left out, which are filled.
    let mut mixed = points.clone();
    mixed.reverse();
    mixed.swap(3, 40);
    mixed.remove(17);
    for point in &mut mixed {
        point.0 = point.0.map(|along| (along * 3.0 / 4.0 * 100.0).round() / 100.0);
    }
    workplace.put("b.ang", ang(HEAD, mixed));
    let [a, b] = ["a.ang", "b.ang"].map(|name| read(&workplace, name, &MapOptions::default()));
    assert_eq!(a.map.labels.iter().filter(|label| **label == a.map.labels[0]).count(), 24);
    // Grains are numbered by their first points, x fastest, whatever the order of the file.
    assert_eq!((a.map.labels, a.voxel_counts, a.map.shape), (b.map.labels, b.voxel_counts, b.map.shape));
    assert!((b.map.spacing.x - 0.3).abs() < 1e-3);
    assert_eq!(b.crystals.unwrap().points.unsolved, 1);
}

#[test]
fn hexagonal_maps_keep_the_area_of_their_points() {
    let workplace = Workplace::new();
    // Odd rows have a point less, or stand out on both sides.
    let (step, height) = (0.5, 0.5 * 0.75_f64.sqrt());
    for shift in [0.5, -0.5] {
        let rows = (0..9).flat_map(|row| {
            let offset = if row % 2 == 1 { shift } else { 0.0 };
            let count = if row % 2 == 0 {
                10
            } else if shift > 0.0 {
                9
            } else {
                11
            };
            (0..count).map(move |column| [(f64::from(column) + offset) * step, f64::from(row) * height])
        });
        let place = |[x, y]: [f64; 2]| {
            // A disc in the middle of another grain.
            let is_inside = (x - 2.25).hypot(y - 4.0 * height) < 1.1;
            ([x, y], [0.0, if is_inside { 40.0 } else { 0.0 }, 0.0], GOOD)
        };
        let points: Vec<Point> = rows.map(place).collect();
        let inside = points.iter().filter(|(_, angles, _)| angles[1] > 0.0).count();
        assert!(inside > 10);
        workplace.put("a.ang", ang(HEAD, points.clone()));
        let said = workplace.run("smooth a.ang -o a.vtp --stats a.json");
        let columns = if shift > 0.0 { 10 } else { 11 };
        assert!(
            line(&said, "map")
                .starts_with(&format!("{columns} x 9 points on a hexagonal grid, step 0.5, in 2 grains")),
            "{said}"
        );
        let statistics = workplace.json("a.json");
        let disc = &statistics["grains"][1];
        assert_eq!(disc["VoxelCount"], inside);
        // The area of a hexagon's cell is step times height; the file rounds both.
        let area = disc["area"].as_f64().unwrap();
        assert!((area / (inside as f64 * step * height) - 1.0).abs() < 1e-5, "{disc}");
        // Without its neighbours, a point is filled by what most of six have.
        let mut holes = points;
        holes[22].1 = [720.0; 3];
        workplace.put("b.ang", ang(HEAD, holes));
        let filled = read(&workplace, "b.ang", &MapOptions::default());
        assert_eq!(filled.map.labels, read(&workplace, "a.ang", &MapOptions::default()).map.labels);
    }
}

#[test]
fn points_are_masked_filled_dropped_or_left_as_pores() {
    let workplace = Workplace::new();
    // Two grains; a block of 6 points without a solution, a single one, an uncertain point, and one of another orientation.
    let point = |column: u32, row: u32| match (column, row) {
        (1..4, 1..3) | (8, 8) => NONE,
        (6, 2) => ([0.0; 3], [100.0, 0.02]),
        (9, 5) => ([0.0; 3], [40.0, 0.9]),
        (3, 7) => ([45.0, 20.0, 0.0], GOOD),
        _ => ([if column < 6 { 10.0 } else { 30.0 }, 0.0, 0.0], GOOD),
    };
    workplace.put("a.ang", ang(HEAD, square([12, 10], 1.0, point)));
    let said = workplace.run("smooth a.ang --min-ci 0.1 --min-iq 50 --min-voxels 2 -o a.vtp");
    assert!(
        line(&said, "map").starts_with("12 x 10 points on a square grid, step 1, in 3 grains; 7 points without a solution; 2 too uncertain; its head"),
        "{said}"
    );
    assert!(line(&said, "map").ends_with("; 1 in 1 small grain went to neighbours"), "{said}");
    let counts = |options: &str| -> Vec<u64> {
        workplace.run(&format!("smooth a.ang {options} -o a.vtp --stats a.json"));
        let statistics = workplace.json("a.json");
        let grains = statistics["grains"].as_array().unwrap().iter();
        grains.map(|grain| grain["VoxelCount"].as_u64().unwrap()).collect()
    };
    assert_eq!(counts("--min-ci 0.1 --min-iq 50 --min-voxels 2"), [60, 60]);
    assert_eq!(counts("--min-ci 0.1 --min-iq 50 --min-voxels 2 --min-pore 6"), [54, 60]);
    assert_eq!(counts("--min-ci 0.1 --min-iq 50 --min-voxels 2 --min-pore 7"), [60, 60]);
    assert_eq!(counts("--min-ci 0.1 --min-iq 50"), [59, 60, 1]);
    // The points of the mask are of the first orientation else, 10 degrees from both.
    assert_eq!(counts("").len(), 5);
    assert_eq!(counts("--threshold 25 --min-voxels 2"), [120]);
    // Rows of a part count from the top.
    assert_eq!(counts("--min-ci 0.1 --min-iq 50 --crop 0:12,6:9 --min-voxels 2"), [18, 18]);
    assert_eq!(counts("--min-ci 0.1 --min-iq 50 --crop 3:9,7:8 --min-voxels 1"), [1, 2, 3]);
}

#[test]
fn spread_tells_where_orientations_drift() {
    let workplace = Workplace::new();
    // One degree from column to column: no two neighbours differ by 5.
    let drift = |column: u32, _| ([f64::from(column), 0.0, 0.0], GOOD);
    workplace.put("a.ang", ang(HEAD, square([31, 4], 1.0, drift)));
    let said = workplace.run("smooth a.ang -o a.vtp --stats a.csv");
    // The mean of |k| for k from -15 to 15.
    assert!(
        line(&said, "spread")
            .starts_with("7.74 degrees from the mean orientation (GOS), at most 7.74; 1 grain above 5"),
        "{said}"
    );
    let table = text(&workplace, "a.csv");
    let [names, row] = [0, 1].map(|at| table.lines().nth(at).unwrap().split(',').collect::<Vec<_>>());
    let value = |name: &str| row[names.iter().position(|other| *other == name).unwrap()];
    let spread: f64 = value("GOS").parse().unwrap();
    assert!((spread - 240.0 / 31.0).abs() < 1e-4, "{spread}");
    let angles: Vec<f64> = value("EulerAngles").split(' ').map(|angle| angle.parse().unwrap()).collect();
    assert!((angles[0] + angles[2] - 15.0).abs() < 1e-4 && angles[1].abs() < 1e-4, "{angles:?}");
    assert_eq!(value("VoxelCount"), "124");
    assert!(line(&workplace.run("smooth a.ang --threshold 0.5 -o a.vtp"), "map").contains("in 31 grains"));
}

#[test]
fn twins_become_one_grain_and_crystals_are_turned() {
    let workplace = Workplace::new();
    // Of an fcc crystal: 60 degrees about [111], in Bunge's angles, and in another of its 24 forms.
    let twin = [45.0, 70.528_779_365_509_31, 45.0];
    let three = |column: u32, _: u32| {
        let angles = match column {
            0..6 => [0.0; 3],
            6..8 => twin,
            _ => [20.0, 0.0, 0.0],
        };
        (angles, GOOD)
    };
    workplace.put("a.ang", ang(HEAD, square([12, 6], 1.0, three)));
    let grains = |options: &str| {
        let said = workplace.run(&format!("smooth a.ang {options} -o a.vtp --stats a.json"));
        let statistics = workplace.json("a.json");
        (said, statistics["grains"].as_array().unwrap().clone())
    };
    assert_eq!(grains("").1.len(), 3);
    let (said, merged) = grains("--merge-twins 60,1,1,1");
    assert!(line(&said, "map").contains("in 2 grains, after 1 twins became one with others"), "{said}");
    assert_eq!([&merged[0]["VoxelCount"], &merged[1]["VoxelCount"]], [48, 24]);
    // Of the larger part.
    assert!((merged[0]["Quaternion"][0].as_f64().unwrap() - 1.0).abs() < 1e-9, "{}", merged[0]);
    assert_eq!(grains("--merge-twins 50,1,1,1").1.len(), 3);
    assert_eq!(grains("--merge-twins 50,1,1,1 --twin-tolerance 10.5").1.len(), 2);
    // A turn of the sample about z adds to phi1.
    let (_, turned) = grains("--rotate 30,0,0,2");
    let sum = |grain: &serde_json::Value| {
        grain["EulerAngles"][0].as_f64().unwrap() + grain["EulerAngles"][2].as_f64().unwrap()
    };
    assert!((sum(&turned[0]) - 30.0).abs() < 1e-3 && (sum(&turned[2]) - 50.0).abs() < 1e-3, "{turned:?}");
}

#[test]
fn old_maps_have_the_fit_before_the_phase() {
    let workplace = Workplace::new();
    let head = format!("{HEAD}# Phase 2\n# Symmetry 62\n");
    let row = |column: u32, phase: u32| format!("0.1 0.2 0.3 {column}.0 0.0 50.0 0.9 1.25 {phase}\n");
    let rows: String = (0..8).map(|column| row(column, 1 + column / 4)).collect();
    workplace.put("a.ang", format!("{head}{rows}"));
    let found = read(&workplace, "a.ang", &MapOptions::default());
    let crystals = found.crystals.unwrap();
    assert_eq!(crystals.phase_of, [0, 1]);
    assert_eq!(crystals.phases[0].0, "Nickel");
    // Where there are several phases, 0 is none of them.
    let rows: String = (0..8).map(|column| row(column, column / 4)).collect();
    workplace.put("b.ang", format!("{head}{rows}"));
    let found = read(&workplace, "b.ang", &MapOptions::default()).crystals.unwrap();
    assert_eq!((found.points.unsolved, found.phase_of), (4, vec![0]));
}

#[test]
fn maps_that_orix_writes_are_read() {
    let workplace = Workplace::new();
    let program = r#"
import numpy as np
from orix.crystal_map import CrystalMap, Phase, PhaseList
from orix.io import save
from orix.quaternion import Rotation
columns, rows = 12, 9
x, y = np.meshgrid(np.arange(columns) * 0.25, np.arange(rows) * 0.25)
grain = (x >= 1).astype(int) + 2 * (y >= 1)
euler = np.radians(np.array([[10, 20, 30], [100, 50, 20], [10, 60, 30], [200, 20, 80]], float))[grain.ravel()]
phases = PhaseList(Phase("nickel", point_group="m-3m"))
made = CrystalMap(rotations=Rotation.from_euler(euler), x=x.ravel(), y=y.ravel(), phase_list=phases,
    prop={"ci": np.full(x.size, 0.8), "iq": np.full(x.size, 90.0), "fit": np.full(x.size, 0.5)})
save("a.ang", made, confidence_index_prop="ci", image_quality_prop="iq", pattern_fit_prop="fit")
"#;
    let mut python = std::process::Command::new("python3");
    python.args(["-c", program]).current_dir(workplace.path(""));
    let Some(output) = programs::run("maps_that_orix_writes_are_read", &mut python) else { return };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found = read(&workplace, "a.ang", &MapOptions::default());
    assert_eq!((found.voxel_counts, found.map.shape), (vec![16, 32, 20, 40], [12, 9, 1]));
    let angles =
        found.crystals.unwrap().orientations.iter().map(|one| one.euler_degrees()).collect::<Vec<_>>();
    let expected = [[10.0, 20.0, 30.0], [100.0, 50.0, 20.0], [10.0, 60.0, 30.0], [200.0, 20.0, 80.0]];
    let errors = angles.as_flattened().iter().zip(expected.as_flattened()).map(|(a, b)| (a - b).abs());
    assert!(errors.fold(0.0, f64::max) < 1e-2, "{angles:?}");
}

#[test]
fn maps_without_a_grid_or_what_they_need_are_refused() {
    let workplace = Workplace::new();
    let flat = |_: u32, _: u32| ([0.0; 3], GOOD);
    let points: Vec<Point> = square([6, 5], 1.0, flat).collect();
    let mut twice = points.clone();
    twice[9].0 = twice[8].0;
    let mut off = points.clone();
    off[9].0[0] += 0.45;
    let spiral = (1..200).map(|at| {
        let at = f64::from(at);
        ([at.sqrt() * at.cos(), at.sqrt() * at.sin()], [0.0; 3], GOOD)
    });
    let no_symmetry = "# Phase 1\n# MaterialName  Nickel\n";
    let none = |_: u32, _: u32| NONE;
    let ctf =
        "Channel Text File\nPhases\t1\n1;1;1\t90;90;90\tIron\t11\nPhase\tX\tY\tEuler1\tEuler2\tEuler3\n";
    for (name, content, options, said) in [
        (
            "a.ang",
            ang(HEAD, twice),
            "",
            "line 20: the point stands where that of line 19 does; give a map whose points lie on one square or hexagonal grid",
        ),
        ("a.ang", ang(HEAD, off), "", "line 20: the point stands off the grid of the others; give"),
        ("a.ang", ang(HEAD, spiral), "", "line 11: the point and those behind it stand on no grid; give"),
        (
            "a.ang",
            ang(no_symmetry, points.clone()),
            "",
            "does not give the symmetry of Nickel; give it with --crystal-symmetry, such as cubic",
        ),
        (
            "a.ang",
            ang(HEAD, square([6, 5], 1.0, none)),
            "",
            "has no grain of 1 or more voxels besides the exterior",
        ),
        (
            "a.ang",
            ang(HEAD, points.clone()),
            "--min-ci 1",
            "has no grain of 1 or more voxels besides the exterior",
        ),
        (
            "a.ang",
            ang(HEAD, points.clone()),
            "--crop 0:7,0:3",
            "has 6 voxels along x; --crop asks for 0:7; give a part of 0:6",
        ),
        (
            "a.ang",
            ang(HEAD, points.clone()),
            "--exterior-label 0",
            "is a map of orientations; leave --exterior-label out",
        ),
        (
            "a.ang",
            format!("{HEAD}0.1 0.2 0.3 1 2 x 0.5 1\n"),
            "",
            "line 11: 'x' is not a finite number; correct it or remove the line",
        ),
        ("a.ang", format!("{HEAD}0.1 0.2 0.3 1 2 3 0.5\n"), "", "line 11: 7 columns; TSL's maps have"),
        (
            "a.ctf",
            "Channel Text File\n".to_owned(),
            "",
            "line 1: no line names the columns Phase, Euler1, Euler2 and Euler3; give a whole .ctf file",
        ),
        (
            "a.ctf",
            format!("{ctf}1\t0\t0\t1\t2\t3\n1\t1\t0\t1\t2\n"),
            "",
            "line 6: fewer columns than names; write one for each name on each line",
        ),
        (
            "a.ctf",
            format!("{ctf}1\t0\t0\t1\t2\t3\n"),
            "--min-ci 0.1",
            "its points have no confidence index; leave --min-ci out",
        ),
        (
            "a.ctf",
            format!("{ctf}2\t0\t0\t1\t2\t3\n"),
            "",
            "line 5: the point has phase 2, which its head does not list",
        ),
    ] {
        workplace.put(name, content);
        workplace.refuses(
            &format!("smooth {name} {options} -o out.vtp"),
            FAILED,
            &format!("{name}: {said} ... "),
        );
    }
    workplace.put("a.npy", b"");
    for (arguments, said) in [
        (
            "smooth a.ang --merge-twins 60,1,1 -o out.vtp",
            "invalid value '60,1,1' for '--merge-twins <DEGREES,X,Y,Z>': give an angle in degrees and an axis, as in 60,1,1,1",
        ),
        (
            "smooth a.ang --rotate 60,0,0,0 -o out.vtp",
            "invalid value '60,0,0,0' for '--rotate <DEGREES,X,Y,Z>': give an angle in degrees and an axis, as in 60,1,1,1",
        ),
        (
            "smooth a.ang --threshold 200 -o out.vtp",
            "invalid value '200' for '--threshold <DEGREES>': give an angle from 0 to 180 degrees",
        ),
        (
            "smooth a.ang --twin-tolerance 2 -o out.vtp",
            "the following required arguments were not provided: ... ",
        ),
    ] {
        workplace.refuses(arguments, USAGE, said);
    }
    workplace.refuses(
        "smooth a.npy --threshold 2 -o out.vtp",
        FAILED,
        "a.npy: is a map of labels; leave --threshold out",
    );
}

#[test]
fn damaged_orientation_maps_are_refused_or_read() {
    let workplace = Workplace::new();
    let three =
        |column: u32, row: u32| ([f64::from(20 * (column / 4)), f64::from(15 * (row / 5)), 0.0], GOOD);
    let points: Vec<Point> = square([12, 10], 0.5, three).collect();
    let ctf: String = points
        .iter()
        .map(|([x, y], [a, b, c], _)| format!("1\t{x}\t{y}\t8\t0\t{a}\t{b}\t{c}\t0.5\t100\t200\n"))
        .collect();
    let ctf_head = "Channel Text File\nXCells\t12\nYCells\t10\nXStep\t0.5\nPhases\t1\n1;1;1\t90;90;90\tIron\t11\t0\nPhase\tX\tY\tBands\tError\tEuler1\tEuler2\tEuler3\tMAD\tBC\tBS\n";
    for (name, whole) in [("a.ang", ang(HEAD, points)), ("a.ctf", format!("{ctf_head}{ctf}"))] {
        workplace.put(name, &whole);
        assert_eq!(read(&workplace, name, &MapOptions::default()).labels.len(), 6);
        let mut generator = ChaCha8Rng::seed_from_u64(5);
        let mut place = |within: usize| usize::try_from(generator.next_u64() % within as u64).unwrap();
        let mut refused = 0;
        for round in 0..200 {
            let mut bytes = whole.clone().into_bytes();
            let at = place(bytes.len());
            match round % 4 {
                0 => bytes.truncate(at),
                1 => bytes[at] ^= 1 << place(8),
                2 => bytes[at] = b"0123456789-.e \t\n"[place(16)],
                // A run of bytes is lost.
                _ => drop(bytes.drain(at..(at + 40).min(whole.len()))),
            }
            workplace.put(name, &bytes);
            match read_map(&workplace.path(name), &MapOptions::default()) {
                Ok(map) => {
                    assert_eq!(map.map.labels.len(), map.map.shape.iter().product::<usize>());
                    // At most as many as for the points.
                    assert!(map.map.labels.len() <= 4 * 120 + 4);
                }
                Err(error) => {
                    refused += 1;
                    assert!(!error.to_string().contains('\n'), "{error}");
                }
            }
        }
        assert!(refused > 20, "{name}: {refused}");
    }
}
