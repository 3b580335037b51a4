//! Meshes, curves and Bezier patches, edited.

use std::path::Path;

use glam::DVec3;
use serde_json::{Value, json};
use subzero::BezierCurve;

use super::browser::Browser;
use super::served::{Served, Visitor};

/// Serves a file of `data/`.
fn served(name: &'static str, more: &str) -> Served {
    Served::new(&format!("edit {name} {more}"), |directory: &Path| {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
        std::fs::copy(data.join(name), directory.join(name)).unwrap();
    })
}

/// What is seen when nothing is asked for.
fn plain() -> Value {
    json!({ "scheme": "", "level": 0 })
}

fn change(visitor: &Visitor, revision: u64, command: Value) -> super::served::Said {
    visitor.ask("/edit", &json!({ "revision": revision, "command": command, "look": { "view": plain() } }))
}

/// The mesh as OBJ.
fn obj(visitor: &Visitor, view: Value) -> String {
    let said = visitor.ask("/file", &json!({ "format": "obj", "view": view, "anyway": false }));
    assert_eq!(said.status, 200);
    String::from_utf8(said.body).unwrap()
}

fn numbers<'a>(obj: &'a str, keyword: &'a str) -> impl Iterator<Item = Vec<f64>> + 'a {
    let lines = obj.lines().filter_map(move |line| line.strip_prefix(keyword)?.strip_prefix(' '));
    lines.map(|line| line.split(' ').map(|number| number.parse().unwrap()).collect())
}

/// The file as the page saves it, from within the page.
fn obj_of_page(browser: &mut Browser) -> String {
    let text = "import('/server.js').then((server) => server.askBytes('/file', { format: 'obj', view: null, anyway: false }))
        .then((bytes) => new TextDecoder().decode(bytes))";
    browser.value(text).as_str().unwrap().to_owned()
}

/// Where the middle of some points is on the screen.
fn on_screen(browser: &mut Browser, points: &[u32]) -> [f64; 2] {
    let found = browser.value(&format!(
        "{{ const page = window.page, middle = new THREE.Vector3();
        for (const point of {points:?}) middle.add(new THREE.Vector3(...page.shape.place(point)));
        page.stage.camera.updateMatrixWorld();
        middle.divideScalar({}).project(page.stage.camera);
        const box = page.stage.renderer.domElement.getBoundingClientRect();
        [box.left + (0.5 + 0.5 * middle.x) * box.width, box.top + (0.5 - 0.5 * middle.y) * box.height]; }}",
        points.len()
    ));
    [0, 1].map(|axis| found[axis].as_f64().unwrap())
}

const DATASET: &str = "document.getElementById('view').dataset";

#[test]
fn a_click_flips_an_edge_and_undoing_gives_the_same_bytes() {
    let Some(mut browser) = Browser::new("editing in the browser") else { return };
    let served = served("cube_triangles.obj", "");
    browser.open(&served.link);
    let status = browser.value("document.getElementById('status').textContent");
    assert_eq!(status, json!("8 points, 18 edges"));
    let before = obj_of_page(&mut browser);
    // Triangles 4 and 5, of the face that is seen at y = 0: their edge is between points 0 and 5, counted from 0.
    let edge: [u32; 2] = diagonal(&before);
    browser.set("act", "flip");
    let at = on_screen(&mut browser, &edge);
    browser.click(at);
    browser.wait(&format!("{DATASET}.undo === '1'"));
    browser.leave_screenshot("flipped.png");
    let after = obj_of_page(&mut browser);
    let faces = |text: &str| numbers(text, "f").collect::<Vec<_>>();
    let changed: Vec<usize> =
        (0..12).filter(|&face| sorted(&faces(&before)[face]) != sorted(&faces(&after)[face])).collect();
    assert_eq!(changed.len(), 2, "{before}{after}");
    // The two triangles have the same four corners, and share the other diagonal.
    let corners = |text: &str| {
        let mut all: Vec<_> = changed.iter().flat_map(|face| sorted(&faces(text)[*face])).collect();
        all.sort_unstable();
        all
    };
    let (mut of_before, mut of_after) = (corners(&before), corners(&after));
    of_before.dedup();
    of_after.dedup();
    assert_eq!(of_before, of_after);
    assert_ne!(corners(&before), corners(&after));
    assert_eq!(before.lines().filter(|line| line.starts_with('v')).count(), 8);
    browser.press("undo");
    browser.wait(&format!("{DATASET}.undo === '0'"));
    assert_eq!(obj_of_page(&mut browser), before);
    browser.press("redo");
    browser.wait(&format!("{DATASET}.undo === '1'"));
    assert_eq!(obj_of_page(&mut browser), after);
    browser.assert_quiet();
}

