use glam::DVec3;

use crate::surface_file::{SurfaceFile, integers};
use crate::workplace::{FAILED, USAGE, Workplace};

#[test]
fn axes_are_refused_where_they_make_no_sense() {
    let workplace = Workplace::new();
    for value in ["w", "x,w", "x,x", "xyz", ",", "x,", "1"] {
        let message = format!(
            "invalid value '{value}' for '--periodic <AXES>': name each axis once, with commas between: x, y, z, x,y or x,y,z; or none"
        );
        workplace.refuses(&format!("--periodic {value} --relax 0"), USAGE, &message);
    }
    workplace.refuses(
        "--dim 2 --periodic x,z --relax 0",
        USAGE,
        "--periodic z needs three dimensions; with --dim 2 give x, y or x,y",
    );
}

#[test]
fn duplicates_across_a_period_are_named() {
    let workplace = Workplace::new();
    workplace.put("seeds.csv", "0,0.5,0.5\n0.5,0.5,0.5\n1,0.5,0.5\n");
    workplace.refuses(
        "--seeds-file seeds.csv --periodic x --relax 0",
        FAILED,
        "seeds.csv line 1 and line 3: the same seed (0, 0.5, 0.5) twice; remove one of them",
    );
    workplace.run("--seeds-file seeds.csv --periodic y --relax 0 -n 0");
}

#[test]
fn grains_are_whole_and_copies_match() {
    let workplace = Workplace::new();
    let said = workplace.run("--seeds 20 --periodic x,y,z --relax 0 -n 1 -o grains.vtp");
    assert!(said.contains("0 on the walls") && said.contains("one period apart"), "{said}");
    let path = workplace.path("grains.vtp");
    let surface = SurfaceFile::read(&path);
    let mut volumes = [0.0; 20];
    for (cell, labels) in surface.cells.iter().zip(&surface.face_labels) {
        let [a, b, c] = [0, 1, 2].map(|corner| surface.points[cell[corner]]);
        let volume = a.dot(b.cross(c)) / 6.0;
        for (label, sign) in labels.iter().zip([1.0, -1.0]) {
            if let Ok(grain) = usize::try_from(*label) {
                volumes[grain] += sign * volume;
            }
        }
    }
    assert!(volumes.iter().all(|volume| *volume > 0.0));
    assert!((volumes.iter().sum::<f64>() - 1.0).abs() < 1e-12);

    let originals = integers(&path, "PeriodicOriginal");
    for (point, original) in surface.points.iter().zip(&originals) {
        let translation = *point - surface.points[usize::try_from(*original).unwrap()];
        let periods = translation.round();
        assert_eq!(surface.points[usize::try_from(*original).unwrap()] + periods, *point);
    }
    let neighbors = integers(&path, "PeriodicNeighbor");
    for (cell, labels) in surface.face_labels.iter().enumerate() {
        assert_ne!(labels[1], -1, "there is no exterior");
        assert_eq!(neighbors[cell] >= 0, labels[1] < -1);
        if labels[1] < -1 {
            let twin = surface.boundary_ids.iter().position(|boundary| *boundary == -2 - labels[1]).unwrap();
            assert_eq!(surface.face_labels[twin], [neighbors[cell], -2 - surface.boundary_ids[cell]]);
        }
    }
    let outside: f64 =
        surface.points.iter().map(|point| (*point - point.clamp(DVec3::ZERO, DVec3::ONE)).length()).sum();
    assert!(outside > 0.0, "whole grains stick out of the box");
}

#[test]
fn tables_name_a_grain_as_its_own_neighbor() {
    let workplace = Workplace::new();
    workplace.put("seeds.csv", "0.5,0.5,0.5\n");
    workplace.run("--seeds-file seeds.csv --periodic x,y --no-mesh --cells-json cells.json");
    let table = workplace.json("cells.json");
    assert_eq!(table["cells"][0]["neighbors"], serde_json::json!([-6, -5, 0, 0, 0, 0]));
    assert!((table["cells"][0]["volume"].as_f64().unwrap() - 1.0).abs() < 1e-15);
}

