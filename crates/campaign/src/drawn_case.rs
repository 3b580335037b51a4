//! How a run is drawn.

use crate::case::{AngleClass, Case, Limits};
use crate::domain::{self, Domain};
use crate::draw::Draw;
use crate::elements;
use crate::mistake;
use crate::options::Options;
use crate::outputs::{self, Promise};
use crate::seeds::{Arrangement, LatticeCells, draw_seeds};

/// Share of runs with a deliberate mistake in their input.
const MISTAKES: f64 = 0.06;

/// Share of runs whose options stand in a TOML file.
const CONFIG_FILES: f64 = 0.05;

/// Share of runs with grains of given shapes, of those in boxes whose seeds can have sizes.
const SHAPES: f64 = 0.1;

/// Share of runs with grains inside others or between them, of those.
const INCLUSIONS: f64 = 0.15;

impl Case {
    /// Draws run `index` of a campaign.
    pub fn draw(seed: u64, index: u64, limits: Limits) -> Self {
        let draw = &mut Draw::of_run(seed, index);
        let mut options = Options::default();
        let dimension = if draw.chance(0.25) { 2 } else { 3 };
        if dimension == 2 {
            options.set("dim", [2]);
        }
        let arrangement = Arrangement::draw(draw);
        let count = draw.count(limits.grains);
        let lattice = LatticeCells::draw(draw, dimension, count);
        let proportions = match arrangement {
            Arrangement::Lattice | Arrangement::JitteredLattice => lattice.proportions(draw),
            _ => domain::proportions(draw, dimension),
        };
        let domain = Domain::draw(draw, proportions, &mut options);
        let mut files = domain.files.clone();
        files.extend(draw_seeds(draw, arrangement, count, &lattice, &domain, &mut options));
        smoothing(draw, &domain, count, limits, &mut options);
        let mut promise = outputs::draw(draw, dimension, &mut options);
        files.extend(sizes(draw, arrangement, count, &domain, &mut options));
        phases(draw, &mut options);
        inside(draw, &domain, count, &mut options);
        grain_shapes(draw, arrangement, dimension, &mut options, &mut promise);
        inclusions(draw, arrangement, dimension, &mut options, &mut promise);
        let mut case = Self {
            kind: arrangement.name().to_owned(),
            command: Vec::new(),
            keeps_volumes: !options.has("free"),
            angles: angle_class(&domain, &options),
            options,
            files,
            mistake: None,
            promise,
            map: None,
            dimension,
        };
        if draw.chance(MISTAKES) {
            mistake::make(draw, &mut case);
            return case;
        }
        elements::draw(draw, &domain, count, &mut case);
        if draw.chance(CONFIG_FILES) {
            case.files.push(("run.toml".to_owned(), case.options.toml().into_bytes()));
            case.options = Options::default();
            case.options.set("config", ["run.toml"]);
        }
        case
    }
}

/// Draws sizes and shapes of the grains, after all else, so that this is as it was without. Returns the file that they need.
fn sizes(
    draw: &mut Draw,
    arrangement: Arrangement,
    count: u32,
    domain: &Domain,
    options: &mut Options,
) -> Option<(String, Vec<u8>)> {
    let is_box = domain.files.is_empty() && !options.has("domain");
    if is_box && !options.has("lattice") && !options.has("series") && draw.chance(0.1) {
        let lengths: Vec<f64> = domain.sides.iter().map(|_| draw.magnitude(0.4, 2.5)).collect();
        options.set("aspect-ratio", lengths);
    }
    let is_free = matches!(arrangement, Arrangement::Random | Arrangement::PoissonDisc);
    // Packed grains have sizes, which nothing may be merged into.
    if arrangement == Arrangement::Random && (options.has("min-diameter") || draw.chance(0.5)) {
        options.set("seeding", ["random"]);
    }
    if !arrangement.may_be_sized() || options.has("min-diameter") || !draw.chance(0.35) {
        return None;
    }
    if is_free {
        options.set("seeding", [draw.one_of(&["packed", "packed", "random", "poisson-disc"])]);
    }
    let specs = [
        "lognormal(mean=1,cv=0.35)",
        "normal(mean=3,sd=1,from=1)",
        "gamma(mean=2,cv=0.5)",
        "weibull(shape=2.8,scale=1e-3)",
        "0.5*uniform(1,2)+0.5*equal(3),by=volume",
    ];
    match draw.weighted(&[(0.7, "words"), (0.1, "packed"), (0.2, "volumes")]) {
        "words" => options.set("diameters", [draw.one_of(&specs)]),
        "volumes" if is_free => {
            options.unset("seeds");
            let lines: String = (0..count).map(|_| format!("{:?}\n", draw.magnitude(0.1, 10.0))).collect();
            options.set("volumes", ["volumes.csv"]);
            return Some(("volumes.csv".to_owned(), lines.into_bytes()));
        }
        _ => {}
    }
    if options.has("diameters") && draw.chance(0.3) {
        options.set("draw", ["random"]);
    }
    if is_box
        && is_free
        && (options.has("diameters") || options.value("seeding") == Some("packed"))
        && draw.chance(0.2)
    {
        let lines = format!("0 1\n{:?} {:?}\n", domain.sides[0], draw.magnitude(0.5, 2.0));
        options.set("gradient", ["x:factors.csv"]);
        return Some(("factors.csv".to_owned(), lines.into_bytes()));
    }
    None
}