/// The edge that two triangles of the face y = 0 share.
fn diagonal(obj: &str) -> [u32; 2] {
    let points: Vec<Vec<f64>> = numbers(obj, "v").collect();
    let faces: Vec<Vec<u32>> = numbers(obj, "f").map(|face| sorted(&face)).collect();
    let of_face: Vec<&Vec<u32>> = faces
        .iter()
        .filter(|face| face.iter().all(|corner| points[*corner as usize - 1][1] == 0.0))
        .collect();
    let shared: Vec<u32> =
        of_face[0].iter().filter(|corner| of_face[1].contains(corner)).map(|corner| corner - 1).collect();
    shared.try_into().unwrap()
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "numbers of points")]
fn sorted(face: &[f64]) -> Vec<u32> {
    let mut corners: Vec<u32> = face.iter().map(|corner| *corner as u32).collect();
    corners.sort_unstable();
    corners
}

#[test]
fn a_drag_moves_a_point_and_what_cannot_be_done_says_why() {
    let Some(mut browser) = Browser::new("dragging in the browser") else { return };
    let served = served("open_grid.obj", "");
    browser.open(&served.link);
    browser.press("triangulate");
    browser.wait(&format!("{DATASET}.undo === '1'"));
    let before = obj_of_page(&mut browser);
    browser.set("scheme", "loop");
    browser.set("level", "2");
    browser.wait(&format!("Number({DATASET}.triangles) === 512"));
    let peak = on_screen(&mut browser, &[12]);
    browser.hover(peak);
    browser.wait(&format!("{DATASET}.hovered === '{{\"point\":12}}'"));
    browser.drag(peak, [peak[0], peak[1] - 60.0]);
    browser.wait(&format!("{DATASET}.undo === '2'"));
    browser.leave_screenshot("dragged.png");
    let after = obj_of_page(&mut browser);
    let points = |text: &str| numbers(text, "v").collect::<Vec<_>>();
    for (point, (before, after)) in points(&before).iter().zip(points(&after)).enumerate() {
        assert_eq!(*before == after, point != 12, "{point}");
    }
    // Up on the screen is up.
    assert!(points(&after)[12][2] > points(&before)[12][2] + 0.2, "{after}");
    assert_known_is_true(&mut browser);
    browser.set("level", "0");
    browser.wait(&format!("Number({DATASET}.triangles) === 32"));
    browser.set("act", "flip");
    let rim = on_screen(&mut browser, &[1, 2]);
    browser.click(rim);
    browser.wait("document.querySelector('.bubble.shown') !== null");
    let why = browser.value("document.querySelector('.bubble').textContent");
    assert_eq!(why, json!("edge 1-2 cannot be flipped: it lies on the boundary"));
    browser.leave_screenshot("refused.png");
    assert_eq!(browser.value(&format!("{DATASET}.undo")), json!("2"));
    // The browser notes each answer that refuses.
    assert!(browser.console.iter().all(|said| said.to_string().contains("422")), "{:?}", browser.console);
}

