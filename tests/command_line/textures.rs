//! Orientations of grains: drawn, read from files, written, given back.

use serde_json::Value;
use texture::{CrystalSymmetry, Orientation};

use crate::workplace::{FAILED, USAGE, Workplace};

/// The orientations in a table of cells or grains.
fn orientations(rows: &Value) -> Vec<Orientation> {
    let numbers = |row: &Value| serde_json::from_value(row["EulerAngles"].clone()).unwrap();
    rows.as_array().unwrap().iter().map(|row| Orientation::from_euler_degrees(numbers(row))).collect()
}

#[test]
fn texture_changes_neither_seeds_nor_geometry() {
    let workplace = Workplace::new();
    for dimension in ["3", "2"] {
        let run = format!("--seeds 20 -n 1 --dim {dimension} --rng-seed 3");
        workplace.run(&format!("{run} --stats without.json --cells-json cells_without.json -o a.tess"));
        workplace
            .run(&format!("{run} --texture random --stats with.json --cells-json cells_with.json -o b.tess"));
        let mut with = workplace.json("with.json");
        let without = workplace.json("without.json");
        for table in ["grains", "boundaries"] {
            for row in with[table].as_array_mut().unwrap() {
                for column in ["EulerAngles", "Quaternion", "Disorientation", "DisorientationAxis"] {
                    row.as_object_mut().unwrap().remove(column);
                }
            }
            assert_eq!(with[table], without[table], "{table}");
        }
        assert_eq!(workplace.json("cells_with.json")["cells"].as_array().unwrap().len(), 20);
    }
}

#[test]
fn drawn_components_have_their_volumes_and_disorientations_are_those_of_the_orientations() {
    let workplace = Workplace::new();
    let spec = "goss(5)*0.4+random*0.6";
    let said = workplace.run(&format!(
        "--seeds 150 --rng-seed 3 -n 0 --texture {spec} --stats a.json --json-summary s.json --cells-json c.json -o a.vtp"
    ));
    let line = said.lines().find(|line| line.starts_with("texture ")).unwrap();
    assert!(line.contains("cubic crystals, goss(5) ") && line.contains("(asked 40.0 %)"), "{line}");
    let stats = workplace.json("a.json");
    let found = orientations(&stats["grains"]);
    assert_eq!(found, orientations(&workplace.json("c.json")["cells"]), "cells become grains");
    // Goss within 15 degrees; of random ones some are, too: the largest, a sixteenth of the volume, where the seed is 1.
    let goss = Orientation::from_euler_degrees([0.0, 45.0, 0.0]);
    let volumes = stats["grains"].as_array().unwrap().iter().map(|grain| grain["volume"].as_f64().unwrap());
    let angle = |one: &Orientation| CrystalSymmetry::Octahedral.disorientation_angle(*one, goss);
    let near: f64 = volumes.zip(&found).filter(|(_, one)| angle(one) < 15.0).map(|(volume, _)| volume).sum();
    assert!((0.38..0.46).contains(&near), "{near}");
    let shares = workplace.json("s.json")["texture"]["components"].clone();
    for (share, wanted) in shares.as_array().unwrap().iter().zip([0.4, 0.6]) {
        assert!((share["reached"].as_f64().unwrap() / wanted - 1.0).abs() < 0.01, "{shares}");
    }
    for boundary in stats["boundaries"].as_array().unwrap() {
        let [first, second] = ["side_0", "side_1"].map(|side| boundary[side].as_i64().unwrap());
        if second < 0 {
            assert_eq!(boundary["Disorientation"], Value::Null);
            continue;
        }
        let [first, second] = [first, second].map(|side| found[usize::try_from(side).unwrap()]);
        let exact = CrystalSymmetry::Octahedral.disorientation_angle(first, second);
        assert!((boundary["Disorientation"].as_f64().unwrap() - exact).abs() < 1e-9);
        assert_eq!(boundary["DisorientationAxis"].as_array().unwrap().len(), 3);
    }
}