/// Draws whether the grains of a second phase stand together or apart.
fn place(draw: &mut Draw, options: &Options) -> &'static str {
    if options.has("gradient") || !draw.chance(0.3) {
        return "";
    }
    draw.one_of(&[",place=clustered", ",place=dispersed"])
}

/// Most grains that are divided into others, each into up to 64: of more, a run would be one of some ten thousand grains.
const MOST_DIVIDED: u32 = 50;

/// Draws what divides grains, after the phases: into parts of a half to a quarter of their width.
fn inside(draw: &mut Draw, domain: &Domain, count: u32, options: &mut Options) {
    // Freely growing parts vanish soon, and so do those of the twins and clusters of files.
    let is_taken = ["free", "seeds-file", "aspect-ratio"].iter().any(|name| options.has(name));
    let is_placed = options.values("phase").iter().any(|phase| phase.contains("place="));
    if is_taken || is_placed || !draw.chance(0.1) {
        return;
    }
    let length = draw.between(0.25, 0.5) * domain.spacing(count) * domain.inner;
    let pattern = match draw.one_of(&["lamellae", "lamellae across x", "voronoi"]) {
        "lamellae" => format!("lamellae(width={length:?})"),
        "lamellae across x" => format!("lamellae(width={length:?},normal=x)"),
        _ if count > MOST_DIVIDED => return,
        _ => format!("voronoi(diameter={length:?})"),
    };
    options.set("inside", [pattern]);
}

/// Draws phases, after the sizes, which they may have of their own. At least four grains are of them.
fn phases(draw: &mut Draw, options: &mut Options) {
    let is_taken = ["lattice", "volumes", "min-diameter", "seeds-file"].iter().any(|name| options.has(name));
    let has_few =
        options.value("seeds").and_then(|seeds| seeds.parse().ok()).is_none_or(|seeds: u32| seeds < 4);
    if is_taken || has_few || !draw.chance(0.2) {
        return;
    }
    let share = f64::from(draw.whole(1..=19)) / 20.0;
    let mut of_second = String::new();
    if options.has("diameters") && draw.chance(0.5) {
        of_second += ",diameters=lognormal(mean=0.5,cv=0.2)";
    }
    if draw.chance(0.3) {
        of_second += ",texture=goss(10)";
    }
    if draw.chance(0.3) {
        of_second += ",symmetry=hexagonal";
    }
    of_second += place(draw, options);
    options.set("phase", [format!("first:{:?}", 1.0 - share), format!("second:{share:?}{of_second}")]);
    if options.has("picture") && draw.chance(0.5) {
        options.set("color-by", ["phase"]);
    }
    if draw.chance(0.3) {
        // Far from where three boundaries are without equilibrium.
        options.set("tension", ["first/second:0.9", "1.1"]);
    }
}

/// What does not go with grains of several cells.
const NOT_WITH_SEVERAL_CELLS: [&str; 8] =
    ["aspect-ratio", "cells-csv", "cells-json", "inside", "min-diameter", "series", "every", "gradient"];