#[test]
fn every_format_and_the_plane() {
    let workplace = Workplace::new();
    for arguments in [
        "--periodic x -o g.vtu",
        "--periodic y,z -o g.vtk",
        "--dim 2 --periodic x,y -o g.vtp",
        "--dim 2 --periodic y",
    ] {
        let said = workplace.run(&format!("{arguments} --seeds 12 --relax 0 -n 1"));
        assert!(said.contains("validation  good"), "{said}");
    }
    let bytes = |threads: usize| {
        workplace.run(&format!("--periodic x,y,z --seeds 40 --relax 0 -n 1 --threads {threads} -o t.vtp"));
        workplace.bytes("t.vtp")
    };
    assert!(bytes(1) == bytes(2), "the file does not depend on the number of threads");
}

/// Cut at the box, grains end at its walls; the checks that every network passes are those of a box without periods.
#[test]
fn grains_are_cut_at_the_box() {
    let workplace = Workplace::new();
    for (arguments, axes) in [
        ("--seeds 20 --periodic x,y,z -n 1", 3),
        ("--seeds 20 --periodic y --box 1 2 1 -n 1", 3),
        ("--dim 2 --seeds 20 --periodic x,y -n 2", 2),
        // The smaller grain stands behind no more than a part of a wall that no boundary meets.
        ("--dim 2 --seeds 2 --rng-seed 1 --periodic x,y -n 2", 2),
    ] {
        let said = workplace.run(&format!("{arguments} --periodic-cut box -o cut.vtp"));
        assert!(said.contains("validation  good") && !said.contains("one period apart"), "{said}");
        if axes == 3 {
            let surface = SurfaceFile::read(&workplace.path("cut.vtp"));
            assert!(surface.face_labels.iter().flatten().all(|label| (-1..20).contains(label)));
            let upper = if arguments.contains("--box") { DVec3::new(1.0, 2.0, 1.0) } else { DVec3::ONE };
            let is_inside = |point: &DVec3| point.cmpge(DVec3::ZERO).all() && point.cmple(upper).all();
            assert!(surface.points.iter().all(is_inside));
        }
        workplace.command("check cut.vtp").assert().success();
        workplace.run("--config cut.vtp -o again.vtp");
        assert!(workplace.bytes("cut.vtp") == workplace.bytes("again.vtp"), "{arguments}");
        workplace.run(&format!("{arguments} --periodic-cut wrap -o whole.vtp"));
        workplace.run(&format!("{arguments} -o as_ever.vtp"));
        assert!(workplace.bytes("whole.vtp") == workplace.bytes("as_ever.vtp"), "{arguments}");
    }
    workplace
        .run("--seeds 20 --periodic x,y,z -n 0 --periodic-cut box --report r.html --stats s.json -o cut.fe");
}

#[test]
fn lattices_with_boundaries_in_the_walls_are_cut() {
    let workplace = Workplace::new();
    for arguments in [
        "--lattice sc 3 --periodic x,y,z",
        "--lattice fcc 2 --periodic x,y",
        "--dim 2 --lattice hex 3 --periodic x,y",
    ] {
        workplace.run(&format!("{arguments} -n 1 --periodic-cut box -o cut.vtp"));
        workplace.command("check cut.vtp").assert().success();
    }
    // A grain that fills all space is a box.
    workplace.run("--seeds 1 --periodic x,y,z -n 0 --periodic-cut box -o cut.vtp");
    workplace.command("check cut.vtp").assert().success();
}

