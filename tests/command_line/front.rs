//! What the program prints besides its summary: dry runs, summaries for programs, completions, the manual, files on standard
//! output; and colours.

use std::collections::BTreeMap;
use std::io::Read;
use std::process::Stdio;

use grainsmooth::OutputFormat;
use serde_json::Value;

use crate::workplace::{FAILED, USAGE, Workplace};

pub fn printed(workplace: &Workplace, arguments: &str) -> Vec<u8> {
    workplace.command(arguments).assert().success().get_output().stdout.clone()
}

pub fn text(workplace: &Workplace, arguments: &str) -> String {
    String::from_utf8(printed(workplace, arguments)).unwrap()
}

/// The estimate once took boundaries for as coarse as `-n` asks for, a quarter of what equilibrium gives them at `-n 1`.
#[test]
fn dry_run_knows_how_fine_arcs_are() {
    let workplace = Workplace::new();
    for levels in [0, 1, 3, 6] {
        let arguments = format!("--dim 2 --seeds 100 -n {levels} --relax equilibrium -o a.vtp");
        let foretold = text(&workplace, &format!("{arguments} --dry-run"));
        assert!(foretold.contains("\nsegments    about "), "{foretold}");
        let segments = foretold.split_once("segments    about ").unwrap().1.split_once('\n').unwrap().0;
        workplace.run(&format!("{arguments} --json-summary run.json"));
        let run = workplace.json("run.json");
        let share = segments.parse::<f64>().unwrap() / run["elements"].as_f64().unwrap();
        assert!((0.8..1.25).contains(&share), "{foretold}, but {}", run["elements"]);
    }
}

#[test]
fn dry_run_foretells_elements_of_a_size() {
    let workplace = Workplace::new();
    for (arguments, elements) in [
        ("--seeds 60 --dim 2 --elements-per-grain 6 -o a.vtp", "segments"),
        ("--seeds 20 -n 2 --elements-per-grain 4 -o a.vtp", "triangles"),
    ] {
        let foretold = text(&workplace, &format!("{arguments} --dry-run"));
        let number = |line: &str| -> f64 {
            let line = foretold.lines().find(|text| text.starts_with(line)).unwrap();
            line.split_whitespace().find_map(|word| word.parse().ok()).unwrap()
        };
        workplace.run(&format!("{arguments} --json-summary run.json"));
        let run = workplace.json("run.json");
        let is_near = |foretold: f64, made: &Value| (foretold / made.as_f64().unwrap() - 1.0).abs() < 0.2;
        assert!(is_near(number(elements), &run["elements"]), "{foretold} {}", run["elements"]);
        if elements == "segments" {
            assert!(is_near(number("filled"), &run["filled"]["count"]), "{foretold} {}", run["filled"]);
        }
    }
}

