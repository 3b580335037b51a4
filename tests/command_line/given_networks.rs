//! Networks of other programs as a start: sets of STL files, datafiles and dumps of Surface Evolver, polygons.

use std::fs;
use std::process::Command;

use grainsmooth::PageDocument;
use serde_json::Value;

use crate::programs::run;
use crate::workplace::{FAILED, Workplace};

/// Number in the file and volume (in the plane: area) of each grain.
fn grains(workplace: &Workplace, name: &str) -> Vec<(u64, f64)> {
    let statistics = workplace.json(name);
    let of_grain = |grain: &Value| {
        let size = grain.get("volume").unwrap_or_else(|| &grain["area"]);
        (grain["SeedId"].as_u64().unwrap(), size.as_f64().unwrap())
    };
    statistics["grains"].as_array().unwrap().iter().map(of_grain).collect()
}

/// Checks and relaxes a network; its grains and their volumes afterwards.
fn relaxed(workplace: &Workplace, name: &str) -> Vec<(u64, f64)> {
    workplace.command(&format!("check {name}")).assert().success();
    let said = workplace.run(&format!("smooth {name} --relax 0.001 -o relaxed.vtp --stats relaxed.json"));
    assert!(said.contains("validation  good"), "{name}: {said}");
    workplace.command("check relaxed.vtp").assert().success();
    grains(workplace, "relaxed.json")
}

fn are_near(found: &[(u64, f64)], expected: impl Iterator<Item = (u64, f64)>, relative: f64) {
    let expected: Vec<(u64, f64)> = expected.collect();
    let are_near =
        |((one, a), (two, b)): (&(u64, f64), &(u64, f64))| one == two && (a / b - 1.0).abs() < relative;
    assert!(
        found.len() == expected.len() && found.iter().zip(&expected).all(are_near),
        "{found:?} {expected:?}"
    );
}

/// Parts of a text with all facets, each a solid of its own: between the grains, and to the exterior.
fn facets(text: &str) -> Vec<String> {
    let lines: Vec<&str> = text.lines().collect();
    let inside = &lines[1..lines.len() - 1];
    inside.chunks(7).map(|facet| facet.join("\n") + "\n").collect()
}

#[test]
fn stl_files_are_grains_or_boundaries() {
    let workplace = Workplace::new();
    let outputs = "-o whole.stl --ascii --grains-dir grains --grains-format stl --stats made.json";
    workplace.run(&format!("--seeds 12 -n 1 {outputs}"));
    let made = grains(&workplace, "made.json");
    // STL has single precision.
    are_near(&relaxed(&workplace, "grains"), made.iter().copied(), 1e-6);
    // The numbers of grains are those in the names, whatever else these say.
    fs::rename(workplace.path("grains/grain_11.stl"), workplace.path("grains/grain_70_last.STL")).unwrap();
    let renamed = relaxed(&workplace, "grains");
    are_near(&renamed[11..], [(70, made[11].1)].into_iter(), 1e-6);

    // Of boundaries the grains are numbered in another order.
    let sorted = |mut grains: Vec<(u64, f64)>| {
        grains.sort_by(|a, b| a.1.total_cmp(&b.1));
        (0..).zip(grains.into_iter().map(|(_, volume)| volume)).collect::<Vec<(u64, f64)>>()
    };
    are_near(&sorted(relaxed(&workplace, "whole.stl")), sorted(made.clone()).into_iter(), 1e-6);
    let text = String::from_utf8(workplace.bytes("whole.stl")).unwrap();
    let facets = facets(&text);
    fs::create_dir(workplace.path("boundaries")).unwrap();
    for (number, part) in facets.chunks(facets.len() / 3).enumerate() {
        let solid = format!("solid part\n{}endsolid part\n", part.concat());
        workplace.put(&format!("boundaries/part_{number}.stl"), solid);
    }
    are_near(&sorted(relaxed(&workplace, "boundaries")), sorted(made).into_iter(), 1e-6);

    let open = format!("solid part\n{}endsolid part\n", facets[1..].concat());
    workplace.put("open.stl", open);
    let said = workplace.command("smooth open.stl --relax 0.1").assert().failure().code(FAILED);
    let said = String::from_utf8_lossy(&said.get_output().stderr).into_owned();
    assert!(said.contains("open.stl: the boundaries leave a gap at the edge in ("), "{said}");
}

