use grainsmooth::vtk::field_bytes;
use serde_json::Value;

use crate::surface_file::integers;
use crate::workplace::{FAILED, USAGE, Workplace};

/// Seed 1 is outweighed by the large spheres around it.
const OUTWEIGHED: &str = "x,y,z,radius\n0.3,0.5,0.5,0.4\n0.5,0.5,0.5,0\n0.7,0.5,0.5,0.4\n0.5,0.9,0.5,0.3\n";

fn table(workplace: &Workplace, name: &str) -> Vec<Value> {
    let table = workplace.json(name);
    table["cells"].as_array().unwrap().clone()
}

#[test]
fn grains_without_volume_are_named_or_dropped() {
    let workplace = Workplace::new();
    workplace.put("seeds.csv", OUTWEIGHED);
    workplace.refuses(
        "--seeds-file seeds.csv",
        FAILED,
        "weights leave grain 1 without volume; change their radii, or drop them with --drop-empty",
    );
    let said = workplace.run("--seeds-file seeds.csv --drop-empty -n 1");
    assert!(said.contains("grains      3 in [0, 1] x [0, 1] x [0, 1]"), "{said}");
}

/// Grains were once numbered anew without a word.
#[test]
fn numbers_of_seeds_are_kept_where_seeds_are_dropped() {
    let workplace = Workplace::new();
    workplace.put("seeds.csv", OUTWEIGHED);
    let dropping = "--seeds-file seeds.csv --drop-empty -n 0";
    let said = workplace.run(&format!(
        "{dropping} --cells-csv c.csv --cells-json c.json --stats s.json --json-summary run.json --grains-dir grains"
    ));
    assert!(said.lines().any(|line| line == "dropped     1 seed (SeedId 1) that others outweigh"), "{said}");
    assert_eq!(workplace.json("run.json")["dropped_seeds"], serde_json::json!([1]));
    for rows in [&workplace.json("c.json")["cells"], &workplace.json("s.json")["grains"]] {
        let ids: Vec<&Value> = rows.as_array().unwrap().iter().map(|row| &row["SeedId"]).collect();
        assert_eq!(ids, [0, 2, 3]);
    }
    let csv = String::from_utf8(workplace.bytes("c.csv")).unwrap();
    let ids: Vec<&str> = csv.lines().map(|line| line.rsplit(',').next().unwrap()).collect();
    assert_eq!(ids, ["SeedId", "0", "2", "3"]);

    let ids: Vec<u8> = [0i32, 2, 3].iter().flat_map(|id| id.to_ne_bytes()).collect();
    for name in ["a.vtp", "a.vtu", "a.vti"] {
        workplace.run(&format!("{dropping} --voxels 4 4 4 -o {name}"));
        assert_eq!(field_bytes(&workplace.bytes(name), "SeedId"), Some(ids.clone()), "{name}");
    }
    workplace.run(&format!("{dropping} -o a.vtk"));
    let legacy: Vec<u8> = [0i32, 2, 3].iter().flat_map(|id| id.to_be_bytes()).collect();
    let expected = [b"SeedId 1 3 int\n", &legacy[..]].concat();
    assert!(workplace.bytes("a.vtk").windows(expected.len()).any(|bytes| bytes == expected));
    workplace.run(&format!("{dropping} -o a.vtm"));
    let [grains, seeds] = ["GrainId", "SeedId"].map(|name| integers(&workplace.path("a/grains.vtp"), name));
    assert!(
        grains.iter().zip(&seeds).all(|(grain, seed)| [0, 2, 3][usize::try_from(*grain).unwrap()] == *seed)
    );
    assert_eq!(seeds.iter().max(), Some(&3));
    let of_last = integers(&workplace.path("grains/grain_2.vtp"), "SeedId");
    assert!(!of_last.is_empty() && of_last.iter().all(|id| *id == 3));

    for (name, comment) in [
        ("a.ply", "comment SeedId 0 2 3\n"),
        ("a.obj", "# SeedId 0 2 3\n"),
        ("a.msh", "\nSeedId 0 2 3\n"),
        ("a.geo", "// SeedId 0 2 3\n"),
        ("a.fe", "// SeedId 0 2 3\n"),
        ("a.tess", "  *id\n   1 3 4\n"),
    ] {
        if name != "a.geo" {
            workplace.run(&format!("{dropping} -o {name}"));
            workplace.run(&format!("--config {name} -o again.vtp"));
        }
        let has = |bytes: &[u8]| bytes.windows(comment.len()).any(|bytes| bytes == comment.as_bytes());
        assert!(has(&workplace.bytes(name)), "{name}");
    }
    workplace.run("--seeds-file a.tess -n 0 -o again.vtp");
    // Only where numbers differ.
    workplace.run("--seeds 3 -n 0 -o a.obj");
    assert!(!String::from_utf8(workplace.bytes("a.obj")).unwrap().contains("SeedId"));
}