/// Whether grains may become several cells: in boxes, where a network of them is asked for.
fn may_be_several_cells(arrangement: Arrangement, options: &Options) -> bool {
    let is_taken = ["domain", "half-spaces", "no-mesh"].iter().any(|name| options.has(name));
    let is_of_cells = options.values("output").iter().any(|name| name.ends_with(".tess"))
        || options.value("format") == Some("tess");
    arrangement.may_be_sized() && !is_taken && !is_of_cells
}

/// Takes out what does not go with grains of several cells.
fn make_several_cells(options: &mut Options, promise: &mut Promise) {
    NOT_WITH_SEVERAL_CELLS.iter().for_each(|name| options.unset(name));
    let is_gone = |file: &str| file.starts_with("cells.") || file.starts_with("series");
    promise.files.retain(|file| !is_gone(file));
    if promise.surface.is_some() && !options.has("json-summary") {
        options.set("json-summary", [outputs::SUMMARY]);
        promise.file("summary", outputs::SUMMARY);
    }
    // Cells alone are sharp where those of a grain meet.
    if options.value("relax") == Some("0") {
        options.unset("relax");
    }
}

/// Draws a phase of small grains inside others or between them, and takes out what does not go with it.
fn inclusions(
    draw: &mut Draw,
    arrangement: Arrangement,
    dimension: usize,
    options: &mut Options,
    promise: &mut Promise,
) {
    let is_taken =
        ["seeds-file", "volumes", "grain-shapes", "dry-run", "free"].iter().any(|name| options.has(name));
    let count = options.value("seeds").and_then(|seeds| seeds.parse().ok()).unwrap_or(0u32);
    if is_taken || count < 20 || !may_be_several_cells(arrangement, options) || !draw.chance(INCLUSIONS) {
        return;
    }
    make_several_cells(options, promise);
    ["diameters", "seeding"].iter().for_each(|name| options.unset(name));
    let places: &[&str] = match dimension {
        2 => &["interior", "boundaries", "triple-lines"],
        _ => &["interior", "boundaries", "triple-lines", "quadruple-points"],
    };
    let share = draw.one_of(&[0.01, 0.03, 0.05, 0.1]);
    let place = draw.one_of(places);
    options.set(
        "phase",
        [
            format!("first:{:?},diameters=lognormal(mean=3,cv=0.3)", 1.0 - share),
            format!("second:{share:?},diameters=equal(1),place={place}"),
        ],
    );
}

/// Draws the shapes of single grains, in boxes with seeds that can have sizes, and takes out what does not go with them.
fn grain_shapes(
    draw: &mut Draw,
    arrangement: Arrangement,
    dimension: usize,
    options: &mut Options,
    promise: &mut Promise,
) {
    let is_placed = options.values("phase").iter().any(|phase| phase.contains("place="));
    if is_placed || !may_be_several_cells(arrangement, options) || !draw.chance(SHAPES) {
        return;
    }
    make_several_cells(options, promise);
    let lengths: &[&str] = match dimension {
        2 => &["2:1", "3:1", "1:1.5"],
        _ => &["2:1:1", "3:1:1", "1:1.5:1.5", "3:3:1", "3:2:1", "1:1:1"],
    };
    options.set("grain-shapes", [format!("{}{}", draw.one_of(lengths), draw.one_of(&["", " aligned"]))]);
}

