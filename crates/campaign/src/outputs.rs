//! What a run writes.

use crate::draw::Draw;
use crate::options::Options;

/// What a good run leaves behind.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Promise {
    /// Files that have to be there.
    pub files: Vec<String>,
    /// What names of files may begin with.
    pub stems: Vec<&'static str>,
    /// A surface file that `grainsmooth check` reads.
    pub surface: Option<String>,
    /// A file of elements that fill grains, which `grainsmooth check` reads.
    pub mesh: Option<String>,
    /// Whether something goes to standard output.
    pub prints: bool,
}

impl Promise {
    pub(crate) fn file(&mut self, stem: &'static str, name: impl Into<String>) {
        self.files.push(name.into());
        self.stems.push(stem);
    }
}

/// The table of the flat cells, whose volumes the grains have to keep.
pub const CELLS: &str = "cells.json";

/// The run's figures.
pub const SUMMARY: &str = "summary.json";

/// Draws what a run writes, into the options.
pub fn draw(draw: &mut Draw, dimension: usize, options: &mut Options) -> Promise {
    let mut promise = Promise::default();
    options.set("threads", [draw.whole(1..=2)]);
    if draw.chance(0.1) {
        options.switch("quiet");
    }
    if draw.chance(0.15) {
        options.set("cells-csv", ["cells.csv"]);
        promise.file("cells", "cells.csv");
    }
    match draw.weighted(&[(0.02, "no-mesh"), (0.02, "dry-run"), (0.96, "whole")]) {
        "no-mesh" => {
            options.switch("no-mesh");
            return promise;
        }
        "dry-run" => {
            options.switch("dry-run");
            return Promise { prints: true, ..Promise::default() };
        }
        _ => {}
    }
    network(draw, dimension, options, &mut promise);
    if promise.surface.is_some() || draw.chance(0.2) {
        options.set("cells-json", [CELLS]);
        promise.file("cells", CELLS);
    }
    if promise.surface.is_none() || draw.chance(0.7) {
        options.set("json-summary", [SUMMARY]);
        promise.file("summary", SUMMARY);
    }
    tables(draw, dimension, options, &mut promise);
    pictures(draw, options, &mut promise);
    texture(draw, dimension, options, &mut promise);
    promise
}

/// Orientations: drawn last, so that all else is as it was without.
fn texture(draw: &mut Draw, dimension: usize, options: &mut Options, promise: &mut Promise) {
    if !draw.chance(0.3) {
        return;
    }
    let textures =
        ["random", "goss(10)", "cube(5)*0.3+random*0.7", "fiber(111||z,10)", "s(0)", "euler(30 45 60,90)"];
    options.set("texture", [draw.one_of(&textures)]);
    if draw.chance(0.3) {
        options.set("crystal-symmetry", [draw.one_of(&["hexagonal", "trigonal", "4/m", "222", "2", "1"])]);
    }
    if draw.chance(0.2) {
        options.set("sample-symmetry", ["orthorhombic"]);
    }
    let mut outputs: Vec<String> = options.values("output").to_vec();
    let of_plane = if dimension == 2 && options.has("voxels") { &["ctf"][..] } else { &[] };
    let format = draw.one_of(&[&["ori", "txt", "yaml"], of_plane].concat());
    let name = format!("orientations.{format}");
    promise.file("orientations", name.clone());
    outputs.push(name);
    options.set("output", outputs);
}

