//! Flips, splits and collapses through the command.

use grainsmooth::mesh::file::{MeshFile, read_mesh};

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
