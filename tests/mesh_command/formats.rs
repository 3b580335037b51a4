//! Each format, written and read back.

use std::fs;
use std::process::Command;

use glam::DVec3;
use grainsmooth::mesh::file::{MeshFile, read_mesh};
use predicates::str::contains;

use crate::programs::run;
use crate::shapes::{CUBE_OBJ, TETRAHEDRON_OFF, json, points};
use crate::workplace::Workplace;

const EXACT: [&str; 6] = ["vtp", "vtu", "vtk", "obj", "ply", "json"];

fn read(workplace: &Workplace, name: &str) -> MeshFile {
    read_mesh(&workplace.path(name)).unwrap()
}

#[test]
fn points_and_faces_come_back_bit_for_bit() {
    let workplace = Workplace::new();
    workplace.put("in.off", TETRAHEDRON_OFF);
    let original = read(&workplace, "in.off");
    assert_eq!(original.points[1], DVec3::new(1.0, 0.1 + 0.2, 0.0));
    for extension in EXACT {
        let name = format!("out.{extension}");
        workplace.run(&format!("mesh midpoint -n 0 in.off -o {name}"));
        let back = read(&workplace, &name);
        assert_eq!((&back.points, &back.faces), (&original.points, &original.faces), "{extension}");
        // And once more, from that format.
        workplace.run(&format!("mesh midpoint -n 0 {name} -o again.ply"));
        assert_eq!(read(&workplace, "again.ply").points, original.points, "{extension}");
    }
}

#[test]
fn polygons_stay_polygons() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ);
    for extension in EXACT {
        let name = format!("out.{extension}");
        workplace.run(&format!("mesh doo-sabin -n 1 cube.obj -o {name}"));
        if extension == "json" {
            let faces = &json(&workplace.bytes(&name))["levels"][0]["faces"];
            assert_eq!(faces.as_array().unwrap().len(), 26);
            continue;
        }
        let back = read(&workplace, &name);
        // 6 squares inside the faces, 12 across the edges, 8 triangles around the corners.
        assert_eq!((back.points.len(), back.faces.len()), (24, 26), "{extension}");
        assert_eq!(back.faces.iter().filter(|face| face.len() == 3).count(), 8, "{extension}");
    }
    workplace.run("mesh catmull-clark -n 2 cube.obj -o out.vtu");
    assert_eq!(read(&workplace, "out.vtu").faces.len(), 6 * 16);
}

#[test]
fn stl_is_merged_by_equal_coordinates() {
    let workplace = Workplace::new();
    workplace.put("in.off", TETRAHEDRON_OFF);
    workplace.run("mesh midpoint -n 1 in.off -o out.stl");
    assert_eq!(workplace.bytes("out.stl").len(), 84 + 50 * 16);
    let said = workplace.run("mesh loop out.stl -o out.ply");
    assert!(said.contains("merged      48 corners with exactly equal coordinates to 10 points"), "{said}");
    assert_eq!(read(&workplace, "out.ply").faces.len(), 64);
    let merged = read(&workplace, "out.stl");
    assert_eq!((merged.points.len(), merged.merged_corners), (10, Some(48)));
    assert!((merged.points[0] - read(&workplace, "in.off").points[0]).length() < 1e-7);

    workplace.put("cube.obj", CUBE_OBJ);
    workplace.run("mesh catmull-clark cube.obj -n 0 -o cube.stl");
    assert_eq!(read(&workplace, "cube.stl").faces.len(), 12, "squares are cut");
}

