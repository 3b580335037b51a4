//! Polylines in and out, and the schemes of curves.

use std::process::Command;

use glam::DVec3;
use grainsmooth::mesh::file::{MeshFile, read_polylines};

use crate::programs::run;
use crate::shapes::{CUBE_OBJ, assert_close, faces, json, points, reference_path};
use crate::workplace::{FAILED, USAGE, Workplace};

fn read(workplace: &Workplace, name: &str) -> MeshFile {
    read_polylines(&workplace.path(name)).unwrap()
}

/// An open polyline, a closed one, and a third that ends in a point of the first.
const LINES_OBJ: &str = "v 0 0 0\nv 1 0 0.1\nv 2 1 0\nv 3 0 0\nv 0 5 0\nv 1 5 0\nv 0 6 0.3333333333333333\n\
                         l 1 2 3 4\nl 5 6 7 5\nl 3 6\n";

#[test]
fn polylines_go_through_every_format_that_holds_them() {
    let workplace = Workplace::new();
    workplace.put("in.obj", LINES_OBJ);
    let original = read(&workplace, "in.obj");
    assert_eq!(original.lines, [vec![0, 1, 2, 3], vec![4, 5, 6, 4], vec![2, 5]]);
    for extension in ["vtp", "vtu", "vtk", "obj", "json"] {
        workplace.run(&format!("mesh four-point -n 0 in.obj -o out.{extension}"));
        let back = read(&workplace, &format!("out.{extension}"));
        assert_eq!((&back.points, &back.lines), (&original.points, &original.lines), "{extension}");
    }
    for (extension, name) in [("ply", "PLY"), ("stl", "STL")] {
        workplace.refuses(
            &format!("mesh b-spline in.obj -o out.{extension}"),
            FAILED,
            &format!(
                "out.{extension}: writing failed and left nothing: {name} holds no curves; write .vtp, .obj or .json instead"
            ),
        );
    }
}

#[test]
fn cubic_b_splines_are_those_of_the_references() {
    for name in ["line_open", "line_closed", "line_open_corner"] {
        let path = reference_path(name);
        let expected = json(&std::fs::read(&path).unwrap());
        let levels = expected["levels"].as_array().unwrap();
        let workplace = Workplace::new();
        let count = levels.len();
        workplace.command(&format!("mesh b-spline -n {count} -o out.json")).arg(&path).assert().success();
        let ours = json(&workplace.bytes("out.json"));
        for (ours, theirs) in ours["levels"].as_array().unwrap().iter().zip(levels) {
            // Theirs are in order along the curve.
            let line = &faces(&ours["lines"])[0];
            let (ours, theirs) = (points(&ours["vertices"]), points(&theirs["vertices"]));
            let is_closed = expected["closed"].as_bool().unwrap();
            assert_eq!(line.len(), theirs.len() + usize::from(is_closed), "{name}");
            for (v, theirs) in line.iter().zip(&theirs) {
                assert_close(&ours[*v as usize], theirs, name);
            }
        }
        workplace.command("mesh limit --scheme b-spline -o limit.vtp").arg(&path).assert().success();
        let limits = read(&workplace, "limit.vtp").points;
        for (ours, theirs) in limits.iter().zip(points(&expected["limit"])) {
            assert_close(&ours.to_array(), &theirs, name);
        }
    }
}

