//! `grainsmooth check` on files of this program, damaged and whole, and on those of others.

use std::fs;

use serde_json::Value;

use crate::workplace::{FAILED, Workplace};

/// A small network as a legacy file in text: a unit cube of two grains, walls at x = 0, 1/2, 1.
pub struct Cubes {
    pub points: Vec<[f64; 3]>,
    /// Corners, then labels.
    pub triangles: Vec<([usize; 3], [i32; 2])>,
}

impl Cubes {
    pub fn new() -> Self {
        let points =
            (0..12).map(|i: u8| [f64::from(i / 4) / 2.0, f64::from(i / 2 % 2), f64::from(i % 2)]).collect();
        let mut triangles = Vec::new();
        let mut square = |[a, b, c, d]: [usize; 4], labels: [i32; 2]| {
            triangles.push(([a, b, c], labels));
            triangles.push(([a, c, d], labels));
        };
        square([0, 1, 3, 2], [0, -1]);
        square([4, 6, 7, 5], [0, 1]);
        square([8, 10, 11, 9], [1, -1]);
        for (grain, [a, b, c, d, e, f, g, h]) in
            [(0, [0, 1, 2, 3, 4, 5, 6, 7]), (1, [4, 5, 6, 7, 8, 9, 10, 11])]
        {
            square([a, e, f, b], [grain, -1]);
            square([c, d, h, g], [grain, -1]);
            square([a, c, g, e], [grain, -1]);
            square([b, f, h, d], [grain, -1]);
        }
        Self { points, triangles }
    }

    /// The file, with what DREAM.3D or VTK call the labels.
    pub fn file(&self, array: &str) -> String {
        let mut text = format!(
            "# vtk DataFile Version 3.0\ncubes\nASCII\nDATASET POLYDATA\nPOINTS {} double\n",
            self.points.len()
        );
        self.points.iter().for_each(|[x, y, z]| text += &format!("{x} {y} {z}\n"));
        text += &format!("POLYGONS {} {}\n", self.triangles.len(), 4 * self.triangles.len());
        self.triangles.iter().for_each(|([a, b, c], _)| text += &format!("3 {a} {b} {c}\n"));
        text += &format!(
            "CELL_DATA {}\nFIELD FieldData 1\n{array} 2 {} int\n",
            self.triangles.len(),
            self.triangles.len()
        );
        self.triangles.iter().for_each(|(_, [a, b])| text += &format!("{a} {b}\n"));
        text
    }
}

pub fn report(workplace: &Workplace, name: &str, code: i32) -> Value {
    let output = workplace.command(&format!("check {name} --json")).assert().code(code).stderr("");
    let mut reports: Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    reports["files"][0].take()
}

/// The kinds of fault found, each once.
fn kinds(workplace: &Workplace, cubes: &Cubes) -> Vec<String> {
    workplace.put("cubes.vtk", cubes.file("FaceLabels"));
    let report = report(workplace, "cubes.vtk", FAILED);
    assert_eq!(report["good"], false);
    let faults = report["faults"].as_array().unwrap();
    let mut kinds: Vec<String> =
        faults.iter().map(|fault| fault["kind"].as_str().unwrap().to_owned()).collect();
    kinds.dedup();
    kinds
}