#[test]
fn ascii_and_big_endian_ply() {
    let workplace = Workplace::new();
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 3\nproperty float x\nproperty uchar red\nproperty double y\n\
             property int z\nelement face 1\nproperty list uchar short vertex_index\nelement edge 0\n\
             property int a\nend_header\n"
        )
    };
    workplace.put("ascii.ply", header("ascii") + "0 9 0 0\n1.5 9 0 0\n0 9 0.1 -2\n3 0 1 2\n");
    let mut bytes = header("binary_big_endian").into_bytes();
    for (x, y, z) in [(0_f32, 0_f64, 0_i32), (1.5, 0.0, 0), (0.0, 0.1, -2)] {
        bytes.extend(x.to_be_bytes());
        bytes.push(9);
        bytes.extend(y.to_be_bytes());
        bytes.extend(z.to_be_bytes());
    }
    bytes.extend([3, 0, 0, 0, 1, 0, 2]);
    workplace.put("binary.ply", bytes);
    for name in ["ascii.ply", "binary.ply"] {
        let mesh = read(&workplace, name);
        assert_eq!(mesh.points[2], DVec3::new(0.0, 0.1, -2.0), "{name}");
        assert_eq!(mesh.faces, [[0, 1, 2]], "{name}");
    }
}

#[test]
fn legacy_vtk_with_strips_and_field_data() {
    let workplace = Workplace::new();
    workplace.put(
        "strip.vtk",
        "# vtk DataFile Version 3.0\nstrip\nASCII\nDATASET POLYDATA\nFIELD FieldData 2\nnote 1 1 string\nhello\n\
         time 2 1 double\n0.5 1\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 1 1 0\nTRIANGLE_STRIPS 1 5\n4 0 1 2 3\n",
    );
    assert_eq!(read(&workplace, "strip.vtk").faces, [[0, 1, 2], [2, 1, 3]]);
    workplace.put(
        "solid.vtk",
        "# vtk DataFile Version 3.0\nsolid\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n\
         0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n",
    );
    let error = read_mesh(&workplace.path("solid.vtk")).unwrap_err().to_string();
    assert!(error.ends_with("cell 0 is a Tetra, not a polygon; give a complete VTK file"), "{error}");
}

#[test]
fn polycrystals_of_this_program_are_subdivided_further() {
    let workplace = Workplace::new();
    for extension in ["vtp", "vtu", "vtk"] {
        workplace.run(&format!("--seeds 5 -n 0 -o grains.{extension}"));
        workplace.run(&format!("mesh loop grains.{extension} -o finer.{extension}"));
        let (coarse, fine) = (
            read(&workplace, &format!("grains.{extension}")),
            read(&workplace, &format!("finer.{extension}")),
        );
        assert_eq!(fine.faces.len(), 4 * coarse.faces.len());
    }
}

#[test]
fn one_file_for_each_level() {
    let workplace = Workplace::new();
    workplace.put("in.off", TETRAHEDRON_OFF);
    let said = workplace.run("mesh loop in.off -n 2 --each-level -o out.vtp");
    for (level, faces) in [4, 16, 64].into_iter().enumerate() {
        assert_eq!(read(&workplace, &format!("out_{level}.vtp")).faces.len(), faces);
        assert!(said.contains(&format!("written     out_{level}.vtp")), "{said}");
    }
    assert!(!workplace.path("out.vtp").exists());
    assert_eq!(workplace.run("mesh loop in.off -q -o out.vtp"), "");
}

#[test]
fn limits_and_normals() {
    let workplace = Workplace::new();
    workplace
        .put("in.off", "OFF\n4 4 0\n1 1 1\n1 -1 -1\n-1 1 -1\n-1 -1 1\n3 0 1 2\n3 0 2 3\n3 0 3 1\n3 1 3 2\n");
    workplace.run("mesh limit in.off -o limit.obj");
    let limit = read(&workplace, "limit.obj");
    // A fifth of the way out: (1 - 3 w) - w with w = 1/(3 + 3/(8 * 3/16)) = 1/5.
    assert!((limit.points[0] - DVec3::splat(0.2)).length() < 1e-15, "{}", limit.points[0]);
    let text = String::from_utf8(workplace.bytes("limit.obj")).unwrap();
    assert!(text.contains("\nvn ") && text.contains("\nf 1//1 "), "{text}");

    workplace.run("mesh normals in.off -o normals.json");
    let normals = points(&json(&workplace.bytes("normals.json"))["normals"]);
    assert!((DVec3::from(normals[1]) - DVec3::new(1.0, -1.0, -1.0).normalize()).length() < 1e-15);
    for extension in ["vtp", "vtu", "vtk", "ply", "obj", "stl"] {
        workplace.run(&format!("mesh normals in.off -o normals.{extension}"));
        assert_eq!(read(&workplace, &format!("normals.{extension}")).points.len(), 4);
    }
    workplace.put("cube.obj", CUBE_OBJ);
    workplace.run("mesh limit --scheme catmull-clark cube.obj -o cube.ply");
    let corner = read(&workplace, "cube.ply").points[6];
    // (n^2 v + 4 sum of edge points + sum of face points)/(n (n + 5)) at valence 3.
    assert!((corner - DVec3::splat(0.5)).length() < 1e-15, "{corner}");
}

