//! Every reference file through the command, level by level, limits and normals included.

use std::collections::HashMap;

use serde_json::Value;

use crate::shapes::{assert_close, faces, json, points, reference_path};
use crate::workplace::Workplace;

/// The file and what the program makes of its level 0.
fn through_the_command(name: &str, subcommand: &str) -> (Value, Value) {
    let path = reference_path(name);
    let expected = json(&std::fs::read(&path).unwrap());
    let levels = expected["levels"].as_array().unwrap().len();
    let workplace = Workplace::new();
    let mut command = workplace.command(&format!("mesh {subcommand} -n {levels} --json -o out.txt"));
    command.arg(path).assert().success();
    (expected, json(&workplace.bytes("out.txt")))
}

/// Checks all levels, matched through `parents`; returns our id of each of their vertices on every level.
fn check_levels(name: &str, expected: &Value, ours: &Value) -> Vec<Vec<usize>> {
    assert_eq!(ours["vertices"], expected["vertices"], "{name}: the input comes back digit for digit");
    let mut maps = vec![(0..points(&expected["vertices"]).len()).collect::<Vec<_>>()];
    let expected = expected["levels"].as_array().unwrap();
    let ours = ours["levels"].as_array().unwrap();
    assert_eq!(ours.len(), expected.len());
    for (expected, ours) in expected.iter().zip(ours) {
        assert_eq!(ours["level"], expected["level"]);
        let sorted = |mut parents: Vec<usize>| {
            parents.sort_unstable();
            parents
        };
        let parents = |value: &Value| -> Vec<Vec<usize>> { serde_json::from_value(value.clone()).unwrap() };
        let our_parents = parents(&ours["parents"]).into_iter().map(sorted).enumerate();
        let by_parents: HashMap<Vec<usize>, usize> = our_parents.map(|(id, parents)| (parents, id)).collect();
        let coarse = &maps[maps.len() - 1];
        let in_ours = |theirs: &Vec<usize>| by_parents[&sorted(theirs.iter().map(|&v| coarse[v]).collect())];
        let map: Vec<usize> = parents(&expected["parents"]).iter().map(in_ours).collect();
        let (theirs, ours_points) = (points(&expected["vertices"]), points(&ours["vertices"]));
        assert_eq!(ours_points.len(), theirs.len());
        for (v, theirs) in theirs.iter().enumerate() {
            assert_close(&ours_points[map[v]], theirs, &format!("{name} {} vertex {v}", ours["level"]));
        }
        if expected["faces"].is_array() {
            let in_ours = |face: &Vec<u32>| face.iter().map(|&v| map[v as usize]).collect();
            let theirs = faces(&expected["faces"]).iter().map(in_ours).map(canonical).collect();
            let own = |face: Vec<u32>| canonical(face.iter().map(|&v| v as usize).collect());
            let ours: Vec<_> = faces(&ours["faces"]).into_iter().map(own).collect();
            assert_eq!(as_set(ours), as_set(theirs), "{name}");
        }
        maps.push(map);
    }
    maps
}

/// A face turned so that its lowest vertex comes first.
fn canonical(mut face: Vec<usize>) -> Vec<usize> {
    let lowest = (0..face.len()).min_by_key(|&i| face[i]).unwrap();
    face.rotate_left(lowest);
    face
}

fn as_set(mut faces: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    faces.sort_unstable();
    faces
}

fn assert_normals(ours: &Value, theirs: &Value, what: &str) {
    if theirs[0].is_null() {
        assert!(ours.as_array().unwrap().iter().all(Value::is_null), "{what}: {ours}");
    } else {
        let normal = |value: &Value| serde_json::from_value(value.clone()).unwrap();
        assert_close(&normal(ours), &normal(theirs), what);
    }
}

