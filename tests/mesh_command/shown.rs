//! Pictures, animations, pages and collections of levels.

use std::fs::File;
use std::io::BufReader;
use std::process::Command;

use crate::programs::run;
use crate::shapes::CUBE_OBJ;
use crate::workplace::{USAGE, Workplace};

/// All frames of a PNG file, each as red, green, blue and opacity of its pixels, and its size.
fn frames(workplace: &Workplace, name: &str) -> (Vec<Vec<u8>>, [u32; 2]) {
    let decoder = png::Decoder::new(BufReader::new(File::open(workplace.path(name)).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let (width, height) = reader.info().size();
    let count = reader.info().animation_control().map_or(1, |control| control.num_frames);
    let mut all = Vec::new();
    for _ in 0..count {
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        all.push(pixels);
    }
    (all, [width, height])
}

fn pixel(frame: &[u8], width: u32, [x, y]: [u32; 2]) -> [u8; 3] {
    let at = 4 * (y * width + x) as usize;
    [frame[at], frame[at + 1], frame[at + 2]]
}

fn white_share(frame: &[u8]) -> f64 {
    let pixels = frame.as_chunks::<4>().0;
    pixels.iter().filter(|pixel| pixel[..3] == [255; 3]).count() as f64 / pixels.len() as f64
}

#[test]
fn a_square_seen_from_above() {
    let workplace = Workplace::new();
    // Two triangles of which the second winds the wrong way: its back is blue.
    workplace.put("in.obj", "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3\n");
    workplace.put("back.obj", "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 3 2 1\n");
    for (name, is_front) in [("in", true), ("back", false)] {
        workplace
            .run(&format!("mesh normals {name}.obj -o out.obj --picture {name}.png --picture-size 200 200"));
        let (frames, [width, height]) = frames(&workplace, &format!("{name}.png"));
        assert_eq!((frames.len(), width, height), (1, 200, 200));
        // The lower right half, with a margin around.
        let [red, _, blue] = pixel(&frames[0], width, [140, 160]);
        assert_eq!(red > blue, is_front, "{name}");
        assert_eq!(pixel(&frames[0], width, [60, 40]), [255; 3]);
        assert_eq!(pixel(&frames[0], width, [4, 196]), [255; 3]);
        let share = white_share(&frames[0]);
        assert!((share - (1.0 - 0.5 * 0.92 * 0.92)).abs() < 0.02, "{share}");
        // An edge is dark.
        let darkest = (100..140).map(|y| u32::from(pixel(&frames[0], width, [192, y])[0])).min();
        let row = (185..199).map(|x| u32::from(pixel(&frames[0], width, [x, 120])[0])).min();
        assert!(row.min(darkest) < Some(170), "{row:?} {darkest:?}");
    }
}

/// Flat and smooth shading of one sphere: the smooth one has no edges, and more shades.
#[test]
fn shading_is_flat_or_smooth() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ);
    workplace.run("mesh edit cube.obj triangulate split=flat -o in.obj");
    let mut darkest = Vec::new();
    for shading in ["flat", "smooth"] {
        workplace.run(&format!(
            "mesh loop in.obj -n 2 -o out.vtp --picture {shading}.png --picture-size 240 180 --shading {shading}"
        ));
        let (frames, _) = frames(&workplace, &format!("{shading}.png"));
        darkest.push(frames[0].as_chunks::<4>().0.iter().map(|pixel| pixel[0]).min().unwrap());
    }
    assert!(darkest[0] < 80 && darkest[1] > 90, "{darkest:?}");
}

#[test]
fn levels_move_and_are_collected() {
    let workplace = Workplace::new();
    workplace.put("in.txt", "0 0\n4 0\n5 3\n1 5\n0 0\n");
    let said = workplace.run(
        "mesh four-point in.txt -n 3 --each-level -o out.pvd --picture out.png --picture-size 160 120 --report out.html",
    );
    for name in ["out_0.vtp", "out_3.vtp", "out.pvd", "out.png", "out.html"] {
        assert!(said.contains(&format!("written     {name}")), "{said}");
        assert!(workplace.path(name).exists());
    }
    let (levels, size) = frames(&workplace, "out.png");
    assert_eq!((levels.len(), size), (4, [160, 120]));
    assert!(levels.windows(2).all(|pair| pair[0] != pair[1]));
    let pvd = String::from_utf8(workplace.bytes("out.pvd")).unwrap();
    assert!(pvd.contains("<DataSet timestep=\"2.0\" part=\"0\" file=\"out_2.vtp\"/>"), "{pvd}");
    // The same beside .vtu, and none beside others.
    workplace.run("mesh four-point in.txt -n 1 --each-level -o b.vtu");
    assert!(workplace.path("b.pvd").exists());
    workplace.run("mesh four-point in.txt -n 1 --each-level -o c.obj");
    assert!(!workplace.path("c.pvd").exists());
    let script = "
import pyvista
reader = pyvista.get_reader('out.pvd')
assert reader.time_values == [0.0, 1.0, 2.0, 3.0], reader.time_values
reader.set_active_time_value(3.0)
assert reader.read()[0].n_points == 32
";
    let mut python = Command::new("python3");
    python.args(["-c", script]).current_dir(workplace.path("."));
    let Some(python) = run("levels_move_and_are_collected", &mut python) else { return };
    assert!(python.status.success(), "{}: {}", python.status, String::from_utf8_lossy(&python.stderr));
}