/// An octahedron around the origin, in text.
fn octahedron(radius: f64) -> String {
    let mut facets = String::new();
    for [x, y, z] in
        [[1, 1, 1], [1, 1, -1], [1, -1, 1], [1, -1, -1], [-1, 1, 1], [-1, 1, -1], [-1, -1, 1], [-1, -1, -1]]
    {
        let [x, y, z] = [x, y, z].map(|sign: i32| f64::from(sign) * radius);
        facets += "facet normal 0 0 0\nouter loop\n";
        facets += &format!("vertex {x} 0 0\nvertex 0 {y} 0\nvertex 0 0 {z}\n");
        facets += "endloop\nendfacet\n";
    }
    facets
}

#[test]
fn a_grain_within_a_grain_is_found() {
    let workplace = Workplace::new();
    // Facets wind in any way, and a third of the volume of a cube of edge 2 times the cube of the radius is an octahedron's.
    workplace.put("nested.stl", format!("solid\n{}{}endsolid\n", octahedron(1.0), octahedron(0.5)));
    workplace.run("smooth nested.stl --relax 0.0000001 -o nested.vtp --stats nested.json");
    let volume = 4.0 / 3.0;
    are_near(
        &grains(&workplace, "nested.json"),
        [(0, volume * 0.875), (1, volume * 0.125)].into_iter(),
        1e-6,
    );
}

/// The state of a datafile after some commands of Surface Evolver, as it dumps it; nothing where it is not installed.
fn dumped(workplace: &Workplace, file: &str, commands: &str, to: &str) -> Option<()> {
    let path = |name: &str| workplace.path(name).display().to_string();
    workplace.put("commands", format!("{commands}\ndump \"{}\"\nq\nq\n", path(to)));
    let mut evolver = Command::new("evolver");
    evolver.arg(workplace.path(file)).stdin(fs::File::open(workplace.path("commands")).unwrap());
    let output = run("surface_evolver_hands_its_bodies_over", &mut evolver)?;
    assert!(workplace.path(to).exists(), "{}", String::from_utf8_lossy(&output.stdout));
    Some(())
}

#[test]
fn surface_evolver_hands_its_bodies_over() {
    let workplace = Workplace::new();
    // Four periodic grains touch themselves.
    for (seeds, how) in
        [(12, ""), (12, "--periodic x,y,z --box 2 1 1"), (12, "--periodic y"), (4, "--periodic x,y,z")]
    {
        workplace.run(&format!("--seeds {seeds} -n 1 {how} -o made.fe --stats made.json"));
        let made = grains(&workplace, "made.json");
        // Bodies count from 1.
        let bodies = || made.iter().map(|(grain, volume)| (grain + 1, *volume));
        are_near(&relaxed(&workplace, "made.fe"), bodies(), 1e-9);
        if dumped(&workplace, "made.fe", "g 1", "dumped.dmp").is_none() {
            return;
        }
        // Evolver corrects volumes to first order.
        are_near(&relaxed(&workplace, "dumped.dmp"), bodies(), 1e-3);
    }
}

/// Two cells in a square, one of them around a corner, as a datafile of strings.
const STRINGS: &str = "\
STRING
space_dimension 2
// The square is 2 wide, and the smaller cell 1.
vertices
1 0 0 fixed
2 2 0 fixed
3 2 2 fixed
4 0 2 fixed
5 1 0 fixed
6 1 1
7 0 1 fixed
edges
1 1 5 fixed
2 5 2 fixed
3 2 3 fixed
4 3 4 fixed
5 4 7 fixed
6 7 1 fixed
7 5 6 /* the line
between both */
8 6 7
faces
1 1 7 8 6
2 2 3 4 5 \\
  -8 -7
bodies
3 1 volume 1
7 2
read
g 10
";

#[test]
fn strings_of_surface_evolver_are_grains_in_the_plane() {
    let workplace = Workplace::new();
    workplace.put("strings.fe", STRINGS);
    workplace.run("smooth strings.fe --relax equilibrium -o relaxed.vtp --stats relaxed.json");
    are_near(&grains(&workplace, "relaxed.json"), [(3, 1.0), (7, 3.0)].into_iter(), 1e-9);
    if dumped(&workplace, "strings.fe", "r\ng", "strings.dmp").is_none() {
        return;
    }
    workplace.run("smooth strings.dmp --relax equilibrium -o dumped.vtp --stats dumped.json");
    // Dumps number bodies anew.
    are_near(&grains(&workplace, "dumped.json"), [(1, 1.0), (2, 3.0)].into_iter(), 1e-3);
}

