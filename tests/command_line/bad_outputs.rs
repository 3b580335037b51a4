use std::fs;

use grainsmooth::OutputFormat;

use crate::workplace::{FAILED, USAGE, Workplace};

/// So many that computing them would outlast the test: a bad path must be found before.
const BEFORE_COMPUTING: &str = "--seeds 100000 -n 0";

#[test]
fn extension_that_names_no_format() {
    let workplace = Workplace::new();
    let known = OutputFormat::known_extensions();
    for name in ["grains.off", "grains", "vtp", ".vtp", "grains.vtp.gz"] {
        let message =
            format!("invalid value '{name}' for '--output <PATH>': unknown extension; name the file {known}");
        workplace.refuses(&format!("{BEFORE_COMPUTING} -o {name}"), USAGE, &message);
    }
}

#[test]
fn directory_that_does_not_exist() {
    let message = "no/such/grains.vtp: no directory no/such; create it or choose another path";
    Workplace::new().refuses(&format!("{BEFORE_COMPUTING} -o no/such/grains.vtp"), FAILED, message);
}

#[test]
fn path_that_is_a_directory() {
    let workplace = Workplace::new();
    fs::create_dir(workplace.path("folder.vtp")).unwrap();
    let message = "folder.vtp: is not a regular file; choose another path";
    workplace.refuses(&format!("{BEFORE_COMPUTING} -o folder.vtp"), FAILED, message);
}

