//! `--config`: options from a file, and runs that are run again.

use std::fs;

use crate::surface_file::SurfaceFile;
use crate::workplace::{USAGE, Workplace};

#[test]
fn files_run_their_run_again() {
    let solid = "--seeds 5 --rng-seed 12345678901234567890 --box 2 1 0.5 --periodic x --edge-length 0.4 --relax 0.1 -n 1";
    let flat = "--dim 2 --seeding poisson-disc --seeds 6 --lloyd 1 --junctions corner -n 2 --voxels 9 8 --names neper";
    let walls = "--lattice fcc 1 --faces plain -n 1";
    for (name, arguments) in [
        ("a.vtp", solid),
        ("a.vtu", solid),
        ("a.vtk", solid),
        ("a.vtm", solid),
        ("a.ply", solid),
        ("a.obj", solid),
        ("a.msh", solid),
        ("a.fe", walls),
        ("a.vti", flat),
        ("a.ang", flat),
        ("a.vtp", flat),
        ("a.npy", flat),
        ("a.inp", flat),
        ("a.tess", solid),
        ("a.vtu", &format!("{solid} --vtk-encoding base64")),
        ("a.vtp", &format!("{flat} --vtk-encoding zlib")),
        ("a.vti", &format!("{flat} --vtk-encoding zlib")),
        ("a.vtm", &format!("{solid} --vtk-encoding base64")),
        ("a.tess", flat),
    ] {
        let workplace = Workplace::new();
        workplace.run(&format!("{arguments} -o {name}"));
        let before = workplace.bytes(name);
        fs::create_dir(workplace.path("again")).unwrap();
        workplace.run(&format!("--config {name} -o again/{name} --threads 1"));
        assert!(workplace.bytes(&format!("again/{name}")) == before, "{name} of {arguments}");
    }
}

/// STL has room in the name of its solid only, for what differs from the default settings.
#[test]
fn stl_runs_its_run_again_where_it_has_room_for_it() {
    let workplace = Workplace::new();
    fs::create_dir(workplace.path("again")).unwrap();
    for arguments in ["--seeds 5 -n 1 --rng-seed 7", "--ascii --seeds 5 -n 0 --box 2 1 0.5 --lloyd 1"] {
        workplace.run(&format!("{arguments} -o a.stl"));
        workplace.run("--config a.stl -o again/a.stl");
        assert!(workplace.bytes("again/a.stl") == workplace.bytes("a.stl"), "{arguments}");
    }
    // A text has more of it.
    let long = "--seeds 5 -n 0 --box 2.123456789 1.123456789 0.5 --relax 0.123456789 --periodic x";
    workplace.run(&format!("{long} --ascii -o a.stl"));
    workplace.run("--config a.stl -o again/a.stl");
    assert!(workplace.bytes("again/a.stl") == workplace.bytes("a.stl"));
    workplace.run(&format!("{long} -o a.stl"));
    workplace.refuses(
        "--config a.stl",
        USAGE,
        "a.stl: holds no configuration, for which STL has little room; give a .toml file, or a .vtp or other file that grainsmooth wrote",
    );
}

#[test]
fn what_stands_beside_runs_its_run_again() {
    let workplace = Workplace::new();
    fs::create_dir(workplace.path("again")).unwrap();
    let beside = "--picture a.png --report a.html --stats a.json --json-summary b.json --cells-json c.json --series a.pvd";
    workplace.run(&format!("--seeds 4 -n 0 --rng-seed 3 --relax 0.1 -o a.msh {beside}"));
    for name in ["a.png", "a.html", "a.json", "b.json", "c.json", "a.pvd", "a.geo"] {
        workplace.run(&format!("--config {name} -o again/a.msh"));
        assert!(workplace.bytes("again/a.msh") == workplace.bytes("a.msh"), "{name}");
    }
    // A name with all that HTML and TOML have signs for.
    workplace.put("a<'&\">.csv", "0.3,0.5,0.5\n0.7,0.5,0.5\n");
    let folder = workplace.path("");
    let run = |arguments: &[&str]| {
        let mut program = assert_cmd::cargo::cargo_bin_cmd!("grainsmooth");
        program.current_dir(&folder).args(["-n", "0", "--quiet"]).args(arguments).assert().success();
    };
    run(&["--seeds-file", "a<'&\">.csv", "--report", "b.html", "-o", "b.vtp"]);
    run(&["--config", "b.html", "-o", "again/b.vtp"]);
    assert!(workplace.bytes("again/b.vtp") == workplace.bytes("b.vtp"));
}

#[test]
fn grains_of_a_directory_run_their_run_again() {
    let workplace = Workplace::new();
    for format in ["vtp", "ply", "obj", "stl"] {
        workplace.run(&format!("--seeds 4 -n 0 --grains-dir {format} --grains-format {format}"));
        let before = workplace.bytes("grains.vtp");
        workplace.run(&format!("--config {format}/grain_3.{format}"));
        assert!(workplace.bytes("grains.vtp") == before, "{format}");
    }
}

#[test]
fn keys_are_the_options_of_the_command_line() {
    let workplace = Workplace::new();
    workplace.put(
        "run.toml",
        "# a plate\nseeds = 7\nbox = [3, 1, 0.5]\nperiodic = \"x,y\"\nrelax = 1e-1\nlevels = 1\noutput = \"plate.vtp\"\n\
         drop-empty = false\nquiet = true\ncells-csv = 'plate.csv'\n",
    );
    assert_eq!(workplace.run("--config run.toml"), "");
    workplace.run("--seeds 7 --box 3 1 0.5 --periodic x,y --relax 0.1 -n 1");
    assert!(workplace.bytes("plate.vtp") == workplace.bytes("grains.vtp"));
    assert!(workplace.path("plate.csv").is_file());
}

