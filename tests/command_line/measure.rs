//! `grainsmooth measure`: what samples are like, and twins of them.

use serde_json::Value;

use crate::workplace::{FAILED, USAGE, Workplace};

fn measured(workplace: &Workplace, arguments: &str) -> Value {
    let output =
        workplace.command(&format!("measure --json {arguments}")).assert().success().get_output().clone();
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn number(value: &Value, keys: &[&str]) -> f64 {
    let found = keys.iter().fold(value, |value, key| &value[*key]);
    found.as_f64().unwrap_or_else(|| panic!("no number {keys:?} in {value}"))
}

fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a / b - 1.0).abs() <= tolerance
}

/// Runs what a report tells to run, with more options.
fn run_twin(workplace: &Workplace, report: &Value, key: &str, more: &str) {
    let words: Vec<&str> =
        report[key].as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect();
    workplace.command(more).args(words).assert().success();
}

#[test]
fn a_twin_is_like_its_sample_by_all_that_is_measured() {
    let workplace = Workplace::new();
    for (options, sharp) in [
        ("--box 3 2 2 --periodic x,y,z --seeds 200", true),
        ("--box 30 30 20 --seeds 150 --crystal-symmetry hexagonal", false),
        ("--dim 2 --box 4 4 --periodic x,y --seeds 300", true),
        ("--box 1 1 1.7 --aspect-ratio 1 1 3 --periodic x,y,z --seeds 200", false),
    ] {
        let texture = if sharp { "goss(6)" } else { "random" };
        let arguments =
            format!("{options} --diameters lognormal(mean=3,cv=0.4) --texture {texture} -n 1 --relax 0");
        workplace.run(&format!("{arguments} -o a.vtp"));
        let sample = measured(&workplace, "a.vtp --table a.csv");
        let count = number(&sample, &["grains"]);
        assert!(near(number(&sample, &["lognormal_by_number", "cv"]), 0.4, 0.02), "{sample}");
        assert!(number(&sample, &["lognormal_by_number", "cdf_distance"]) < 0.02, "{sample}");
        for key in ["twin", "twin_of_table"] {
            run_twin(&workplace, &sample, key, "-n 1 --relax 0 -o b.vtp");
            let twin = measured(&workplace, "b.vtp");
            assert!(near(number(&twin, &["grains"]), count, 0.02), "{options}: {sample}\n{twin}");
            for (keys, tolerance) in [
                (&["volume"][..], 1e-6),
                (&["equivalent_diameter", "mean"], 0.01),
                (&["cv"], 0.02),
                (&["sphericity", "mean"], 0.01),
                (&["faces", "mean"], 0.03),
                (&["axis_ratio", "2"], 0.05),
            ] {
                let value = |report: &Value| match keys {
                    ["axis_ratio", _] => report["axis_ratio"][2].as_f64().unwrap(),
                    keys => number(report, keys),
                };
                assert!(
                    near(value(&sample), value(&twin), tolerance),
                    "{options}, {keys:?}: {sample}\n{twin}"
                );
            }
            if key == "twin_of_table" {
                // Of random orientations some are drawn twice, which a kernel takes for a mode.
                let index = |report: &Value| number(report, &["texture", "index"]);
                assert!(!sharp || near(index(&sample), index(&twin), 0.1), "{sample}\n{twin}");
                let equal = |key: &str| assert_eq!(sample["texture"][key], twin["texture"][key]);
                ["crystal_symmetry", "orientations", "halfwidth"].into_iter().for_each(equal);
            }
        }
    }
}

