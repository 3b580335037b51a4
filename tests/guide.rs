//! The guide, done as it says: its commands, then its Python.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "common/programs.rs"]
mod programs;

use std::path::Path;
use std::process::Command;

use programs::{run, skip};

/// The text of the guide's blocks, each with its language.
fn blocks(guide: &str) -> Vec<(&str, &str)> {
    let fenced = guide.split("```").skip(1).step_by(2);
    fenced.map(|block| block.split_once('\n').unwrap()).collect()
}

fn run_command(line: &str, folder: &Path) {
    let words: Vec<&str> = line.split_whitespace().collect();
    assert_eq!(words[0], "grainsmooth", "{line}");
    let mut program = assert_cmd::cargo::cargo_bin_cmd!("grainsmooth");
    program.args(&words[1..]).current_dir(folder).assert().success();
}

/// The files that come with the project, by the commands that its README names.
#[test]
fn small_files_can_be_tried_as_their_readme_says() {
    let folder = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let copy = folder.path().join("data");
    std::fs::create_dir(&copy).unwrap();
    let readme = std::fs::read_to_string(data.join("README.md")).unwrap();
    for file in std::fs::read_dir(&data).unwrap() {
        let name = file.unwrap().file_name();
        std::fs::copy(data.join(&name), copy.join(&name)).unwrap();
        let name = name.into_string().unwrap();
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