#[test]
fn command_line_overrides_the_file() {
    let workplace = Workplace::new();
    workplace.put("run.toml", "seeds = 7\nrng-seed = 3\nedge-length = 0.5\nlevels = 0\n");
    for (given, same) in [
        ("--seeds 8", "--seeds 8 --rng-seed 3 --edge-length 0.5 -n 0"),
        ("-n 1 --faces plain", "--seeds 7 --rng-seed 3 --faces plain -n 1"),
        // What excludes a key of the file takes its place.
        ("--lattice bcc 1", "--lattice bcc 1 --edge-length 0.5 -n 0"),
    ] {
        workplace.run(&format!("{given} --config run.toml -o one.vtp"));
        workplace.run(&format!("{same} -o two.vtp"));
        assert!(workplace.bytes("one.vtp") == workplace.bytes("two.vtp"), "{given}");
    }
    workplace.put("lattice.toml", "lattice = ['sc', 2]\nlevels = 0\n");
    workplace.run("--config=lattice.toml --seeds 5 -o one.vtp");
    workplace.run("--seeds 5 -n 0 -o two.vtp");
    assert!(workplace.bytes("one.vtp") == workplace.bytes("two.vtp"));
}

#[test]
fn each_mistake_is_named_with_its_line() {
    let workplace = Workplace::new();
    for (content, message) in [
        ("\nseed = 3\n", "run.toml line 2: unknown key 'seed'; did you mean 'seeds'?"),
        ("seeds = 3\nrelaxation = 1\n", "run.toml line 2: unknown key 'relaxation'; did you mean 'relax'?"),
        (
            "zzz = 1",
            "run.toml line 1: unknown key 'zzz'; keys are the long names of the options that --help lists",
        ),
        (
            "# c\n\nseeds = -1\n",
            "run.toml line 3: invalid value '-1' for '--seeds <N>': give a whole number from 1 to 4000000000",
        ),
        (
            "seeds = 3.5",
            "run.toml line 1: invalid value '3.5' for '--seeds <N>': give a whole number from 1 to 4000000000",
        ),
        (
            "faces = 'fann'",
            "run.toml line 1: invalid value 'fann' for '--faces <RULE>'; tip: a similar value exists: 'fan'",
        ),
        ("quiet = 1", "run.toml line 1: 'quiet' is true or false"),
        ("box = [[1, 1], 1]", "run.toml line 1: 'box' is a decimal number, a text, or a list of them"),
        ("config = 'other.toml'", "run.toml line 1: unknown key 'config'; ... "),
        ("seeds = 3\nseeds = 4", "run.toml line 2: duplicate key"),
        ("seeds 3", "run.toml line 1: ... "),
        (
            "lattice = ['bcc', 2]\nseeds = 3",
            "the argument '--lattice <LATTICE> <N>' cannot be used with '--seeds <N>'",
        ),
        ("box = [1, 1]", "--box takes three numbers, X Y Z, without --dim 2; 2 given"),
    ] {
        workplace.put("run.toml", content);
        workplace.refuses("--config run.toml", USAGE, message);
    }
    workplace.put("run.toml", [0xff, 0xfe]);
    workplace.refuses("--config run.toml", USAGE, "run.toml: is not UTF-8 text; save it as UTF-8");
    workplace.refuses(
        "--config grains.vtp",
        USAGE,
        "grains.vtp: holds no configuration; give a .toml file, or a .vtp or other file that grainsmooth wrote",
    );
    workplace.refuses(
        "--config none.toml",
        USAGE,
        "none.toml: cannot be read: ... ; give the path of a readable file",
    );
}

#[test]
fn truncated_and_corrupt_files_are_refused_or_read() {
    let workplace = Workplace::new();
    workplace.run("--seeds 2 -n 0 -o whole.vtp");
    let whole = workplace.bytes("whole.vtp");
    let begin = whole.windows(15).position(|window| window == b"# grainsmooth c").unwrap();
    for (name, content) in [("cut.toml", &whole[begin..begin + 420]), ("cut.vtp", &whole[..])] {
        for round in 0..12 {
            let mut content = content.to_vec();
            // Into the configuration, at places that are far apart and not at regular ones.
            let at = (if name == "cut.vtp" { begin } else { 0 }) + round * 31 % 400;
            match round % 3 {
                0 => content.truncate(at),
                1 => content[at] ^= 0x80,
                _ => content[at] = b"=['\n"[round % 4],
            }
            workplace.put(name, content);
            let code = workplace.command(&format!("--config {name}")).output().unwrap().status.code();
            assert!(matches!(code, Some(0 | 1 | USAGE)), "{name} {round}: {code:?}");
        }
    }
}

/// A file that was relaxed carries the length to regularise by; without relaxation that moves nothing.
#[test]
fn relax_0_keeps_all_flat_whatever_else_is_set() {
    let workplace = Workplace::new();
    workplace.run("--seeds 20 -n 1 -o smooth.vtp");
    let said = workplace.run("--config smooth.vtp --relax 0 -o flat.vtp");
    assert!(!said.contains("collapsed"), "{said}");
    let said = workplace.run("--seeds 20 -n 1 --relax 0 --regularize 0.2 -o as_flat.vtp");
    assert!(!said.contains("collapsed"), "{said}");
    let [flat, as_flat] = ["flat.vtp", "as_flat.vtp"].map(|name| SurfaceFile::read(&workplace.path(name)));
    assert_eq!(flat.points, as_flat.points);
}
