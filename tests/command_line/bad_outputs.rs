use std::fs;
use std::io::Write;

use crate::workplace::{FAILED, USAGE, Workplace};

/// So many that computing them would outlast the test: a bad path must be found before.
const BEFORE_COMPUTING: &str = "--seeds 100000 -n 0";

#[test]
fn extension_that_names_no_format() {
    let workplace = Workplace::new();
    let known = "*.vtp, *.vtu, *.vtk, *.vtm, *.stl, *.ply, *.obj, *.msh, *.fe, *.tess, *.vti, *.npy or *.ang";
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
    let message =
        "grains.vtp: cannot be written: the present file is read-only; allow it or choose another path";
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

/// A real full disk, of 64 kB, in a name space of our own.
#[cfg(target_os = "linux")]
#[test]
fn full_disk() {
    let workplace = Workplace::new();
    let in_name_space = |script: &str| {
        let mut unshare = assert_cmd::Command::new("unshare");
        unshare.current_dir(workplace.path("")).args(["--user", "--map-root-user", "--mount", "sh", "-c"]);
        unshare.arg(format!("mkdir -p disk && mount -t tmpfs -o size=64k none disk && {script}"));
        unshare.arg(workplace.command("").get_program());
        unshare
    };
    if in_name_space("true").ok().is_err() {
        // Not through `eprintln`, which the test harness keeps to itself.
        writeln!(std::io::stderr(), "SKIPPED full_disk: no file system can be mounted here").unwrap();
        return;
    }
    let script = "echo old > disk/grains.vtp; \"$0\" --seeds 30 -n 2 -o disk/grains.vtp; code=$?; ls -A disk >&2; cat disk/grains.vtp >&2; exit $code";
    let output = in_name_space(script).assert().code(FAILED).stdout("").get_output().clone();
    let said = String::from_utf8(output.stderr).unwrap();
    let lines: Vec<&str> = said.lines().collect();
    assert!(
        lines[0].starts_with("error: disk/grains.vtp: writing failed and left nothing: No space left"),
        "{said}"
    );
    assert!(lines[0].ends_with("; make room or choose another path"), "{said}");
    assert_eq!(lines[1..], ["grains.vtp", "old"], "the old file stays and nothing else is left");
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