#[test]
fn the_four_point_scheme_keeps_points_and_puts_new_ones_by_its_mask() {
    let workplace = Workplace::new();
    // A closed curve in the plane: points have two coordinates.
    workplace.put("in.json", r#"{"vertices": [[0, 0], [4, 0], [5, 3], [1, 5]], "lines": [[0, 1, 2, 3, 0]]}"#);
    workplace.run("mesh four-point in.json --closed -o out.vtp");
    let mesh = read(&workplace, "out.vtp");
    let [a, b, c, d] = [[0.0, 0.0], [4.0, 0.0], [5.0, 3.0], [1.0, 5.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    assert_eq!(mesh.points[..4], [a, b, c, d]);
    assert_eq!(mesh.lines, [[0, 4, 1, 5, 2, 6, 3, 7, 0]]);
    assert!((mesh.points[4] - (9.0 * (a + b) - d - c) / 16.0).length() < 1e-15);
    assert!((mesh.points[7] - (9.0 * (d + a) - c - b) / 16.0).length() < 1e-15);
    // The same from a text of points, the first again at the end.
    workplace.put("in.txt", "0 0\n4 0\n5 3\n1 5\n0 0\n");
    workplace.run("mesh four-point in.txt -o text.vtp");
    assert_eq!(read(&workplace, "text.vtp").points, mesh.points);
    // A corner stays where cubic B-splines move points.
    workplace.run("mesh b-spline in.txt --corners 2 -n 2 -o out.obj");
    let points = read(&workplace, "out.obj").points;
    assert_eq!(points[2], c);
    assert_ne!(points[1], b);
}

#[test]
fn one_file_for_each_level_of_a_curve() {
    let workplace = Workplace::new();
    workplace.put("in.obj", LINES_OBJ);
    let said = workplace.run("mesh b-spline in.obj -n 2 --each-level -o out.vtk");
    assert!(said.contains("level 2     28 points, 28 segments"), "{said}");
    for (level, points) in [7, 14, 28].into_iter().enumerate() {
        let mesh = read(&workplace, &format!("out_{level}.vtk"));
        assert_eq!((mesh.points.len(), mesh.lines[0].len()), (points, 3 * (1 << level) + 1));
    }
}

#[test]
fn what_is_no_curve_is_refused() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ);
    workplace.put("in.obj", LINES_OBJ);
    workplace.put("short.json", r#"{"vertices": [[0, 0, 0]], "lines": [[0]]}"#);
    workplace.put("range.json", r#"{"vertices": [[0, 0, 0]], "lines": [[0, 1]]}"#);
    workplace.put("four.json", r#"{"vertices": [[0, 0, 0, 0]], "lines": [[0, 1]]}"#);
    workplace.put("soft.json", r#"{"vertices": [[0, 0], [1, 0]], "lines": [[0, 1]], "corners": [[1, 2.5]]}"#);
    workplace.put("patch.txt", "1 1\n0 0 0\n0 1 0\n1 0 0\n1 1 2\n");
    for (command, message) in [
        (
            "b-spline cube.obj",
            "cube.obj: holds no polylines; give lines as .obj, .vtp, .vtu, .vtk, .json or .txt, or use a scheme for surfaces",
        ),
        (
            "loop in.obj",
            "in.obj: holds polylines and no faces; give a surface mesh, or use b-spline or four-point",
        ),
        ("four-point in.obj --closed", "in.obj: polyline 0 is open; end it with its first point"),
        ("four-point short.json", "short.json: polyline 0 has one point; give at least two"),
        (
            "four-point range.json",
            "range.json: polyline 0 refers to vertex 1, but there are only 1 vertices, counted from 0",
        ),
        (
            "four-point four.json",
            "four.json: line 1: invalid length 4, expected a point [x, y, z], or [x, y] in the plane at line 1 column 26",
        ),
        (
            "b-spline soft.json",
            "soft.json: corner 1 of a polyline has the sharpness 2.5; leave it out: corners of polylines are always fixed",
        ),
        (
            "b-spline in.obj --corners 7",
            "in.obj: corner 0 refers to vertex 7, but there are only 7 vertices, counted from 0",
        ),
        (
            "four-point patch.txt",
            "patch.txt: a surface of control points is not a polyline; give a complete polyline file",
        ),
    ] {
        workplace.refuses(&format!("mesh {command} -o out.vtp"), FAILED, message);
    }
    workplace.refuses(
        "mesh limit --scheme b-spline --crease 0-1 in.obj -o out.vtp",
        USAGE,
        "--crease and --boundary apply to surfaces only; for curves, give --corners",
    );
}

/// What other programs write comes in, and what we write they read.
#[test]
fn polylines_of_other_programs() {
    let workplace = Workplace::new();
    workplace.put("in.obj", LINES_OBJ);
    for extension in ["vtp", "vtu", "vtk"] {
        workplace.run(&format!("mesh b-spline in.obj -n 1 -o ours.{extension}"));
    }
    let script = "
import numpy, pyvista, meshio
ours = pyvista.read('ours.vtp')
assert ours.n_lines == 3 and ours.n_points == 14, ours
first = ours.lines[:8]
assert list(first) == [7, 0, 7, 1, 8, 2, 9, 3], first
assert abs(ours.points[0] - [0, 0, 0]).max() == 0
middle = ours.points[7]
assert abs(middle - [0.5, 0, 0.05]).max() < 1e-15, middle
smooth = ours.points[1]
assert abs(smooth - (6 * numpy.array([1, 0, 0.1]) + [0, 0, 0] + [2, 1, 0]) / 8).max() < 1e-15, smooth
for name in ['ours.vtu', 'ours.vtk']:
    other = pyvista.read(name)
    assert abs(other.points - ours.points).max() == 0
    assert other.n_cells == 3
pyvista.MultipleLines([[0., 0, 0], [1, 1, 0], [2, 0, 0]]).save('pyvista.vtp')
pyvista.MultipleLines([[0., 0, 0], [1, 1, 0], [2, 0, 0]]).save('pyvista.vtk')
points = numpy.array([[0., 0, 0], [1, 1, 0], [2, 0, 0]])
meshio.write('meshio.vtu', meshio.Mesh(points, [('line', numpy.array([[0, 1], [1, 2]]))]))
";
    let mut python = Command::new("python3");
    python.args(["-c", script]).current_dir(workplace.path("."));
    let Some(output) = run("polylines_of_other_programs", &mut python) else { return };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for name in ["pyvista.vtp", "pyvista.vtk", "meshio.vtu"] {
        workplace.run(&format!("mesh b-spline {name} -o out.vtp"));
        // Segments that join in a point are one curve, in one polyline or in two.
        let smooth = read(&workplace, "out.vtp").points[1];
        assert!((smooth - DVec3::new(1.0, 0.75, 0.0)).length() < 1e-7, "{name}: {smooth}");
    }
}
