//! How long the page of `view` and `edit` takes, in headless Chromium without a graphics card: what is demanded beside what is measured.
//!
//! Times are by the page's own clock, from a command to its buffers; drawing, which a graphics card would do, counts only where frames are named.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    missing_docs,
    reason = "a benchmark may panic, prints, and has no users"
)]

#[allow(dead_code, reason = "tests use the rest")]
#[path = "../tests/page/browser.rs"]
mod browser;
#[path = "../tests/common/programs.rs"]
mod programs;
#[allow(dead_code, reason = "tests use the rest")]
#[path = "../tests/page/served.rs"]
mod served;

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use serde_json::{Value, json};

use browser::Browser;
use served::Served;

/// Cells of the torus along each of its circles: 100 352 triangles.
const CELLS: u32 = 224;

/// How many edits are undone from.
const EDITS: u32 = 10_000;

/// Draws a frame, and waits until it is there.
const DRAWN: &str = "{ const { stage } = page, gl = stage.renderer.getContext();
    stage.render(); gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); 0 }";

fn main() {
    let chosen = std::env::args().skip(1).find(|argument| !argument.starts_with("--"));
    let mut browser = Browser::new("the page's bench").expect("needs chromium");
    println!("{:52} {:>12} {:>10}", "", "measured", "demanded");
    for (name, group) in
        [("edit", edit as fn(&mut Browser)), ("levels", levels), ("undo", undo), ("grains", grains)]
    {
        if chosen.as_deref().is_none_or(|chosen| chosen == name) {
            group(&mut browser);
        }
    }
    browser.assert_quiet();
}

/// Prints a row; what is more than demanded FAILS.
fn row(what: &str, unit: &str, measured: f64, demanded: Option<f64>) {
    let verdict = if demanded.is_some_and(|most| measured > most) { "FAILS" } else { "" };
    let demanded = demanded.map_or(String::new(), |most| format!("{most} {unit}"));
    println!("{what:52} {measured:>9.1} {unit:2} {demanded:>10} {verdict}");
}

/// Median, 95th percentile and largest of some times.
fn spread(times: &Value) -> [f64; 3] {
    let mut times: Vec<f64> = times.as_array().unwrap().iter().map(|time| time.as_f64().unwrap()).collect();
    times.sort_by(f64::total_cmp);
    let at = |share: usize| times[(times.len() - 1) * share / 100];
    [at(50), at(95), at(100)]
}

/// Serves a torus of 100 352 triangles.
fn torus() -> Served {
    Served::new("edit torus.obj", |directory: &Path| {
        let turn = |step: u32| f64::from(step % CELLS) * std::f64::consts::TAU / f64::from(CELLS);
        let mut text = String::new();
        for (i, j) in (0..CELLS * CELLS).map(|number| (number / CELLS, number % CELLS)) {
            let (u, v) = (turn(i), turn(j));
            let radius = 1.0 + 0.4 * v.cos();
            text += &format!("v {} {} {}\n", radius * u.cos(), radius * u.sin(), 0.4 * v.sin());
        }
        for (i, j) in (0..CELLS * CELLS).map(|number| (number / CELLS, number % CELLS)) {
            let id = |i: u32, j: u32| 1 + i % CELLS * CELLS + j % CELLS;
            let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
            text += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
        }
        std::fs::write(directory.join("torus.obj"), text).unwrap();
    })
}

/// Defines what measures some work so many times, one after the other.
fn define_timed(browser: &mut Browser) {
    browser.value(
        "window.timed = async (count, work) => {
           const times = [];
           for (let number = 0; number < count; number++) {
             const start = performance.now();
             await work(number);
             times.push(performance.now() - start);
           }
           return times;
         }; 0",
    );
}

/// Opens the torus without drawing it.
fn opened(browser: &mut Browser) -> Served {
    let served = torus();
    browser.open(&served.link);
    // The first frame, and then no more.
    browser.value(DRAWN);
    browser.value("page.stage.draw = () => {}; 0");
    define_timed(browser);
    // Edges and points far from each other.
    browser.value(
        "window.cell = (number) => (7919 * number) % 50176;
         window.at = (number) => ({ clientX: 300 + (97 * number) % 900, clientY: 100 + (61 * number) % 450 });
         page.what.input.value = 'edge'; 0",
    );
    served
}

