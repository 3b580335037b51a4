//! Deliberate mistakes: input that has to be refused by name.

use crate::case::Case;
use crate::draw::Draw;
use crate::options::Options;

/// A mistake: what it is called, what the refusal has to name, and how it is made.
type Mistake = (&'static str, &'static str, fn(&mut Case));

/// Every mistake. A seeds file is made anew, so that its line numbers are known.
const MISTAKES: &[Mistake] = &[
    ("seed that is not a number", "line 3", |case| seeds(case, "0.1, 0.2, Z\n0.1, 0.x, Z\n")),
    ("seed that is not finite", "line 3", |case| seeds(case, "0.1, 0.2, Z\n0.1, nan, Z\n")),
    ("seed outside", "line 2", |case| seeds(case, "1e9, 0, Z\n")),
    ("seed twice", "line 3", |case| seeds(case, "0, 0, Z\n0, 0, Z\n")),
    ("negative radius", "-0.5", |case| seeds(case, "0, 0, Z, -0.5\n")),
    ("no seeds", "seeds.csv", |case| seeds(case, "")),
    ("missing seeds file", "absent.csv", |case| seeds_option(case, "absent.csv")),
    ("seeds in a folder", "a folder", |case| {
        case.files.push(("a folder/file".to_owned(), Vec::new()));
        seeds_option(case, "a folder");
    }),
    ("two sources of seeds", "--seeds", |case| {
        seeds(case, "0, 0, Z\n");
        case.options.set("seeds", [7]);
    }),
    ("unknown extension", "unknown extension", |case| output(case, "out.xyz")),
    ("missing directory", "absent", |case| output(case, "absent/out.vtp")),
    ("output that is a directory", "taken.vtp", |case| {
        case.files.push(("taken.vtp/file".to_owned(), Vec::new()));
        output(case, "taken.vtp");
    }),
    ("format of another dimension", "holds", |case| {
        output(case, if case.dimension == 2 { "out.stl" } else { "out.ang" });
        case.options.set("voxels", (0..case.dimension).map(|_| 4));
    }),
    ("voxels without a number", "--voxels", |case| {
        output(case, "out.vti");
        case.options.unset("voxels");
    }),
    ("orientations without a texture", "--texture", |case| {
        output(case, "out.ori");
        case.options.unset("texture");
        case.options.unset("color-by");
        case.options.unset("phase");
        case.options.unset("tension");
        case.options.unset("mobility");
        // It is refused without a texture before anything is written.
        case.options.unset("sample-symmetry");
    }),
    ("unknown distribution of diameters", "did you mean 'lognormal'?", |case| {
        sources(&mut case.options);
        case.options.set("diameters", ["lognomal(mean=1,cv=0.3)"]);
    }),
    ("unknown component of a texture", "did you mean 'goss'?", |case| {
        case.options.set("texture", ["gos(10)"]);
    }),
    ("fractions that do not add up to 1", "add up to 0.9", |case| {
        sources(&mut case.options);
        case.options.unset("min-diameter");
        case.options.set("phase", ["first:0.5", "second:0.4"]);
    }),
    ("grains that are too small to divide", "divides no grain", |case| {
        case.options.set("inside", ["lamellae(width=1e9)"]);
    }),
    ("directory of grains that is taken", "grains", |case| {
        case.files.push(("grains/file".to_owned(), Vec::new()));
        whole(case);
        case.options.set("grains-dir", ["grains"]);
    }),
    ("more levels than memory", "levels would", |case| {
        whole(case);
        sources(&mut case.options);
        case.options.set("seeds", [20]);
        case.options.set("levels", [40]);
    }),
    ("more levels than there are", "100", |case| case.options.set("levels", [100])),
    ("more seeds than memory", "of memory", |case| {
        sources(&mut case.options);
        case.options.set("seeds", [4_000_000_000_u32]);
    }),
    ("box of no size", "'0'", |case| case.options.set("box", (0..case.dimension).map(|_| 0))),
    ("box without a number", "'nan'", |case| case.options.set("box", (0..case.dimension).map(|_| "nan"))),
    ("box of another dimension", "--box", |case| {
        plain(&mut case.options);
        case.options.set("box", (0..5 - case.dimension).map(|_| 1));
    }),
    ("negative time", "'-1'", |case| case.options.set("relax", [-1])),
    ("infinite tension", "'inf'", |case| case.options.set("wall-tension", ["inf"])),
    ("collapse of everything", "'0.7'", |case| case.options.set("regularize", [0.7])),
    ("unknown axis", "'w'", |case| case.options.set("periodic", ["w"])),
    ("periodic ball", "--periodic", |case| {
        plain(&mut case.options);
        case.options.set("box", (0..case.dimension).map(|_| 1));
        case.options.set("periodic", ["x"]);
        case.options.set("domain", [if case.dimension == 2 { "disc" } else { "sphere" }]);
    }),
    ("flat ball", "--domain", |case| {
        plain(&mut case.options);
        case.options.set("box", (0..case.dimension).map(|axis| 1 + axis));
        case.options.set("domain", [if case.dimension == 2 { "disc" } else { "sphere" }]);
    }),
    ("chord error of a box", "--chord-error", |case| {
        plain(&mut case.options);
        case.options.set("box", (0..case.dimension).map(|_| 1));
        case.options.set("chord-error", [0.1]);
    }),
    ("domain without end", "unbounded", |case| {
        plain(&mut case.options);
        let line = if case.dimension == 2 { "1, 0, 1\n" } else { "1, 0, 0, 1\n" };
        case.files.push(("open.csv".to_owned(), line.into()));
        case.options.set("half-spaces", ["open.csv"]);
    }),
    ("cut without periods", "--periodic-cut", |case| {
        plain(&mut case.options);
        case.options.set("periodic-cut", ["box"]);
    }),
    ("unknown key", "line 1", |case| {
        case.files.push(("run.toml".to_owned(), "sedes = 7\n".into()));
        case.options.set("config", ["run.toml"]);
    }),
    ("config without settings", "run.vtp", |case| {
        case.files.push(("run.vtp".to_owned(), "<VTKFile/>\n".into()));
        case.options.set("config", ["run.vtp"]);
    }),
];