/// Checks that what the page has after all changes is what it would be told anew.
fn assert_known_is_true(browser: &mut Browser) {
    let difference = browser.value(
        "Promise.all([import('/server.js'), import('/packed.js')]).then(async ([server, packed]) => {
           const known = page.unpacked;
           const { arrays } = packed.unpack(await server.askBytes('/draw', { view: page.view }));
           page.redraw();
           if (Object.keys(arrays).join() !== Object.keys(known.arrays).join()) return Infinity;
           let most = 0;
           for (const [name, array] of Object.entries(arrays)) {
             if (array.length !== known.arrays[name].length) return Infinity;
             array.forEach((number, place) => { most = Math.max(most, Math.abs(number - known.arrays[name][place])); });
           }
           return most;
         })",
    );
    // Points that followed another are written by other sums.
    assert!(difference.as_f64().is_some_and(|difference| difference < 1e-6), "{difference}");
}

/// Only what has changed is sent, and it adds up; the triangles of levels are found by the page as they are in files.
#[test]
fn pages_hear_of_changes_alone() {
    let Some(mut browser) = Browser::new("changes in the browser") else { return };
    let served = served("torus.obj", "");
    browser.open(&served.link);
    browser.press("triangulate");
    browser.wait(&format!("{DATASET}.undo === '1'"));
    let edge = browser.value("[...page.shape.arrays.triangles.subarray(0, 2)]");
    let mut change = |command: Value, undo: u32| {
        browser.value(&format!("page.change({command})"));
        assert_eq!(browser.value("page.head.undo"), json!(undo));
        assert_known_is_true(&mut browser);
    };
    change(json!({ "flip": { "edge": edge } }), 2);
    change(json!({ "move": { "point": 3, "to": [0.1, 0.2, 0.3] } }), 3);
    browser.value(
        "page.update('/edit', () => ({ revision: page.revision, command: 'undo', look: page.asked() }))",
    );
    let changed = browser.value("page.unpacked.changes");
    assert_eq!(changed["triangles"], json!([]), "a point was moved back");
    assert_eq!(changed["points"], json!([[9, 3]]));
    browser.value("page.change('undo')");
    let changed = browser.value("page.unpacked.changes.triangles.reduce((sum, run) => sum + run[1], 0)");
    assert!(changed.as_u64().unwrap() <= 12, "two triangles were turned back: {changed}");
    browser.set("scheme", "loop");
    browser.set("level", "2");
    browser.wait("page.head.steps === 2");
    let before = browser.value("page.shape.index.version");
    browser.value("page.change({ move: { point: 3, to: [0.1, 0.2, 0.3] } })");
    assert_eq!(browser.value("page.shape.index.version"), before, "connectivity stays");
    let runs = browser.value("page.unpacked.changes.surface_points.reduce((sum, run) => sum + run[1], 0)");
    let all = browser.value("page.shape.arrays.surface_points.length");
    assert!(runs.as_f64().unwrap() < 0.4 * all.as_f64().unwrap(), "{runs} of {all}");
    assert_known_is_true(&mut browser);
    browser.set("scheme", "butterfly");
    browser.wait(&format!("JSON.parse({DATASET}.shown).scheme === 'butterfly'"));
    assert_known_is_true(&mut browser);
    for scheme in ["loop", "butterfly"] {
        let fine = browser.value(&format!(
            "import('/server.js').then((server) => server.askBytes('/file', {{ format: 'obj', view: {{ ...page.view, scheme: '{scheme}' }}, anyway: false }}))
             .then((bytes) => new TextDecoder().decode(bytes))"
        ));
        let faces: Vec<f64> =
            numbers(fine.as_str().unwrap(), "f").flatten().map(|corner| corner - 1.0).collect();
        let found = browser.value("[...page.shape.index.array]");
        let found: Vec<f64> =
            found.as_array().unwrap().iter().map(|corner| corner.as_f64().unwrap()).collect();
        assert!(found == faces, "{scheme}");
    }
    browser.assert_quiet();
}