/// Meshes were written raw alone, which some readers do not know.
#[test]
fn vtk_files_hold_their_numbers_as_asked() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ);
    for extension in ["vtp", "vtu"] {
        workplace.run(&format!("mesh catmull-clark cube.obj -o raw.{extension}"));
        let raw = read(&workplace, &format!("raw.{extension}"));
        for (encoding, compressor) in [("base64", false), ("zlib", true)] {
            let name = format!("{encoding}.{extension}");
            workplace.run(&format!("mesh catmull-clark cube.obj --vtk-encoding {encoding} -o {name}"));
            assert_eq!(read(&workplace, &name), raw, "{name}");
            let text = String::from_utf8(workplace.bytes(&name)).unwrap();
            assert!(!text.contains("AppendedData"), "{name}");
            assert_eq!(text.contains("vtkZLibDataCompressor"), compressor, "{name}");
        }
    }
}

#[test]
fn bezier_curves_and_patches() {
    let workplace = Workplace::new();
    workplace.put("curve.txt", "0 0 0\n1 2 0\n2 0 0\n");
    workplace.run("mesh bezier curve.txt --samples 3 -o curve.obj");
    let text = String::from_utf8(workplace.bytes("curve.obj")).unwrap();
    assert!(text.ends_with("v 0.0 0.0 0.0\nv 1.0 1.0 0.0\nv 2.0 0.0 0.0\nl 1 2 3\n"), "{text}");
    workplace.run("mesh bezier curve.txt -o curve.vtp");
    workplace.refuses(
        "mesh bezier curve.txt -o curve.ply",
        1,
        "curve.ply: writing failed and left nothing: PLY holds no curves; write .vtp, .obj or .json instead",
    );
    workplace.put("patch.bpt", format!("1\n1 1\n{}", "0 0 0\n0 1 0\n1 0 0\n1 1 2\n"));
    workplace.run("mesh bezier patch.bpt --samples 3 -o patch.ply");
    let patch = read(&workplace, "patch.ply");
    assert_eq!((patch.points.len(), patch.faces.len(), patch.points[4].z), (9, 8, 0.5));
}

/// The teapot as one closed mesh, which Loop's scheme smooths without holes, and what others make of it.
#[test]
fn the_teapot_is_merged() {
    let workplace = Workplace::new();
    let teapot = concat!(env!("CARGO_MANIFEST_DIR"), "/data/teapot.bpt");
    workplace.command("mesh bezier --merge --samples 9 -o teapot.vtp").arg(teapot).assert().success();
    let said = workplace.run("mesh loop teapot.vtp --closed -n 1 -o smooth.vtp");
    assert!(said.contains("level 1 "), "{said}");
    workplace.command("mesh bezier --merge=open --samples 9 -o open.ply").arg(teapot).assert().success();
    workplace.refuses(
        "mesh loop open.ply --closed -o out.vtp",
        1,
        "open.ply: the surface is open: edge ... has one face only; close the hole",
    );
    workplace.put("curve.txt", "0 0 0\n1 2 0\n2 0 0\n");
    workplace.refuses(
        "mesh bezier curve.txt --merge -o out.vtp",
        1,
        "curve.txt: holds no surfaces to merge; leave --merge out",
    );
    let script = "
import pyvista
for name in ['teapot.vtp', 'smooth.vtp']:
    mesh = pyvista.read(name)
    assert mesh.is_manifold and mesh.n_open_edges == 0, mesh
    assert mesh.compute_cell_sizes()['Area'].min() > 1e-9
    bodies = mesh.split_bodies()
    assert len(bodies) == 4, len(bodies)
teapot = pyvista.read('teapot.vtp')
assert set(teapot.cell_data['Surface']) == set(range(-1, 32))
assert teapot.volume > 0 and pyvista.read('open.ply').n_open_edges > 0
";
    let mut python = Command::new("python3");
    python.args(["-c", script]).current_dir(workplace.path("."));
    let Some(python) = run("the_teapot_is_merged", &mut python) else { return };
    assert!(python.status.success(), "{}: {}", python.status, String::from_utf8_lossy(&python.stderr));
}

