//! Edits through the command: flips, splits and collapses, winding made to agree, polygons cut.

use grainsmooth::mesh::file::{MeshFile, read_mesh};

use crate::shapes::CUBE_OBJ;
use crate::workplace::Workplace;

/// A square of four triangles around its middle.
const SQUARE: &str = "OFF\n5 4 0\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n1 1 0\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n";

fn edited(command: &str) -> MeshFile {
    let workplace = Workplace::new();
    workplace.put("in.off", SQUARE);
    workplace.run(&format!("mesh {command} in.off -o out.json"));
    read_mesh(&workplace.path("out.json")).unwrap()
}

/// Triangles turned so that the lowest vertex comes first, and sorted.
fn triangles(mesh: &MeshFile) -> Vec<Vec<u32>> {
    let mut triangles = mesh.faces.clone();
    for triangle in &mut triangles {
        let lowest = (0..3).min_by_key(|&i| triangle[i]).unwrap();
        triangle.rotate_left(lowest);
    }
    triangles.sort();
    triangles
}

#[test]
fn flip_turns_an_edge() {
    let mesh = edited("flip --edge 4-1");
    assert_eq!(triangles(&mesh), [[0, 1, 2], [0, 2, 4], [0, 4, 3], [2, 3, 4]]);
}

#[test]
fn split_appends_a_point() {
    let mesh = edited("split --edge 0-1,4-2");
    assert_eq!((mesh.points.len(), mesh.faces.len()), (7, 7));
    assert_eq!(mesh.points[5].to_array(), [1.0, 0.0, 0.0]);
    assert_eq!(mesh.points[6].to_array(), [1.5, 1.5, 0.0]);
}

#[test]
fn collapse_draws_the_first_point_into_the_second() {
    let mesh = edited("collapse --edge 4-2");
    assert_eq!(triangles(&mesh), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.points.len(), 5, "ids are kept");
    // Along the boundary too, in either direction.
    assert_eq!(triangles(&edited("collapse --edge 0-1")), [[1, 2, 4], [1, 4, 3], [2, 3, 4]]);
    assert_eq!(triangles(&edited("collapse --edge 1-0")), [[0, 2, 4], [0, 4, 3], [2, 3, 4]]);
}

#[test]
fn edits_that_would_break_the_mesh_are_refused() {
    let workplace = Workplace::new();
    workplace.put("in.off", SQUARE);
    for (command, message) in [
        ("flip in.off --edge 0-1", "edge 0-1 cannot be flipped: it lies on the boundary"),
        ("split in.off --edge 0-2", "there is no edge 0-2; name two neighbours"),
        ("split in.off --edge 0-99", "there is no edge 0-99; name two neighbours"),
        ("collapse in.off --edge 4-2,4-3", "there is no edge 4-3; name two neighbours"),
    ] {
        workplace.refuses(&format!("mesh {command} -o out.obj"), 1, &format!("in.off: {message}"));
    }
}

/// SubZero's own example, triangles that wind as they were typed: refused by name, and smoothed after what the message names.
#[test]
fn winding_is_made_to_agree() {
    let workplace = Workplace::new();
    let points =
        ["0 0 0", "0 0 0", "1 1 1", "0 0 0.5", "0 1 0", "1 2 0", "-2 1 3", "-1 0 3", "0 0 0"].join("\nv ");
    workplace.put("typed.obj", format!("v {points}\nf 7 6 3\nf 5 4 3\nf 3 5 6\nf 7 8 3\n"));
    workplace.refuses(
        "mesh loop typed.obj -o out.obj",
        1,
        "typed.obj: faces 0 and 2 both run along edge 5-2 in the same direction: make their winding agree, or crease \
         the edge infinitely; `grainsmooth mesh orient` makes it agree",
    );
    let said = workplace.run("mesh orient typed.obj -o agreeing.obj");
    assert!(said.contains("oriented    2 of 4 faces turned round; 1 parts"), "{said}");
    let agreeing = read_mesh(&workplace.path("agreeing.obj")).unwrap();
    assert_eq!(agreeing.faces, [[6, 5, 2], [4, 3, 2], [2, 5, 4], [6, 2, 7]]);
    workplace.run("mesh loop agreeing.obj -n 3 -o smooth.vtp");
    assert_eq!(read_mesh(&workplace.path("smooth.vtp")).unwrap().faces.len(), 4 * 64);
}

#[test]
fn closed_parts_face_outward_if_asked() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ.replace("f 4 3 2 1", "f 1 2 3 4"));
    let volume = |name: &str| -> f64 {
        let mesh = read_mesh(&workplace.path(name)).unwrap();
        let triangles = mesh.triangles().unwrap();
        let volumes = triangles.iter().map(|t| {
            let [a, b, c] = t.map(|v| mesh.points[v as usize]);
            a.dot(b.cross(c)) / 6.0
        });
        volumes.sum()
    };
    workplace.run("mesh orient cube.obj -o out.obj");
    workplace.run("mesh triangulate out.obj -o triangles.ply");
    assert!((volume("triangles.ply") - 8.0).abs() < 1e-15);
    // Inside out, it agrees and stays so unless asked.
    let inside_out =
        ["f 1 2 3 4", "f 8 7 6 5", "f 5 6 2 1", "f 6 7 3 2", "f 7 8 4 3", "f 8 5 1 4"].join("\n");
    let points = CUBE_OBJ.split("f ").next().unwrap();
    workplace.put("inside_out.obj", format!("{points}{inside_out}\n"));
    for (option, expected) in [("", -8.0), ("--outward", 8.0)] {
        workplace.run(&format!("mesh orient {option} inside_out.obj -o out.obj"));
        workplace.run("mesh triangulate out.obj -o triangles.ply");
        assert!((volume("triangles.ply") - expected).abs() < 1e-15, "{option}");
    }
}

#[test]
fn polygons_are_cut_where_they_are_notched() {
    let workplace = Workplace::new();
    // A chevron that stands upright, and a triangle below.
    workplace.put("in.obj", "v 0 0 0\nv 2 0 1\nv 0 0 2\nv 0.5 0 1\nv 2 0 -1\nf 1 2 3 4\nf 2 1 5\n");
    let said = workplace.run("mesh triangulate in.obj -o out.json");
    assert!(said.contains("cut         1 polygons: 3 triangles"), "{said}");
    let mesh = read_mesh(&workplace.path("out.json")).unwrap();
    assert_eq!(triangles(&mesh), [[0, 1, 3], [0, 4, 1], [1, 2, 3]]);
}