#[test]
fn every_file_of_orientations_gives_them_back() {
    let workplace = Workplace::new();
    for (symmetry, tolerance) in [("cubic", 1e-9), ("hexagonal", 1e-9), ("trigonal", 1e-9)] {
        let run = format!("--seeds 12 --dim 2 --voxels 60 60 -n 0 --crystal-symmetry {symmetry}");
        workplace.run(&format!(
            "{run} --texture random --stats a.json -o a.txt -o a.ori -o a.tess -o a.ang -o a.ctf -o material.yaml"
        ));
        let given = orientations(&workplace.json("a.json")["grains"]);
        for (file, tolerance) in
            [("a.txt", tolerance), ("a.ori", tolerance), ("a.ang", 1e-3), ("a.ctf", 1e-4)]
        {
            workplace.run(&format!("{run} --texture {file} --stats b.json -o b.vtp"));
            let drawn = orientations(&workplace.json("b.json")["grains"]);
            let nearest = |one: &Orientation| {
                let angles =
                    given.iter().map(|other| CrystalSymmetry::Triclinic.disorientation_angle(*one, *other));
                angles.fold(f64::INFINITY, f64::min)
            };
            let off = drawn.iter().map(nearest).fold(0.0, f64::max);
            assert!(off < tolerance, "{symmetry} {file}: {off}");
        }
        let [list, tess] = ["a.ori", "a.tess"].map(|name| String::from_utf8(workplace.bytes(name)).unwrap());
        let section = tess.split_once("  *ori\n   rodrigues:passive\n").unwrap().1;
        assert_eq!(section.split_once(" **vertex").unwrap().0, list);
        assert_eq!(
            tess.contains(&format!("  *crysym\n   {symmetry}\n")),
            symmetry != "trigonal",
            "{symmetry}"
        );
        let materials = String::from_utf8(workplace.bytes("material.yaml")).unwrap();
        let of_grains = materials.lines().filter(|line| line.contains("phase: A, v: 1.0, O: ["));
        for (line, given) in of_grains.zip(&given) {
            let quaternion = format!("O: {:?}", given.quaternion());
            let numbers = |text: &str| -> Vec<f64> {
                let inside = text.split_once("O: [").unwrap().1.split(']').next().unwrap();
                inside.split(", ").map(|number| number.parse().unwrap()).collect()
            };
            for (ours, exact) in numbers(line).into_iter().zip(numbers(&quaternion)) {
                assert!((ours - exact).abs() < 1e-12, "{line}");
            }
        }
    }
}