#[test]
fn de_casteljaus_points_level_by_level() {
    let workplace = Workplace::new();
    // In the plane, by two coordinates.
    workplace.put("curve.txt", "0 0\n1 2\n3 2\n4 0\n");
    let said = workplace.run("mesh bezier curve.txt --t 0.25 --construction -o levels.obj");
    assert!(said.contains("point       0.90625 1.125 0.0 after 3 levels"), "{said}");
    let expected = [
        [0.0, 0.0],
        [1.0, 2.0],
        [3.0, 2.0],
        [4.0, 0.0],
        [0.25, 0.5],
        [1.5, 2.0],
        [3.25, 1.5],
        [0.5625, 0.875],
        [1.9375, 1.875],
        [0.90625, 1.125],
    ];
    let mesh = grainsmooth::mesh::file::read_polylines(&workplace.path("levels.obj")).unwrap();
    assert_eq!(mesh.points, expected.map(|[x, y]| DVec3::new(x, y, 0.0)));
    assert_eq!(mesh.lines, [vec![0, 1, 2, 3], vec![4, 5, 6], vec![7, 8]]);
    workplace.run("mesh bezier curve.txt --t 0.25 --construction -o levels.json");
    let curve = &json(&workplace.bytes("levels.json"))["curves"][0];
    let levels: Vec<Vec<[f64; 3]>> = serde_json::from_value(curve["levels"].clone()).unwrap();
    let flat: Vec<[f64; 3]> = levels.concat();
    assert_eq!(flat, expected.map(|[x, y]| [x, y, 0.0]));
    assert_eq!(points(&curve["left"])[3], [0.90625, 1.125, 0.0]);
    workplace.run("mesh bezier curve.txt --t 0.25 --construction -o levels.vtp");
    workplace.put("patch.txt", "1 1\n0 0 0\n0 1 0\n1 0 0\n1 1 2\n");
    // Rows to v, then along u: the point is (t, v, 2 t v).
    let said = workplace.run("mesh bezier patch.txt --t 0.25 --v 0.5 --construction -o patch.obj");
    assert!(said.contains("point       0.25 0.5 0.25 after 1 levels along v and 1 along u"), "{said}");
    let patch = grainsmooth::mesh::file::read_polylines(&workplace.path("patch.obj")).unwrap();
    let expected = [
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 2.0],
        [0.0, 0.5, 0.0],
        [1.0, 0.5, 1.0],
        [0.25, 0.5, 0.25],
    ];
    assert_eq!(patch.points, expected.map(DVec3::from));
    assert_eq!(patch.lines, [vec![0, 1], vec![2, 3], vec![4, 5]]);
    workplace.run("mesh bezier patch.txt --t 0.25 --construction -o patch.json");
    let surface = &json(&workplace.bytes("patch.json"))["surfaces"][0];
    assert_eq!(surface["point"], serde_json::json!([0.25, 0.25, 0.125]));
    assert_eq!(
        [&surface["du"], &surface["dv"]],
        [&serde_json::json!([1.0, 0.0, 0.5]), &serde_json::json!([0.0, 1.0, 0.5])]
    );
    for (arguments, message) in [
        ("--t 0.4", "the following required arguments were not provided:"),
        ("--construction", "the following required arguments were not provided:"),
        (
            "--t 1.5 --construction",
            "invalid value '1.5' for '--t <T>': give a number from 0 (start) to 1 (end)",
        ),
    ] {
        workplace.refuses(&format!("mesh bezier curve.txt {arguments} -o out.vtp"), 2, message);
    }
    let script = "