/// Draws the options of the control mesh, relaxation and subdivision.
fn smoothing(draw: &mut Draw, domain: &Domain, count: u32, limits: Limits, options: &mut Options) {
    let is_plane = domain.sides.len() == 2;
    // Triangles on a grain's share of the control mesh; segments in the plane.
    let mut share = if is_plane { 6.0 } else { 81.0 };
    match draw.weighted(&[(0.72, "fan"), (0.12, "plain"), (0.16, "edge length")]) {
        "plain" => options.set("faces", ["plain"]),
        "edge length" => {
            let relative = draw.magnitude(0.25, 3.0);
            options.set("edge-length", [domain.spacing(count) * relative]);
            // Small triangles cover the faces, each of some two by two edge lengths.
            share *= (0.8 / relative).powi(2).max(1.0);
        }
        _ => {}
    }
    match draw.weighted(&[
        (0.45, "default"),
        (0.12, "flat"),
        (0.18, "equilibrium"),
        (0.22, "time"),
        (0.03, "any"),
    ]) {
        "flat" => options.set("relax", [0]),
        "equilibrium" => options.set("relax", ["equilibrium"]),
        "time" => options.set("relax", [draw.magnitude(0.01, 1.0)]),
        "any" => options.set("relax", [draw.magnitude(1e-9, 10.0)]),
        _ => {}
    }
    if draw.chance(0.1) {
        options.switch("free");
    }
    if options.has("free") && draw.chance(0.3) {
        let law = if options.has("texture") { "humphreys(15)" } else { "2" };
        options.set("mobility", [law]);
    }
    if draw.chance(0.15) {
        options.set("wall-tension", [draw.between(0.0, 1.5)]);
    }
    match draw.weighted(&[(0.7, "default"), (0.15, "off"), (0.15, "any")]) {
        "off" => options.set("regularize", [0]),
        "any" => options.set("regularize", [draw.between(0.0, 0.5)]),
        _ => {}
    }
    if draw.chance(0.1) {
        options.set("junctions", ["corner"]);
    }
    if draw.chance(0.1) {
        options.set("lloyd", [draw.whole(1..=5)]);
    }
    if draw.chance(0.05) {
        options.set("min-diameter", [draw.between(0.0, 0.6)]);
    }
    let growth: f64 = if is_plane { 2.0 } else { 4.0 };
    let affordable = (f64::from(limits.triangles) / (share * f64::from(count))).log(growth).max(0.0);
    let levels = f64::from(draw.weighted(&[(0.15, 0), (0.3, 1), (0.3, 2), (0.25, 3)]));
    options.set("levels", [levels.min(affordable.floor())]);
}

fn angle_class(domain: &Domain, options: &Options) -> AngleClass {
    let is_off = |name| options.value(name) == Some("0");
    // Lamellae are planes unless a time is given.
    let are_lamellae = options.values("inside").iter().any(|pattern| pattern.starts_with("lamellae"));
    let is_flat = is_off("relax") || are_lamellae && !options.has("relax");
    let is_equilibrium = options.value("relax") == Some("equilibrium");
    match domain.sides.len() {
        2 => AngleClass::Plane,
        _ if is_flat || is_off("regularize") => AngleClass::Unregularized,
        _ if options.has("grain-shapes") => AngleClass::Shapes,
        _ if domain.is_cut => AngleClass::Cut,
        _ if is_equilibrium => AngleClass::Equilibrium,
        _ if domain.is_periodic => AngleClass::Periodic,
        _ => AngleClass::Walls,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn run_is_the_same_whenever_it_is_drawn() {
        assert_eq!(Case::draw(5, 731, Limits::USUAL), Case::draw(5, 731, Limits::USUAL));
        assert_ne!(Case::draw(5, 731, Limits::USUAL), Case::draw(5, 732, Limits::USUAL));
    }

    #[test]
    fn campaign_draws_every_option_of_the_program() {
        let cases: Vec<Case> = (0..2000).map(|index| Case::draw(1, index, Limits::USUAL)).collect();
        let is_given = |name: &str| cases.iter().any(|case| case.options.has(name));
        let options = [
            "adapt-curvature",
            "arrays",
            "ascii",
            "aspect-ratio",
            "box",
            "cells-csv",
            "cells-json",
            "chord-error",
            "cohesive",
            "color-by",
            "config",
            "diameters",
            "dim",
            "domain",
            "draw",
            "drop-empty",
            "dry-run",
            "edge-length",
            "element-size",
            "elements-per-grain",
            "every",
            "explode",
            "faces",
            "format",
            "free",
            "gradient",
            "grain-shapes",
            "grains-dir",
            "grains-format",
            "half-spaces",
            "inside",
            "json-summary",
            "junctions",
            "lattice",
            "levels",
            "lloyd",
            "min-diameter",
            "names",
            "mobility",
            "no-mesh",
            "order",
            "output",
            "periodic",
            "periodic-cut",
            "periodic-equations",
            "phase",
            "picture",
            "picture-size",
            "plane-state",
            "quiet",
            "regularize",
            "relax",
            "report",
            "rng-seed",
            "seeding",
            "seeds",
            "seeds-file",
            "series",
            "size-growth",
            "solver-deck",
            "stats",
            "tension",
            "texture",
            "threads",
            "voxels",
            "volume-mesh",
            "volumes",
            "vtk-encoding",
            "wall-tension",
        ];
        for name in options {
            assert!(is_given(name), "no run has --{name}");
        }
    }
}
