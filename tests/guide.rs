//! The guide and the recipes, done as they say: commands, then Python.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "common/programs.rs"]
mod programs;

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use programs::{run, skip};

/// The text of the guide's blocks, each with its language.
fn blocks(guide: &str) -> Vec<(&str, &str)> {
    let fenced = guide.split("```").skip(1).step_by(2);
    fenced.map(|block| block.split_once('\n').unwrap()).collect()
}

/// The words of a command line; what stands between quotes is one.
fn words(line: &str) -> Vec<String> {
    let parts = line.split('\'').enumerate();
    let words = parts.flat_map(|(number, part)| match number % 2 {
        0 => part.split_whitespace().map(str::to_owned).collect::<Vec<_>>(),
        _ => vec![part.to_owned()],
    });
    words.collect()
}

fn run_command(line: &str, folder: &Path) {
    let words = words(line);
    if ["gmsh", "ccx"].contains(&&*words[0]) {
        let mut program = Command::new(&words[0]);
        if let Some(output) = run(line, program.args(&words[1..]).current_dir(folder)) {
            assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stdout));
        }
        return;
    }
    assert_eq!(words[0], "grainsmooth", "{line}");
    if ["view", "edit"].contains(&&words[1][..]) {
        return run_page(&words[1..], folder);
    }
    let mut program = assert_cmd::cargo::cargo_bin_cmd!("grainsmooth");
    program.args(&words[1..]).current_dir(folder).assert().success();
}

/// Serves a page until its link is told.
fn run_page(words: &[String], folder: &Path) {
    let program = Command::new(env!("CARGO_BIN_EXE_grainsmooth"))
        .args(words)
        .arg("--no-open")
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn();
    let mut program = program.unwrap();
    let mut link = String::new();
    BufReader::new(program.stdout.take().unwrap()).read_line(&mut link).unwrap();
    program.kill().unwrap();
    program.wait().unwrap();
    assert!(link.starts_with("http://127.0.0.1:"), "{words:?}: {link}");
}

/// A folder with the files that come with the project.
fn folder_with_data() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("data");
    std::fs::create_dir(&copy).unwrap();
    for file in std::fs::read_dir(data()).unwrap() {
        let file = file.unwrap();
        std::fs::copy(file.path(), copy.join(file.file_name())).unwrap();
    }
    folder
}

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data")
}

#[test]
fn recipes_do_what_they_say() {
    let folder = folder_with_data();
    let blocks = blocks(include_str!("../docs/recipes.md"));
    assert!(blocks.len() > 20 && blocks.iter().all(|(language, _)| *language == "sh"));
    for (_, text) in blocks {
        text.lines().for_each(|line| run_command(line, folder.path()));
    }
    // Forces at the side of the EBSD map that is pulled, where CalculiX is there: they pull.
    if let Ok(printed) = std::fs::read_to_string(folder.path().join("map.tension-x.dat")) {
        let rows = printed.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
        let along_x: Vec<f64> =
            rows.filter(|row| row.len() == 4).filter_map(|row| row[1].parse().ok()).collect();
        assert!(along_x.len() > 5 && along_x.iter().sum::<f64>() > 0.0, "{printed}");
    }
}

/// Every command of the page on finite elements, its jobs and its Python, where Gmsh is there to fill grains. A job begins with its name; what is for programs that cannot be installed is
/// plain text.
#[test]
fn finite_elements_do_what_they_say() {
    if let Err(error) = grainsmooth::check_gmsh() {
        return skip("the page on finite elements", &error.to_string());
    }
    let folder = tempfile::tempdir().unwrap();
    let blocks = blocks(include_str!("../docs/finite-elements.md"));
    assert!(blocks.len() > 4);
    for (language, text) in blocks {
        if language == "inp" {
            let (name, _) = text.strip_prefix("** ").unwrap().split_once('\n').unwrap();
            std::fs::write(folder.path().join(name), text).unwrap();
        } else if language == "python" {
            let mut python = Command::new("python3");
            let Some(output) = run(text, python.args(["-c", text]).current_dir(folder.path())) else {
                return;
            };
            assert!(output.status.success(), "{text}: {}", String::from_utf8_lossy(&output.stderr));
        } else {
            assert!(["sh", "text"].contains(&language), "{language}");
            let lines = text.lines().filter(|_| language == "sh");
            lines.for_each(|line| run_command(line, folder.path()));
        }
    }
    // The strain sideways is Poisson's ratio times that along x, of one material.
    if let Ok(printed) = std::fs::read_to_string(folder.path().join("strained.dat")) {
        let line =
            printed.lines().find(|line| line.split_whitespace().count() == 4 && line.contains('E')).unwrap();
        let sideways: f64 = line.split_whitespace().nth(2).unwrap().parse().unwrap();
        assert!((sideways / -0.0003 - 1.0).abs() < 1e-5, "{line}");
    }
}

/// Every command of the page on subdivision, on the files that come with the project.
#[test]
fn subdivision_does_what_it_says() {
    let folder = folder_with_data();
    let blocks = blocks(include_str!("../docs/subdivision.md"));
    assert!(blocks.len() > 1);
    for (language, text) in blocks {
        assert_eq!(language, "sh");
        text.lines().for_each(|line| run_command(line, folder.path()));
    }
}

/// The files that come with the project, by the commands that its README names.
#[test]
fn small_files_can_be_tried_as_their_readme_says() {
    let folder = folder_with_data();
    let readme = std::fs::read_to_string(data().join("README.md")).unwrap();
    for file in std::fs::read_dir(data()).unwrap() {
        let name = file.unwrap().file_name().into_string().unwrap();
        assert!(name == "README.md" || readme.contains(&format!("`{name}`")), "{name} is not explained");
        assert!(name == "README.md" || readme.contains(&format!("data/{name}")), "{name} is not used");
    }
    for (language, text) in blocks(&readme) {
        assert_eq!(language, "sh");
        text.lines().for_each(|line| run_command(line, folder.path()));
    }
}

#[test]
fn guide_does_what_it_says() {
    let guide = include_str!("../docs/guide.md");
    let blocks = blocks(guide);
    let folder = tempfile::tempdir().unwrap();
    let (mut commands, mut python) = (0, String::new());
    for (language, text) in blocks {
        match language {
            "sh" => {
                text.lines().for_each(|line| run_command(line, folder.path()));
                commands += 1;
            }
            "python" => python += text,
            other => panic!("a block of {other:?} is not run"),
        }
    }
    assert!(commands >= 5 && python.contains("pyvista.read"));

    let interpret = |program: &str| {
        let mut interpreter = Command::new("python3");
        interpreter.args(["-c", program]).current_dir(folder.path());
        run("the guide's Python", interpreter.env("PYVISTA_OFF_SCREEN", "true").env_remove("DISPLAY"))
    };
    let sphere = "import pyvista; pyvista.Sphere().plot(screenshot='sphere.png')";
    let Some(output) = interpret(sphere) else { return };
    // Without OpenGL, VTK takes the interpreter down.
    let can_draw = output.status.success();
    if !can_draw {
        skip("the guide's picture", "pyvista cannot draw off screen");
        python.insert_str(0, "import pyvista; pyvista.DataSet.plot = lambda *_, **__: None\n");
    }
    let Some(output) = interpret(&python) else { return };
    assert!(output.status.success(), "{}: {}", output.status, String::from_utf8_lossy(&output.stderr));
    if !can_draw {
        return;
    }
    let picture = std::fs::read(folder.path().join("grain.png")).unwrap();
    assert!(picture.starts_with(b"\x89PNG") && picture.len() > 5000, "a picture of the grain");
}
