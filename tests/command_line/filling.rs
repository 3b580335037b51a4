//! Grains that are filled through Gmsh, and what is told of those that it cannot fill.

#![cfg(unix)]

use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;

use crate::programs::skip;
use crate::workplace::{FAILED, Workplace};

/// Runs the next Gmsh on the path, but refuses several grains at a time, and single ones in the runs that `REFUSED` lists.
const HALTING_GMSH: &str = r#"#!/bin/sh
if [ "$1" != --version ]; then
    if grep -q '^Volume(2)' surface.geo; then echo 'Error : too many'; exit 1; fi
    echo >> "$RUNS"
    case " $REFUSED " in *" $(wc -l < "$RUNS" | tr -d ' ') "*) echo 'Error : too hard'; exit 1;; esac
fi
PATH=${PATH#*:} exec gmsh "$@"
"#;

#[test]
fn grains_that_cannot_be_filled_are_named_and_all_others_are_filled() {
    if let Err(error) = grainsmooth::check_gmsh() {
        return skip("grains_that_cannot_be_filled_are_named_and_all_others_are_filled", &error.to_string());
    }
    let workplace = Workplace::new();
    let programs = tempfile::tempdir().unwrap();
    let gmsh = programs.path().join("gmsh");
    fs::write(&gmsh, HALTING_GMSH).unwrap();
    fs::set_permissions(&gmsh, Permissions::from_mode(0o755)).unwrap();
    let network = "--seeds 4 -n 1 --elements-per-grain 2";
    let command = |refused: &str| {
        let mut command = workplace.command(&format!("{network} -o a.inp"));
        let runs = programs.path().join("runs");
        fs::write(&runs, "").unwrap();
        let path = format!("{}:{}", programs.path().display(), std::env::var("PATH").unwrap());
        command.envs([("PATH", path.as_str()), ("REFUSED", refused)]).env("RUNS", runs);
        command
    };
    // Grains 1 and 3 by either algorithm.
    workplace.refuses_command(
        &mut command("2 3 5 6"),
        FAILED,
        "Gmsh cannot fill grains 1, 3: with Delaunay, Gmsh says `Error : too hard`; give elements of another size with --elements-per-grain, or write each surface alone: the same command with --grains-dir surfaces in place of -o and of options of volume meshes",
    );
    workplace.run(&format!("{network} --grains-dir surfaces"));
    assert!(workplace.path("surfaces/grain_1.vtp").exists());
    // None: what Gmsh cannot fill at a time is filled grain by grain.
    command("").assert().success();
    workplace.command("check a.inp").assert().success();
}

/// In a box thinner than an element, edges of the network lead from a point to its own copy. Their bent middles were once written half a chord away from those of their copies.
#[test]
fn middles_of_edges_once_around_a_thin_box_are_tied_where_they_are() {
    let test = "middles_of_edges_once_around_a_thin_box_are_tied_where_they_are";
    if let Err(error) = grainsmooth::check_gmsh() {
        return skip(test, &error.to_string());
    }
    let workplace = Workplace::new();
    for seed in [1, 2, 4] {
        let grains = format!("--seeds 8 --rng-seed {seed} --periodic x,z --box 1 1 0.15 -n 1");
        let elements = "--elements-per-grain 1 --small-features merge --order 2 --volume-mesh -o a.vtu";
        workplace.run(&format!("{grains} {elements}"));
        workplace.command("check a.vtu").assert().success();
    }
}