#[test]
fn a_sample_is_the_same_in_any_file() {
    let workplace = Workplace::new();
    for options in [
        "--seeds 60",
        "--seeds 60 --periodic x,y,z",
        "--dim 2 --seeds 80",
        "--dim 2 --seeds 80 --periodic x,y",
    ] {
        workplace.run(&format!(
            "{options} --seeding packed --texture cube(8) -n 0 --relax 0 --regularize 0 -o a.vtp -o b.vtu -o c.vtk -o d.tess --cells-csv e.csv --cells-json f.json --stats g.json"
        ));
        let network = measured(&workplace, "a.vtp");
        for (name, has_place) in [
            ("b.vtu", true),
            ("c.vtk", true),
            ("d.tess", true),
            ("e.csv", false),
            ("f.json", false),
            ("g.json", false),
        ] {
            let other = measured(&workplace, name);
            for keys in [
                &["grains"][..],
                &["dimension"],
                &["volume"],
                &["cv"],
                &["lognormal_by_volume", "sigma"],
                &["texture", "index"],
                &["faces", "mean"],
                &["sphericity", "mean"],
            ] {
                // In a periodic box the table of measures knows no walls, but neighbours behind them: as many faces.
                let [one, two] = [&network, &other].map(|report| number(report, keys));
                assert!(near(one, two, 1e-9), "{options}, {name}, {keys:?}: {network}\n{other}");
            }
            assert_eq!(network["whole_grains"], other["whole_grains"], "{options}, {name}");
            if has_place {
                let place = |report: &Value| report["twin"].as_array().unwrap()[2..].to_vec();
                assert_eq!(place(&network), place(&other), "{options}, {name}");
            }
        }
        // What is written is read as the same.
        let before = measured(&workplace, "a.vtp --table t.csv");
        let after = measured(&workplace, "t.csv");
        for keys in
            [&["cv"][..], &["faces", "mean"], &["sphericity", "standard_deviation"], &["texture", "index"]]
        {
            assert!(near(number(&before, keys), number(&after, keys), 1e-12), "{keys:?}: {before}\n{after}");
        }
    }
}

#[test]
fn bare_lists_are_samples_too() {
    let workplace = Workplace::new();
    let lines: String = (0..400).map(|k| format!("{:?}\n", 1.0 + f64::from(k) / 400.0)).collect();
    workplace.put("list.txt", &lines);
    let report = measured(&workplace, "list.txt");
    assert_eq!(report["sphericity"], Value::Null);
    assert!(near(number(&report, &["equivalent_diameter", "mean"]), 1.5, 2e-3), "{report}");
    let said = workplace.command("measure list.txt").assert().success().get_output().stdout.clone();
    let said = String::from_utf8(said).unwrap();
    assert!(
        said.starts_with(
            "list.txt: 400 grains in space, 400 that no wall cuts\n  diameters   mean 1.499, cv 0.1926\n"
        ),
        "{said}"
    );
    assert!(said.contains("  twin        grainsmooth --diameters list.txt --box 9.2"), "{said}");
    assert!(said.contains("  twin        grainsmooth --diameters 'lognormal(mean=1."), "{said}");
    // In the plane the box is another.
    let plane = measured(&workplace, "list.txt --dim 2");
    assert_eq!(plane["dimension"], 2);
    workplace.put("equal.csv", "name,diameter\na,2\nb,2\n");
    let report = measured(&workplace, "equal.csv");
    assert_eq!(report["twin"][1], "equal(2)");
    run_twin(&workplace, &report, "twin", "-n 0 --relax 0 -o b.vtp");
    assert_eq!(measured(&workplace, "b.vtp")["grains"], 2);
}