#[test]
fn dry_run_foretells_the_run_and_writes_nothing() {
    let workplace = Workplace::new();
    for arguments in [
        "--seeds 30 -n 2 --regularize 0 -o a.vtp",
        "--seeds 30 -n 2 -o a.vtp",
        "--seeds 30 -n 2 -o a.vtu",
        "--seeds 30 -n 2 -o a.vtk",
        "--seeds 30 -n 2 -o a.stl",
        "--seeds 30 -n 2 -o a.ply",
        "--seeds 30 -n 2 -o a.obj",
        "--seeds 30 -n 2 -o a.msh",
        "--seeds 30 -n 2 -o a.fe",
        "--seeds 90 --dim 2 --relax 0.3 -n 4 -o a.vtp",
        "--seeds 30 --periodic x,y,z --faces plain -n 2 -o a.vtp",
        "--seeds 300 -n 0 -o a.tess",
    ] {
        let foretold = text(&workplace, &format!("{arguments} --dry-run"));
        let name = arguments.split(' ').next_back().unwrap();
        assert!(!workplace.path(name).exists(), "{arguments}");
        let said = workplace.run(&format!("{arguments} --json-summary run.json"));
        let run = workplace.json("run.json");
        let number = |line: &str| -> u64 {
            let line = foretold.lines().find(|text| text.starts_with(line)).unwrap();
            line.split_whitespace().find_map(|word| word.parse().ok()).unwrap()
        };
        let elements = if arguments.contains("--dim 2") { "segments" } else { "triangles" };
        assert_eq!(run["grains"], number("grains"), "{said}");
        // In space, relaxation decides what regularisation takes out.
        let is_exact = arguments.contains("--dim 2") || arguments.contains("--regularize 0");
        assert_eq!(foretold.contains("points      about "), !is_exact, "{foretold}");
        for (key, line) in [("points", "points"), ("elements", elements)] {
            let error = (number(line) as f64 / run[key].as_f64().unwrap() - 1.0).abs();
            assert!(error <= if is_exact { 0.0 } else { 0.3 }, "{arguments}: {foretold}, but {said}");
        }
        let bytes = workplace.bytes(name).len() as f64;
        assert!(
            (number("file") as f64 / bytes - 1.0).abs() < if is_exact { 0.25 } else { 0.5 },
            "{arguments}: {foretold}, but {bytes}"
        );
        assert!(number("memory") > 1_000_000);
        std::fs::remove_file(workplace.path(name)).unwrap();
    }
    let too_much =
        workplace.command("--seeds 100 -n 12 --dry-run").assert().code(FAILED).get_output().clone();
    assert!(String::from_utf8(too_much.stdout).unwrap().contains("\nmemory      about "));
    assert!(String::from_utf8(too_much.stderr).unwrap().contains(" levels would fit"));
}

#[test]
fn dry_run_counts_voxels() {
    let workplace = Workplace::new();
    let foretold = |arguments: &str| {
        let output = workplace.command(&format!("--dry-run {arguments}")).output().unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        let number = |name: &str| -> u64 {
            let line = said.lines().find(|line| line.starts_with(name)).unwrap();
            line.split_whitespace().find_map(|word| word.parse().ok()).unwrap()
        };
        [number("file"), number("memory")]
    };
    let [file, memory] = foretold("--seeds 5 -n 0 --voxels 3000 3000 3000 -o a.vti");
    assert!((108_000_000_000..108_001_000_000).contains(&file), "four bytes each: {file}");
    // As much as for a few of them: they are labelled slab by slab.
    let few = "--seeds 5 -n 0";
    let none = foretold(&format!("{few} -o a.vtp"));
    let small = foretold(&format!("{few} --voxels 30 30 30 -o a.vti"));
    assert!(memory == small[1] && memory > none[1] + 100_000_000 && memory < 200_000_000, "{memory}");
    // Where files need all at once, peaks of 500 grains were 1.31, 0.67 and 2.23 GB.
    let all = "--seeds 500 -n 3 --voxels 300 300 300";
    for (format, file, peak) in [
        ("-o a.dream3d", 0.54e9, 1.31e9),
        ("-o a.inp", 4.23e9, 0.67e9),
        ("--volume-mesh -o a.vtu", 1.76e9, 2.23e9),
    ] {
        for (foretold, measured) in foretold(&format!("{all} {format}")).into_iter().zip([file, peak]) {
            let ratio = foretold as f64 / measured;
            assert!((1.0 / 1.2..1.2).contains(&ratio), "{format}: {foretold} of {measured}");
        }
    }
    let [plane, _] = foretold("--seeds 5 -n 0 --dim 2 --voxels 3000 3000 -o a.npy");
    assert!((36_000_000..36_010_000).contains(&plane), "{plane}");
}