#[test]
fn files_of_this_program_pass_in_every_format() {
    let workplace = Workplace::new();
    for (name, arguments, elements) in [
        ("a.vtp", "--box 2 1 0.5", "triangles"),
        ("b.vtu", "", "triangles"),
        ("c.vtk", "--box 3 1 1", "triangles"),
        ("p.vtp", "--periodic x,y,z --relax 0", "triangles"),
        ("d.vtp", "--dim 2", "segments"),
        ("e.vtu", "--dim 2", "segments"),
        ("f.vtk", "--dim 2", "segments"),
    ] {
        workplace.run(&format!("--seeds 20 -n 1 -o {name} {arguments}"));
        let report = report(&workplace, name, 0);
        assert_eq!((&report["good"], &report["grains"]), (&Value::from(true), &Value::from(20)), "{name}");
        assert_eq!(report["element"], elements);
        if !name.ends_with("vtu") {
            assert!(report["volume_error"].as_f64().unwrap() < 1e-9, "{name}");
            let known = if elements == "triangles" { 4 } else { 3 };
            assert_eq!(report["statistics"].as_array().unwrap().len(), known, "{name}");
        }
    }
    let said =
        workplace.command("check a.vtp b.vtu").assert().success().stderr("").get_output().stdout.clone();
    let said = String::from_utf8(said).unwrap();
    assert!(said.starts_with("a.vtp: good\n  network     20 grains, "), "{said}");
    assert!(said.contains("\nb.vtu: good\n"), "{said}");
}

#[test]
fn flat_random_grains_have_the_exact_statistics() {
    let workplace = Workplace::new();
    for (arguments, known) in [("--periodic x,y,z", 4), ("--dim 2 --periodic x,y", 3)] {
        workplace.run(&format!("--seeds 300 --seeding random {arguments} --relax 0 -n 0 -o a.vtp"));
        let report = report(&workplace, "a.vtp", 0);
        let statistics = report["statistics"].as_array().unwrap();
        assert_eq!(statistics.len(), known);
        for statistic in statistics {
            let theory = &statistic["poisson_voronoi"];
            let number = |value: &Value| value.as_f64().unwrap();
            // Less than one in a thousand sets of seeds is farther off.
            let error = (number(&statistic["value"]) - number(&theory["exact"])).abs()
                / number(&theory["standard_error"]);
            assert!(error < 3.3, "{arguments}: {statistic}");
        }
    }
}

/// A file carries what its sizes should be: relaxed grains are as near the distribution as cells are.
#[test]
fn sizes_stand_beside_what_was_asked_for() {
    let workplace = Workplace::new();
    let asked = "lognormal(mean=3,cv=0.5)";
    for (arguments, distribution) in [
        (String::new(), Some("lognormal(mean=1, cv=0.35)")),
        (format!("--dim 2 --diameters {asked}"), Some(asked)),
        (format!("--diameters {asked} --box 2 1 1 --periodic x,y,z --aspect-ratio 2 1 1"), Some(asked)),
        (format!("--diameters {asked} --draw random"), None),
        ("--seeding random".to_owned(), None),
        ("--phase a:0.5 --phase b:0.5".to_owned(), None),
    ] {
        workplace.run(&format!("--seeds 25 {arguments} -n 0 -o a.vtp"));
        let sizes = &report(&workplace, "a.vtp", 0)["sizes"];
        assert_eq!(sizes["asked"].as_str(), distribution, "{arguments}");
        if distribution.is_some() {
            let distance = sizes["cdf_distance"].as_f64().unwrap();
            assert!((distance - 0.5 / 25.0).abs() < 1e-9, "{arguments}: {distance}");
        }
    }
}

/// Relaxed networks between walls stood beside flat ones without: 9.92 faces a grain beside 15.535.
#[test]
fn theory_stands_beside_what_it_holds_for_alone() {
    let workplace = Workplace::new();
    let flat = "--seeding random --periodic x,y,z --relax 0";
    for (arguments, figures, has_theory) in [
        (flat, 4, true),
        (
            "--seeding random --periodic x,y,z --relax 0 --free --regularize 0.3 --box 2 1 1 --names neper",
            4,
            true,
        ),
        ("--seeding random --periodic x,y,z", 4, false),
        ("--periodic x,y,z --relax 0", 4, false),
        ("--seeding random --relax 0", 4, false),
        ("--seeding random --periodic x,y,z --relax 0 --lloyd 2", 4, false),
        ("--periodic x,y,z --relax 0 --seeding poisson-disc", 4, false),
        ("--periodic x --relax 0", 0, false),
        ("--periodic x,y,z --periodic-cut box --relax 0", 0, false),
        ("--seeding random --dim 2 --periodic x,y --relax 0", 3, true),
        ("--seeding random --dim 2 --periodic x,y", 3, false),
    ] {
        workplace.run(&format!("--seeds 30 {arguments} -n 0 -o a.vtp"));
        let report = report(&workplace, "a.vtp", 0);
        let statistics = report["statistics"].as_array().unwrap();
        assert_eq!(statistics.len(), figures, "{arguments}");
        for statistic in statistics {
            assert_eq!(!statistic["poisson_voronoi"].is_null(), has_theory, "{arguments}: {statistic}");
        }
    }
}