/// Spoils a run by one of the mistakes.
pub fn make(draw: &mut Draw, case: &mut Case) {
    let (name, value, spoil) = draw.one_of(MISTAKES);
    // The mistake is the only one: these are refused beside some other options.
    for option in ["free", "mobility", "series", "every"] {
        case.options.unset(option);
    }
    // Phases may go with a mistake, and then have no colours.
    if case.options.value("color-by") == Some("phase") {
        case.options.unset("color-by");
    }
    spoil(case);
    case.kind = format!("mistake: {name}");
    case.mistake = Some(value.to_owned());
}

fn sources(options: &mut Options) {
    for name in [
        "seeds",
        "rng-seed",
        "seeding",
        "lattice",
        "seeds-file",
        "drop-empty",
        "diameters",
        "volumes",
        "draw",
        "gradient",
        "inside",
        "phase",
        "tension",
        "mobility",
    ] {
        options.unset(name);
    }
}

fn seeds_option(case: &mut Case, name: &str) {
    sources(&mut case.options);
    case.options.set("seeds-file", [name]);
}

/// A seeds file with these lines below the names of its columns; Z stands where the plane has no coordinate.
fn seeds(case: &mut Case, lines: &str) {
    let lines = lines.replace(", Z", if case.dimension == 2 { "" } else { ", 0" });
    let names = if case.dimension == 2 { "x, y" } else { "x, y, z" };
    let radius = if lines.contains("-0.5") { ", radius" } else { "" };
    seeds_option(case, "seeds.csv");
    // Line 1 of a body with planes for faces would lie outside.
    if case.options.has("half-spaces") || case.options.has("domain") {
        plain(&mut case.options);
    }
    case.files.retain(|(file, _)| file != "seeds.csv");
    case.files.push(("seeds.csv".to_owned(), format!("{names}{radius}\n{lines}").into_bytes()));
}

/// A run that goes to the end.
fn whole(case: &mut Case) {
    case.options.unset("no-mesh");
    case.options.unset("dry-run");
}

fn output(case: &mut Case, name: &str) {
    whole(case);
    case.options.unset("format");
    case.options.set("output", [name]);
}

/// No domain but the box, and no periods.
fn plain(options: &mut Options) {
    for name in [
        "domain",
        "chord-error",
        "half-spaces",
        "periodic",
        "periodic-cut",
        "box",
        "aspect-ratio",
        "grain-shapes",
        "gradient",
    ] {
        options.unset(name);
    }
}
