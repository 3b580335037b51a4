use std::f64::consts::PI;

use serde_json::Value;

use crate::workplace::{FAILED, USAGE, Workplace};

const OCTAHEDRON: &str = "# faces of an octahedron\nnx, ny, nz, d\n1,1,1,1\n1 1 -1 1\n1,-1,1,1\n1,-1,-1,1\n-1,1,1,1\n-1,1,-1,1\n-1,-1,1,1\n-1,-1,-1,1\n";
const PYRAMID: &str =
    "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0.9 1.1 1.5\nf 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";

fn cells(workplace: &Workplace, arguments: &str) -> Vec<Value> {
    workplace.run(&format!("{arguments} --no-mesh --cells-json cells.json"));
    let table = workplace.json("cells.json");
    table["cells"].as_array().unwrap().clone()
}

fn sum(cells: &[Value], name: &str) -> f64 {
    cells.iter().map(|cell| cell[name].as_f64().unwrap()).sum()
}

#[test]
fn cells_fill_domains_of_every_kind() {
    let workplace = Workplace::new();
    workplace.put("octahedron.csv", OCTAHEDRON);
    workplace.put("pyramid.obj", PYRAMID);
    workplace.put("triangle.csv", "-1,0,0\n0,-1,0\n1,1,1\n");
    for (arguments, measure, volume) in [
        ("--domain sphere --box 2 2 2 --seeds 50", "volume", PI * 4.0 / 3.0),
        ("--domain sphere --chord-error 0.01 --seeding poisson-disc --seeds 50", "volume", PI / 6.0),
        ("--domain sphere --lattice fcc 4 --lloyd 2", "volume", PI / 6.0),
        ("--domain cylinder --box 2 2 0.5 --seeds 50 --lloyd 1", "volume", PI * 0.5),
        ("--domain disc --dim 2 --box 2 2 --seeds 50", "area", PI),
        ("--domain pyramid.obj --seeds 50", "volume", 2.0),
        ("--domain pyramid.obj --lattice bcc 3", "volume", 2.0),
        ("--half-spaces octahedron.csv --seeds 50", "volume", 4.0 / 3.0),
        ("--half-spaces triangle.csv --dim 2 --seeds 20", "area", 0.5),
    ] {
        let cells = cells(&workplace, arguments);
        assert!(cells.len() > 10);
        let total = sum(&cells, measure);
        assert!((total - volume).abs() < 1e-12 * volume, "{arguments}: {total} not {volume}");
    }
    // Walls are numbered like the lines of the file.
    let cells = cells(&workplace, "--half-spaces octahedron.csv --seeds 1");
    assert_eq!(cells[0]["neighbors"], serde_json::json!([-8, -7, -6, -5, -4, -3, -2, -1]));
    assert_eq!((&cells[0]["nverts"], &cells[0]["nedges"]), (&6.into(), &12.into()));
}

/// Where lines cross the edges of facets at small angles five and ten triangles were once thin, down to 0.09 degrees: what did not become as wide as
/// wanted stayed as it was.
#[test]
fn no_triangle_is_thin_beside_the_facets_of_a_cylinder() {
    let workplace = Workplace::new();
    for seed in [1, 3] {
        workplace.run(&format!(
            "--domain cylinder --seeds 20 --rng-seed {seed} --relax equilibrium -n 2 -o a.vtp --json-summary a.json"
        ));
        let summary = workplace.json("a.json");
        let least = summary["triangle_angles"]["least"].as_f64().unwrap();
        assert!(least >= 1.5, "{least}");
    }
}

#[test]
fn seeds_outside_a_domain_are_named() {
    let workplace = Workplace::new();
    workplace.put("seeds.csv", "0.5,0.5,0.5\n0.05,0.05,0.05\n");
    workplace.refuses(
        "--domain sphere --seeds-file seeds.csv",
        FAILED,
        "seeds.csv line 2: seed 1 at (0.05, 0.05, 0.05) lies outside the domain a ball of radius 0.5 with 492 faces in ... ; move it inside or enlarge the domain",
    );
}

#[test]
fn polycrystals_in_a_ball_are_written_and_run_again() {
    let workplace = Workplace::new();
    let run = "--domain sphere --seeds 20 -n 1 -q -o";
    workplace.run(&format!("{run} ball.vtp"));
    workplace.run(&format!("{run} other.vtp --threads 1"));
    assert_eq!(workplace.bytes("ball.vtp"), workplace.bytes("other.vtp"));
    workplace.run("--config ball.vtp -q -o again.vtp");
    assert_eq!(workplace.bytes("ball.vtp"), workplace.bytes("again.vtp"));
    // A ball is smaller than its box, which is no fault.
    workplace.command("check ball.vtp").assert().success();
    for name in ["ball.fe", "ball.tess", "ball.msh", "ball.obj"] {
        workplace.run(&format!("--config ball.vtp -q -o {name}"));
    }
    let evolver = String::from_utf8(workplace.bytes("ball.fe")).unwrap();
    assert_eq!(evolver.matches("\nformula: (").count() + evolver.matches("\nformula: x").count(), 492);
    let tess = grainsmooth::read_tess(&String::from_utf8(workplace.bytes("ball.tess")).unwrap()).unwrap();
    assert_eq!((tess.polyhedra.len(), &tess.domain.kind[..]), (20, "poly"));
}