/// Angles of a map were once made up only.
#[test]
fn maps_without_a_texture_still_have_random_orientations() {
    let workplace = Workplace::new();
    let run = "--seeds 5 --dim 2 --voxels 9 9 -n 0";
    workplace.run(&format!("{run} -o a.ang"));
    workplace.run(&format!("{run} --texture random -o b.ang"));
    let pixels = |name: &str| {
        let map = String::from_utf8(workplace.bytes(name)).unwrap();
        map.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(pixels("a.ang"), pixels("b.ang"));
}

#[test]
fn settings_of_a_file_repeat_its_orientations() {
    let workplace = Workplace::new();
    let options = "--seeds 9 -n 0 --texture basal(20)*0.5+random*0.5 --crystal-symmetry 6/mmm --sample-symmetry orthorhombic";
    for file in ["a.vtp", "a.vti", "a.yaml", "a.txt"] {
        workplace.run(&format!("{options} --voxels 4 4 4 -o {file}"));
        workplace.run(&format!("--config {file} -o again_{file}"));
        assert!(workplace.bytes(file) == workplace.bytes(&format!("again_{file}")), "{file}");
    }
}

#[test]
fn texture_that_is_mistaken() {
    let workplace = Workplace::new();
    let value = |value: &str, message: &str| {
        format!("invalid value '{value}' for '--texture <SPEC|FILE>': texture '{value}': {message}")
    };
    workplace.refuses(
        "--texture gos(10)",
        USAGE,
        &value("gos(10)", "'gos' is unknown; did you mean 'goss'?"),
    );
    workplace.refuses(
        "--texture goss",
        USAGE,
        &value("goss", "'goss' needs a halfwidth in degrees: goss(10); goss(0) gives each grain the same"),
    );
    workplace.refuses(
        "--crystal-symmetry bcc",
        USAGE,
        "invalid value 'bcc' for '--crystal-symmetry <GROUP>': unknown crystal symmetry 'bcc'; choose a word (cubic, hexagonal, \
         trigonal, tetragonal, orthorhombic, monoclinic, triclinic), a group of rotations (1, 2, 222, 4, 422, 3, 32, 6, 622, 23, 432) \
         or a Laue group (-1, 2/m, mmm, 4/m, 4/mmm, -3, -3m, 6/m, 6/mmm, m-3, m-3m)",
    );
    for file in ["a.ori", "a.txt", "a.yaml"] {
        let message = format!(
            "{file}: this format holds orientations, but the grains have none; give them some, such as --texture random, or choose another"
        );
        workplace.refuses(&format!("--seeds 100000 -n 0 -o {file}"), FAILED, &message);
    }
}

#[test]
fn file_of_orientations_that_is_mistaken() {
    let workplace = Workplace::new();
    let ang =
        |points: &str, symmetry: &str| format!("# Phase 1\n# Symmetry {symmetry}\n# GRID: SqrGrid\n{points}");
    let ctf =
        "Channel Text File\nPhases\t1\n1;1;1\t90;90;90\tiron\t11\t229\nPhase X Y Euler1 Euler2 Euler3\n";
    for (name, content, message) in [
        (
            "a.csv",
            "1,2\n",
            "a.csv line 1: 2 columns; write phi1, Phi, phi2 in degrees and perhaps a weight, or name the columns in the first line",
        ),
        (
            "a.csv",
            "phi1,Phi,weight\n",
            "a.csv line 1: no column is named phi2; name three of them phi1, Phi and phi2, and perhaps one weight",
        ),
        (
            "a.csv",
            "1,2,3\n1,x,3\n",
            "a.csv line 2: 'x' is not a finite number; correct it or remove the line",
        ),
        (
            "a.csv",
            "1,2,3,1\n1,2,3\n",
            "a.csv line 2: fewer columns than in the lines before; write the same number on each",
        ),
        ("a.csv", "1,2,3,-1\n", "a.csv line 1: weight is -1; write 0 or more"),
        ("a.csv", "1,2,3,0\n", "a.csv line 1: no orientation has a weight above 0; give at least one"),
        ("a.csv", "# nothing\n", "a.csv line 1: holds no orientation; give a file with one or more"),
        (
            "a.ori",
            "0 0\n",
            "a.ori line 1: 2 numbers; write three of a Rodrigues vector (rodrigues:passive in Neper), or four of a quaternion",
        ),
        ("a.ori", "0 0 0 0\n", "a.ori line 1: a quaternion of length 0; correct it or remove the line"),
        (
            "a.ang",
            &ang("1 2 3\n", "43"),
            "a.ang line 4: 3 columns; TSL's maps have phi1, Phi, phi2, x, y, quality, confidence, phase on each line",
        ),
        (
            "a.ang",
            &ang("1 2 3 0 0 1 1 1\n", "62"),
            "a.ang: its crystals are hexagonal and not cubic; give --crystal-symmetry hexagonal",
        ),
        (
            "a.ang",
            &ang("1 2 3 0 0 1 -1 0\n", "43"),
            "a.ang line 1: holds no orientation; give a file with one or more",
        ),
        (
            "a.ang",
            &ang("1 2 3 0 0 1 1 1\n1 2 3 0 0 1 1 2\n", "43"),
            "a.ang line 5: a point of phase 2 after points of phase 1; name one of its 2 phases behind the path: #2",
        ),
        (
            "a.ctf",
            "Channel Text File\n",
            "a.ctf line 1: no line names the columns Phase, Euler1, Euler2 and Euler3; give a whole .ctf file",
        ),
        (
            "a.ctf",
            &format!("{ctf}1 0 0 1\n"),
            "a.ctf line 5: fewer columns than names; write one for each name on each line",
        ),
    ] {
        workplace.put(name, content);
        workplace.refuses(&format!("--texture {name}"), FAILED, message);
    }
    workplace.refuses(
        "--texture none.ori",
        FAILED,
        "none.ori: cannot be read: ... ; give the path of a readable text file",
    );
    // The remedies work.
    workplace.put("a.ang", ang("1 2 3 0 0 1 1 1\n", "62"));
    workplace.run("--texture a.ang --crystal-symmetry hexagonal --seeds 2 -n 0 -o a.vtp");
    workplace.put("a.ctf", format!("{ctf}0 0 0 0 0 0\n1 0 0 1,5 2 3\n"));
    workplace.run("--texture a.ctf --seeds 2 -n 0 -o a.vtp --stats a.json");
    let drawn = orientations(&workplace.json("a.json")["grains"]);
    let given = Orientation::from_euler_degrees([1.5, 2.0, 3.0]);
    assert!(CrystalSymmetry::Triclinic.disorientation_angle(drawn[0], given) < 1e-9);
}

/// The orientations of each phase of a map are for grains of that phase.
#[test]
fn a_map_of_two_phases_gives_the_texture_of_each() {
    let workplace = Workplace::new();
    workplace.run("--dim 2 --seeds 12 -n 0 --phase a:0.5,symmetry=hexagonal --phase b:0.5 --texture random --voxels 40 40 -o m.ang -o m.ctf --stats m.json");
    let measured = workplace.json("m.json");
    let of_phase = |table: &Value, phase: i64| -> Vec<Orientation> {
        let grains = table["grains"].as_array().unwrap().iter().zip(orientations(&table["grains"]));
        grains.filter(|(grain, _)| grain["Phase"].as_i64() == Some(phase)).map(|(_, found)| found).collect()
    };
    for map in ["m.ang", "m.ctf"] {
        workplace.run(&format!(
            "--seeds 9 -n 0 --phase a:0.5,symmetry=hexagonal,texture={map}#1 --phase b:0.5,texture={map}#2 --stats t.json -o a.vtp"
        ));
        let drawn = workplace.json("t.json");
        for (phase, symmetry) in [(1, CrystalSymmetry::Hexagonal), (2, CrystalSymmetry::Octahedral)] {
            let known = of_phase(&measured, phase);
            for found in of_phase(&drawn, phase) {
                let nearest = known.iter().map(|one| symmetry.disorientation_angle(*one, found));
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                assert!(nearest < 2e-3, "{map}: {nearest} degrees, which is more than the map's digits");
            }
        }
        // A file tells its settings, and these make it again.
        workplace.run("--config a.vtp -o b.vtp");
        assert!(workplace.bytes("a.vtp") == workplace.bytes("b.vtp"));
        workplace.refuses(
            &format!("--texture {map}#3"),
            FAILED,
            &format!("{map} line 1: holds no point of phase 3; it has phases 1, 2"),
        );
    }
}

/// Mackenzie's shares in bins of 5 degrees, with three times as much below 15 degrees.
const LOW_ANGLES: &str = "angle,weight\n5,0.00255\n10,0.0177\n15,0.0480\n20,0.0311\n25,0.0509\n30,0.0755\n35,0.1046\n40,0.1379\n\
                          45,0.1753\n50,0.1778\n55,0.1351\n60,0.0813\n65,0.0077\n";

#[test]
fn neighbours_get_the_disorientations_asked_for_and_components_keep_their_volumes() {
    let workplace = Workplace::new();
    workplace.put("angles.csv", LOW_ANGLES);
    for dimension in ["3", "2"] {
        let run = format!(
            "--seeds 300 --dim {dimension} -n 0 --relax 0 --texture cube(20)*0.3+random*0.7 -o a.vtp"
        );
        let said = workplace.run(&format!(
            "{run} --misorientations angles.csv --json-summary s.json --stats a.json --report r.html"
        ));
        assert!(said.contains("disorientations of neighbours are "), "{said}");
        let texture = &workplace.json("s.json")["texture"];
        let [before, after] =
            ["before", "after"].map(|when| texture["misorientations"][when].as_f64().unwrap());
        assert!(after < 0.03 && after < 0.3 * before, "{dimension}: from {before} to {after}");
        for (share, wanted) in texture["components"].as_array().unwrap().iter().zip([0.3, 0.7]) {
            assert!((share["reached"].as_f64().unwrap() / wanted - 1.0).abs() < 0.04, "{texture}");
        }
        // What is written has the shares below 15 degrees.
        let stats = workplace.json("a.json");
        let size = if dimension == "3" { "area" } else { "length" };
        let inside = stats["boundaries"].as_array().unwrap().iter();
        let inside = inside.filter(|boundary| boundary["Disorientation"].is_f64());
        let sizes: Vec<(f64, f64)> = inside
            .map(|boundary| (boundary["Disorientation"].as_f64().unwrap(), boundary[size].as_f64().unwrap()))
            .collect();
        let low: f64 = sizes.iter().filter(|(angle, _)| *angle <= 15.0).map(|(_, size)| size).sum();
        let share = low / sizes.iter().map(|(_, size)| size).sum::<f64>();
        assert!((share - 0.0653).abs() < 0.02, "{share}");
        let page = String::from_utf8(workplace.bytes("r.html")).unwrap();
        for part in
            ["Pole figure {001}", "Inverse pole figure Z", "Disorientations of neighbours", "asked for"]
        {
            assert!(page.contains(part), "{part}");
        }
        workplace.run("--config a.vtp -o b.vtp");
        assert!(workplace.bytes("a.vtp") == workplace.bytes("b.vtp"), "swaps repeat");
    }
}

/// The summary once told that their disorientations are NaN from those asked for.
#[test]
fn grain_without_neighbours_has_no_disorientations() {
    let workplace = Workplace::new();
    workplace.put("angles.csv", LOW_ANGLES);
    for run in ["--seeds 1", "--seeds 1 --periodic x,y,z", "--seeds 1 --dim 2"] {
        let said = workplace.run(&format!(
            "{run} --relax 0 -n 0 --texture random --misorientations angles.csv --report r.html --json-summary s.json -o a.vtp"
        ));
        assert!(said.contains("cubic crystals, random 100.0 %") && !said.contains("NaN"), "{said}");
        assert_eq!(workplace.json("s.json")["texture"]["misorientations"], Value::Null);
        let page = String::from_utf8(workplace.bytes("r.html")).unwrap();
        assert!(!page.split_once("<h2>Statistics</h2>").unwrap().1.contains("NaN"), "{run}");
    }
}

#[test]
fn histogram_of_disorientations_that_is_mistaken() {
    let workplace = Workplace::new();
    for (content, message) in [
        ("", "line 1: holds no bin; give the upper end of each in degrees, and its weight"),
        (
            "angle,weight\n5,1,2\n",
            "line 2: 3 columns; write the upper end of a bin in degrees and its weight",
        ),
        ("5,1\nx,1\n", "line 2: 'x' is not a finite number; correct it or remove the line"),
        (
            "5,1\n\n5,1\n",
            "line 3: bin 2 ends at 5, not above the one before; list positive ends in increasing order",
        ),
        ("5,-1\n", "line 1: bin 1 has the weight -1; give 0 or more, and more than 0 somewhere"),
        (
            "70,1\n80,1\n",
            "line 2: bin 2 begins at 70 degrees, but two cubic crystals differ by at most 62.8; give it the weight 0",
        ),
    ] {
        workplace.put("angles.csv", content);
        let message = format!("angles.csv {message}");
        workplace.refuses("--texture random --misorientations angles.csv", FAILED, &message);
    }
    workplace.put("angles.csv", "70,1\n80,0\n");
    workplace.run("--texture random --misorientations angles.csv --seeds 3 -n 0 -o a.vtp");
}