/// A tiny seed beside a large one in each of two corners: the one in the middle of its cluster of three goes first.
#[test]
fn tiny_cells_are_merged_into_what_surrounds_them() {
    let workplace = Workplace::new();
    let close = ["0.500 0.5", "0.503 0.5", "0.506 0.5", "0.503 0.503"];
    let far = ["0.1 0.1", "0.9 0.1", "0.1 0.9", "0.9 0.9", "0.5 0.1", "0.5 0.9"];
    workplace.put("seeds.txt", [close.join("\n"), far.join("\n")].join("\n"));
    let cells = "--dim 2 --seeds-file seeds.txt --no-mesh";
    workplace.run(&format!("{cells} --cells-json all.json"));
    let said = workplace.run(&format!("{cells} --min-diameter 0.7 --cells-json kept.json"));
    let merged = said.lines().find(|line| line.starts_with("merged ")).expect(&said);
    assert!(
        merged.contains("(SeedId 1") && merged.ends_with(" with cells below 0.7 mean diameters"),
        "{said}"
    );
    let kept = table(&workplace, "kept.json");
    let diameters: Vec<f64> = kept.iter().map(|cell| cell["equivalent_diameter"].as_f64().unwrap()).collect();
    let mean = diameters.iter().sum::<f64>() / diameters.len() as f64;
    assert!(diameters.iter().all(|diameter| *diameter >= 0.7 * mean), "{diameters:?}");
    assert!((kept.iter().map(|cell| cell["area"].as_f64().unwrap()).sum::<f64>() - 1.0).abs() < 1e-12);
    // What is left is the diagram of the seeds that are left, and their numbers lead back to them.
    let all = table(&workplace, "all.json");
    for cell in &kept {
        let seed = cell["SeedId"].as_u64().unwrap();
        assert_eq!(cell["seed"], all[usize::try_from(seed).unwrap()]["seed"]);
        assert_ne!(seed, 1);
    }
    assert_eq!(said, workplace.run(&format!("{cells} --min-diameter 0.7 --cells-json kept.json")));
    for share in ["1", "-0.1", "NaN", "tiny"] {
        workplace.refuses(
            &format!("--min-diameter {share}"),
            USAGE,
            &format!(
                "invalid value '{share}' for '--min-diameter <F>': give a share of the mean diameter, from 0 (off) to below 1"
            ),
        );
    }
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

/// Without a mesh, cells of seeds that are used as they are come without their complex.
#[test]
fn tables_of_cells_are_the_same_with_and_without_a_mesh() {
    let workplace = Workplace::new();
    workplace.put("radii.csv", "x,y,z,radius\n0.2,0.3,0.4,0.1\n0.8,0.3,0.5,0.2\n0.5,0.8,0.9,0.05\n");
    for seeds in ["--seeds 60 --seeding random --periodic x,y", "--lattice bcc 2", "--seeds-file radii.csv"] {
        workplace.run(&format!("{seeds} --relax 0 -n 0 --cells-json whole.json -o whole.vtp"));
        workplace.run(&format!("{seeds} --no-mesh --cells-json alone.json --cells-csv alone.csv"));
        let [whole, alone] = ["whole.json", "alone.json"].map(|name| table(&workplace, name));
        assert_eq!(whole.len(), alone.len(), "{seeds}");
        for (whole, alone) in whole.iter().zip(&alone) {
            for (name, value) in whole.as_object().unwrap() {
                match (value.as_f64(), alone[name].as_f64()) {
                    (Some(whole), Some(alone)) => {
                        assert!((whole - alone).abs() <= 1e-12 * whole.abs().max(1e-3), "{seeds}: {name}");
                    }
                    _ if name == "centroid" => {}
                    _ => assert_eq!(*value, alone[name], "{seeds}: {name}"),
                }
            }
        }
        let csv = String::from_utf8(workplace.bytes("alone.csv")).unwrap();
        assert_eq!(csv.lines().count(), alone.len() + 1, "{seeds}");
    }
    workplace.put("seeds.csv", OUTWEIGHED);
    workplace.refuses(
        "--seeds-file seeds.csv --no-mesh",
        FAILED,
        "weights leave grain 1 without volume; change their radii, or drop them with --drop-empty",
    );
}
