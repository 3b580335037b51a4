//! `--stats` and `--arrays`: what is measured, read back.

use std::f64::consts::FRAC_PI_3;
use std::fs;

use grainsmooth::vtk::inlined;
use serde_json::Value;
use vtkio::model::{Attribute, DataSet, Piece, PolyDataPiece, Vtk};

use crate::workplace::{FAILED, USAGE, Workplace};

fn json(workplace: &Workplace, name: &str) -> Value {
    serde_json::from_slice(&workplace.bytes(name)).unwrap()
}

fn rows<'a>(document: &'a Value, table: &str) -> &'a Vec<Value> {
    document[table].as_array().unwrap()
}

/// The row of a number.
fn row<'a>(document: &'a Value, table: &str, id: f64) -> &'a Value {
    rows(document, table).iter().find(|row| row["id"].as_f64() == Some(id)).unwrap()
}

fn sum(document: &Value, table: &str, column: &str) -> f64 {
    rows(document, table).iter().map(|row| row[column].as_f64().unwrap()).sum()
}

/// The header and the rows of a CSV file.
fn csv(workplace: &Workplace, name: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let text = String::from_utf8(workplace.bytes(name)).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    (lines.next().unwrap(), lines.collect())
}

/// Cell and point arrays of numbers in a .vtp file.
fn numbers(workplace: &Workplace, file: &str, name: &str) -> Vec<f64> {
    let bytes = inlined(&workplace.bytes(file));
    let DataSet::PolyData { pieces, .. } = Vtk::parse_xml(&bytes[..]).unwrap().data else {
        panic!("no PolyData")
    };
    let Some(Piece::Inline(piece)) = pieces.into_iter().next() else { panic!("no piece in the file") };
    let PolyDataPiece { data, .. } = *piece;
    let array = [data.cell, data.point].concat().into_iter().find_map(|attribute| match attribute {
        Attribute::DataArray(array) if array.name == name => Some(array),
        _ => None,
    });
    array.unwrap_or_else(|| panic!("no array {name}")).data.cast_into().unwrap()
}

#[test]
fn statistics_of_a_periodic_network_sum_up() {
    let workplace = Workplace::new();
    let said = workplace.run("--seeds 12 -n 1 --periodic x,y,z --regularize 0 --stats grains.json");
    assert!(said.ends_with("written     grains.vtp, grains.json\n"), "{said}");
    let all = json(&workplace, "grains.json");
    assert!((sum(&all, "grains", "volume") - 1.0).abs() < 1e-9);
    // What one grain gains others lose.
    assert!(sum(&all, "grains", "growth_rate").abs() < 1e-9);
    // V - E + F - C = 0 on the torus.
    let count = |table: &str| rows(&all, table).len();
    assert_eq!(count("quadruple_points") + count("boundaries"), count("triple_lines") + count("grains"));
    assert_eq!(all["distributions"]["volume"]["count"], 12);
    assert!((all["distributions"]["dihedral_angle"]["mean"].as_f64().unwrap() - 120.0).abs() < 1e-9);
    let faces: f64 = sum(&all, "grains", "faces");
    assert_eq!(faces, 2.0 * count("boundaries") as f64, "each boundary has two sides");
    for line in rows(&all, "triple_lines") {
        let angles: f64 = line["mean_angles"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).sum();
        assert!((angles - 360.0).abs() < 1e-9);
    }
}

#[test]
fn statistics_as_csv_are_those_of_json() {
    let workplace = Workplace::new();
    let said = workplace.run("--seeds 8 -n 1 --stats a.csv");
    let names = ["a.csv", "a.boundaries.csv", "a.triple_lines.csv", "a.quadruple_points.csv"];
    assert!(said.ends_with(&format!("written     grains.vtp, {}\n", names.join(", "))), "{said}");
    workplace.run("--seeds 8 -n 1 --stats a.json");
    let document = json(&workplace, "a.json");
    for (name, table) in names.into_iter().zip(["grains", "boundaries", "triple_lines", "quadruple_points"]) {
        let (header, lines) = csv(&workplace, name);
        let rows = rows(&document, table);
        assert_eq!(lines.len(), rows.len());
        for (line, row) in lines.iter().zip(rows) {
            assert_eq!(line.len(), header.len());
            assert_eq!(row.as_object().unwrap().len(), header.len());
            for (value, column) in line.iter().zip(&header) {
                match &row[column] {
                    Value::Null => assert_eq!(value, ""),
                    Value::Number(number) => {
                        assert_eq!(number.as_f64(), Some(value.parse::<f64>().unwrap()), "{column}");
                    }
                    Value::Bool(flag) => assert_eq!(value, &flag.to_string()),
                    Value::Array(list) => assert_eq!(value.split_whitespace().count(), list.len()),
                    other => panic!("{other}"),
                }
            }
        }
    }
}

#[test]
fn statistics_in_the_plane() {
    let workplace = Workplace::new();
    workplace.run("--dim 2 --seeds 30 -n 2 --periodic x,y --regularize 0 --stats a.json");
    let all = json(&workplace, "a.json");
    assert!((sum(&all, "grains", "area") - 1.0).abs() < 1e-9);
    assert!((all["distributions"]["sides"]["mean"].as_f64().unwrap() - 6.0).abs() < 1e-12);
    for grain in rows(&all, "grains") {
        let rate = FRAC_PI_3 * (grain["sides"].as_f64().unwrap() - 6.0);
        assert!((grain["growth_rate"].as_f64().unwrap() - rate).abs() < 1e-12);
    }
    assert_eq!(rows(&all, "triple_points").len(), 60, "two for each grain");
    workplace.run("--dim 2 --seeds 30 -n 2 --stats a.csv");
    assert_eq!(csv(&workplace, "a.triple_points.csv").0[..3], ["point", "x", "y"]);
}