#[test]
fn what_is_no_sample_is_refused() {
    let workplace = Workplace::new();
    workplace.put("a.xyz", "");
    workplace.put("empty.csv", "diameter\n");
    workplace.put("names.csv", "length,width\n1,2\n");
    workplace.put("gap.csv", "diameter\n1\n\n0\n");
    workplace.put("bad.json", "{\"cells\": [1");
    workplace.put("other.json", "{\"version\": 1}");
    workplace.put("bad.tess", "***tess\n **format\n   9.9\n");
    workplace.refuses(
        "measure a.xyz",
        FAILED,
        "a.xyz: unknown extension; give a network (*.vtp, *.vtu, *.vtk), a tessellation (*.tess) or a table (*.csv, *.txt, *.json)",
    );
    workplace.refuses(
        "measure absent.csv",
        FAILED,
        "absent.csv: cannot be read: ... ; give the path of a readable text file",
    );
    workplace.refuses(
        "measure empty.csv",
        FAILED,
        "empty.csv line 1: holds no grains; give one on each line",
    );
    workplace.refuses(
        "measure names.csv",
        FAILED,
        "names.csv line 2: no number under diameter or volume; name one column so, and fill it in",
    );
    workplace.refuses(
        "measure gap.csv",
        FAILED,
        "gap.csv: grain 1 has the volume 0; give grains of positive volumes",
    );
    workplace.refuses("measure bad.json", FAILED, "bad.json line 1: ... ; give a complete JSON document");
    workplace.refuses(
        "measure other.json",
        FAILED,
        "other.json line 1: no list of grains; give one under the name cells or grains",
    );
    workplace.refuses(
        "measure bad.tess",
        FAILED,
        "bad.tess line 3: version \"9.9\" is none of 3.3, 3.4, 3.5; write the file again with another Neper",
    );
    workplace.refuses(
        "measure names.csv --table t.vtp",
        USAGE,
        "invalid value 't.vtp' for '--table <PATH>': name the table *.csv",
    );
    workplace.refuses(
        "measure names.csv --table no/t.csv",
        FAILED,
        "no/t.csv: no directory no; create it or choose another path",
    );
}

/// A triangle that is missing made the volume of its grain another without a word.
#[test]
fn an_open_grain_is_refused() {
    let workplace = Workplace::new();
    let triangles = ["0 2 1", "0 1 3", "0 3 2", "1 2 3"];
    let file = |triangles: &[&str]| {
        let count = triangles.len();
        let corners: String = triangles.iter().map(|corners| format!("3 {corners}\n")).collect();
        format!(
            "# vtk DataFile Version 3.0\ngrain\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n0 0 0\n1 0 0\n0 1 0\n0 0 1\nPOLYGONS {count} {}\n{corners}CELL_DATA {count}\nFIELD FieldData 1\nFaceLabels 2 {count} int\n{}",
            4 * count,
            "0 -1\n".repeat(count)
        )
    };
    workplace.put("whole.vtk", file(&triangles));
    let report = measured(&workplace, "whole.vtk");
    assert!(near(number(&report, &["volume"]), 1.0 / 6.0, 1e-12), "{report}");
    assert_eq!(report["whole_grains"], 0);
    workplace.put("open.vtk", file(&triangles[..3]));
    workplace.refuses(
        "measure open.vtk",
        FAILED,
        "open.vtk: grain 0 is not closed; repair what `grainsmooth check` finds in the file",
    );
}

#[test]
fn the_phases_of_a_sample_and_of_its_twin_have_the_same_shares() {
    let workplace = Workplace::new();
    let phases = "--phase a:0.7,diameters=lognormal(mean=3,cv=0.3) --phase b:0.3,diameters=equal(2)";
    workplace.run(&format!(
        "{phases} --seeds 60 --box 9 9 9 -n 0 --relax 0 -o a.vtp -o a.tess -o a.vtk --cells-csv a.csv"
    ));
    // Neper's cells have groups.
    assert!(String::from_utf8(workplace.bytes("a.tess")).unwrap().contains("\n  *group\n"));
    for name in ["a.vtp", "a.tess", "a.vtk", "a.csv"] {
        let sample = measured(&workplace, name);
        for (phase, share) in sample["phases"].as_array().unwrap().iter().zip([0.7, 0.3]) {
            assert!(near(number(phase, &["fraction"]), share, 1e-9), "{name}: {phase}");
        }
        run_twin(&workplace, &sample, "twin", "-n 0 --relax 0 -o b.vtp");
        let twin = measured(&workplace, "b.vtp");
        for (phase, own) in
            twin["phases"].as_array().unwrap().iter().zip(sample["phases"].as_array().unwrap())
        {
            assert!(near(number(phase, &["fraction"]), number(own, &["fraction"]), 1e-9), "{name}: {twin}");
            assert!(
                near(number(phase, &["grains"]), number(own, &["grains"]), 0.15),
                "{name}: {sample} {twin}"
            );
        }
    }
}