#[test]
fn summary_for_programs_holds_the_numbers_of_the_summary() {
    let workplace = Workplace::new();
    let record: Value =
        serde_json::from_slice(&printed(&workplace, "--seeds 9 -n 1 --json-summary - -o a.vtp --quiet"))
            .unwrap();
    assert_eq!((&record["grains"], &record["dimension"]), (&Value::from(9), &Value::from(3)));
    assert_eq!(record["settings"]["seeds"], 9);
    assert_eq!(record["written"], serde_json::json!(["a.vtp"]));
    assert!(record["largest_relative_volume_error"].as_f64().unwrap() < 1e-9);
    assert!(
        record["angles_after"]["standard_deviation"].as_f64()
            < record["angles_before"]["standard_deviation"].as_f64()
    );
    assert!(record["seconds"]["relaxation"].as_f64().unwrap() > 0.0);
    let command_line =
        record["command_line"].as_str().unwrap().strip_prefix("grainsmooth ").unwrap().to_owned();
    workplace.run(&format!("{command_line} -o b.vtp"));
    assert!(workplace.bytes("a.vtp") == workplace.bytes("b.vtp"));
    workplace.refuses(
        "--json-summary none/run.json",
        FAILED,
        "none/run.json: no directory none; create it or choose another path",
    );
}

#[test]
fn standard_output_takes_the_bytes_of_the_file() {
    let workplace = Workplace::new();
    for (format, extension) in
        [("", "vtp"), ("--format ply", "ply"), ("--format obj", "obj"), ("--format tess", "tess")]
    {
        let arguments = "--seeds 6 -n 1";
        workplace.run(&format!("{arguments} -o a.{extension}"));
        let bytes = printed(&workplace, &format!("{arguments} -o - {format}"));
        assert!(bytes == workplace.bytes(&format!("a.{extension}")), "{format}");
    }
    workplace.refuses(
        "-o - --format vtm",
        USAGE,
        "standard output takes a single file; choose another format, such as vtp, or give a path",
    );
    workplace.refuses(
        "-o - --format pli",
        USAGE,
        &format!(
            "invalid value 'pli' for '--format <FORMAT>': did you mean ply? the formats are those of {}",
            OutputFormat::known_extensions()
        ),
    );
    workplace.refuses(
        "-o a.vtp --format ply",
        USAGE,
        "--format is for -o -; the extension of a file names its format",
    );
    workplace.refuses(
        "-o - --json-summary -",
        USAGE,
        "-o - and --json-summary - both go to standard output; give one of them a path",
    );
}

#[test]
fn several_outputs_of_one_run_are_those_of_several_runs() {
    let workplace = Workplace::new();
    let arguments = "--seeds 6 -n 1 --voxels 4 4 4";
    let names = ["b.vtp", "b.geo", "b.msh", "b.vti", "b/grains.vtp", "b.vtm"];
    for name in ["b.msh", "b.vti", "b.vtm", "b.vtp"] {
        workplace.run(&format!("{arguments} -o {name}"));
    }
    let alone = names.map(|name| workplace.bytes(name));
    let said = workplace.run(&format!("{arguments} -o b.vtp -o b.msh --output b.vti -o b.vtm"));
    assert!(said.ends_with("written     b.vtp, b.msh, b.vti, b.vtm\n"), "{said}");
    assert!(names.map(|name| workplace.bytes(name)) == alone);
    let printed = printed(&workplace, &format!("{arguments} -o b.ply -o - --format vtp"));
    assert!(printed == alone[0] && workplace.path("b.ply").exists());
    workplace.put("run.toml", "seeds = 6\nlevels = 1\noutput = [\"a.vtp\", \"a.ply\"]\n");
    workplace.run("--config run.toml");
    for extension in ["vtp", "ply"] {
        let [a, b] = ["a", "b"].map(|name| workplace.bytes(&format!("{name}.{extension}")));
        // Only the number of voxels is among the settings of one and not of the other.
        assert!(a.len() > 10_000 && a.len().abs_diff(b.len()) < 100);
    }
    let foretold = |arguments: &str| {
        let said = text(&workplace, &format!("{arguments} --dry-run"));
        let line = said.lines().find(|line| line.starts_with("file")).unwrap().to_owned();
        line.split_whitespace().find_map(|word| word.parse::<u64>().ok()).unwrap()
    };
    let both = foretold("--seeds 6 -o a.vtp -o a.stl");
    assert_eq!(both, foretold("--seeds 6 -o a.vtp") + foretold("--seeds 6 -o a.stl"));
}