#[test]
fn file_that_is_read_only() {
    let workplace = Workplace::new();
    let mut permissions = fs::metadata(workplace.path("grains.vtp")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(workplace.path("grains.vtp"), permissions).unwrap();
    let message = "grains.vtp: cannot be written: the present file is read-only; make it writable or choose another path";
    workplace.refuses(BEFORE_COMPUTING, FAILED, message);
}

/// The shell forbids files above a few kilobytes, as a quota would; the program is told and goes on to say so.
#[cfg(unix)]
#[test]
fn file_system_that_takes_no_more() {
    let workplace = Workplace::new();
    let program = workplace.command("").get_program().to_owned();
    let mut shell = assert_cmd::Command::new("sh");
    shell
        .current_dir(workplace.path(""))
        .arg("-c")
        .arg("trap '' XFSZ; ulimit -f 8; exec \"$0\" --seeds 30 -n 2");
    let message = "grains.vtp: writing failed and left nothing: ... ; make room or choose another path";
    workplace.refuses_command(shell.arg(program), FAILED, message);
}

/// As above; the report, which comes after all else, is what is too large.
#[cfg(unix)]
#[test]
fn failure_of_the_last_output_leaves_none_of_the_others() {
    let workplace = Workplace::new();
    workplace.put("stats.csv", "kept");
    let program = workplace.command("").get_program().to_owned();
    let others = "-o grains.vtp -o a.msh -o a.vtm -o a.vti --voxels 4 4 4 --cells-json a.json --cells-csv a.csv \
                  --stats stats.csv --grains-dir each --series a.pvd --picture a.png --picture-size 32 32";
    let mut shell = assert_cmd::Command::new("sh");
    shell.current_dir(workplace.path("")).arg("-c");
    shell.arg(format!(
        "trap '' XFSZ; ulimit -f 400; exec \"$0\" --seeds 3 -n 0 --relax 0.01 {others} --report a.html"
    ));
    let message = "a.html: writing failed and left nothing: ... ; make room or choose another path";
    workplace.refuses_command(shell.arg(&program), FAILED, message);
    // What is said on standard output comes last.
    let mut shell = assert_cmd::Command::new("sh");
    shell.current_dir(workplace.path("")).arg("-c");
    shell.arg(format!("exec \"$0\" --seeds 3 -n 0 --relax 0.01 {others} --json-summary - > /dev/full"));
    let message = "standard output: writing failed and left nothing: ... ; make room or choose another path";
    if cfg!(target_os = "linux") {
        workplace.refuses_command(shell.arg(&program), FAILED, message);
    }
    // All that is too much for the report is room enough for the others.
    workplace.run(&format!("--seeds 3 -n 0 --relax 0.01 {others}"));
}

#[test]
fn tables_of_a_run_that_fails_after_its_cells_are_not_left() {
    let workplace = Workplace::new();
    workplace.put("seeds.csv", "0.2,0.3,0.4\n0.7,0.6,0.5\n0.4,0.8,0.3\n");
    workplace.put("cells.csv", "kept");
    let arguments = "--seeds-file seeds.csv -n 14 --cells-csv cells.csv --cells-json cells.json";
    workplace.refuses(arguments, FAILED, "14 levels would ... levels would fit");
}

#[test]
fn two_outputs_of_one_path() {
    let workplace = Workplace::new();
    let message = |name: &str| format!("{name}: two outputs have this path; give each a path of its own");
    for (arguments, name) in [
        ("-o a.vtp -o a.vtp", "a.vtp"),
        ("-o a.vtp -o ./a.vtp", "a.vtp"),
        ("-o a.ply --cells-csv a.ply", "a.ply"),
        ("--stats a.csv --cells-csv a.csv", "a.csv"),
        ("--stats a.csv --cells-csv a.boundaries.csv", "a.boundaries.csv"),
        ("--cells-json a.json --json-summary a.json", "a.json"),
        ("-o a.msh --cells-csv a.geo", "a.geo"),
        ("-o a.vtm --grains-dir a", "a"),
    ] {
        workplace.refuses(&format!("{BEFORE_COMPUTING} {arguments}"), USAGE, &message(name));
    }
    // Steps of a series are counted when they are there.
    let steps = "--seeds 2 -n 0 --relax 0.01 --series a.pvd -o a_0001.vtp";
    workplace.refuses(steps, FAILED, &message("a_0001.vtp"));
    let message = "two outputs go to standard output; give one of them a path";
    workplace.refuses(&format!("{BEFORE_COMPUTING} -o - -o -"), USAGE, message);
}

#[test]
fn script_of_a_gmsh_mesh_that_cannot_be_written() {
    let workplace = Workplace::new();
    fs::create_dir(workplace.path("a.geo")).unwrap();
    let message = "a.geo: is not a regular file; choose another path";
    workplace.refuses(&format!("{BEFORE_COMPUTING} -o a.msh"), FAILED, message);
}

/// A disk that is full, as Linux has one everywhere, fails the last of all outputs: none of the others is left, and old files stay.
#[cfg(target_os = "linux")]
#[test]
fn full_disk() {
    let workplace = Workplace::new();
    workplace.put("grains.vtp", "old");
    let outputs = "-o grains.vtp -o - --format vtp --stats a.json --cells-csv a.csv --report a.html";
    let mut shell = assert_cmd::Command::new("sh");
    shell.current_dir(workplace.path("")).arg("-c");
    shell.arg(format!("exec \"$0\" --seeds 5 -n 0 {outputs} > /dev/full"));
    let message = "standard output: writing failed and left nothing: No space left on device ... ; make room or choose another path";
    workplace.refuses_command(shell.arg(workplace.command("").get_program()), FAILED, message);
}

#[test]
fn format_that_cannot_hold_the_grains() {
    let workplace = Workplace::new();
    for name in ["a.stl", "a.ply", "a.obj", "a.msh", "a.fe"] {
        let message = format!("{name}: this format holds 3D grains only; choose another, such as .vtp");
        workplace.refuses(&format!("{BEFORE_COMPUTING} --dim 2 -o {name}"), FAILED, &message);
    }
    let message = "a.ang: this format holds 2D grains only; choose another, such as .vtp";
    workplace.refuses(&format!("{BEFORE_COMPUTING} -o a.ang --voxels 2 2 2"), FAILED, message);
    for name in ["a.vti", "a.npy"] {
        let message = format!(
            "{name}: this format holds voxels; give their number with --voxels NX NY NZ (NX NY in 2D)"
        );
        workplace.refuses(&format!("{BEFORE_COMPUTING} -o {name}"), FAILED, &message);
    }
    workplace.refuses(
        &format!("{BEFORE_COMPUTING} -o a.vti --voxels 4 4"),
        USAGE,
        "--voxels takes three numbers, NX NY NZ, without --dim 2; 2 given",
    );
}

/// The number of bytes is known before anything is computed.
#[test]
fn voxels_that_the_disk_has_no_room_for() {
    let workplace = Workplace::new();
    for name in ["a.vti", "a.npy"] {
        let message = format!(
            "{name}: would take 1.1 PB and ... are free there; use fewer voxels or choose another path"
        );
        let arguments = format!("{BEFORE_COMPUTING} --voxels 65536 65536 65536 -o {name}");
        workplace.refuses(&arguments, FAILED, &message);
    }
}

#[test]
fn directory_of_grains_that_is_taken() {
    let workplace = Workplace::new();
    for name in ["taken", "grains.vtp"] {
        if name == "taken" {
            fs::create_dir(workplace.path(name)).unwrap();
            workplace.put("taken/file", "");
        }
        let message = format!("{name}: is not an empty directory; remove it or choose another path");
        workplace.refuses(&format!("{BEFORE_COMPUTING} --grains-dir {name}"), FAILED, &message);
    }
    let message = "no/such: no directory no; create it or choose another path";
    workplace.refuses(&format!("{BEFORE_COMPUTING} --grains-dir no/such"), FAILED, message);
}
