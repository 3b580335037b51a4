//! Every example runs, and prints what it promises.

use std::process::Command;

/// Runs an example and checks that it prints some words.
#[track_caller]
fn prints(example: &str, expected: &str) {
    let output = Command::new(env!("CARGO"))
        .args(["run", "--quiet", "--example", example])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo starts");
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
    prints("topology_once", "66 points from 6, 128 triangles");
    prints("flat_stays_flat", "--relax 0: boundaries bulge by up to");
    prints("mean_faces", "mean faces of");
}