#[test]
fn a_cube_split_beforehand_becomes_symmetric() {
    let served = served("cube_triangles.obj", "");
    let visitor = served.visitor();
    let said = change(&visitor, 0, json!({ "split-many": "flat" }));
    assert_eq!(said.status, 200);
    assert_eq!(said.packed_head()["said"], json!("6 edges"));
    let fine = obj(&visitor, json!({ "scheme": "loop", "level": 3 }));
    let points: Vec<DVec3> =
        numbers(&fine, "v").map(|point| DVec3::from_slice(&point) - DVec3::splat(0.5)).collect();
    assert_eq!(numbers(&fine, "f").count(), 24 * 64);
    let symmetries: [fn(DVec3) -> DVec3; 3] = [
        |point| DVec3::new(-point.x, point.y, point.z),
        |point| DVec3::new(point.y, point.x, point.z),
        |point| DVec3::new(point.y, point.z, point.x),
    ];
    for symmetry in symmetries {
        for point in &points {
            let image = symmetry(*point);
            let nearest = points.iter().map(|other| other.distance(image)).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-12, "{point} {nearest}");
        }
    }
}

#[test]
fn a_control_point_is_dragged_and_de_casteljau_follows() {
    let Some(mut browser) = Browser::new("Bezier curves in the browser") else { return };
    let served = served("curve.txt", "--as bezier");
    browser.open(&served.link);
    browser.set("t", "0.4");
    let at = on_screen(&mut browser, &[1]);
    browser.hover(at);
    browser.wait(&format!("{DATASET}.hovered === '{{\"point\":1}}'"));
    browser.drag(at, [at[0] + 40.0, at[1] - 30.0]);
    browser.wait(&format!("{DATASET}.undo === '1'"));
    browser.leave_screenshot("bezier.png");
    let place = |browser: &mut Browser, what: &str| -> DVec3 {
        let found = browser.value(&format!("Array.from({what})"));
        DVec3::from_array([0, 1, 2].map(|axis| found[axis].as_f64().unwrap()))
    };
    let control: Vec<DVec3> =
        (0..4).map(|point| place(&mut browser, &format!("window.page.shape.place({point})"))).collect();
    let last = place(&mut browser, "window.page.shape.arrays.line_points.slice(-3)");
    let exact = BezierCurve::new(control).unwrap().point(0.4);
    assert!(last.distance(exact) < 1e-6, "{last} {exact}");
    // Of a cubic curve, three levels below its control points, and itself.
    assert_eq!(
        browser.value("window.page.head.lines.map(([count, level]) => [count, level]).slice(1)"),
        json!([[3, 1], [2, 2], [1, 3]])
    );
    browser.assert_quiet();
}

#[test]
fn curves_and_the_teapot_are_shown() {
    let Some(mut browser) = Browser::new("curves and the teapot in the browser") else { return };
    let outline = served("outline.obj", "");
    browser.open(&outline.link);
    browser.set("level", "3");
    browser.wait("window.page.head.lines.length === 2 && window.page.head.lines[0][0] === 57");
    browser.leave_screenshot("curves.png");
    browser.assert_quiet();
    let teapot = Served::new("edit --teapot", |_| ());
    browser.open(&teapot.link);
    browser.set("shading", "smooth");
    browser.set("patch", "8");
    browser.wait(&format!("JSON.parse({DATASET}.shown ?? '{{}}').patch === 8"));
    browser.leave_screenshot("teapot.png");
    browser.assert_quiet();
}

#[test]
fn two_pages_lose_no_edits() {
    let served = served("cube_triangles.obj", "");
    let visitor = served.visitor();
    let before = obj(&visitor, Value::Null);
    let edge = diagonal(&before);
    assert_eq!(change(&visitor, 0, json!({ "split": { "edge": edge } })).status, 200);
    let late = change(&visitor, 0, json!("reverse"));
    assert_eq!(
        (late.status, &late.why()[..]),
        (409, "another page changed this in the meantime: look, and do it again")
    );
    assert_eq!(numbers(&obj(&visitor, Value::Null), "f").count(), 14);
    // The other page hears of it.
    assert_eq!(visitor.ask("/news", &json!(0)).body, b"1");
    assert_eq!(change(&visitor, 1, json!("undo")).status, 200);
    assert_eq!(obj(&visitor, Value::Null), before);
    let nothing = change(&visitor, 2, json!("undo"));
    assert_eq!((nothing.status, &nothing.why()[..]), (422, "there is nothing to undo"));
}

