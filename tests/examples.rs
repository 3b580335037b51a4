//! Every example runs, and prints what it promises.

use std::path::Path;
use std::process::Command;

/// Runs an example, which a plain `cargo test` has built, and checks that it prints some words.
#[track_caller]
fn prints(example: &str, expected: &str) {
    let program = Path::new(env!("CARGO_BIN_EXE_grainsmooth")).with_file_name("examples").join(example);
    let output = Command::new(&program)
        .output()
        .unwrap_or_else(|error| panic!("{}: {error}; `cargo build --examples` makes it", program.display()));
    let [printed, errors] =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(output.status.success(), "{example}: {errors}");
    assert!(printed.contains(expected), "{example} prints no {expected:?} but {printed:?}");
}

#[test]
fn print_what_they_promise() {
    prints("bezier_circle", "farthest from the circle: 2.7");
    prints("catmull_clark_cube", "corner after one step: 0.555556\ncorner in the limit:   0.500000");
    prints("limit_of_tetrahedron", "level 8: 0.2000");
    prints("symmetry_of_a_cube", "diagonals split: 0.000000");
    prints(
        "topology_once",
        "control points up to 1: surface up to 0.436584\ncontrol points up to 2: surface up to 0.873168",
    );
    prints("flat_stays_flat", "--relax 1.2: boundaries bulge by up to 7.9e-2");
    prints("move_control_points", "moved by 1.00: boundaries have an area of");
    prints("mean_faces", "inner cells: 15.5");
}