/// Its boundaries lie in the walls but for 1e-8: that once was an error, whatever points moved.
#[test]
fn noisy_lattices_with_boundaries_near_the_walls_move_to_be_cut() {
    let workplace = Workplace::new();
    let off = |k: u32| (DVec3::new(0.819, 0.671, 0.550) * f64::from(k)).fract() * 1e-8;
    let place =
        |k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)) + 0.5 + off(k);
    let seeds: Vec<String> = (0..8).map(|k| place(k).to_array().map(|x| x.to_string()).join(" ")).collect();
    workplace.put("seeds.txt", seeds.join("\n"));
    let said = workplace.run(
        "--seeds-file seeds.txt --box 2 2 2 --periodic y,z --periodic-cut box --relax 0 --regularize 0 -n 1 -o cut.vtp",
    );
    assert!(said.contains("cut         all grains moved by (0.0000, "), "{said}");
    assert!(said.contains("given up    the cut at the box, grains where they are: "), "{said}");
    workplace.command("check cut.vtp").assert().success();
}

/// A boundary of a grain and the walls goes all round the box, and one of few grains comes in several parts.
#[test]
fn boundaries_in_the_plane_that_a_cut_leaves_in_parts_are_written_in_parts() {
    let workplace = Workplace::new();
    workplace.put("seeds.txt", "0.23 0.95 0\n0.66 0.78 0\n0.77 0.83 0\n");
    for seeds in ["--seeds 1", "--seeds-file seeds.txt --relax equilibrium"] {
        workplace.run(&format!("--dim 2 {seeds} --periodic y -n 1 --periodic-cut box -o cut.vtp"));
        workplace.command("check cut.vtp").assert().success();
    }
}

#[test]
fn cuts_are_refused_where_they_make_no_sense() {
    let workplace = Workplace::new();
    workplace.refuses(
        "--periodic x --periodic-cut half",
        USAGE,
        "invalid value 'half' for '--periodic-cut <RULE>'",
    );
    workplace.refuses(
        "--periodic-cut box",
        USAGE,
        "--periodic-cut box needs periodic grains; give --periodic x,y,z or leave it out",
    );
    workplace.refuses(
        "--periodic x --periodic-cut box --series a.pvd",
        USAGE,
        "--series shows whole grains; leave --periodic-cut box out",
    );
    workplace.refuses(
        "--lattice fcc 1 --box 1 1 2 --periodic y --periodic-cut box --faces plain --relax 0.113 --junctions corner -n 1",
        FAILED,
        "grain 1 touches its own image, so cut at the box it would touch itself; keep grains whole, or give more seeds; ... wide (7.816e-1)",
    );
}

/// Opposite grains of a face-centred lattice touch in points. With one cell along each axis they are images of one grain.
#[test]
fn a_grain_that_would_touch_itself_in_the_box_is_named() {
    let workplace = Workplace::new();
    let lattice = "--periodic x,y,z --periodic-cut box -n 0 --lattice fcc";
    let said = "grain 0 touches its own image, so cut at the box it would touch itself; keep grains whole, or give more seeds; grain 0 (SeedId 0), 1.00e0 mean equivalent diameters wide ... )";
    workplace.refuses(&format!("{lattice} 1"), FAILED, said);
    // Here they touch in lines.
    workplace.refuses(
        "--lattice fcc 1 --box 1 1 0.2 --periodic y,z -n 0 --periodic-cut box --relax 0",
        FAILED,
        said,
    );
    // What each way of cutting said was dropped once.
    let output = workplace.command(&format!("{lattice} 1")).assert().code(FAILED).get_output().clone();
    let log = String::from_utf8(output.stderr).unwrap();
    let given_up =
        |log: &str| log.lines().filter(|line| line.starts_with("given up    the cut at the box, ")).count();
    assert_eq!(given_up(&log), 3, "{log}");
    assert_eq!(log.lines().count(), 4, "{log}");
    let output =
        workplace.command(&format!("{lattice} 1 --quiet")).assert().code(FAILED).get_output().clone();
    assert_eq!(given_up(&String::from_utf8(output.stderr).unwrap()), 0);
    workplace.run(&format!("{lattice} 2"));
    workplace.run("--periodic x,y,z -n 0 --lattice fcc 1");
}