#[test]
fn statistics_that_cannot_be_written_are_found_beforehand() {
    let workplace = Workplace::new();
    let message = "invalid value 'a.txt' for '--stats <F>': unknown extension; name the file *.json or *.csv";
    workplace.refuses("--seeds 100000 --stats a.txt", USAGE, message);
    let message = "no/a.json: no directory no; create it or choose another path";
    workplace.refuses("--seeds 100000 --stats no/a.json", FAILED, message);
    // The tables beside are looked at too.
    fs::create_dir(workplace.path("a.triple_lines.csv")).unwrap();
    let message = "a.triple_lines.csv: is not a regular file; choose another path";
    workplace.refuses("--seeds 100000 --stats a.csv", FAILED, message);
    workplace.command("--no-mesh --stats a.json").assert().code(USAGE);
}

#[test]
fn arrays_are_what_statistics_say() {
    let workplace = Workplace::new();
    workplace.run("--seeds 10 -n 2 --arrays --stats a.json");
    let all = json(&workplace, "a.json");
    let ids = numbers(&workplace, "grains.vtp", "BoundaryId");
    let areas = numbers(&workplace, "grains.vtp", "BoundaryArea");
    let curvatures = numbers(&workplace, "grains.vtp", "BoundaryMeanCurvature");
    let labels = numbers(&workplace, "grains.vtp", "FaceLabels");
    let volumes = numbers(&workplace, "grains.vtp", "GrainVolumes");
    for (cell, id) in ids.iter().enumerate() {
        let boundary = row(&all, "boundaries", *id);
        assert_eq!(boundary["area"].as_f64(), Some(areas[cell]));
        assert_eq!(boundary["mean_curvature"].as_f64(), Some(curvatures[cell]));
        for side in [2 * cell, 2 * cell + 1] {
            match labels[side] {
                -1.0 => assert!(volumes[side].is_nan()),
                grain => {
                    let row = row(&all, "grains", grain);
                    assert_eq!(row["volume"].as_f64(), Some(volumes[side]));
                }
            }
        }
    }
    let node_types = numbers(&workplace, "grains.vtp", "NodeTypes");
    let mean = numbers(&workplace, "grains.vtp", "MeanCurvature");
    let gaussian = numbers(&workplace, "grains.vtp", "GaussianCurvature");
    let smallest = numbers(&workplace, "grains.vtp", "SmallestDihedralAngle");
    let largest = numbers(&workplace, "grains.vtp", "LargestDihedralAngle");
    for (point, code) in node_types.iter().enumerate() {
        assert_eq!(mean[point].is_nan(), gaussian[point].is_nan());
        match code {
            2.0 => assert!(mean[point].is_finite() && smallest[point].is_nan()),
            3.0 => {
                assert!(mean[point].is_nan());
                assert!(0.0 < smallest[point] && smallest[point] <= 120.0 && 120.0 <= largest[point]);
            }
            _ => {}
        }
    }
    workplace.run("--seeds 10 -n 2 -o plain.vtp");
    let bytes = inlined(&workplace.bytes("plain.vtp"));
    assert!(!String::from_utf8_lossy(&bytes).contains("MeanCurvature"), "only where they are asked for");
}

#[test]
fn arrays_of_blocks_are_what_statistics_say() {
    let workplace = Workplace::new();
    workplace.run("--seeds 6 -n 1 --periodic x,y,z --arrays --stats a.json -o a.vtm");
    let all = json(&workplace, "a.json");
    let grains = numbers(&workplace, "a/grains.vtp", "GrainId");
    let rates = numbers(&workplace, "a/grains.vtp", "GrowthRate");
    for (grain, rate) in grains.iter().zip(rates) {
        assert_eq!(row(&all, "grains", *grain)["growth_rate"].as_f64(), Some(rate));
    }
    // Copies have what their originals have: no length but those known.
    let known: Vec<f64> =
        rows(&all, "triple_lines").iter().map(|line| line["length"].as_f64().unwrap()).collect();
    let lengths = numbers(&workplace, "a/triple_lines.vtp", "Length");
    assert!(!lengths.is_empty() && lengths.iter().all(|length| known.contains(length)));
    let angles = numbers(&workplace, "a/quadruple_points.vtp", "MeanAngle");
    assert!(!angles.is_empty() && angles.iter().all(|angle| (50.0..130.0).contains(angle)));
    assert!(numbers(&workplace, "a/boundaries.vtp", "MeanCurvature").iter().any(|value| value.is_finite()));
}

#[test]
fn arrays_in_the_plane() {
    let workplace = Workplace::new();
    for name in ["a.vtp", "a.vtu", "a.vtk"] {
        workplace.run(&format!("--dim 2 --seeds 10 -n 2 --arrays -o {name}"));
    }
    let lengths = numbers(&workplace, "a.vtp", "BoundaryLength");
    assert!(lengths.iter().all(|length| *length > 0.0));
    let areas = numbers(&workplace, "a.vtp", "GrainAreas");
    assert_eq!(areas.len(), 2 * lengths.len());
    let smallest = numbers(&workplace, "a.vtp", "SmallestDihedralAngle");
    assert!(smallest.iter().any(|angle| angle.is_finite()) && smallest.iter().any(|angle| angle.is_nan()));
    for name in ["a.vtu", "a.vtk"] {
        let bytes = workplace.bytes(name);
        let has = |text: &str| bytes.windows(text.len()).any(|window| window == text.as_bytes());
        assert!(has("BoundaryLength") && has("GrainAreas") && has("MeanCurvature"), "{name}");
    }
}
