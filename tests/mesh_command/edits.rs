//! Edits through the command: flips, splits and collapses, winding made to agree, polygons cut.

use glam::DVec3;
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
    assert!(said.contains("oriented    2 of 4 faces reversed; 1 part"), "{said}");
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
    assert!(said.contains("cut         1 polygon: 3 triangles"), "{said}");
    let mesh = read_mesh(&workplace.path("out.json")).unwrap();
    assert_eq!(triangles(&mesh), [[0, 1, 3], [0, 4, 1], [1, 2, 3]]);
}

#[test]
fn edges_chosen_together() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ);
    workplace.run("mesh triangulate cube.obj -o triangles.obj");
    for (command, message, points, faces) in [
        ("split --edge all", "split       18 edges", 26, 48),
        ("split --edge flat", "split       6 edges", 14, 24),
        ("split --edge longest", "split       6 edges", 14, 24),
        ("flip --edge flat", "flipped     6 edges", 8, 12),
        ("split --edge flat,0-1", "split       7 edges", 15, 26),
    ] {
        let said = workplace.run(&format!("mesh {command} triangles.obj -o out.obj"));
        assert!(said.contains(message), "{said}");
        let mesh = read_mesh(&workplace.path("out.obj")).unwrap();
        assert_eq!((mesh.points.len(), mesh.faces.len()), (points, faces), "{command}");
    }
    // A boundary stays where edges are flipped together, and is told.
    workplace.put("in.off", SQUARE);
    let said = workplace.run("mesh flip --edge all in.off -o out.obj");
    assert!(
        said.contains("flipped     1 edge; 7 stay, on the boundary or as the mesh would be no manifold"),
        "{said}"
    );
}

/// A cube whose squares are cut at their middles keeps all its symmetries under Loop's scheme; cut along one diagonal each, it does not.
#[test]
fn presplit_cube_stays_symmetric() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ);
    let said = workplace.run("mesh edit cube.obj triangulate split=flat orient -o presplit.obj");
    for line in
        ["cut         6 polygons: 12 triangles", "split       6 edges", "edited      14 points, 24 faces"]
    {
        assert!(said.contains(line), "{said}");
    }
    workplace.run("mesh triangulate cube.obj -o plain.obj");
    let asymmetry = |name: &str| {
        workplace.run(&format!("mesh loop {name} -n 3 -o smooth.vtp"));
        let points = read_mesh(&workplace.path("smooth.vtp")).unwrap().points;
        let symmetries = [
            |p: DVec3| DVec3::new(p.y, p.z, p.x),
            |p: DVec3| DVec3::new(-p.y, p.x, p.z),
            |p: DVec3| DVec3::new(p.y, p.x, p.z),
        ];
        let nearest = |place: DVec3| points.iter().map(|p| p.distance(place)).fold(f64::INFINITY, f64::min);
        let worst = symmetries.iter().flat_map(|s| points.iter().map(|p| nearest(s(*p))));
        worst.fold(0.0, f64::max)
    };
    assert!(asymmetry("presplit.obj") < 1e-12);
    assert!(asymmetry("plain.obj") > 1e-3);
}

#[test]
fn several_edits_in_their_order() {
    let workplace = Workplace::new();
    workplace.put("in.off", SQUARE);
    workplace.run("mesh edit in.off split=0-4 flip=1-5 reverse -o out.json");
    workplace.run("mesh split in.off --edge 0-4 -o one.json");
    workplace.run("mesh flip one.json --edge 1-5 -o two.json");
    let (at_once, steps) =
        (read_mesh(&workplace.path("out.json")).unwrap(), read_mesh(&workplace.path("two.json")).unwrap());
    let mut turned = steps.clone();
    turned.faces.iter_mut().for_each(|face| face.reverse());
    assert_eq!(triangles(&at_once), triangles(&turned));
    // In another order there is no such edge yet.
    workplace.refuses(
        "mesh edit in.off flip=1-5 split=0-4 -o out.json",
        1,
        "in.off: there is no edge 1-5; name two neighbours",
    );
}

#[test]
fn creases_follow_their_edges() {
    let workplace = Workplace::new();
    let json = r#"{"vertices": [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 0]],
        "faces": [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]], "creases": [[0, 4, 2.5], [4, 2], [1, 4]], "corners": [3]}"#;
    workplace.put("in.json", json);
    workplace.run("mesh edit in.json split=4-0 flip=1-4 -o out.json");
    let mesh = read_mesh(&workplace.path("out.json")).unwrap();
    let creases: Vec<_> = mesh.creases.iter().map(|crease| (crease.ends, crease.sharpness)).collect();
    assert_eq!(creases, [([4, 5], 2.5), ([5, 0], 2.5), ([4, 2], 10.0)]);
    assert_eq!(mesh.corners, [(3, 10.0)]);
    workplace.run("mesh loop out.json -o smooth.vtp");
}