#[test]
fn reader_that_stops_is_a_quiet_end() {
    let workplace = Workplace::new();
    for arguments in ["--seeds 20 -n 3 -o - --quiet --cells-csv cells.csv", "man", "completions bash"] {
        let program = workplace.command("").get_program().to_owned();
        let mut child = std::process::Command::new(program)
            .args(arguments.split(' '))
            .current_dir(workplace.path(""))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut first = [0; 8];
        child.stdout.take().unwrap().read_exact(&mut first).unwrap();
        let end = child.wait_with_output().unwrap();
        assert_eq!(
            (end.status.code(), String::from_utf8(end.stderr).unwrap().as_str()),
            (Some(0), ""),
            "{arguments}"
        );
    }
    assert!(workplace.path("cells.csv").is_file(), "what else was asked for is there");
}

#[test]
fn completions_and_manual_know_every_option() {
    let workplace = Workplace::new();
    let help = text(&workplace, "--help");
    let options = help.split_whitespace().filter(|word| word.starts_with("--") && word.len() > 2);
    let options: Vec<&str> = options.map(|word| word.trim_end_matches([',', '.', ';'])).collect();
    assert!(options.contains(&"--seeds-file"));
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = text(&workplace, &format!("completions {shell}"));
        for option in &options {
            assert!(script.contains(option.trim_start_matches('-')), "{shell}: {option}");
        }
    }
    let page = include_str!("../../docs/options.md");
    let unlisted: Vec<_> = options.iter().filter(|option| !page.contains(&format!("`{option}"))).collect();
    assert!(unlisted.iter().all(|option| ["--help", "--version"].contains(option)), "{unlisted:?}");
    let manual = text(&workplace, "man").replace("\\-", "-");
    assert!(manual.contains(".TH grainsmooth 1"));
    for option in options {
        assert!(manual.contains(option), "{option}");
    }
}

/// An option stands once: the page has the spelling and the default that `--help` has.
#[test]
fn each_option_in_the_docs_is_that_of_the_help() {
    let help = text(&Workplace::new(), "--help");
    let listed = help.split("\nSeeds:\n").nth(1).unwrap().split("\nExamples:\n").next().unwrap();
    let plain = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let page = include_str!("../../docs/options.md").replace("\\|", "\u{1}");
    let link = |(before, rest): (&str, &str)| format!("{before}{}", rest.split_once(')').unwrap().1);
    let unlinked =
        |cell: &str| cell.split_once("](").map_or_else(|| cell.to_owned(), link).replace(['`', '['], "");
    let row = |row: &str| {
        let cells: Vec<&str> = row.split('|').collect();
        let option = cells[1].replace('`', "").replace('\u{1}', "|");
        Some((plain(&option[option.find("--")?..]), plain(&unlinked(cells[2]))))
    };
    let rows: BTreeMap<String, String> =
        page.lines().filter(|line| line.starts_with("| `")).filter_map(row).collect();
    let (mut option, mut count) = (String::new(), 0);
    let mut lines = listed.lines();
    while let Some(line) = lines.next() {
        let is_indented = line.starts_with("        ");
        if let Some(long) = line.find("--").filter(|_| !is_indented) {
            option = plain(&line[long..].replace(['<', '>'], ""));
            count += 1;
            assert!(rows.contains_key(&option), "options.md has no row {option}");
        }
        if let Some((_, start)) = line.split_once("[default:") {
            let mut default = start.to_owned();
            while !default.contains(']') {
                default = format!("{default} {}", lines.next().unwrap().trim());
            }
            assert_eq!(rows[&option], plain(default.split(']').next().unwrap()), "{option}");
        }
    }
    assert!(count > 40, "{count}");
}

#[test]
fn each_format_is_in_the_docs() {
    let (formats, options) = (include_str!("../../docs/formats.md"), include_str!("../../docs/options.md"));
    let rows: Vec<&str> = formats.lines().filter(|line| line.starts_with("| `.")).collect();
    let output = options.lines().find(|line| line.contains("`--output PATH`")).unwrap();
    assert!(
        include_str!("../../README.md").contains(&format!("{} formats", OutputFormat::ALL.len())),
        "README.md"
    );
    for format in OutputFormat::ALL {
        let name = format!("`.{}`", format.extension());
        assert!(rows.iter().any(|row| row.split('|').nth(1).unwrap().contains(&name)), "formats.md: {name}");
        assert!(output.contains(&name), "options.md: {name}");
    }
}