fn check_limits(name: &str, expected: &Value, ours: &Value, maps: &[Vec<usize>]) {
    for expected in expected["limits"].as_array().unwrap() {
        let level = usize::try_from(expected["level"].as_u64().unwrap()).unwrap();
        let of_level = |limits: &&Value| limits["level"] == expected["level"];
        let ours = ours["limits"].as_array().unwrap().iter().find(of_level).expect(name);
        let (positions, our_positions) =
            (points(&expected["position_exact"]), points(&ours["position_exact"]));
        for (v, &id) in maps[level].iter().enumerate() {
            let what = format!("{name} level {level} vertex {v}");
            assert_eq!(ours["kind"][id], expected["kind"][v], "{what}");
            assert_close(&our_positions[id], &positions[v], &what);
            assert_normals(&ours["normal_exact"][id], &expected["normal_exact"][v], &what);
        }
    }
    for theirs in expected["sector_normals_level0"].as_array().into_iter().flatten() {
        let is_it = |ours: &&Value| ours["v"] == theirs["v"] && ours["ring"] == theirs["ring"];
        let ours = ours["sector_normals_level0"].as_array().unwrap().iter().find(is_it).expect(name);
        assert_normals(&ours["normal"], &theirs["normal"], name);
    }
}

#[test]
fn loop_and_its_limits() {
    for name in [
        "loop_tetrahedron",
        "loop_torus",
        "loop_cube_asym",
        "loop_cube_presplit",
        "loop_open_edge",
        "loop_open_edge_corner",
        "loop_crease_inf",
        "loop_crease_semi",
        "loop_nonmanifold_triple_line",
        "loop_nonmanifold_2grains",
    ] {
        let (expected, ours) = through_the_command(name, "loop");
        let maps = check_levels(name, &expected, &ours);
        check_limits(name, &expected, &ours, &maps);
    }
}

#[test]
fn other_weights_of_loop() {
    for (name, weights) in
        [("loop_warren_open_edge", "warren"), ("loop_blz_open_edge", "biermann-levin-zorin")]
    {
        let (expected, ours) = through_the_command(name, &format!("loop --weights {weights}"));
        check_levels(name, &expected, &ours);
    }
}

#[test]
fn butterflies() {
    for (name, subcommand) in [
        ("butterfly_cube_presplit", "butterfly"),
        ("mbutterfly_tetrahedron", "modified-butterfly"),
        ("mbutterfly_torus", "modified-butterfly"),
        ("mbutterfly_cube_presplit", "modified-butterfly"),
        ("mbutterfly_open", "modified-butterfly"),
    ] {
        let (expected, ours) = through_the_command(name, subcommand);
        check_levels(name, &expected, &ours);
    }
}

#[test]
fn doo_sabin_and_its_limits() {
    for name in ["doosabin_cube", "doosabin_tetrahedron", "doosabin_open_grid"] {
        let (expected, ours) = through_the_command(name, "doo-sabin");
        let mut vertex_ids: Vec<usize> = (0..points(&expected["vertices"]).len()).collect();
        let mut face_ids: Vec<usize> = (0..faces(&expected["faces"]).len()).collect();
        for (expected, ours) in
            expected["levels"].as_array().unwrap().iter().zip(ours["levels"].as_array().unwrap())
        {
            let corners =
                |value: &Value| -> Vec<[usize; 2]> { serde_json::from_value(value.clone()).unwrap() };
            let our_corners = corners(&ours["corners"]).into_iter().enumerate();
            let by_corner: HashMap<[usize; 2], usize> =
                our_corners.map(|(id, corner)| (corner, id)).collect();
            let in_ours = |&[face, vertex]: &[usize; 2]| by_corner[&[face_ids[face], vertex_ids[vertex]]];
            vertex_ids = corners(&expected["corners"]).iter().map(in_ours).collect();
            let our_points = points(&ours["vertices"]);
            for (v, theirs) in points(&expected["vertices"]).iter().enumerate() {
                assert_close(&our_points[vertex_ids[v]], theirs, name);
            }
            let own = |face: Vec<u32>| canonical(face.iter().map(|&v| v as usize).collect());
            let our_faces = faces(&ours["faces"]).into_iter().map(own).enumerate();
            let by_vertices: HashMap<Vec<usize>, usize> = our_faces.map(|(id, face)| (face, id)).collect();
            let in_ours = |face: &Vec<u32>| canonical(face.iter().map(|&v| vertex_ids[v as usize]).collect());
            face_ids = faces(&expected["faces"]).iter().map(|face| by_vertices[&in_ours(face)]).collect();
            let limit_points = points(&ours["limit_face_point"]);
            for (f, theirs) in points(&expected["limit_face_point"]).iter().enumerate() {
                assert_close(&limit_points[face_ids[f]], theirs, name);
                let normal = &ours["limit_face_normal"][face_ids[f]];
                assert_normals(normal, &expected["limit_face_normal"][f], name);
            }
        }
        let (expected, ours) = through_the_command(name, "doo-sabin --weights means");
        let means = points(&ours["levels"][0]["vertices"]);
        for (ours, theirs) in
            means.iter().zip(points(&expected["level1_catmull_clark_1978_weights_numpy_only"]))
        {
            assert_close(ours, &theirs, name);
        }
    }
}

