//! Random tessellations against independent programs: neighbours exactly, measures to 1e-12 of the mean.

use crate::common::{assert_complex, assert_power_complex, complex_counts};
use glam::{BVec3, DVec3};
use serde_json::Value;
use voronoi::{CellId, Domain, FaceId, Side, Tessellation, VertexId};

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
        Side::Cell(cell) | Side::Image(cell, _) => i64::from(cell.0),
        Side::Wall(wall) => -1 - i64::try_from(wall.index()).expect("few"),
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

/// The squares of the radii of a reference, where it has them.
fn weights(reference: &Value) -> Option<Vec<f64>> {
    let radii = reference["radii"].as_array()?.iter().filter_map(Value::as_f64);
    Some(radii.map(|radius| radius * radius).collect())
}

fn compare(name: &str, domain: Domain, volume_key: &str, area_key: &str, face_key: &str) -> Tessellation {
    let reference = load(name);
    let domain = domain.with_periods(BVec3::splat(reference["periodic"] == true));
    let tessellation = match weights(&reference) {
        None => Tessellation::new(&domain, &seeds(&reference)),
        Some(weights) => Tessellation::power(&domain, &seeds(&reference), &weights),
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
    let reference = load(name);
    match weights(&reference) {
        None => assert_complex(&tessellation),
        Some(weights) => assert_power_complex(&tessellation, &weights),
    }
    let expected = &reference["complex_counts"];
    let counts = complex_counts(&tessellation);
    assert_eq!(Some(counts.vertices as u64), expected["vertices"].as_u64());
    assert_eq!(Some(counts.edges as u64), expected["edges"].as_u64());
    assert_eq!(Some(counts.faces as u64), expected["faces"].as_u64());
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
fn periodic_cells() {
    compare_in_space("v3_N50_periodic");
    compare_in_space("v3_N200_periodic");
    assert_complex(&compare("v2_N200_periodic", Domain::unit_square(), "area", "perimeter", "nedges"));
}

/// Corners of every face, as one list without order for each face and neighbour.
#[test]
fn periodic_cells_have_the_same_corners() {
    let reference = load("v3_N50_periodic_geometry");
    let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
    let tessellation = Tessellation::new(&domain, &seeds(&load("v3_N50_periodic"))).expect("valid seeds");
    for (id, cell) in (0u32..).zip(reference["cells"].as_array().expect("cells")) {
        let number =
            |value: &Value| usize::try_from(value.as_u64().expect("a number")).expect("a small number");
        let point =
            |value: &Value| DVec3::from_array([0, 1, 2].map(|axis| value[axis].as_f64().expect("a number")));
        let list = |key: &str| cell[key].as_array().expect("a list").iter();
        let vertices: Vec<DVec3> = list("vertices").map(point).collect();
        for (face, neighbor) in list("faces").zip(list("neighbors")) {
            let expected: Vec<DVec3> =
                face.as_array().expect("corners").iter().map(|corner| vertices[number(corner)]).collect();
            let found = tessellation.cell_faces(CellId(id)).iter().filter(|face| {
                let sides = tessellation.face_sides(**face);
                let beyond = if sides[0] == Side::Cell(CellId(id)) { sides[1] } else { sides[0] };
                matches!(beyond, Side::Cell(cell) | Side::Image(cell, _) if cell.index() == number(neighbor))
            });
            let is_same = |face: &FaceId| {
                let corners = tessellation.face_corners(*face);
                let near = |corner: &VertexId| {
                    expected
                        .iter()
                        .any(|point| point.distance(tessellation.vertices()[corner.index()]) < 1e-13)
                };
                corners.len() == expected.len() && corners.iter().all(near)
            };
            assert_eq!(found.filter(|face| is_same(face)).count(), 1, "face of cell {id} with {neighbor}");
        }
    }
}

#[test]
fn periodic_lattices() {
    for name in ["lattice_sc8", "lattice_bcc4", "lattice_fcc4"] {
        let reference = load(name);
        let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
        let tessellation = Tessellation::new(&domain, &seeds(&reference)).expect("valid seeds");
        assert_complex(&tessellation);
        let exact = &reference["exact_per_cell"];
        let number = |key: &str| exact[key].as_f64().expect("a number");
        for (id, cell) in tessellation.cell_measures().iter().enumerate() {
            let found = [cell.face_count, cell.vertex_count, cell.edge_count].map(|count| count as f64);
            assert_eq!(found, ["nfaces", "nverts", "nedges"].map(number), "{name}, cell {id}");
            assert!((cell.volume / number("volume") - 1.0).abs() < TOLERANCE);
            assert!((cell.area / number("area") - 1.0).abs() < TOLERANCE);
        }
        for (id, cell) in (0u32..).zip(reference["cells"].as_array().expect("cells")) {
            let expected: Vec<i64> =
                cell["neighbors"].as_array().expect("neighbors").iter().filter_map(Value::as_i64).collect();
            assert_eq!(neighbors(&tessellation, CellId(id)), expected, "{name}, neighbours of cell {id}");
        }
    }
}

#[test]
fn power_cells() {
    for name in
        ["v3_N50_radical_box", "v3_N200_radical_box", "v3_N50_radical_periodic", "v3_N200_radical_periodic"]
    {
        compare_in_space(name);
        let reference = load(name);
        let empty = reference["cells"].as_array().expect("cells").iter();
        let empty =
            empty.filter(|cell| cell["nfaces"].as_u64() == Some(0)).filter_map(|cell| cell["id"].as_u64());
        let weights = weights(&reference).expect("radii");
        let domain = Domain::unit_cube().with_periods(BVec3::splat(reference["periodic"] == true));
        let tessellation = Tessellation::power(&domain, &seeds(&reference), &weights);
        let found = tessellation.expect("valid seeds").empty_cells();
        assert_eq!(found.iter().map(|cell| u64::from(cell.0)).collect::<Vec<_>>(), empty.collect::<Vec<_>>());
        assert!(!found.is_empty());
    }
}
