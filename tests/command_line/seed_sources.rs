use grainsmooth::vtk::field_text;
use serde_json::Value;

use crate::workplace::{USAGE, Workplace};

fn cells(workplace: &Workplace, arguments: &str) -> Vec<Value> {
    workplace.run(&format!("{arguments} --no-mesh --cells-json cells.json"));
    let table = workplace.json("cells.json");
    table["cells"].as_array().unwrap().clone()
}

fn number(cell: &Value, key: &str) -> f64 {
    cell[key].as_f64().unwrap()
}

/// Cells that have all their neighbours: of seeds at least 1.2 unit cells off the walls of a box of the given size.
fn inner(cells: &[Value], unit_cells: u32, size: f64) -> Vec<&Value> {
    let margin = 1.2 / f64::from(unit_cells) * size;
    let is_inner = |cell: &&Value| {
        let seed = cell["seed"].as_array().unwrap();
        seed.iter().all(|x| (margin..size - margin).contains(&x.as_f64().unwrap()))
    };
    cells.iter().filter(is_inner).collect()
}

/// Counts and measures of crystallography's cells, at spacings that binary numbers do and do not hold.
#[test]
fn lattices_have_their_perfect_cells() {
    let workplace = Workplace::new();
    for n in [3u32, 4, 5] {
        // The edge of the conventional cell.
        let a = 1.0 / f64::from(n);
        let truncated_octahedron = (6.0 + 12.0 * 3f64.sqrt()) / 8.0 * a * a;
        let rhombic_dodecahedron = 8.0 * 2f64.sqrt() * (3f64.sqrt() / 4.0 * a).powi(2);
        for (lattice, seeds_a_cell, faces, vertices, area) in [
            ("sc", 1u32, 6, 8, 6.0 * a * a),
            ("bcc", 2, 14, 24, truncated_octahedron),
            ("fcc", 4, 12, 14, rhombic_dodecahedron),
        ] {
            let cells = cells(&workplace, &format!("--lattice {lattice} {n}"));
            let count = seeds_a_cell * n.pow(3);
            assert_eq!(cells.len(), count as usize);
            let inner = inner(&cells, n, 1.0);
            assert!(!inner.is_empty());
            for cell in inner {
                assert_eq!(cell["nfaces"], faces, "{lattice} {n}");
                assert_eq!(cell["nverts"], vertices, "{lattice} {n}");
                assert!((number(cell, "volume") * f64::from(count) - 1.0).abs() < 1e-12);
                assert!((number(cell, "area") / area - 1.0).abs() < 1e-12, "{lattice} {n}");
            }
        }
        let honeycomb = cells(&workplace, &format!("--dim 2 --lattice hex {n} --box 1 {}", 3f64.sqrt()));
        assert_eq!(honeycomb.len(), 2 * (n * n) as usize);
        let inner = inner(&honeycomb, n, 1.0);
        assert!(!inner.is_empty());
        for cell in inner {
            assert_eq!(cell["nedges"], 6);
            assert!((number(cell, "perimeter") / (2.0 * 3f64.sqrt() * a) - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn lattices_are_smoothed_like_other_grains() {
    let workplace = Workplace::new();
    // A third is no binary number.
    for lattice in ["sc 3", "bcc 3", "fcc 2", "hex 3 --dim 2", "square 3 --dim 2"] {
        workplace.run(&format!("--lattice {lattice} -n 1"));
    }
}

#[test]
fn a_stretched_lattice_says_so_and_what_fits() {
    let workplace = Workplace::new();
    let said = workplace.run("--lattice hcp 2 --no-mesh");
    let line = said.lines().find(|line| line.starts_with("lattice")).unwrap();
    let (before, perfect) = line.split_once("; perfect with ").unwrap();
    assert_eq!(before, "lattice     hcp, 3 x 2 x 2 cells, stretched 1.0000 : 0.8660 : 0.9186");
    let cells = cells(&workplace, &format!("--lattice hcp 2 {perfect}"));
    let said = workplace.run(&format!("--lattice hcp 2 {perfect} --no-mesh"));
    assert!(said.contains("lattice     hcp, 3 x 2 x 2 cells\n"), "{said}");
    assert_eq!(cells.len(), 48);
}

#[test]
fn seeds_of_a_lattice_outside_the_domain_are_counted() {
    let workplace = Workplace::new();
    // Of 64 seeds all but the 32 in the corners, and at the edges beside them, are within 0.5 of the middle.
    let said = workplace.run("--lattice sc 4 --domain sphere --no-mesh");
    assert!(said.contains("cells       32 in "), "{said}");
    assert!(said.contains("; 32 of 64 seeds lie outside the domain and are left out\n"), "{said}");
    // Half of a square of 16.
    workplace.put("triangle.csv", "-1,0,0\n0,-1,0\n1,1,1\n");
    let said = workplace.run("--lattice square 4 --half-spaces triangle.csv --dim 2 --no-mesh");
    assert!(said.contains("cells       10 in "), "{said}");
    let left_out = "lattice     square, 4 x 4 cells; 6 of 16 seeds lie outside the domain and are left out\n";
    assert!(said.contains(left_out), "{said}");
}

#[test]
fn lattices_that_do_not_fit_are_refused() {
    let workplace = Workplace::new();
    for (arguments, message) in [
        ("--lattice bcc 2 --dim 2", "--dim 2 has the lattices square and hex"),
        ("--lattice hex 2", "the lattices square and hex are for --dim 2; give sc, bcc, fcc or hcp"),
        ("--lattice 2 bcc", "--lattice takes a lattice and the number of its cells, such as bcc 4"),
        (
            "--lattice dia 4",
            "invalid value 'dia' for '--lattice <LATTICE> <N>': the lattices are sc, bcc, fcc and hcp, and square and hex \
             in 2D; then give a whole number from 1 to 1600",
        ),
        (
            "--lattice sc 0",
            "invalid value '0' for '--lattice <LATTICE> <N>': the lattices are sc, bcc, fcc and hcp, and square and hex \
             in 2D; then give a whole number from 1 to 1600",
        ),
        ("--lattice sc", "2 values required for '--lattice <LATTICE> <N>' but 1 was provided"),
        (
            "--lattice sc 4 --seeds 3",
            "the argument '--lattice <LATTICE> <N>' cannot be used with '--seeds <N>'",
        ),
    ] {
        workplace.refuses(arguments, USAGE, message);
    }
}

/// Standard deviation of the cells' volumes in units of their mean.
fn spread(cells: &[Value]) -> f64 {
    let volumes: Vec<f64> = cells.iter().map(|cell| number(cell, "volume") * cells.len() as f64).collect();
    (volumes.iter().map(|volume| (volume - 1.0).powi(2)).sum::<f64>() / volumes.len() as f64).sqrt()
}

#[test]
fn poisson_disc_seeds_and_lloyd_steps_even_the_grains_out() {
    let workplace = Workplace::new();
    let [random, apart, even] = ["--seeding random", "--seeding poisson-disc", "--seeding random --lloyd 20"]
        .map(|how| spread(&cells(&workplace, &format!("--seeds 300 {how}"))));
    assert!(apart < 0.7 * random, "{apart} and {random}");
    assert!(even < 0.5 * random, "{even} and {random}");
}

#[test]
fn files_say_where_their_seeds_came_from() {
    let workplace = Workplace::new();
    for arguments in ["--lattice bcc 2", "--seeding poisson-disc --seeds 9 --lloyd 3"] {
        workplace.run(&format!("{arguments} -n 0 --relax 0"));
        let file = workplace.bytes("grains.vtp");
        let command_line = field_text(&file, "CommandLine").unwrap();
        workplace.run(command_line.strip_prefix("grainsmooth ").unwrap());
        assert!(workplace.bytes("grains.vtp") == file, "{command_line}");
    }
}