/// `check` looked for options in the command line: a folder's name gave the network a box, and its period another.
#[test]
fn settings_are_not_searched_for_in_the_names_of_files() {
    let workplace = Workplace::new();
    let folder = "run --box 2 2 2.csv --periodic x,y,z --names neper --domain sphere -o ";
    fs::create_dir(workplace.path(folder)).unwrap();
    workplace.put(&format!("{folder}/seeds.csv"), "0.2 0.3 0.4\n0.7 0.8 0.6\n0.3 0.9 0.1\n");
    let seeds = format!("{folder}/seeds.csv");
    workplace.command("-n 0 -o a.vtk --seeds-file").arg(seeds).assert().success();
    let good = report(&workplace, "a.vtk", 0);
    assert!(good["volume_error"].as_f64().unwrap() < 1e-9, "{good}");
    assert_eq!(good["faults"], serde_json::json!([]));
    // Types of points are looked at, as nothing is periodic.
    let mut file = workplace.bytes("a.vtk");
    let head = b"NodeTypes 1 ";
    let start = file.windows(head.len()).position(|window| window == head).unwrap();
    let first = start + file[start..].iter().position(|byte| *byte == b'\n').unwrap() + 1;
    file[first] = if file[first] == 2 { 3 } else { 2 };
    workplace.put("a.vtk", file);
    assert_eq!(report(&workplace, "a.vtk", FAILED)["faults"][0]["kind"], "wrong node type");
}

#[test]
fn a_single_grain_has_no_statistics_of_boundaries() {
    let workplace = Workplace::new();
    for (seeds, expected) in [(1, 0), (2, 1)] {
        workplace.run(&format!("--seeds {seeds} -n 1 -o few.vtp"));
        let output = workplace.command("check few.vtp").assert().success().get_output().clone();
        let said = String::from_utf8(output.stdout).unwrap();
        assert_eq!(said.matches("boundary area per volume").count(), expected, "{said}");
    }
}

#[test]
fn each_damage_is_named() {
    let workplace = Workplace::new();
    workplace.put("good.vtk", Cubes::new().file("FaceLabels"));
    let good = report(&workplace, "good.vtk", 0);
    assert_eq!((&good["volume"], &good["boundaries"]), (&Value::from(1.0), &Value::from(3)));

    let mut removed = Cubes::new();
    removed.triangles.remove(2);
    assert_eq!(kinds(&workplace, &removed), ["open"]);
    let mut flipped = Cubes::new();
    flipped.triangles[2].0.reverse();
    assert_eq!(kinds(&workplace, &flipped), ["winding"]);
    let mut moved = Cubes::new();
    moved.points[4] = [0.75, 1.5, 1.5];
    assert!(kinds(&workplace, &moved).contains(&"crossing".to_owned()));
    let mut swapped = Cubes::new();
    swapped.triangles[2].1 = [1, 0];
    assert_eq!(kinds(&workplace, &swapped), ["winding"]);
    let mut wrong = Cubes::new();
    wrong.triangles[2].1 = [0, 7];
    assert_eq!(kinds(&workplace, &wrong)[0], "wrong sides");
    let mut duplicated = Cubes::new();
    duplicated.points.push(duplicated.points[5]);
    assert_eq!(kinds(&workplace, &duplicated), ["duplicate points", "orphan point"]);
    duplicated.triangles[2].0 = duplicated.triangles[2].0.map(|corner| if corner == 7 { 12 } else { corner });
    duplicated.points[12] = duplicated.points[7];
    assert_eq!(kinds(&workplace, &duplicated)[..2], ["duplicate points", "open"]);
    let mut double = Cubes::new();
    double.triangles.push(double.triangles[2]);
    assert!(kinds(&workplace, &double).contains(&"duplicate elements".to_owned()));
}