fn edit(browser: &mut Browser) {
    let served = opened(browser);
    row("100 000 triangles: server's memory when opened", "MB", served.megabytes(), Some(60.0));
    let diagonal =
        "const a = cell(number), edge = [a, 224 * ((Math.floor(a / 224) + 1) % 224) + (a + 1) % 224]";
    for command in ["flip", "split", "collapse"] {
        let times = browser.value(&format!(
            "timed(50, (number) => {{ number += {}; {diagonal}; return page.change({{ {command}: {{ edge }} }}); }})",
            match command {
                "flip" => 0,
                "split" => 60,
                _ => 120,
            }
        ));
        let [median, _, most] = spread(&times);
        row(&format!("{command}: click to buffers, median"), "ms", median, None);
        row(&format!("{command}: the longest of 50"), "ms", most, Some(50.0));
    }
    assert!(browser.value("page.head.undo").as_f64().unwrap() > 140.0, "edits were refused");
    let [median, often, _] = spread(&browser.value("timed(100, (number) => page.pick(at(number)))"));
    row("hover: what is under the pointer, median", "ms", median, None);
    row("hover, 95 of 100", "ms", often, Some(20.0));
    row("server's memory then", "MB", served.megabytes(), None);
}

fn levels(browser: &mut Browser) {
    let served = opened(browser);
    browser.value(
        "timed(3, async (number) => {
           Object.assign(page.view, { scheme: 'loop', level: 0 });
           const start = performance.now();
           page.view.level = 3;
           await page.update('/draw', () => page.asked());
           (window.levels ??= []).push(performance.now() - start);
           if (number < 2) { page.view.level = 0; await page.update('/draw', () => page.asked()); }
         })",
    );
    assert_eq!(browser.value("page.head.triangle_count"), json!(64 * 2 * CELLS * CELLS));
    let [median, _, most] = spread(&browser.value("levels"));
    row("Loop's level 3 to buffers, median of 3", "ms", median, None);
    row("the longest", "ms", most, Some(1000.0));
    let bytes = browser.value("page.shape.arrays.surface_points.byteLength / 1e6").as_f64().unwrap();
    row("its points", "MB", bytes, Some(40.0));
    row("server's memory then", "MB", served.megabytes(), None);
    let times = browser.value(
        "timed(200, (number) => {
           page.grabbed = 5000;
           const place = [...page.shape.place(5000)];
           place[2] += 0.0005;
           return page.held(place);
         })",
    );
    let [median, often, _] = spread(&times);
    row("drag at level 3, median of 200", "ms", median, None);
    row("drag at level 3, 95 of 100", "ms", often, Some(16.0));
    browser.value("page.grabbed = undefined; 0");
}

fn undo(browser: &mut Browser) {
    let served = opened(browser);
    let file = "import('/server.js').then((server) => server.askBytes('/file', { format: 'obj', view: null, anyway: false }))
        .then((bytes) => new TextDecoder().decode(bytes))";
    // Splits, flips of what was split, and moved points.
    browser.value(&format!(
        "(async () => {{
           for (let number = 0; number < {EDITS} - 1; number++) {{
             const a = cell(Math.floor(number / 3)), b = 224 * ((Math.floor(a / 224) + 1) % 224) + (a + 1) % 224;
             const place = [...page.shape.place(a)];
             place[2] += 0.001;
             const command = [{{ split: {{ edge: [a, b] }} }}, {{ flip: {{ edge: [a, 50176 + Math.floor(number / 3)] }} }}, {{ move: {{ point: a, to: place }} }}][number % 3];
             await page.change(command);
           }}
         }})()"
    ));
    assert_eq!(browser.value("page.head.undo"), json!(EDITS - 1));
    let before = browser.value(file);
    browser.value("page.change({ move: { point: 7, to: [0.1, 0.2, 0.3] } })");
    let mut times = Vec::new();
    for number in 0..5 {
        if number > 0 {
            browser.value("page.change('redo')");
        }
        times.extend_from_slice(browser.value("timed(1, () => page.change('undo'))").as_array().unwrap());
    }
    let [median, _, most] = spread(&Value::Array(times));
    assert!(browser.value(file) == before, "undoing gave other bytes");
    assert_eq!(browser.value("page.head.undo"), json!(EDITS - 1));
    row("undo of the 10 000th edit, median of 5", "ms", median, None);
    row("the longest", "ms", most, Some(50.0));
    row("server's memory then", "MB", served.megabytes(), None);
}