import pyvista
levels = pyvista.read('levels.vtp')
assert list(levels.point_data['Level']) == [0] * 4 + [1] * 3 + [2] * 2 + [3]
assert list(levels.cell_data['Level']) == [0, 1, 2]
";
    let mut python = Command::new("python3");
    python.args(["-c", script]).current_dir(workplace.path("."));
    let Some(python) = run("de_casteljaus_points_level_by_level", &mut python) else { return };
    assert!(python.status.success(), "{}: {}", python.status, String::from_utf8_lossy(&python.stderr));
}

/// Means of the faces' normals by area, polygons too.
#[test]
fn normals_of_polygons() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ);
    workplace.run("mesh normals cube.obj -o cube.json");
    for (normal, place) in points(&json(&workplace.bytes("cube.json"))["normals"])
        .into_iter()
        .zip(read(&workplace, "cube.obj").points)
    {
        assert!((DVec3::from(normal) - place.normalize()).length() < 1e-15, "{normal:?}");
    }
}

/// Files as ParaView's own library writes them.
#[test]
fn files_of_vtk_itself() {
    let workplace = Workplace::new();
    let script = "
import pyvista
cube = pyvista.Cube().clean()
cube.save('cube.vtp'); cube.save('ascii.vtk', binary=False); cube.save('binary.vtk'); cube.save('cube.ply')
cube.cast_to_unstructured_grid().save('cube.vtu')
cube.triangulate().save('cube.stl')
import vtk
for mode in ['Ascii', 'Binary', 'Appended']:
    for encode in [0, 1]:
        for compressor in ['None', 'ZLib', 'LZ4']:
            for header in ['32', '64']:
                for kind, mesh in [('PolyData', cube), ('UnstructuredGrid', cube.cast_to_unstructured_grid())]:
                    writer = getattr(vtk, f'vtkXML{kind}Writer')()
                    writer.SetInputData(mesh)
                    getattr(writer, f'SetDataModeTo{mode}')()
                    writer.SetEncodeAppendedData(encode)
                    getattr(writer, f'SetCompressorTypeTo{compressor}')()
                    getattr(writer, f'SetHeaderTypeToUInt{header}')()
                    extension = 'vtp' if kind == 'PolyData' else 'vtu'
                    writer.SetFileName(f'{mode}_{encode}_{compressor}_{header}.{extension}')
                    writer.Write()
";
    let mut python = Command::new("python3");
    python.args(["-c", script]).current_dir(workplace.path("."));
    let Some(python) = run("files_of_vtk_itself", &mut python) else { return };
    assert!(python.status.success(), "{}: {}", python.status, String::from_utf8_lossy(&python.stderr));
    let mut count = 0;
    for entry in fs::read_dir(workplace.path(".")).unwrap() {
        let path = entry.unwrap().path();
        if path.ends_with("cube.stl") || path.ends_with("grains.vtp") {
            continue;
        }
        let mesh = read_mesh(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((mesh.points.len(), mesh.faces.len()), (8, 6), "{}", path.display());
        count += 1;
    }
    assert_eq!(count, 5 + 3 * 2 * 3 * 2 * 2);
    assert_eq!(read(&workplace, "cube.stl").points.len(), 8);
}

#[test]
fn output_is_checked_before_the_input() {
    let workplace = Workplace::new();
    workplace
        .command("mesh loop missing.obj -o nowhere/out.obj")
        .assert()
        .code(1)
        .stderr(contains("nowhere/out.obj: no directory nowhere"));
}