fn network(draw: &mut Draw, dimension: usize, options: &mut Options, promise: &mut Promise) {
    let surfaces = [(45.0, "vtp"), (12.0, "vtu"), (10.0, "vtk"), (6.0, "vtm")];
    let others: &[(f64, &str)] = if dimension == 2 {
        &[(3.0, "tess"), (2.0, "vti"), (2.0, "npy"), (2.0, "inp"), (3.0, "ang")]
    } else {
        &[
            (3.0, "stl"),
            (3.0, "ply"),
            (3.0, "obj"),
            (4.0, "msh"),
            (3.0, "fe"),
            (3.0, "tess"),
            (2.0, "vti"),
            (2.0, "npy"),
            (1.0, "inp"),
        ]
    };
    let format = draw.weighted(&[&surfaces, others].concat());
    if ["vti", "npy", "inp", "ang"].contains(&format) {
        options.set("voxels", (0..dimension).map(|_| draw.whole(1..=40)));
    }
    if format == "stl" && draw.chance(0.5) {
        options.switch("ascii");
    }
    if draw.chance(0.2) {
        let tools = ["grainsmooth", "dream3d", "pyvista", "virmat", "neper"];
        options.set("names", [draw.one_of(&tools)]);
    }
    if draw.chance(0.2) {
        options.set("vtk-encoding", [draw.one_of(&["raw", "base64", "zlib"])]);
    }
    if draw.chance(0.15) {
        options.switch("arrays");
    }
    let mut outputs = Vec::new();
    if draw.chance(0.03) && !["vtm", "msh"].contains(&format) {
        options.set("format", [format]);
        promise.prints = true;
        outputs.push("-".to_owned());
    } else {
        let name = format!("out.{format}");
        promise.file("out", name.clone());
        match format {
            "vtm" => promise.files.push("out".to_owned()),
            "msh" => promise.files.push("out.geo".to_owned()),
            _ => {}
        }
        outputs.push(name);
    }
    let is_surface = ["vtp", "vtu", "vtk"].contains(&format) && !promise.prints;
    promise.surface = is_surface.then(|| outputs[0].clone());
    // What `check` cannot read is written as what it reads too.
    if draw.chance(if is_surface { 0.05 } else { 0.85 }) {
        let name = format!("surface.{}", draw.one_of(&["vtp", "vtu", "vtk"]));
        promise.file("surface", name.clone());
        promise.surface = Some(name.clone());
        outputs.push(name);
    }
    options.set("output", outputs);
}

fn tables(draw: &mut Draw, dimension: usize, options: &mut Options, promise: &mut Promise) {
    if draw.chance(0.2) {
        let name = draw.one_of(&["stats.json", "stats.csv"]);
        options.set("stats", [name]);
        promise.file("stats", name);
        if name == "stats.csv" {
            let tables: &[&str] = match dimension {
                2 => &["boundaries", "triple_points"],
                _ => &["boundaries", "triple_lines", "quadruple_points"],
            };
            promise.files.extend(tables.iter().map(|table| format!("stats.{table}.csv")));
        }
    }
    if draw.chance(0.07) && (!options.has("periodic-cut") || draw.chance(0.05)) {
        options.set("series", ["series.pvd"]);
        if draw.chance(0.5) {
            options.set("every", [draw.whole(1..=10)]);
        }
        promise.file("series", "series.pvd");
        promise.files.push("series_0000.vtp".to_owned());
    }
    if draw.chance(0.1) && dimension == 3 {
        options.set("grains-dir", ["grains"]);
        let format = draw.one_of(&["vtp", "stl", "ply", "obj"]);
        options.set("grains-format", [format]);
        // Any grain may have vanished, and has no file then.
        promise.file("grains", "grains");
    }
}

fn pictures(draw: &mut Draw, options: &mut Options, promise: &mut Promise) {
    if draw.chance(0.1) {
        options.set("picture", ["picture.png"]);
        options.set("picture-size", [draw.whole(16..=300), draw.whole(16..=300)]);
        options.set("color-by", [draw.one_of(&["grain", "diameter", "neighbors"])]);
        if options.has("texture") && draw.chance(0.5) {
            options.set("color-by", [draw.one_of(&["ipf-x", "ipf-y", "ipf-z", "disorientation"])]);
        }
        options.set("explode", [draw.one_of(&[0.0, 0.3, 10.0])]);
        promise.file("picture", "picture.png");
    }
    if draw.chance(0.06) {
        options.set("report", ["report.html"]);
        promise.file("report", "report.html");
    }
}
