//! How a run of `grainsmooth smooth` is drawn.

use crate::case::{AngleClass, Case, MapPromise};
use crate::draw::Draw;
use crate::map::{LabelledGrid, Orientations};
use crate::options::Options;
use crate::outputs::{Promise, SUMMARY};

impl Case {
    /// Draws run `index` of a campaign of measured maps.
    pub fn draw_map(seed: u64, index: u64) -> Self {
        let draw = &mut Draw::of_run(seed, index);
        let dimension = if draw.chance(0.35) { 2 } else { 3 };
        let grid = LabelledGrid::draw(draw, dimension);
        let mut options = Options::default();
        let is_of_orientations = draw.chance(0.3);
        let (name, files) = match is_of_orientations {
            true => orientations(draw, &grid, &mut options),
            false => labels(draw, &grid, &mut options),
        };
        reading(draw, &grid, is_of_orientations, &mut options);
        // Those so far are about the map: `check` takes them too.
        let of_map = options.words();
        network(draw, dimension, &mut options);
        let promise = outputs(draw, dimension, &mut options);
        let is_still = !options.has("relax");
        let is_exact = is_still
            && !options.has("levels")
            && !options.has("fit-cells")
            && all_points_stay(dimension, &options);
        let kind = format!("{}{}", if is_of_orientations { "orientations of " } else { "" }, grid.kind);
        Self {
            kind,
            command: vec!["smooth".to_owned(), name.clone()],
            options,
            files,
            mistake: None,
            promise,
            keeps_volumes: true,
            map: Some(MapPromise { name, options: of_map, is_exact }),
            dimension,
            angles: AngleClass::Measured,
        }
    }
}

/// Whether no edge collapses.
fn all_points_stay(dimension: usize, options: &Options) -> bool {
    options.value("decimate").map_or(dimension == 2, |length| length == "0")
}

/// A file of labels, and the options that it needs.
fn labels(draw: &mut Draw, grid: &LabelledGrid, options: &mut Options) -> (String, Vec<(String, Vec<u8>)>) {
    let spacing = [0; 3].map(|_| draw.magnitude(0.3, 3.0));
    let (name, content) = match draw.one_of(&["npy", "zyx", "raw", "vti"]) {
        "vti" => ("map.vti", grid.vti(spacing).into_bytes()),
        "raw" => {
            let axes = if grid.shape[2] == 1 { 2 } else { 3 };
            options.set("shape", &grid.shape[..axes]);
            options.set("type", ["u8"]);
            ("map.raw", grid.labels.clone())
        }
        form => {
            let is_zyx = form == "zyx";
            if is_zyx {
                options.set("axes", ["zyx"]);
            }
            ("map.npy", grid.npy(is_zyx))
        }
    };
    if name != "map.vti" && draw.chance(0.3) {
        options.set("spacing", spacing);
    }
    if grid.labels.contains(&0) && draw.chance(0.8) {
        options.set("exterior-label", [0]);
    }
    (name.to_owned(), vec![(name.to_owned(), content)])
}

/// Files of orientations: one of a map, several of sections.
fn orientations(
    draw: &mut Draw,
    grid: &LabelledGrid,
    options: &mut Options,
) -> (String, Vec<(String, Vec<u8>)>) {
    let drawn = Orientations::draw(draw, grid);
    options.set("threshold", [draw.between(3.0, 15.0)]);
    if draw.chance(0.2) {
        options.set("min-ci", [0.1]);
    }
    if draw.chance(0.2) {
        options.set("min-pore", [draw.whole(1..=30)]);
    }
    if draw.chance(0.15) {
        options.set("merge-twins", ["60,1,1,1"]);
    }
    let shape = grid.shape;
    if shape[2] > 1 {
        let section =
            |layer| (format!("sections/section_{layer}.ang"), drawn.ang(shape, layer, false).into_bytes());
        if draw.chance(0.3) {
            options.switch("align");
        }
        return ("sections".to_owned(), (0..shape[2]).map(section).collect());
    }
    let (name, text) = match draw.one_of(&["square", "hexagonal", "ctf"]) {
        "ctf" => ("map.ctf", drawn.ctf(shape, 0)),
        form => ("map.ang", drawn.ang(shape, 0, form == "hexagonal")),
    };
    (name.to_owned(), vec![(name.to_owned(), text.into_bytes())])
}