#[test]
fn voxels_outside_of_a_ball_have_a_number_of_their_own() {
    let workplace = Workplace::new();
    for (names, outside) in [("grainsmooth", -1), ("neper", 0), ("dream3d", 0)] {
        workplace.run(&format!(
            "--domain sphere --seeds 20 -n 1 --voxels 20 20 20 --names {names} -q -o ball.npy"
        ));
        let file = workplace.bytes("ball.npy");
        let header = 10 + usize::from(u16::from_le_bytes([file[8], file[9]]));
        let labels: Vec<i32> =
            file[header..].as_chunks().0[..8000].iter().map(|b| i32::from_le_bytes(*b)).collect();
        let share = labels.iter().filter(|label| **label == outside).count() as f64 / 8000.0;
        assert!((share - (1.0 - PI / 6.0)).abs() < 0.02, "{share}");
        assert_eq!((labels[0], labels.iter().max()), (outside, Some(&(outside + 20))));
    }
    workplace.run("--domain disc --dim 2 --seeds 9 --voxels 30 30 -q -o disc.ang");
    let map = String::from_utf8(workplace.bytes("disc.ang")).unwrap();
    let corner = map.lines().find(|line| !line.starts_with('#')).unwrap();
    assert_eq!(corner, "12.56637 12.56637 12.56637 0.0 0.0 -1.0 -1.000 0 -1 180.000");
}

#[test]
fn what_does_not_fit_together() {
    let workplace = Workplace::new();
    workplace.put("pyramid.obj", PYRAMID);
    for (arguments, message) in [
        (
            "--domain sphere --box 1 1 2",
            "--domain sphere needs a --box of equal sides, its diameter; 1 1 2 given",
        ),
        (
            "--domain cylinder --box 1 2 2",
            "--domain cylinder needs a --box as wide as deep, its diameter; 1 2 given",
        ),
        ("--domain disc", "--domain disc is for --dim 2; give sphere or cylinder"),
        ("--domain sphere --dim 2", "with --dim 2 the domain is a box, a disc, or --half-spaces"),
        ("--domain sphere --periodic x", "--periodic is for boxes; other domains do not repeat"),
        (
            "--chord-error 0.1",
            "--chord-error is for --domain sphere, cylinder or disc; others have flat faces",
        ),
        (
            "--domain pyramid.obj --box 1 1 1",
            "--box has no meaning with a --domain from a file, which has its own size",
        ),
        (
            "--domain ball",
            "invalid value 'ball' for '--domain <SHAPE>': give box, sphere, cylinder, disc or a file with an extension, such as body.obj",
        ),
        (
            "--domain sphere --chord-error 0",
            "invalid value '0' for '--chord-error <E>': a chord error is a positive length",
        ),
    ] {
        workplace.refuses(arguments, USAGE, message);
    }
    workplace.refuses(
        "--domain sphere --chord-error 1e-9",
        FAILED,
        "more than the 32768 walls that a domain can have; use fewer half-spaces or a larger chord error",
    );
}

#[test]
fn files_that_hold_no_domain() {
    let workplace = Workplace::new();
    let open = PYRAMID.replace("f 4 1 5\n", "");
    let dented = PYRAMID.replace("f 4 3 2 1\n", "v 1 1 0.5\nf 2 1 6\nf 3 2 6\nf 4 3 6\nf 1 4 6\n");
    let huge = PYRAMID.replace("v 2", "v 2e200");
    for (name, content, message) in [
        (
            "open.obj",
            open.as_str(),
            "open.obj: face 0 has no neighbour across its edge from vertex 0 to vertex 3, or one that winds the other way; close the surface",
        ),
        (
            "dented.obj",
            &dented,
            "dented.obj: vertex ... lies outside face ... : the surface is not convex, which a domain must be",
        ),
        ("words.csv", "1,0,0,1\n1,2,x,1\n", "words.csv line 2: write nx, ny, nz, d as numbers such as 0.5"),
        (
            "flat.csv",
            "1,0,0,1\n\n0,0,0,1\n",
            "flat.csv line 3: half-space 1 has no direction; its normal must be finite and not 0, in the plane without a part along z",
        ),
        (
            "empty.csv",
            "1,0,0,1\n-1,0,0,-2\n",
            "empty.csv line 2: half-space 1 has nothing in common with those before it; turn its normal outward or move it",
        ),
        (
            "none.csv",
            "",
            "none.csv: the half-spaces are unbounded in the direction ... ; add one with a normal that points there",
        ),
        (
            "far.csv",
            "1,0,0,1\n0,1e200,0,1e200\n0,0,1,1e200\n-1,-1,-1,0\n",
            "far.csv line 3: half-space 2 is 1e200 from the origin; move it within 1e30, or leave it out",
        ),
        // Once this ended in a panic.
        (
            "tiny.csv",
            "1,0,0,1e-200\n0,1,0,1e-200\n0,0,1,1e-200\n-1,-1,-1,0\n",
            "tiny.csv: the domain's side along x is ... ; every side must be between 1e-30 and 1e30",
        ),
        (
            "huge.obj",
            &huge,
            "huge.obj: point 1 has the coordinate 2e200; scale the mesh so that none exceeds 1e30",
        ),
    ] {
        workplace.put(name, content);
        let option = if name.ends_with("csv") { "--half-spaces" } else { "--domain" };
        let message = message.replacen("vertex ... lies outside face ... :", "vertex ... :", 1);
        workplace.refuses(&format!("{option} {name} --seeds 5"), FAILED, &message);
    }
}