#[test]
fn faults_have_ids_and_places() {
    let workplace = Workplace::new();
    let mut flipped = Cubes::new();
    flipped.triangles[2].0.reverse();
    workplace.put("flipped.vtk", flipped.file("FaceLabels"));
    let fault = report(&workplace, "flipped.vtk", FAILED)["faults"][0].clone();
    assert_eq!(fault["elements"], serde_json::json!([2]));
    assert_eq!(fault["position"][0], 0.5);
    let output = workplace.command("check flipped.vtk").assert().code(FAILED).stderr("").get_output().clone();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.starts_with("flipped.vtk: 1 fault\n"), "{said}");
    assert!(said.contains("\n  winding           element 2 winds the wrong way, at (0.5, "), "{said}");
}

/// DREAM.3D puts the exterior first, VTK calls it 0; both may wind either way.
#[test]
fn conventions_of_other_programs_are_understood() {
    let workplace = Workplace::new();
    let mut cubes = Cubes::new();
    for (_, labels) in &mut cubes.triangles {
        *labels = labels.map(|label| label + i32::from(label >= 0));
    }
    let mut dream = Cubes { triangles: cubes.triangles.clone(), ..Cubes::new() };
    dream.triangles.iter_mut().for_each(|(_, labels)| labels.sort_unstable());
    let mut vtk = Cubes { triangles: cubes.triangles.clone(), ..Cubes::new() };
    vtk.triangles.iter_mut().for_each(|(_, labels)| *labels = labels.map(|label| label.max(0)));
    let mut inside_out = Cubes { triangles: vtk.triangles.clone(), ..Cubes::new() };
    inside_out.triangles.iter_mut().for_each(|(corners, _)| corners.reverse());
    for (cubes, array) in [
        (&cubes, "FaceLabels"),
        (&dream, "FaceLabels"),
        (&vtk, "boundary_labels"),
        (&vtk, "BoundaryLabels"),
        (&inside_out, "BoundaryLabels"),
    ] {
        workplace.put("cubes.vtk", cubes.file(array));
        let report = report(&workplace, "cubes.vtk", 0);
        assert_eq!((&report["labels"], &report["grains"]), (&Value::from(array), &Value::from(2)));
    }
}

#[test]
fn files_with_the_names_of_other_tools_pass() {
    let workplace = Workplace::new();
    for names in ["grainsmooth", "dream3d", "pyvista", "virmat", "neper"] {
        for periodic in ["", "--periodic x,y,z"] {
            workplace.run(&format!("--seeds 6 -n 1 {periodic} --names {names} -o a.vtp"));
            let report = report(&workplace, "a.vtp", 0);
            let array = if names == "pyvista" { "boundary_labels" } else { "FaceLabels" };
            assert_eq!(
                (&report["labels"], &report["grains"]),
                (&Value::from(array), &Value::from(6)),
                "{names}"
            );
        }
    }
}

/// Other tools know no periodic boundaries: all have the label of the exterior, and several meet at sharp edges.
#[test]
fn periodic_boundaries_with_the_labels_of_one_exterior_are_not_folded() {
    let workplace = Workplace::new();
    for (dim, names) in [(3, "neper"), (3, "virmat"), (2, "pyvista")] {
        workplace.run(&format!(
            "--seeds 8 --dim {dim} -n 0 --seeding poisson-disc --periodic y --names {names} -o a.vtp --rng-seed 1003"
        ));
        assert_eq!(report(&workplace, "a.vtp", 0)["grains"], 8, "{names}");
    }
}