#[test]
fn creases_and_corners_of_the_command_line_are_those_of_a_file() {
    let expected = json(&std::fs::read(reference_path("loop_crease_semi")).unwrap());
    let creases: Vec<(u32, u32, f32)> = serde_json::from_value(expected["creases"].clone()).unwrap();
    let levels = expected["levels"].as_array().unwrap().len();
    let workplace = Workplace::new();
    let corners: Vec<(u32, f32)> = serde_json::from_value(expected["corners"].clone()).unwrap();
    let mut bare = expected.clone();
    for key in ["creases", "corners", "levels", "limits"] {
        bare.as_object_mut().unwrap().remove(key);
    }
    workplace.put("bare.json", bare.to_string());
    let creases: Vec<_> = creases.iter().map(|(a, b, sharpness)| format!("{a}-{b}:{sharpness}")).collect();
    let corners: Vec<_> = corners.iter().map(|(v, sharpness)| format!("{v}:{sharpness}")).collect();
    let [creases, corners] = [creases, corners].map(|features| features.join(","));
    workplace
        .run(&format!("mesh loop bare.json -n {levels} -o out.json --crease {creases} --corners {corners}"));
    let ours = json(&workplace.bytes("out.json"));
    let maps = check_levels("loop_crease_semi", &expected, &ours);
    check_limits("loop_crease_semi", &expected, &ours, &maps);

    // A corner stays, and the boundary rule fixes the corners of the boundary.
    let path = reference_path("loop_open_edge_corner");
    let expected = json(&std::fs::read(&path).unwrap());
    workplace.command("mesh loop -n 3 --boundary edge -o edge.json").arg(&path).assert().success();
    workplace.command("mesh loop -n 3 --boundary edge-corner -o out.json").arg(&path).assert().success();
    check_levels("loop_open_edge_corner", &expected, &json(&workplace.bytes("out.json")));
    assert!(workplace.bytes("edge.json") != workplace.bytes("out.json"));
    workplace.command("mesh loop -n 2 --corners 3,17 -o corners.json").arg(&path).assert().success();
    let ours = json(&workplace.bytes("corners.json"));
    for corner in [3, 17] {
        assert_eq!(ours["levels"][1]["vertices"][corner], expected["vertices"][corner]);
    }
}

#[test]
fn bezier_points_and_derivatives() {
    let path = reference_path("bezier");
    let expected = json(&std::fs::read(&path).unwrap());
    let workplace = Workplace::new();
    workplace.command("mesh bezier --samples 9 -o out.json").arg(path).assert().success();
    let ours = json(&workplace.bytes("out.json"));
    let mut checked = 0;
    for (ours, theirs) in
        ours["curves"].as_array().unwrap().iter().zip(expected["curves"].as_array().unwrap())
    {
        assert_eq!(ours["degree"], theirs["degree"]);
        for (i, t) in theirs["t"].as_array().unwrap().iter().enumerate() {
            let Some(sample) = ours["t"].as_array().unwrap().iter().position(|ours| ours == t) else {
                continue;
            };
            for key in ["point", "derivative"] {
                assert_close(&points(&ours[key])[sample], &points(&theirs[key])[i], key);
            }
            checked += 1;
        }
    }
    assert_eq!(checked, 5 * 4);
    let (ours, theirs) = (&ours["surfaces"][0], &expected["surface"]);
    let uv = |value: &Value| -> Vec<[f64; 2]> { serde_json::from_value(value["uv"].clone()).unwrap() };
    for (i, parameters) in uv(theirs).iter().enumerate() {
        let Some(sample) = uv(ours).iter().position(|ours| ours == parameters) else { continue };
        for key in ["point", "du", "dv"] {
            assert_close(&points(&ours[key])[sample], &points(&theirs[key])[i], key);
        }
    }
}
