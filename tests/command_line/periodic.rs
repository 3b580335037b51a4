use glam::DVec3;
use serde_json::Value;

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
    assert!(said.contains("0 on the walls") && said.contains("a period apart"), "{said}");
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
        let shift = *point - surface.points[usize::try_from(*original).unwrap()];
        let periods = shift.round();
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
    let table: Value = serde_json::from_slice(&workplace.bytes("cells.json")).unwrap();
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