/// Every subcommand draws and reports.
#[test]
fn every_command_shows_its_result() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ);
    workplace.put("line.txt", "0 0 0\n1 2 0\n3 2 1\n4 0 1\n");
    workplace.put("patch.bpt", "1\n1 1\n0 0 0\n0 1 0\n1 0 0\n1 1 2\n");
    workplace.run("mesh triangulate cube.obj -o in.obj");
    for command in [
        "loop in.obj",
        "butterfly in.obj",
        "modified-butterfly in.obj",
        "midpoint in.obj",
        "doo-sabin cube.obj",
        "catmull-clark cube.obj",
        "b-spline line.txt",
        "four-point line.txt",
        "limit in.obj",
        "normals cube.obj",
        "orient cube.obj",
        "triangulate cube.obj",
        "flip in.obj --edge flat",
        "split in.obj --edge longest",
        "collapse in.obj --edge 0-1",
        "edit cube.obj reverse",
        "bezier line.txt",
        "bezier line.txt --construction --t 0.4",
        "bezier patch.bpt",
        "bezier patch.bpt --merge=open",
    ] {
        let said = workplace.run(&format!(
            "mesh {command} -o out.json --picture out.png --picture-size 64 48 --report out.html"
        ));
        assert!(said.ends_with("written     out.png\nwritten     out.html\n"), "{command}: {said}");
        let (frames, _) = frames(&workplace, "out.png");
        assert!(white_share(&frames[0]) < 0.999, "{command} draws nothing");
        let page = String::from_utf8(workplace.bytes("out.html")).unwrap();
        assert!(page.contains(&format!("grainsmooth mesh {command}")), "{command}");
        assert!(!page.contains("{{"), "{command} leaves a gap in the page");
    }
}

/// The colours of the key stand in the picture as they are; those of the surface are shaded.
#[test]
fn arrays_colour_pictures_and_have_a_key() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ);
    workplace.run("mesh triangulate cube.obj -o in.obj");
    let has = |name: &str, color: [u8; 3]| {
        let (frames, _) = frames(&workplace, name);
        frames.iter().all(|frame| frame.as_chunks::<4>().0.iter().any(|pixel| pixel[..3] == color))
    };
    let kinds = [[230, 159, 0], [86, 180, 233], [0, 158, 115]];
    let run = "mesh loop in.obj -n 2 --each-level -o out.vtp --picture-size 240 180 --picture";
    workplace.run(&format!("{run} plain.png"));
    workplace.run(&format!("{run} born.png --color-by Generation"));
    for color in kinds {
        assert!(has("born.png", color) && !has("plain.png", color), "{color:?}");
    }
    // The same key, and so the same scale, beside each level.
    let (levels, [width, height]) = frames(&workplace, "born.png");
    let key = |frame: &[u8]| -> Vec<[u8; 3]> {
        let right = (0..height).flat_map(|y| (width - 60..width).map(move |x| [x, y]));
        right.map(|place| pixel(frame, width, place)).collect()
    };
    assert!(levels.windows(2).all(|pair| key(&pair[0]) == key(&pair[1]) && pair[0] != pair[1]));
    // Numbers of faces, from the least, violet, to the greatest, yellow.
    let table = "CELL_DATA 6\nSCALARS Height double 1\nLOOKUP_TABLE default\n0.5 1 2 3 4 7.25\n";
    let faces = "POLYGONS 6 30\n4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
    let points = "POINTS 8 double\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n";
    let head = "# vtk DataFile Version 3.0\ncube\nASCII\nDATASET POLYDATA\n";
    workplace.put("high.vtk", format!("{head}{points}{faces}{table}"));
    workplace.run("mesh catmull-clark high.vtk -n 1 -o out.vtp --picture high.png --picture-size 240 180 --color-by Height");
    let (high, _) = frames(&workplace, "high.png");
    let ends = [[68, 2, 86], [249, 230, 34]];
    let is_near =
        |pixel: &[u8; 4], end: [u8; 3]| (0..3).all(|channel| pixel[channel].abs_diff(end[channel]) < 5);
    for end in ends {
        assert!(high[0].as_chunks::<4>().0.iter().any(|pixel| is_near(pixel, end)), "{end:?}");
    }
    for (command, message) in [
        (
            "mesh catmull-clark high.vtk -n 1 -o no.vtp --picture no.png --color-by Hight",
            "high.vtk: --color-by Hight: the result has no array of this name with one number each; give Generation or Height, or leave it out",
        ),
        (
            "mesh triangulate cube.obj -o no.vtp --picture no.png --color-by Height",
            "cube.obj: --color-by Height: the result has no array of this name with one number each; leave it out",
        ),
    ] {
        workplace.refuses(command, 1, message);
        assert!(!workplace.path("no.png").exists() && !workplace.path("no.vtp").exists());
    }
}

#[test]
fn mistakes_about_what_is_shown() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ);
    for (arguments, message) in [
        (
            "-o out.vtp --picture a.gif",
            "invalid value 'a.gif' for '--picture <PATH.png>': unknown extension; name the file *.png",
        ),
        (
            "-o out.vtp --report a.txt",
            "invalid value 'a.txt' for '--report <PATH.html>': unknown extension; name the file *.html",
        ),
        ("-o out.vtp --shading smooth", "the following required arguments were not provided:"),
        (
            "-o out.pvd",
            "out.pvd: unknown extension; name the file *.vtp, *.vtu, *.vtk, *.obj, *.ply, *.stl or *.json",
        ),
    ] {
        workplace.refuses(&format!("mesh doo-sabin cube.obj {arguments}"), USAGE, message);
    }
    workplace.refuses(
        "mesh doo-sabin cube.obj -o out.vtp --picture nowhere/a.png",
        1,
        "nowhere/a.png: no directory nowhere; create it or choose another path",
    );
}