#[test]
fn datafiles_that_cannot_be_read_are_refused() {
    let workplace = Workplace::new();
    let refuses = |from: &str, to: &str, message: &str| {
        let file = STRINGS.replacen(from, to, 1);
        assert_ne!(file, STRINGS);
        workplace.put("bad.fe", file);
        workplace.refuses("smooth bad.fe --relax 0.1", FAILED, &format!("bad.fe: {message}"));
    };
    let dump = "write the state with Surface Evolver's command `dump`";
    refuses("2 2 0", "2 width 0", &format!("line 6: \"width\" where a number must stand; {dump}"));
    refuses("7 5 6", "7 5 9", "line 19: there is no vertex 9; add it, or leave it out here");
    refuses(
        "-8 -7",
        "-8 7",
        "edge 7 by order has body 7 and another on one side; give a complete Surface Evolver file",
    );
    refuses("\n3 1 volume", "\n7 1 volume", "line 28: body 7 stands here a second time; leave one out");
    refuses(
        "STRING",
        "STRING\nQUADRATIC",
        "line 2: the model QUADRATIC has curved elements; give Surface Evolver's command `linear`, then `dump`",
    );
    refuses(
        "STRING\n",
        "",
        "strings are read in the plane, with `space_dimension 2`, and facets in space; give a complete Surface Evolver file",
    );
}

/// A square of 4 with a square of 2 inside, whose middle is a square of 1 of the first grain again.
const NESTED: [[f64; 2]; 12] = [
    [0.0, 0.0],
    [4.0, 0.0],
    [4.0, 4.0],
    [0.0, 4.0],
    [1.0, 1.0],
    [3.0, 1.0],
    [3.0, 3.0],
    [1.0, 3.0],
    [1.5, 1.5],
    [2.5, 1.5],
    [2.5, 2.5],
    [1.5, 2.5],
];

#[test]
fn networks_of_other_programs_are_shown() {
    let workplace = Workplace::new();
    workplace.run("--seeds 4 -n 0 --relax 0 -o a.tess -o a.fe -o a.stl");
    workplace.put("a.csv", "grain,x,y\n3,0,0\n3,1,0\n3,1,1\n4,0,0\n4,1,1\n4,0,1\n");
    for name in ["a.tess", "a.fe", "a.stl", "a.csv"] {
        let shown = PageDocument::grains(&[workplace.path(name)]);
        assert!(shown.is_ok(), "{name}: {}", shown.err().unwrap());
    }
}

#[test]
fn polygons_with_holes_are_grains_in_the_plane() {
    let workplace = Workplace::new();
    let file = serde_json::json!({
        "V": NESTED,
        // Holes run in any direction.
        "poly": [[1, 2, 3, 4, 1, 5, 6, 7, 8, 5, 9, 12, 11, 10, 9], [8, 7, 6, 5, 8, 9, 10, 11, 12, 9]],
        "id": [17, 5],
        "phase": [2, 1],
        "euler": [[10, 20, 30], [40, 50, 60]],
    });
    workplace.put("grains.json", file.to_string());
    let expected = || [(17, 13.0), (5, 3.0)].into_iter();
    let made = "smooth grains.json --relax 0.00001 -o made.vtp --stats made.json";
    workplace.run(made);
    are_near(&grains(&workplace, "made.json"), expected(), 1e-9);
    let statistics = workplace.json("made.json");
    assert_eq!(statistics["grains"][1]["Phase"], 1);
    let angles = statistics["grains"][1]["EulerAngles"].as_array().unwrap();
    assert!(
        angles
            .iter()
            .zip([40.0, 50.0, 60.0])
            .all(|(found, angle)| (found.as_f64().unwrap() - angle).abs() < 1e-9)
    );

    let mut table = "grain,x,y\n".to_owned();
    for (grain, corners) in
        [(17, &[0, 1, 2, 3, 0, 4, 5, 6, 7, 4, 8, 9, 10, 11][..]), (5, &[4, 5, 6, 7, 4, 8, 9, 10, 11])]
    {
        for corner in corners {
            let [x, y] = NESTED[*corner];
            table += &format!("{grain},{x},{y}\n");
        }
    }
    workplace.put("grains.csv", &table);
    workplace.run("smooth grains.csv --relax 0.00001 -o made.vtp --stats made.json");
    are_near(&grains(&workplace, "made.json"), [(5, 3.0), (17, 13.0)].into_iter(), 1e-9);

    workplace.put("grains.csv", table.replace("17,4,4\n", "17,4,x\n"));
    workplace.refuses(
        "check grains.csv",
        FAILED,
        "grains.csv: line 4: \"x\" is no coordinate; give a number",
    );
    workplace.put("grains.csv", table.replace("17,4,4\n", "17,4\n"));
    workplace.refuses("check grains.csv", FAILED, "grains.csv: line 4: 2 columns; write three: grain,x,y");
    workplace.put("grains.json", file.to_string().replace("[17,5]", "[17]"));
    let message = "grains.json: id has 1 entries for 2 polygons; give a complete polygon file";
    workplace.refuses("check grains.json", FAILED, message);
}
