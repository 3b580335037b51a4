//! Random tessellations against independent programs: neighbours exactly, measures to 1e-12 of the mean.

use glam::DVec3;
use serde_json::Value;
use voronoi::{CellId, Domain, Side, Tessellation};

/// Allowed difference, as a share of the mean over all cells.
const TOLERANCE: f64 = 1e-12;

fn load(name: &str) -> Value {
    let path = format!("{}/tests/data/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).expect("reference file")).expect("JSON")
}

fn seeds(reference: &Value) -> Vec<DVec3> {
    let coordinate = |seed: &Value, axis: usize| seed[axis].as_f64().unwrap_or(0.0);
    let seeds = reference["seeds"].as_array().expect("seeds").iter();
    seeds.map(|seed| DVec3::new(coordinate(seed, 0), coordinate(seed, 1), coordinate(seed, 2))).collect()
}

/// Walls as -1 to -6, in the order of the reference: ascending numbers.
fn neighbors(tessellation: &Tessellation, cell: CellId) -> Vec<i64> {
    let number = |side: &Side| match side {
        Side::Cell(cell) => i64::from(cell.0),
        Side::Wall(wall) => -1 - wall.index() as i64,
    };
    let mut numbers: Vec<i64> = tessellation.neighbors(cell).iter().map(number).collect();
    numbers.sort_unstable();
    numbers
}

fn assert_close(ours: &[f64], reference: &[f64]) {
    let mean = reference.iter().sum::<f64>() / reference.len() as f64;
    for (cell, (a, b)) in ours.iter().zip(reference).enumerate() {
        assert!((a - b).abs() <= TOLERANCE * mean, "cell {cell}: {a} is not {b}");
    }
}

fn compare(name: &str, domain: Domain, volume_key: &str, area_key: &str, face_key: &str) -> Tessellation {
    let reference = load(name);
    let tessellation = match reference["radii"].as_array() {
        None => Tessellation::new(&domain, &seeds(&reference)),
        Some(radii) => {
            let weights: Vec<f64> =
                radii.iter().filter_map(Value::as_f64).map(|radius| radius * radius).collect();
            Tessellation::power(&domain, &seeds(&reference), &weights)
        }
    };
    let tessellation = tessellation.expect("valid seeds");
    let cells = reference["cells"].as_array().expect("cells");
    assert_eq!(tessellation.cell_count(), cells.len());
    let measures = tessellation.cell_measures();
    for (id, cell) in (0u32..).zip(cells) {
        let expected: Vec<i64> =
            cell["neighbors"].as_array().expect("neighbors").iter().filter_map(Value::as_i64).collect();
        assert_eq!(neighbors(&tessellation, CellId(id)), expected, "neighbours of cell {id}");
        assert_eq!(Some(measures[id as usize].face_count as u64), cell[face_key].as_u64());
        if let Some(count) = cell["nverts"].as_u64() {
            assert_eq!(measures[id as usize].vertex_count as u64, count, "vertices of cell {id}");
        }
    }
    let column = |key: &str| cells.iter().filter_map(|cell| cell[key].as_f64()).collect::<Vec<_>>();
    assert_close(&measures.iter().map(|m| m.volume).collect::<Vec<_>>(), &column(volume_key));
    assert_close(&measures.iter().map(|m| m.area).collect::<Vec<_>>(), &column(area_key));
    tessellation
}

fn compare_in_space(name: &str) {
    let tessellation = compare(name, Domain::unit_cube(), "volume", "area", "nfaces");
    let counts = &load(name)["complex_counts"];
    assert_eq!(Some(tessellation.vertices().len() as u64), counts["vertices"].as_u64());
    assert_eq!(Some(tessellation.edges().ends.len() as u64), counts["edges"].as_u64());
    assert_eq!(Some(tessellation.face_count() as u64), counts["faces"].as_u64());
}

#[test]
fn fifty_cells_in_a_cube() {
    compare_in_space("v3_N50_box");
}

#[test]
fn two_hundred_cells_in_a_cube() {
    compare_in_space("v3_N200_box");
}

#[test]
fn two_hundred_cells_in_a_square() {
    let tessellation = compare("v2_N200_box", Domain::unit_square(), "area", "perimeter", "nedges");
    let counts = &load("v2_N200_box")["complex_counts"];
    if let Some(vertices) = counts["vertices"].as_u64() {
        assert_eq!(tessellation.vertices().len() as u64, vertices);
    }
}

#[test]
fn power_cells_in_a_cube() {
    for name in ["v3_N50_radical_box", "v3_N200_radical_box"] {
        compare_in_space(name);
        let reference = load(name);
        let empty = reference["cells"].as_array().expect("cells").iter();
        let empty =
            empty.filter(|cell| cell["nfaces"].as_u64() == Some(0)).filter_map(|cell| cell["id"].as_u64());
        let radii = reference["radii"].as_array().expect("radii").iter().filter_map(Value::as_f64);
        let weights: Vec<f64> = radii.map(|radius| radius * radius).collect();
        let tessellation = Tessellation::power(&Domain::unit_cube(), &seeds(&reference), &weights);
        let found = tessellation.expect("valid seeds").empty_cells();
        assert_eq!(found.iter().map(|cell| u64::from(cell.0)).collect::<Vec<_>>(), empty.collect::<Vec<_>>());
        assert!(!found.is_empty());
    }
}