#[test]
fn each_option_has_an_example_in_the_help() {
    let help = text(&Workplace::new(), "--help");
    let listed = help.split("\nSeeds:\n").nth(1).unwrap().split("\nExamples:\n").next().unwrap();
    let starts_option = |line: &&str| {
        line.starts_with("  ") && line.trim_start().starts_with('-') && !line.contains("Example")
    };
    let indented = |line: &&str| line.len() - line.trim_start().len() < 8;
    let options = listed.lines().filter(starts_option).filter(indented).count();
    assert!(options > 25, "{options}");
    assert_eq!(listed.matches("Example: -").count(), options);
}

#[test]
fn values_that_are_misspelled_are_suggested() {
    let workplace = Workplace::new();
    workplace.refuses(
        "--lattice bbc 3",
        USAGE,
        "invalid value 'bbc' for '--lattice <LATTICE> <N>': did you mean bcc? the lattices are sc, bcc, fcc and hcp, and square and hex in 2D; then give a whole number from 1 to 1600",
    );
    let said = workplace.command("--sedes 3").assert().code(USAGE).get_output().stderr.clone();
    assert!(String::from_utf8(said).unwrap().contains("a similar argument exists: '--seeds'"));
    let said = workplace.command("-o a.vtpp").assert().code(USAGE).get_output().stderr.clone();
    assert!(String::from_utf8(said).unwrap().contains("did you mean .vtp?"));
}

#[test]
fn colours_obey_the_environment() {
    let workplace = Workplace::new();
    let has_colour = |no_color: Option<&str>| {
        let mut command = workplace.command("--sedes 3");
        command.env("CLICOLOR_FORCE", "1").env_remove("NO_COLOR");
        if let Some(value) = no_color {
            command.env("NO_COLOR", value);
        }
        command.assert().code(USAGE).get_output().stderr.contains(&0x1b)
    };
    assert!(has_colour(None), "the test can see colours");
    assert!(!has_colour(Some("1")));
}

#[cfg(unix)]
#[test]
fn interrupted_run_leaves_nothing() {
    let names = |workplace: &Workplace| {
        let entries = std::fs::read_dir(workplace.path("")).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    for (arguments, signal, code) in [
        ("--seeds 100 -n 3 --relax 0 -o a.obj", "-INT", 130),
        ("--seeds 100 -n 3 --relax 0 -o a.vtm", "-INT", 130),
        ("--seeds 100 -n 3 --relax 0 --grains-dir d --grains-format obj", "-TERM", 143),
    ] {
        let workplace = Workplace::new();
        let program = workplace.command("").get_program().to_owned();
        let mut child = std::process::Command::new(program)
            .args(arguments.split(' '))
            .current_dir(workplace.path(""))
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // Outputs are probed at once, so what is being written is what has bytes.
        let is_writing = || {
            let entries = std::fs::read_dir(workplace.path("")).unwrap().flatten();
            entries.filter(|entry| entry.file_name().to_string_lossy().ends_with(".part")).any(|entry| {
                let data = entry.metadata();
                data.is_ok_and(|data| if data.is_dir() { has_files(&entry.path()) } else { data.len() > 0 })
            })
        };
        while !is_writing() {
            assert!(child.try_wait().unwrap().is_none(), "{arguments}: over before it was seen writing");
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        std::process::Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
        let end = child.wait_with_output().unwrap();
        assert_eq!(end.status.code(), Some(code), "{arguments}");
        assert_eq!(String::from_utf8(end.stderr).unwrap(), "\ninterrupted; nothing half written is left\n");
        assert!(names(&workplace).iter().all(|name| name == "grains.vtp"), "{:?}", names(&workplace));
    }
}

#[cfg(unix)]
fn has_files(directory: &std::path::Path) -> bool {
    std::fs::read_dir(directory).is_ok_and(|mut entries| entries.next().is_some())
}
