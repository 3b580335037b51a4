use serde_json::Value;

use crate::workplace::{FAILED, USAGE, Workplace};

/// Seed 1 is outweighed by the large spheres around it.
const OUTWEIGHED: &str = "x,y,z,radius\n0.3,0.5,0.5,0.4\n0.5,0.5,0.5,0\n0.7,0.5,0.5,0.4\n0.5,0.9,0.5,0.3\n";

fn table(workplace: &Workplace, name: &str) -> Vec<Value> {
    let table: Value = serde_json::from_slice(&workplace.bytes(name)).unwrap();
    table["cells"].as_array().unwrap().clone()
}

#[test]
fn grains_without_volume_are_named_or_dropped() {
    let workplace = Workplace::new();
    workplace.put("seeds.csv", OUTWEIGHED);
    workplace.refuses(
        "--seeds-file seeds.csv",
        FAILED,
        "weights leave grain 1 without volume; change their radii, or go on without them with --drop-empty",
    );
    let said = workplace.run("--seeds-file seeds.csv --drop-empty -n 1");
    assert!(said.contains("grains      3 in [0, 1] x [0, 1] x [0, 1]"), "{said}");
}

#[test]
fn tables_hold_every_cell() {
    let workplace = Workplace::new();
    let said = workplace.run("--seeds 30 --no-mesh --cells-json cells.json --cells-csv cells.csv");
    assert!(said.contains("written     cells.json, cells.csv"), "{said}");
    let cells = table(&workplace, "cells.json");
    assert_eq!(cells.len(), 30);
    let sum: f64 = cells.iter().map(|cell| cell["volume"].as_f64().unwrap()).sum();
    assert!((sum - 1.0).abs() < 1e-12);
    for (id, cell) in cells.iter().enumerate() {
        assert_eq!(cell["id"].as_u64(), Some(id as u64));
        assert_eq!(cell["neighbors"].as_array().unwrap().len() as u64, cell["nfaces"].as_u64().unwrap());
        let count = |name: &str| cell[name].as_i64().unwrap();
        assert_eq!(count("nverts") - count("nedges") + count("nfaces"), 2);
        assert!((0.3..1.0).contains(&cell["sphericity"].as_f64().unwrap()));
    }
    let csv = String::from_utf8(workplace.bytes("cells.csv")).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 31);
    let volume: f64 = lines[1].split(',').nth(5).unwrap().parse().unwrap();
    assert_eq!(Some(volume), cells[0]["volume"].as_f64());
    assert_eq!(workplace.bytes("grains.vtp"), b"an earlier result", "no mesh was asked for");
}

#[test]
fn tables_in_the_plane() {
    let workplace = Workplace::new();
    workplace.put("seeds.csv", "x,y,radius\n0.25,0.5,0.25\n0.75,0.5,0\n");
    workplace.run("--dim 2 --seeds-file seeds.csv --no-mesh --cells-json cells.json --cells-csv cells.csv");
    let cells = table(&workplace, "cells.json");
    // The bisector lies r^2 / (2 d) = 1/16 from the middle.
    assert_eq!(cells[0]["area"].as_f64(), Some(0.5625));
    assert_eq!(cells[1]["perimeter"].as_f64(), Some(2.875));
    assert_eq!(cells[0]["neighbors"], serde_json::json!([-4, -3, -1, 1]));
    assert_eq!(cells[1]["centroid"], serde_json::json!([0.78125, 0.5]));
    assert!(String::from_utf8(workplace.bytes("cells.csv")).unwrap().starts_with("id,x,y,weight,area,"));
}

#[test]
fn tables_that_cannot_be_written_are_found_before() {
    let workplace = Workplace::new();
    workplace.refuses(
        "--cells-json missing/cells.json",
        FAILED,
        "missing/cells.json: no directory missing; create it or choose another path",
    );
}

#[test]
fn no_mesh_has_no_output() {
    let workplace = Workplace::new();
    workplace.command("--no-mesh -o grains.vtp").assert().code(USAGE).stdout("");
}
