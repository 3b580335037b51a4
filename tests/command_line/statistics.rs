//! `--stats` and `--arrays`: what is measured, read back.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_3, PI};
use std::fs;

use grainsmooth::vtk::inlined;
use serde_json::Value;
use vtkio::model::{Attribute, DataSet, Piece, PolyDataPiece, Vtk};

use crate::workplace::{FAILED, USAGE, Workplace};

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
    let all = workplace.json("grains.json");
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

/// Nothing once told that half of the quadruple points join five grains or more: short edges collapse by default.
#[test]
fn higher_order_junctions_are_told_apart() {
    let workplace = Workplace::new();
    let periodic =
        "--seeds 60 --seeding random --periodic x,y,z -n 0 --stats a.json --json-summary run.json -o a.vtp";
    let said = workplace.run(periodic);
    let [all, run] = ["a.json", "run.json"].map(|name| workplace.json(name));
    let topology = &run["topology"];
    assert_eq!(all["topology"], *topology);
    let number = |key: &str| topology[key].as_f64().unwrap();
    assert!((number("faces") - all["distributions"]["faces"]["mean"].as_f64().unwrap()).abs() < 1e-12);
    assert!(number("faces") < number("faces_before") - 1.0, "{said}");
    let mut by_grains: BTreeMap<String, u64> = BTreeMap::new();
    let counts = numbers(&workplace, "a.vtp", "NumberOfGrains");
    for row in rows(&all, "quadruple_points") {
        let point = usize::try_from(row["point"].as_u64().unwrap()).unwrap();
        assert_eq!(row["grains"].as_f64(), Some(counts[point]));
        *by_grains.entry(row["grains"].to_string()).or_default() += 1;
    }
    assert_eq!(topology["points_by_grains"], serde_json::to_value(&by_grains).unwrap());
    assert!(by_grains.keys().any(|grains| grains != "4"), "{by_grains:?}");
    let mut by_boundaries: BTreeMap<String, u64> = BTreeMap::new();
    for row in rows(&all, "triple_lines") {
        assert_eq!(row["grains"], row["sides"].as_array().unwrap().len());
        *by_boundaries.entry(row["boundaries"].as_array().unwrap().len().to_string()).or_default() += 1;
    }
    assert_eq!(topology["lines_by_boundaries"], serde_json::to_value(&by_boundaries).unwrap());
    let counted = |counts: &BTreeMap<String, u64>, what: &str| {
        let mut counts: Vec<String> =
            counts.iter().map(|(number, count)| format!("{count} of {number}")).collect();
        counts[0] += &format!(" {what}");
        format!("({})", counts.join(", "))
    };
    let line = said.lines().find(|line| line.starts_with("junctions ")).unwrap();
    assert!(line.contains(&counted(&by_grains, "grains")), "{line}");
    assert!(line.contains(&counted(&by_boundaries, "boundaries")), "{line}");
    let faces =
        format!("; {:.2} faces a grain, {:.2} before relaxation", number("faces"), number("faces_before"));
    assert!(line.ends_with(&faces), "{line}");

    workplace.run(&format!("{periodic} --regularize 0"));
    let topology = &workplace.json("run.json")["topology"];
    assert_eq!(topology["faces"], topology["faces_before"]);
    assert_eq!(topology["points_by_grains"].as_object().unwrap().keys().collect::<Vec<_>>(), ["4"]);
    assert!(numbers(&workplace, "a.vtp", "NumberOfGrains").iter().all(|grains| (2.0..=4.0).contains(grains)));
    // In the plane only three grains meet, by default.
    workplace.run("--dim 2 --seeds 60 --json-summary run.json");
    let run = workplace.json("run.json");
    assert_eq!(run["settings"]["relax"], "equilibrium");
    assert_eq!(run["topology"]["points_by_grains"].as_object().unwrap().keys().collect::<Vec<_>>(), ["3"]);
    for (arguments, relax) in
        [("--free", 0.3), ("--edge-length 0.05", 0.3), ("--regularize 0", 0.3), ("--relax 0.1", 0.1)]
    {
        workplace
            .run(&format!("--dim 2 --seeds 9 --seeding random -n 0 --json-summary run.json {arguments}"));
        assert_eq!(workplace.json("run.json")["settings"]["relax"], relax, "{arguments}");
    }
}

/// (6V/pi)^(1/3) of a cube of 1/8 is 0.6204; the sides of the box are 2 micrometres long, say.
#[test]
fn diameters_are_told_in_the_unit_of_the_box() {
    let workplace = Workplace::new();
    let said = workplace.run("--lattice sc 2 --box 2 2 2 -n 0 --json-summary run.json");
    let line = "diameters   1.241 +- 0.0 in the unit of the box, equivalent: (6V/pi)^(1/3)";
    assert!(said.lines().any(|said| said == line), "{said}");
    let diameter = &workplace.json("run.json")["equivalent_diameter"];
    assert!((diameter["mean"].as_f64().unwrap() - (6.0 / PI).cbrt()).abs() < 1e-12);
    let said = workplace.run("--dim 2 --seeds 20 --no-mesh --cells-json c.json");
    let cells = workplace.json("c.json");
    let mean = sum(&cells, "cells", "equivalent_diameter") / 20.0;
    let line = said.lines().find(|line| line.starts_with("diameters ")).unwrap();
    assert!(line.ends_with("in the unit of the box, equivalent: 2 sqrt(A/pi)"), "{line}");
    let told: f64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
    assert!((told / mean - 1.0).abs() < 5e-4, "{line}");
}

#[test]
fn statistics_as_csv_are_those_of_json() {
    let workplace = Workplace::new();
    let said = workplace.run("--seeds 8 -n 1 --stats a.csv");
    let names = ["a.csv", "a.boundaries.csv", "a.triple_lines.csv", "a.quadruple_points.csv"];
    assert!(said.ends_with(&format!("written     grains.vtp, {}\n", names.join(", "))), "{said}");
    workplace.run("--seeds 8 -n 1 --stats a.json");
    let document = workplace.json("a.json");
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
    let all = workplace.json("a.json");
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
    let all = workplace.json("a.json");
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
    let all = workplace.json("a.json");
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
