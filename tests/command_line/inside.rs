//! Grains that are divided by a second tessellation.

use serde_json::Value;

use crate::workplace::{FAILED, USAGE, Workplace};

fn numbers(table: &Value, name: &str, column: &str) -> Vec<f64> {
    table[name].as_array().unwrap().iter().map(|row| row[column].as_f64().unwrap()).collect()
}

fn parents(table: &Value, name: &str) -> Vec<usize> {
    let numbers = table[name].as_array().unwrap().iter().map(|row| row["Parent"].as_u64().unwrap());
    numbers.map(|number| usize::try_from(number).unwrap()).collect()
}

/// What the rows of a table have in a column, added up by `Parent`.
fn sums(table: &Value, name: &str, column: &str) -> Vec<f64> {
    let mut sums = Vec::new();
    for (parent, value) in parents(table, name).into_iter().zip(numbers(table, name, column)) {
        sums.resize(sums.len().max(parent + 1), 0.0);
        sums[parent] += value;
    }
    sums
}

/// They bent and came apart, in the plane until lines crossed.
#[test]
fn lamellae_stay_plane_unless_a_time_is_given() {
    let workplace = Workplace::new();
    for options in
        ["--dim 2 --seeds 20 --inside lamellae(width=0.03)", "--seeds 10 --inside lamellae(width=0.1) -n 1"]
    {
        workplace.run(&format!("{options} --stats a.json"));
        workplace.run(&format!("{options} --relax 0 --stats b.json"));
        assert_eq!(workplace.json("a.json")["grains"], workplace.json("b.json")["grains"], "{options}");
    }
}

#[test]
fn divided_grains_keep_their_volumes_before_and_after_relaxation() {
    let workplace = Workplace::new();
    for (grains, inside, column) in [
        ("--seeds 12", "lamellae(width=0.12)", "volume"),
        ("--seeds 8 --periodic x,y,z", "voronoi(diameter=0.3)", "volume"),
        ("--seeds 10 --domain sphere --chord-error 0.02", "lamellae(width=0.1,normal=z)", "volume"),
        ("--seeds 10 --seeding random", "lamellae(width=0.15)", "volume"),
        ("--seeds 20 --dim 2", "lamellae(width=0.05)", "area"),
        ("--seeds 12 --dim 2 --periodic x,y", "voronoi(diameter=0.1,cv=0.2)", "area"),
        ("--lattice bcc 2", "lamellae(width=0.2)", "volume"),
    ] {
        let tables = "-n 0 --cells-json c.json";
        workplace.run(&format!("{grains} {tables} --no-mesh"));
        let whole = numbers(&workplace.json("c.json"), "cells", column);
        let said = workplace
            .run(&format!("{grains} {tables} --inside {inside} --stats t.json --json-summary s.json"));
        assert!(said.contains("\ninside      "), "{said}");
        let summary = workplace.json("s.json");
        let found = &summary["inside"][0];
        assert!(found["parts"].as_u64().unwrap() >= 2 * found["divided"].as_u64().unwrap(), "{found}");
        let [asked, reached] = ["length_asked", "length"].map(|key| found[key].as_f64().unwrap());
        assert!((reached / asked - 1.0).abs() < 0.35, "{found}");
        for (table, name) in [("c.json", "cells"), ("t.json", "grains")] {
            let sums = sums(&workplace.json(table), name, column);
            assert_eq!(sums.len(), whole.len());
            for (sum, whole) in sums.iter().zip(&whole) {
                assert!((sum / whole - 1.0).abs() < 1e-10, "{grains} {inside}: {sum} {whole}");
            }
        }
        if !summary["sizes"].is_null() {
            assert!(summary["sizes"]["largest_volume_error"].as_f64().unwrap() < 1e-10, "{grains}");
        }
    }
}