fn grains(browser: &mut Browser) {
    let directory = tempfile::TempDir::new().unwrap();
    let file = directory.path().join("grains.vtp");
    let made = Command::new(env!("CARGO_BIN_EXE_grainsmooth"))
        .args(["--seeds", "2000", "-n", "1", "--quiet", "-o"])
        .arg(&file)
        .status()
        .unwrap();
    assert!(made.success());
    let start = Instant::now();
    let served = Served::new(&format!("view {}", file.display()), |_| ());
    browser.open(&served.link);
    browser.value(DRAWN);
    define_timed(browser);
    row("2000 grains: from the command to the first picture", "s", start.elapsed().as_secs_f64(), Some(3.0));
    row("server's memory", "MB", served.megabytes(), None);
    browser.value(&format!("window.drawn = () => {DRAWN}; 0"));
    let turn = "page.stage.controls._rotateLeft(0.03); page.stage.controls.update()";
    // As a drag begins: slow frames get fewer pixels until it ends.
    browser.value("page.stage.controls.dispatchEvent({ type: 'start' }); 0");
    let [median, _, most] = spread(&browser.value(&format!(
        "timed(30, () => {{ {turn}; drawn(); return (window.scripts ??= []).push(page.stage.script); }})"
    )));
    row("a frame while turning, median", "ms", median, Some(125.0));
    row("the longest of 30", "ms", most, None);
    let [median, _, most] = spread(&browser.value("scripts"));
    row("its script, median", "ms", median, None);
    row("its script, the longest", "ms", most, Some(10.0));
    browser.value("page.stage.controls.dispatchEvent({ type: 'end' }); drawn()");
    // What runs often enough is compiled, and then makes no objects of its numbers. Pixels and triangles, which are none of the script's work, are few here.
    let draw = |count: u32| {
        format!("for (let number = 0; number < {count}; number++) {{ {turn}; page.stage.render(); }} 0")
    };
    browser.value("page.stage.renderer.setSize(4, 4); page.network.surface.geometry.setDrawRange(0, 3); page.network.lines.geometry.setDrawRange(0, 2); 0");
    browser.value(&draw(600));
    browser.call("HeapProfiler.collectGarbage", json!({}));
    let heap =
        |browser: &mut Browser| browser.call("Runtime.getHeapUsage", json!({}))["usedSize"].as_f64().unwrap();
    let before = heap(browser);
    browser.value(&draw(200));
    row("allocated in a frame, mean of 200", "kB", (heap(browser) - before) / 200.0 / 1024.0, None);
    browser.value("page.stage.resize(); page.network.select(); drawn()");
    let times = browser.value(
        "timed(20, (number) => { page.pick({ clientX: 300 + 20 * number, clientY: 200 + 10 * number }); })",
    );
    let [median, often, _] = spread(&times);
    row("hover: the grain under the pointer, median", "ms", median, None);
    row("hover, 95 of 100", "ms", often, Some(20.0));
    let times = browser.value(
        "timed(20, (number) => { page.axis.input.value = 'y'; page.turned.checked = true; page.depth.value = 0.02 * number - 0.2; page.slice(false); drawn(); })",
    );
    let [median, _, _] = spread(&times);
    row("a frame while the slice moves, median", "ms", median, Some(250.0));
}