/// What is read of the map.
fn reading(draw: &mut Draw, grid: &LabelledGrid, is_of_orientations: bool, options: &mut Options) {
    if draw.chance(0.35) {
        options.set("min-voxels", [draw.magnitude(2.0, 30.0).round()]);
    }
    if !is_of_orientations && draw.chance(0.25) {
        options.set("parts", ["split"]);
    }
    if !is_of_orientations && draw.chance(0.25) {
        let axes = if grid.shape[2] == 1 { &["x", "y"][..] } else { &["x", "y", "z"] };
        let chosen: Vec<&str> = axes.iter().copied().filter(|_| draw.chance(0.7)).collect();
        let chosen = if chosen.is_empty() { axes.to_vec() } else { chosen };
        options.set("periodic", [chosen.join(",")]);
    } else if draw.chance(0.1) {
        let range = |voxels: &u32| {
            let first = draw.whole(0..=voxels / 2);
            format!("{first}:{}", draw.whole(first + 1..=*voxels))
        };
        let axes = if grid.shape[2] == 1 { 2 } else { 3 };
        let ranges: Vec<String> = grid.shape[..axes].iter().map(range).collect();
        options.set("crop", [ranges.join(",")]);
    }
}

/// What the network is to be like.
fn network(draw: &mut Draw, dimension: usize, options: &mut Options) {
    match draw.weighted(&[(0.4, "default"), (0.25, "all points"), (0.29, "any"), (0.06, "cells")]) {
        "all points" => options.set("decimate", [0]),
        "any" => options.set("decimate", [draw.magnitude(0.5, 5.0)]),
        "cells" => options.switch("fit-cells"),
        _ => {}
    }
    match draw.weighted(&[(0.85, "still"), (0.1, "time"), (0.05, "equilibrium")]) {
        "time" => options.set("relax", [draw.magnitude(0.001, 0.5)]),
        "equilibrium" => options.set("relax", ["equilibrium"]),
        _ => {}
    }
    if draw.chance(0.25) {
        // All points of a map in space are many already.
        let most = if dimension == 2 || !all_points_stay(dimension, options) { 2 } else { 1 };
        options.set("levels", [draw.whole(1..=most)]);
    }
}

fn outputs(draw: &mut Draw, dimension: usize, options: &mut Options) -> Promise {
    let mut promise = Promise::default();
    options.set("threads", [draw.whole(1..=2)]);
    let surface = format!("out.{}", draw.one_of(&["vtp", "vtu", "vtk"]));
    promise.file("out", surface.clone());
    let mut outputs = vec![surface.clone()];
    promise.surface = Some(surface);
    let others: &[&str] = if dimension == 2 { &["npy", "vti"] } else { &["stl", "npy", "vti"] };
    if draw.chance(0.2) {
        let name = format!("other.{}", draw.one_of(others));
        promise.file("other", name.clone());
        outputs.push(name);
    }
    options.set("output", outputs);
    options.set("json-summary", [SUMMARY]);
    promise.file("summary", SUMMARY);
    if draw.chance(0.15) {
        options.set("stats", ["stats.json"]);
        promise.file("stats", "stats.json");
    }
    if draw.chance(0.1) {
        options.set("picture", ["picture.png"]);
        options.set("picture-size", [draw.whole(16..=300), draw.whole(16..=300)]);
        promise.file("picture", "picture.png");
    }
    if draw.chance(0.1) {
        options.set("report", ["report.html"]);
        promise.file("report", "report.html");
    }
    promise
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn campaign_of_maps_draws_every_option_of_maps() {
        let cases: Vec<Case> = (0..1000).map(|index| Case::draw_map(1, index)).collect();
        assert_eq!(cases[731], Case::draw_map(1, 731));
        for name in [
            "align",
            "axes",
            "crop",
            "decimate",
            "exterior-label",
            "fit-cells",
            "json-summary",
            "levels",
            "merge-twins",
            "min-ci",
            "min-pore",
            "min-voxels",
            "output",
            "parts",
            "periodic",
            "picture",
            "relax",
            "report",
            "shape",
            "spacing",
            "stats",
            "threads",
            "threshold",
            "type",
        ] {
            assert!(cases.iter().any(|case| case.options.has(name)), "no run has --{name}");
        }
    }
}