#[test]
fn the_phases_of_divided_grains_keep_their_shares() {
    let workplace = Workplace::new();
    let phases = "--phase a:0.7 --phase b:0.3,texture=goss(5) --seeds 20 -n 0 --relax 0.1";
    workplace.run(&format!(
        "{phases} --inside b:lamellae(width=0.1) --inside a:voronoi(diameter=0.2) -o a.vtm -o a.vtp -o a.vti --voxels 4 4 4 \
         --json-summary s.json --cells-csv c.csv --stats t.csv --grains-dir each --picture p.png --picture-size 200 200 --color-by phase --report r.html"
    ));
    let summary = workplace.json("s.json");
    for phase in summary["phases"].as_array().unwrap() {
        let [asked, reached] = ["fraction_asked", "fraction"].map(|key| phase[key].as_f64().unwrap());
        assert!((reached / asked - 1.0).abs() < 1e-10, "{phase}");
    }
    let grains: u64 =
        summary["inside"].as_array().unwrap().iter().map(|one| one["grains"].as_u64().unwrap()).sum();
    assert_eq!(grains, 20);
    let text = |name: &str| String::from_utf8_lossy(&workplace.bytes(name)).into_owned();
    for name in ["a/grains.vtp", "a.vti", "a.vtp", "each/grain_0.vtp"] {
        assert!(text(name).contains(r#"type="Int32" Name="Parent""#), "{name}");
    }
    for name in ["c.csv", "t.csv"] {
        assert!(text(name).lines().next().unwrap().contains(",Parent,Phase"), "{name}");
    }
    // Each part has an orientation of its own.
    let table = text("c.csv");
    let mut angles: Vec<&str> = table.lines().skip(1).map(|line| line.rsplit(',').next().unwrap()).collect();
    let count = angles.len();
    angles.sort_unstable();
    angles.dedup();
    assert_eq!(angles.len(), count);
    workplace.run("--config a.vtp -o b.vtp");
    assert!(workplace.bytes("a.vtp") == workplace.bytes("b.vtp"));
    workplace.command("check a.vtp").assert().success();
    workplace.put("run.toml", "seeds = 5\nlevels = 0\nrelax = 0\ninside = 'lamellae(width=0.2)'\n");
    workplace.run("--config run.toml -o c.vtp");
    workplace.put("run.toml", "seeds = 5\nlevels = 0\nrelax = 0\ninside = ['lamellae(width=0.2)']\n");
    workplace.run("--config run.toml -o d.vtp");
    assert!(workplace.bytes("c.vtp") == workplace.bytes("d.vtp"));
}

#[test]
fn lamellae_of_stretched_grains_are_as_wide_as_asked_for() {
    let workplace = Workplace::new();
    for normal in ["x", "1 2"] {
        let options = "--dim 2 --seeds 6 --relax 0 -n 0 --aspect-ratio 3 1 --cells-json c.json --no-mesh";
        let mut command = workplace.command(options);
        command.args(["--inside", &format!("lamellae(width=0.1,normal={normal})")]).assert().success();
        let table = workplace.json("c.json");
        // A grain three times as long as wide has five lamellae across its length, and some two across its width.
        let parents = parents(&table, "cells");
        let most = (0..6).map(|parent| parents.iter().filter(|own| **own == parent).count()).max();
        assert!(most.unwrap() >= 4, "{normal}: {parents:?}");
    }
}

#[test]
fn mistaken_patterns_are_refused() {
    let workplace = Workplace::new();
    let value = |text: &str, message: &str| {
        format!("invalid value '{text}' for '--inside <[PHASE:]PATTERN(LENGTH)>': {message}")
    };
    let known = "write lamellae(width=2) or voronoi(diameter=5), with PHASE: before it for one phase";
    for (text, message) in [
        ("layers(2)", format!("'layers' divides nothing; {known}")),
        ("lamellae", format!("'lamellae' divides nothing; {known}")),
        ("lamellae()", format!("lamellae needs width=; {known}")),
        ("lamellae(width=0)", "width= is not a length; give a number above 0".to_owned()),
        ("lamellae(2)", "lamellae takes width= and normal=; '2' is none of them".to_owned()),
        ("voronoi(diameter=1,cv=2)", "cv=2 is none; give a number from 0 to 1".to_owned()),
        (
            "lamellae(width=1,normal=w)",
            "normal=w is not a direction; give x, y, z, random, or coordinates such as normal=1 1 0"
                .to_owned(),
        ),
    ] {
        workplace.refuses(&format!("--inside {text}"), USAGE, &value(text, &message));
    }
    for (arguments, message) in [
        (
            "--inside a:lamellae(width=0.1)",
            "--inside names the phase 'a'; there are none, so leave it out, or give some with --phase",
        ),
        (
            "--phase a:0.5 --phase b:0.5 --inside c:lamellae(width=0.1)",
            "--inside names the phase 'c'; the phases are a, b",
        ),
        (
            "--inside lamellae(width=0.1) --inside voronoi(diameter=0.1)",
            "--inside divides grains twice; leave one of them out",
        ),
        (
            "--phase a:1 --inside a:lamellae(width=0.1) --inside a:voronoi(diameter=0.1)",
            "--inside divides grains of a twice; leave one of them out",
        ),
        (
            "--dim 2 --inside lamellae(width=0.1,normal=z)",
            "--inside lamellae(width=0.1,normal=0.0 0.0 1.0): in 2D the normal lies in the plane; give x, y, random, or two coordinates",
        ),
    ] {
        workplace.refuses(arguments, USAGE, message);
    }
    for (arguments, message) in [
        (
            "--seeds 20 --inside lamellae(width=5)",
            "--inside lamellae(width=5.0) divides no grain because all are too small; give at most width=0.41",
        ),
        (
            "--seeds 20 --inside voronoi(diameter=0.7)",
            "--inside voronoi(diameter=0.7,cv=0.35) divides no grain because all are too small; give at most diameter=0.59",
        ),
        (
            "--seeds 20 --inside lamellae(width=1e-12)",
            "10071556060336 parts of grains would take 16.1 PB of memory and ... are available; make the parts wider",
        ),
    ] {
        workplace.refuses(arguments, FAILED, message);
    }
    // The remedies work.
    for inside in ["lamellae(width=0.41)", "voronoi(diameter=0.59)"] {
        workplace.run(&format!("--seeds 20 --relax 0 -n 0 --inside {inside}"));
    }
}