/// Where voxels touch along an edge, vtkSurfaceNets3D splits points, leaves the copies where the originals are and keeps one
/// that nothing uses.
#[test]
fn surface_nets_pass_only_where_they_are_right() {
    let workplace = Workplace::new();
    for name in ["surface_nets_good.vtp", "surface_nets_touching.vtp"] {
        let data = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/");
        fs::copy(format!("{data}{name}"), workplace.path(name)).unwrap();
    }
    let good = report(&workplace, "surface_nets_good.vtp", 0);
    assert_eq!((&good["grains"], &good["elements"]), (&Value::from(3), &Value::from(608)));
    let touching = report(&workplace, "surface_nets_touching.vtp", FAILED);
    let faults = touching["faults"].as_array().unwrap();
    for kind in ["duplicate points", "orphan point", "crossing"] {
        assert!(faults.iter().any(|fault| fault["kind"] == kind), "{kind}");
    }
    assert_eq!(touching["grains"], 2);
}

#[test]
fn files_that_are_no_networks_are_refused() {
    let workplace = Workplace::new();
    workplace.refuses(
        "check missing.vtp",
        FAILED,
        "missing.vtp: cannot be read: ... give the path of a readable mesh file",
    );
    workplace.put("seeds.xyz", "0.5 0.5 0.5\n");
    workplace.refuses(
        "check seeds.xyz",
        FAILED,
        "seeds.xyz: unknown extension; give a network as *.vtp, *.vtu, *.vtk, *.tess, *.stl, *.fe, *.dmp, *.dream3d, *.json or *.csv",
    );
    workplace.put("elements.xdmf", "<Xdmf/>\n");
    workplace.refuses(
        "check elements.xdmf",
        FAILED,
        "elements.xdmf: elements in .xdmf are only written; to check them, write and give a .vtu, .msh, .inp or .bdf, and for the network a .vtp",
    );
    let cube = "# vtk DataFile Version 3.0\nvoxels\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 float\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n\
        0 0 1\n1 0 1\n1 1 1\n0 1 1\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n";
    workplace.put("cube.vtk", cube);
    workplace.refuses(
        "check cube.vtk",
        FAILED,
        "cube.vtk: cell 0 is a Hexahedron, not a triangle of a boundary; give the boundaries of the network, such as a .vtp, or of voxels their labels as a .vti to `grainsmooth smooth`",
    );
    workplace.put("plain.vtk", Cubes::new().file("Other"));
    workplace.refuses(
        "check plain.vtk",
        FAILED,
        "plain.vtk: has no cell array FaceLabels or boundary_labels or BoundaryLabels; add one with two labels for each triangle",
    );
    let mut bad = Cubes::new();
    bad.triangles[3].1 = [0, 77];
    workplace
        .put("bad.vtk", bad.file("FaceLabels").replace(" int\n", " long\n").replace("0 77", "0 4294967296"));
    workplace.refuses(
        "check bad.vtk",
        FAILED,
        "bad.vtk: cell 3 has the label 4294967296; number grains from 0 to 4294967295, and the exterior as -1",
    );
    let square =
        Cubes::new().file("FaceLabels").replace("POLYGONS 22 88\n3 0 1 3\n", "POLYGONS 22 89\n4 0 1 3 2\n");
    workplace.put("square.vtk", square);
    workplace.refuses("check square.vtk", FAILED, "square.vtk: cell 0 has 4 corners; cut it into triangles");
    let beyond = Cubes::new().file("FaceLabels").replace("\n3 0 1 3\n", "\n3 0 1 33\n");
    workplace.put("beyond.vtk", beyond);
    workplace.refuses(
        "check beyond.vtk",
        FAILED,
        "beyond.vtk: face 0 refers to point 33, but there are only 12 points; give a complete VTK file",
    );
    workplace.put("cut.vtk", &Cubes::new().file("FaceLabels").into_bytes()[..400]);
    workplace.command("check cut.vtk").assert().code(FAILED).stdout("");
    workplace.command("check").assert().code(2).stdout("");
}
