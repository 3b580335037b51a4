//! `grainsmooth check` on what files of VTK and Abaqus hold: encodings, what they say of themselves, points and tetrahedra.

use std::fs;

use grainsmooth::vtk::{field_numbers, field_text};
use serde_json::Value;

use crate::check::{Cubes, report};
use crate::surface_file::SurfaceFile;
use crate::workplace::{FAILED, Workplace};

/// VTK gives the size of the last compressed block as 0 where it is full, as with 4096 cells of two labels: `vtkio` reads too little
/// then.
#[test]
fn arrays_of_vtk_that_fill_their_last_compressed_block_are_read() {
    let workplace = Workplace::new();
    let name = "vtk_full_blocks.vtp";
    fs::copy(format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR")), workplace.path(name)).unwrap();
    let report = report(&workplace, name, 0);
    assert_eq!((&report["grains"], &report["elements"]), (&Value::from(1), &Value::from(4096)));
}

/// The program's own file, three flat grains, after VTK has read and written it in single precision, compressed.
#[test]
fn what_files_say_is_read_after_another_program_wrote_them() {
    let workplace = Workplace::new();
    let name = "rewritten_by_vtk.vtp";
    fs::copy(format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR")), workplace.path(name)).unwrap();
    let good = report(&workplace, name, 0);
    assert!(good["volume_error"].as_f64().unwrap() < 1e-6);
    assert_eq!(good["statistics"].as_array().unwrap().len(), 4);
    let file = workplace.bytes(name);
    let volumes = field_numbers(&file, "Volumes").unwrap();
    assert_eq!(volumes.len(), 3);
    assert!((volumes.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    assert!(field_text(&file, "CommandLine").unwrap().starts_with("grainsmooth --seeds 3 "));
}

/// Grain 7 has another number, which no volume in the file has.
#[test]
fn grains_without_a_stated_volume_and_volumes_without_a_grain_are_found() {
    let workplace = Workplace::new();
    workplace.run("--seeds 12 -n 0 -o a.vtk");
    let mut file = workplace.bytes("a.vtk");
    let head = b"FaceLabels 2 ";
    let start = file.windows(head.len()).position(|window| window == head).unwrap();
    let start = start + file[start..].iter().position(|byte| *byte == b'\n').unwrap() + 1;
    let count = report(&workplace, "a.vtk", 0)["elements"].as_u64().unwrap();
    for label in file[start..].chunks_exact_mut(4).take(2 * usize::try_from(count).unwrap()) {
        if label == 7i32.to_be_bytes() {
            label.copy_from_slice(&700i32.to_be_bytes());
        }
    }
    workplace.put("a.vtk", file);
    let report = report(&workplace, "a.vtk", FAILED);
    let messages: Vec<&str> =
        report["faults"].as_array().unwrap().iter().map(|fault| fault["message"].as_str().unwrap()).collect();
    let expected =
        ["grain 7 is missing: its volume is stated, but nothing bounds it", "grain 700 has no stated volume"];
    assert_eq!(messages, expected);
}

/// They were passed over: the command line in each file says `--periodic none`, which was taken for a period.
#[test]
fn wrong_node_types_in_files_of_this_program_are_found() {
    let workplace = Workplace::new();
    for arguments in ["", "--dim 2", "--periodic x,y,z --periodic-cut box"] {
        workplace.run(&format!("--seeds 12 -n 1 -o a.vtk {arguments}"));
        assert_eq!(report(&workplace, "a.vtk", 0)["good"], true);
        let mut file = workplace.bytes("a.vtk");
        let head = b"NodeTypes 1 ";
        let start = file.windows(head.len()).position(|window| window == head).unwrap();
        let first = start + file[start..].iter().position(|byte| *byte == b'\n').unwrap() + 1;
        file[first] = if file[first] == 2 { 3 } else { 2 };
        workplace.put("a.vtk", file);
        let report = report(&workplace, "a.vtk", FAILED);
        assert_eq!(report["faults"][0]["kind"], "wrong node type", "{arguments}");
        assert_eq!(report["faults"].as_array().unwrap().len(), 1, "{arguments}");
    }
}

/// In periodic files too, where the grains at all copies of a point count.
#[test]
fn wrong_numbers_of_grains_are_found() {
    let workplace = Workplace::new();
    for arguments in
        ["", "--dim 2", "--periodic x,y,z", "--dim 2 --periodic x", "--periodic x,y --periodic-cut box"]
    {
        workplace.run(&format!("--seeds 12 -n 1 -o a.vtk {arguments}"));
        assert_eq!(report(&workplace, "a.vtk", 0)["good"], true);
        let mut file = workplace.bytes("a.vtk");
        let head = b"NumberOfGrains 1 ";
        let start = file.windows(head.len()).position(|window| window == head).unwrap();
        let first = start + file[start..].iter().position(|byte| *byte == b'\n').unwrap() + 1;
        let right = file[first];
        file[first] = right + 1;
        workplace.put("a.vtk", &file);
        let report = report(&workplace, "a.vtk", FAILED);
        let message = format!("point 0 has {} as its number of grains, but {right} meet there", right + 1);
        assert_eq!(report["faults"][0]["message"], message, "{arguments}");
        assert_eq!(report["faults"].as_array().unwrap().len(), 1, "{arguments}");
        file[first] = 0;
        workplace.put("a.vtk", file);
        let message = "a.vtk: NumberOfGrains of point 0 is 0 and not from 1 to 255; give a complete VTK file";
        workplace.refuses("check a.vtk", FAILED, message);
    }
}

/// As VTK 9 and meshio write legacy files: remarks between the arrays of field data, newer names of types, a third label, and
/// `nan` among numbers.
#[test]
fn legacy_files_as_others_write_them_are_read() {
    let workplace = Workplace::new();
    let cubes = Cubes::new();
    let file = cubes.file("FaceLabels");
    let volumes = "POLYDATA\nFIELD FieldData 3\nSeed 1 1 vtktypeuint64\n1 \nMETADATA\nINFORMATION 0\n\n\
         Config 1 1 string\nbox%20=%20[1.0,%201.0,%201.0]%0Anames%20=%20\"grainsmooth\"\n\nVolumes 1 2 double\n0.5 0.25 \nMETADATA\n\
         INFORMATION 0\n\n";
    let remarked = file.replace("POLYDATA\n", volumes);
    workplace.put("cubes.vtk", &remarked);
    let found = report(&workplace, "cubes.vtk", FAILED);
    let message =
        "the volume of grain 1 has a relative error of 1.0e0; its equivalent diameter should be 7.816e-1";
    assert_eq!(found["faults"][0]["message"], message);
    assert_eq!(found["faults"].as_array().unwrap().len(), 1);
    workplace.put("cubes.vtk", remarked.replace("0.5 0.25", "0.5 0.5"));
    assert_eq!(report(&workplace, "cubes.vtk", 0)["volume_error"], 0.0);

    let count = cubes.triangles.len();
    let types = format!(
        "CELL_DATA {count}\nSCALARS Other signed_char \nLOOKUP_TABLE default\n{}",
        "1\n".repeat(count)
    );
    let newer = file.replace(&format!("CELL_DATA {count}\n"), &types);
    workplace.put("cubes.vtk", newer.replace(" int\n", " vtktypeint32\n"));
    assert_eq!(report(&workplace, "cubes.vtk", 0)["grains"], 2);
    let none = types.replace("signed_char", "double").replacen("1\n1\n", "nan\n-inf\n", 1);
    workplace.put("cubes.vtk", file.replace(&format!("CELL_DATA {count}\n"), &none));
    assert_eq!(report(&workplace, "cubes.vtk", 0)["grains"], 2);

    let labels = |third: u8| {
        let (head, pairs) = file.split_once("FaceLabels 2 ").unwrap();
        let (line, pairs) = pairs.split_once('\n').unwrap();
        let triples: String = pairs.lines().map(|pair| format!("{pair} {third}\n")).collect();
        format!("{head}FaceLabels 3 {line}\n{triples}")
    };
    workplace.put("cubes.vtk", labels(0));
    assert_eq!(report(&workplace, "cubes.vtk", 0)["grains"], 2);
    workplace.put("cubes.vtk", labels(1));
    workplace.refuses(
        "check cubes.vtk",
        FAILED,
        "cubes.vtk: FaceLabels has 66 numbers where 22 cells need two each; give a complete VTK file",
    );
    // Once this found crossings, and a volume that is no number.
    workplace.put("cubes.vtk", file.replace("0.5 0 1\n", "0.5 0 1e160\n"));
    workplace.refuses(
        "check cubes.vtk",
        FAILED,
        "cubes.vtk: point 5 has the coordinate 1e160; scale the mesh so that none exceeds 1e30",
    );
    workplace.put("cubes.vtk", file.replace("0.5 0 1\n", "0.5 nan 1\n"));
    workplace.refuses(
        "check cubes.vtk",
        FAILED,
        "cubes.vtk: point 5 has the coordinate nan; give a complete VTK file",
    );
    workplace.put("cubes.vtk", file.replace(" int\n", " double\n").replace("\n0 1\n", "\n0 1.5\n"));
    workplace.refuses(
        "check cubes.vtk",
        FAILED,
        "cubes.vtk: FaceLabels are no whole numbers; give a complete VTK file",
    );
}

/// Newer versions of VTK write 32-bit offsets, `OFFSETS int`, where they are enough; `vtkio` knows 64-bit ones only.
#[test]
fn legacy_cells_with_narrow_offsets_are_read() {
    let workplace = Workplace::new();
    let cubes = Cubes::new();
    let count = cubes.triangles.len();
    let corners: Vec<usize> = cubes.triangles.iter().flat_map(|(corners, _)| *corners).collect();
    let file = cubes.file("FaceLabels");
    let (head, rest) = file.split_once("POLYGONS").unwrap();
    let (_, labels) = rest.split_once("CELL_DATA").unwrap();
    let head = format!("{head}POLYGONS {} {}\nOFFSETS int\n", count + 1, 3 * count);
    let words = |numbers: &[usize]| numbers.iter().map(|number| format!("{number} ")).collect::<String>();
    let offsets: Vec<usize> = (0..=count).map(|cell| 3 * cell).collect();
    let text =
        [&head, &words(&offsets), "\nCONNECTIVITY int\n", &words(&corners), "\nCELL_DATA", labels].concat();
    workplace.put("cubes.vtk", text);
    assert_eq!(report(&workplace, "cubes.vtk", 0)["grains"], 2);

    let big = |numbers: &[usize]| -> Vec<u8> {
        numbers.iter().flat_map(|number| i32::try_from(*number).unwrap().to_be_bytes()).collect()
    };
    let points: Vec<u8> = cubes.points.iter().flatten().flat_map(|x| x.to_be_bytes()).collect();
    let pairs: Vec<u8> =
        cubes.triangles.iter().flat_map(|(_, pair)| *pair).flat_map(i32::to_be_bytes).collect();
    let (before_points, _) = head.split_once("double\n").unwrap();
    let before_points = before_points.replace("ASCII", "BINARY");
    let counts = format!("\nPOLYGONS {} {}\nOFFSETS int\n", count + 1, 3 * count);
    let heads = format!("\nCELL_DATA {count}\nFIELD FieldData 1\nFaceLabels 2 {count} int\n");
    let parts: [&[u8]; 10] = [
        before_points.as_bytes(),
        b"double\n",
        &points,
        counts.as_bytes(),
        &big(&offsets),
        b"\nCONNECTIVITY int\n",
        &big(&corners),
        heads.as_bytes(),
        &pairs,
        b"\n",
    ];
    workplace.put("cubes.vtk", parts.concat());
    assert_eq!(report(&workplace, "cubes.vtk", 0)["grains"], 2);
}

/// However little a point moves: grains on both sides of its boundary are no longer as large as the file says.
#[test]
fn points_moved_a_little_are_found() {
    let workplace = Workplace::new();
    for (name, arguments) in [
        ("a.vtp", ""),
        ("b.vtu", "--periodic x,y,z"),
        ("c.vtk", "--names dream3d"),
        ("d.vtp", "--dim 2"),
        ("e.vtk", "--periodic x,y,z --periodic-cut box"),
    ] {
        workplace.run(&format!("--seeds 12 -n 1 -o {name} {arguments}"));
        assert_eq!(report(&workplace, name, 0)["faults"], serde_json::json!([]), "{name}");
        workplace.run(&format!("--seeds 12 -n 1 -o same.vtp {arguments}"));
        let points = SurfaceFile::read(&workplace.path("same.vtp")).points;
        // Inside the box, so not on a wall or a cap, where it could move along.
        let axes = if arguments == "--dim 2" { 2 } else { 3 };
        let inside = points.iter().rev().find(|p| (0..axes).all(|axis| (0.3..0.7).contains(&p[axis])));
        let old = inside.unwrap().x;
        let is_big = name.ends_with("vtk");
        let bytes = |x: f64| if is_big { x.to_be_bytes() } else { x.to_ne_bytes() };
        let mut file = workplace.bytes(name);
        let at = file.windows(8).position(|window| window == bytes(old)).unwrap();
        file[at..at + 8].copy_from_slice(&bytes(old + 1e-3));
        workplace.put(name, file);
        let report = report(&workplace, name, FAILED);
        let faults = report["faults"].as_array().unwrap();
        assert!(faults.iter().any(|fault| fault["kind"] == "wrong volume"), "{name}: {faults:?}");
    }
}

/// Two tetrahedra with a face in common, each a grain, as a file for Abaqus.
const TETRAHEDRA: &str = "\
*NODE, NSET=NODES
1, 0., 0., 0.
2, 1., 0., 0.
3, 0., 1., 0.
4, 0., 0., 1.
5, 1., 1., 1.
*ELEMENT, TYPE=C3D4, ELSET=ELEMENTS
1, 1, 2, 3, 4
2, 2, 3, 4, 5
*ELSET, ELSET=GRAIN_0
1,
*ELSET, ELSET=GRAIN_1, GENERATE
2, 2, 1
*NSET, NSET=X0
1, 3, 4
*NSET, NSET=X1
2, 5
*NSET, NSET=Y0
1, 2, 4
*NSET, NSET=Y1
3, 5
*NSET, NSET=Z0
1, 2, 3
*NSET, NSET=Z1
4, 5
";

#[test]
fn tetrahedra_are_checked_like_networks() {
    let workplace = Workplace::new();
    workplace.put("a.inp", TETRAHEDRA);
    let good = report(&workplace, "a.inp", 0);
    assert_eq!(good["volumes"].to_string(), "[[0,0.16666666666666666],[1,0.3333333333333333]]");
    assert_eq!(good["node_sets"].as_array().unwrap().len(), 6);
    for (from, to, kind, message) in [
        ("2, 2, 3, 4, 5", "2, 3, 2, 4, 5", "inverted", "tetrahedron 2 has the volume -3.333e-1"),
        ("2, 2, 1\n", "1, 2, 1\n", "two grains", "tetrahedron 1 is part of the grains 0 and 1"),
        ("1, 3, 4\n", "1, 3\n", "incomplete set", "the set X0 lacks 1 nodes, such as that at node 4"),
        ("1., 1., 1.\n", "1., 1., 1.\n6, 2., 2., 2.\n", "unused node", "node 6 is part of no element"),
    ] {
        assert!(TETRAHEDRA.contains(from), "{from}");
        workplace.put("a.inp", TETRAHEDRA.replacen(from, to, 1));
        let bad = report(&workplace, "a.inp", FAILED);
        let faults = bad["faults"].as_array().unwrap();
        assert!(
            faults.iter().any(|fault| fault["kind"] == kind && fault["message"] == message),
            "{faults:?}"
        );
        workplace.command("check a.inp").assert().code(FAILED);
    }
    for (from, to, message) in [
        (
            "C3D4",
            "C3D8",
            "line 8: elements of the type C3D8 are not checked; give C3D4, C3D10 and COH3D6, or in the plane CPS3, CPE3, CPS6, CPE6 and COH2D4",
        ),
        ("1, 2, 3, 4\n2", "1, 2, 3, 9\n2", "line 8: there is no node 9"),
        ("2, 1., 0., 0.", "1, 1., 0., 0.", "line 3: node 1 comes a second time"),
        ("5, 1., 1., 1.", "5, 1., 1., one", "line 6: 'one' is no number that fits here"),
        ("*ELEMENT", "*ELEMENTS", "line 11: there is no element 1"),
    ] {
        assert!(TETRAHEDRA.contains(from), "{from}");
        workplace.put("a.inp", TETRAHEDRA.replacen(from, to, 1));
        let output = workplace.command("check a.inp").assert().code(FAILED).stdout("").get_output().clone();
        assert_eq!(String::from_utf8(output.stderr).unwrap(), format!("error: a.inp: {message}\n"));
    }
    workplace.put("a.inp", "*NODE\n1, 0., 0., 0.\n");
    let message = "error: a.inp: holds no tetrahedra, nor triangles in one plane; give a mesh that fills grains, or a network as .vtp, .vtu or .vtk\n";
    workplace.command("check a.inp").assert().code(FAILED).stderr(message);
    workplace.put("a.inp", TRIANGLES.replacen("1., 1.\n", "1., 1., 1.\n", 1));
    workplace.command("check a.inp").assert().code(FAILED).stderr(message);
}

/// Two triangles with nodes of their own, each a grain, and a cohesive element between them, as a file for Abaqus.
const TRIANGLES: &str = "\
*NODE, NSET=NODES
1, 0., 0.
2, 1., 0.
3, 0., 1.
4, 1., 0.
5, 1., 1.
6, 0., 1.
*ELEMENT, TYPE=CPS3, ELSET=ELEMENTS
1, 1, 2, 3
2, 4, 5, 6
*ELEMENT, TYPE=COH2D4, ELSET=COHESIVE
3, 3, 2, 4, 6
*ELSET, ELSET=GRAIN_0
1,
*ELSET, ELSET=GRAIN_1
2,
*NSET, NSET=X0
1, 3, 6
*NSET, NSET=X1
2, 4, 5
*NSET, NSET=Y0
1, 2, 4
*NSET, NSET=Y1
3, 5, 6
*SURFACE, TYPE=ELEMENT, NAME=BOUNDARY_0
1, S2
*SURFACE, TYPE=ELEMENT, NAME=X0
1, S3
*SURFACE, TYPE=ELEMENT, NAME=X1
2, S1
*SURFACE, TYPE=ELEMENT, NAME=Y0
1, S1
*SURFACE, TYPE=ELEMENT, NAME=Y1
2, S2
";

#[test]
fn triangles_that_fill_grains_are_checked() {
    let workplace = Workplace::new();
    workplace.put("a.inp", TRIANGLES);
    let good = report(&workplace, "a.inp", 0);
    assert_eq!(good["volumes"].to_string(), "[[0,0.5],[1,0.5]]");
    assert_eq!([&good["dimension"], &good["elements"], &good["cohesive_elements"]], [2, 2, 1]);
    assert!((good["quality"]["least_angle"].as_f64().unwrap() - 45.0).abs() < 1e-12);
    let said = workplace.command("check a.inp").assert().success().get_output().clone();
    let said = String::from_utf8(said.stdout).unwrap();
    assert!(said.contains("2 triangles of order 1, 1 cohesive elements") && said.contains("area        1\n"));
    for (from, to, kind, message) in [
        ("2, 4, 5, 6", "2, 5, 4, 6", "inverted", "triangle 2 has the area -5.000e-1"),
        (
            "1, S2\n",
            "",
            "incomplete set",
            "1 edges between grains or at the exterior are in no set, such as that at node 2",
        ),
        ("1, S3\n", "", "incomplete set", "the set X0 lacks 1 edges, such as that at node 1"),
        ("X1\n2, 4, 5", "X1\n2, 4", "incomplete set", "the set X1 lacks 1 nodes, such as that at node 5"),
        (
            "3, 3, 2, 4, 6\n",
            "3, 3, 2, 6, 4\n",
            "torn",
            "a cohesive element joins the nodes 3 and 4, which are apart",
        ),
        (
            "3, 3, 2, 4, 6\n",
            "3, 1, 2, 2, 1\n",
            "torn",
            "edges at nodes 2, 4 lie on each other, and no cohesive element joins them",
        ),
    ] {
        assert!(TRIANGLES.contains(from), "{from}");
        workplace.put("a.inp", TRIANGLES.replacen(from, to, 1));
        let bad = report(&workplace, "a.inp", FAILED);
        let faults = bad["faults"].as_array().unwrap();
        assert!(
            faults.iter().any(|fault| fault["kind"] == kind && fault["message"] == message),
            "{faults:?}"
        );
    }
    workplace.put("a.inp", TRIANGLES.replacen("2, 4, 5, 6", "2, 4, 5, 6, 1", 1));
    let message = "error: a.inp: line 10: an element has 4 nodes in place of 3\n";
    workplace.command("check a.inp").assert().code(FAILED).stderr(message);
}
