//! Bad meshes and mistakes: one line that names the place, and nothing written.

use crate::shapes::CUBE_OBJ;
use crate::workplace::{FAILED, USAGE, Workplace};

#[test]
fn bad_meshes_are_refused_by_name() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ);
    let fin = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n";
    workplace.put("fin.obj", fin);
    for (name, content) in [
        ("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
        ("range.json", r#"{"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 3]]}"#),
        ("range.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
        ("degenerate.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 1\n"),
        ("twice.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 3 2 1\n"),
        ("nan.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n"),
        ("inf.off", "OFF\n3 1 0\n0 0 0\ninf 0 0\n0 1 0\n3 0 1 2\n"),
        ("nan.json", r#"{"vertices": [[0, 0, NaN]], "faces": []}"#),
        ("winding.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n"),
        ("bowtie.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 2 1\nv 3 3 3\nf 1 2 3\nf 1 4 5\n"),
        ("two.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"),
        ("two.json", r#"{"vertices": [[0, 0, 0], [1, 0, 0]], "faces": [[0, 1]]}"#),
        ("star.off", "OFF\n5 1 0\n0 3 0\n2 -3 0\n-3 1 0\n3 1 0\n-2 -3 0\n5 0 1 2 3 4\n"),
        ("line.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 0\n4 0 1 2 3\n"),
        (
            "moebius.off",
            "OFF\n5 5 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n3 0 1 2\n3 1 2 3\n3 2 3 4\n3 3 4 0\n3 4 0 1\n",
        ),
        ("open.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
        ("empty.obj", ""),
        ("huge.obj", "v 0 0 0\nv 1e155 0 0\nv 0 1e155 0\nf 1 2 3\n"),
        ("tiny.obj", "v 0 0 0\nv 1e-155 0 0\nv 0 1e-155 0\nf 1 2 3\n"),
        ("huge.txt", "0 0 0\n1 -1e200 0\n2 0 0\n"),
        ("nothing.ply", ""),
        ("valence.off", "OFF\n5 2 0\n0 0 0\n1 1 0\n2 0 0\n1 2 0\n1 -2 0\n4 0 1 2 3\n4 2 1 0 4\n"),
    ] {
        workplace.put(name, content);
    }
    for (command, message) in [
        ("loop range.obj", "range.obj: line 4: a face refers to vertex 4, but the file has 3 vertices"),
        (
            "loop range.json",
            "range.json: face 0 refers to vertex 3, but there are only 3 vertices, counted from 0",
        ),
        ("loop range.off", "range.off: line 6: face 0 refers to vertex 3, but the file has 3 vertices"),
        (
            "loop degenerate.obj",
            "degenerate.obj: triangle 0 is degenerate: it uses vertex 0 twice; remove it",
        ),
        (
            "catmull-clark degenerate.obj",
            "degenerate.obj: face 0 is degenerate: it uses vertex 0 twice; remove it",
        ),
        ("butterfly twice.obj", "twice.obj: faces 0 and 1 have the same vertices; remove one"),
        ("doo-sabin twice.obj", "twice.obj: faces 0 and 1 have the same vertices; remove one"),
        ("loop nan.obj", "nan.obj: line 2: NaN is a z coordinate that is not finite"),
        ("loop inf.off", "inf.off: line 4: inf is an x coordinate that is not finite"),
        ("loop nan.json", "nan.json: line 1: expected value at line 1 column 22"),
        (
            "midpoint winding.obj",
            "winding.obj: faces 0 and 1 both run along edge 0-1 in the same direction: make their winding agree, or \
             crease the edge infinitely; `grainsmooth mesh orient` makes it agree",
        ),
        (
            "orient moebius.off",
            "moebius.off: the winding cannot agree: the surface has only one side, as can be seen at edge 3-4 of faces 3 and 2; cut it open there",
        ),
        (
            "triangulate star.off",
            "star.off: face 0 crosses or touches itself, as seen along its normal: divide it there",
        ),
        ("triangulate line.off", "line.off: face 0 has no area: remove it, or move a corner off the line"),
        (
            "loop --closed open.off",
            "open.off: the surface is open: edge 0-1 has one face only; close the hole",
        ),
        (
            "doo-sabin --closed open.off",
            "open.off: the surface is open: edge 0-1 has one face only; close the hole",
        ),
        (
            "normals fin.obj",
            "fin.obj: 3 faces share edge 0-1: a manifold mesh has at most two; split it there into several",
        ),
        (
            "flip --edge 0-1 fin.obj",
            "fin.obj: 3 faces share edge 0-1: a manifold mesh has at most two; split it there into several",
        ),
        (
            "catmull-clark fin.obj",
            "fin.obj: 3 faces share edge 0-1: a manifold mesh has at most two; split it there into several",
        ),
        (
            "normals bowtie.obj",
            "bowtie.obj: the faces around vertex 0 touch only in this point: a manifold mesh has one fan around it; give each fan a vertex of its own",
        ),
        ("loop two.obj", "two.obj: line 3: a face with 2 corners; it needs at least three"),
        ("loop two.json", "two.json: face 0 has 2 corners: it needs at least three"),
        ("loop empty.obj", "empty.obj: holds no faces; give a surface mesh"),
        ("loop nothing.ply", "nothing.ply: ... give a complete PLY file"),
        (
            "loop cube.obj",
            "cube.obj: face 0 has 4 corners where triangles are needed; cut it with `grainsmooth mesh triangulate`, or use catmull-clark or doo-sabin",
        ),
        (
            "doo-sabin valence.off",
            "valence.off: vertex 1 has only two edges: Doo-Sabin subdivision would give it a face with two corners; merge the faces beside it",
        ),
        (
            "catmull-clark cube.obj --crease 0-6",
            "cube.obj: crease 0 joins vertices 0 and 6, but the mesh has no such edge; name the two ends of an edge",
        ),
        (
            "catmull-clark cube.obj --corners 8",
            "cube.obj: corner 0 refers to vertex 8, but there are only 8 vertices, counted from 0",
        ),
        (
            "limit --scheme catmull-clark cube.obj --crease 0-1:1.5",
            "cube.obj: vertex 0 is semi-sharp: refine until its sharpness has run out",
        ),
        ("loop missing.obj", "missing.obj: cannot be read: ... give the path of a readable mesh file"),
        ("loop cube.blend", "cube.blend: unknown extension; give a file *.obj, ... or polylines as *.txt"),
        ("catmull-clark cube.obj -n 60", "60 levels would take ... would fit"),
        // Their normals were none, and nothing said so.
        (
            "normals huge.obj",
            "huge.obj: point 1 has the coordinate 1e155; scale the mesh so that none exceeds 1e30",
        ),
        ("loop tiny.obj", "tiny.obj: the mesh is 1e-155 wide; scale it to 1e-30 or more"),
        (
            "bezier huge.txt",
            "huge.txt: point 1 has the coordinate -1e200; scale the mesh so that none exceeds 1e30",
        ),
    ] {
        workplace.refuses(&format!("mesh {command} -o out.obj"), FAILED, message);
    }
}

#[test]
fn mistakes_of_usage() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ);
    for (command, message) in [
        (
            "catmull-clark cube.obj -o out.blend",
            "out.blend: unknown extension; name the file *.vtp, *.vtu, *.vtk, *.obj, *.ply, *.stl or *.json",
        ),
        (
            "catmull-clark cube.obj --each-level -o out.json",
            "--each-level writes one file per level, but JSON holds all levels in one; leave it out",
        ),
        ("catmull-clark cube.obj", "the following required arguments were not provided:"),
        ("flip cube.obj -o out.obj", "the following required arguments were not provided:"),
        ("smooth cube.obj -o out.obj", "unrecognized subcommand 'smooth'"),
        (
            "flip cube.obj -o out.obj --edge 4",
            "invalid value '4' for ... edges are two points each, such as 4-9, or all, longest or flat",
        ),
        ("collapse cube.obj -o out.obj --edge all", "invalid value 'all' for ... such as 4-9"),
        ("edit cube.obj -o out.obj", "the following required arguments were not provided:"),
        (
            "edit cube.obj turn -o out.obj",
            "invalid value 'turn' for ... an edit is flip=EDGES, split=EDGES, collapse=A-B,..., orient, outward, reverse or triangulate",
        ),
        ("edit cube.obj flip=4 -o out.obj", "invalid value 'flip=4' for ... or all, longest or flat"),
        ("loop cube.obj -o out.obj --corners 3:x", "invalid value '3:x' for ... or 3:1.5"),
        ("loop cube.obj -o out.obj --crease 1-2:-3", "invalid value '1-2:-3' for ... or 4-9:2.5"),
        (
            "loop cube.obj -o out.obj -n 100",
            "invalid value '100' for '--levels <LEVELS>': 100 is not in 0..=99",
        ),
        ("loop cube.obj -o out.obj --weights zorin", "invalid value 'zorin' for ... <WEIGHTS>'"),
        (
            "bezier cube.obj -o out.obj --samples 1",
            "invalid value '1' for '--samples <N>': 1 is not in 2..=10000",
        ),
    ] {
        workplace.refuses(&format!("mesh {command}"), USAGE, message);
    }
}