#[test]
fn commands_that_make_no_sense_change_nothing() {
    let served = served("cube_triangles.obj", "");
    let visitor = served.visitor();
    let before = obj(&visitor, Value::Null);
    for (command, status) in [
        (json!({ "flip": { "edge": [0, 99] } }), 422),
        (json!({ "move": { "point": 8, "to": [0, 0, 0] } }), 422),
        (json!({ "move": { "point": 0, "to": [1e300, 0, 0] } }), 422),
        (json!({ "crease": { "edge": [0, 99], "sharpness": "infinite" } }), 422),
        (json!({ "corner": { "point": 0, "sharpness": -1 } }), 422),
        (json!({ "flip": { "edge": [0] } }), 422),
        (json!("nothing"), 422),
    ] {
        assert_eq!(change(&visitor, 0, command.clone()).status, status, "{command}");
    }
    let lines = visitor.lines("/edit");
    let nan = br#"{"revision": 0, "command": {"move": {"point": 0, "to": [NaN, 0, 0]}}, "look": {}}"#;
    assert_eq!(served.said(&lines, nan).status, 400);
    let deep = visitor.ask("/draw", &json!({ "view": { "scheme": "loop", "level": 40 } }));
    assert_eq!(deep.status, 422);
    assert!(deep.why().contains("levels would"), "{}", deep.why());
    assert_eq!(obj(&visitor, Value::Null), before);
}

#[test]
fn a_long_log_is_undone() {
    let served = served("torus.obj", "");
    let visitor = served.visitor();
    let mut states = vec![obj(&visitor, Value::Null)];
    let commands = [
        json!("triangulate"),
        json!({ "corner": { "point": 3, "sharpness": 2.5 } }),
        json!({ "split": { "edge": [0, 1] } }),
        json!({ "split-many": "longest" }),
        json!({ "move": { "point": 5, "to": [0.1, 0.2, 0.3] } }),
        json!("reverse"),
    ];
    for command in &commands {
        let said = change(&visitor, states.len() as u64 - 1, command.clone());
        assert_eq!(said.status, 200, "{command}: {}", String::from_utf8_lossy(&said.body));
        states.push(obj(&visitor, Value::Null));
    }
    let mut revision = commands.len() as u64;
    for state in states[..commands.len()].iter().rev() {
        assert_eq!(change(&visitor, revision, json!("undo")).status, 200);
        revision += 1;
        assert!(obj(&visitor, Value::Null) == *state, "{revision}");
    }
    for state in &states[1..] {
        assert_eq!(change(&visitor, revision, json!("redo")).status, 200);
        revision += 1;
        assert!(obj(&visitor, Value::Null) == *state, "{revision}");
    }
}

#[test]
fn saving_overwrites_the_file_unless_another_did() {
    let served = served("cube_triangles.obj", "");
    let visitor = served.visitor();
    assert_eq!(change(&visitor, 0, json!({ "split-many": "flat" })).status, 200);
    let save = |revision: u64, anyway: bool| {
        visitor.ask("/save", &json!({ "format": "", "view": null, "anyway": anyway, "revision": revision }))
    };
    assert_eq!(save(0, false).status, 409);
    assert_eq!(save(1, false).status, 200);
    let file = served.path("cube_triangles.obj");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), obj(&visitor, Value::Null));
    let later = std::time::SystemTime::now() + std::time::Duration::from_secs(5);
    std::fs::write(&file, "v 0 0 0\n").unwrap();
    std::fs::File::options().append(true).open(&file).unwrap().set_modified(later).unwrap();
    assert_eq!(save(1, false).status, 412);
    assert_eq!(save(1, true).status, 200);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), obj(&visitor, Value::Null));
}
