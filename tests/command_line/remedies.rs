//! Messages that refuse input say what to do: here that is done, and then the program runs.

use std::fs;
use std::process::Output;

use campaign::{REFUSALS, refusal};

use crate::map_remedies;

use super::workplace::{FAILED, Workplace};

/// A file and what it holds; a name that ends in a slash is that of a directory.
type File = (&'static str, &'static str);

/// A kind of refusal, the files and the arguments that are refused, and the same after the remedy; files that stay are not repeated.
type Remedy = (&'static str, &'static [File], &'static str, &'static [File], &'static str);

/// Those that cannot be met here.
const BEYOND: [&str; 3] = [
    // Memory for as many is refused first, wherever there is less than some hundred gigabytes.
    "LevelsExceedIds",
    "TooLarge",
    // Seeds that are not from a file are never two in one place.
    "DuplicateSeeds",
];

/// Those of which the remedy is not tried here. Tests of their own try numbers in a message, short lines, files that are no text and read-only ones;
/// those of a map of other crystals, and of sections that share no place, are not tried. Those of most maps are in `map_remedies`.
const NOT_HERE: [&str; 14] = [
    "LevelsExceedMemory",
    // Without relaxation grains have no places.
    "NoPlace",
    "NoPlace, none",
    "NoRoomAround",
    "TextureSymmetry",
    "KeptShortLines",
    "LineTooShort",
    // Such runs take half a minute.
    "TinyGrain",
    "GrainVanished",
    "GrainVanished, at any time",
    "SeedProblem::NotUtf8",
    "OutputNotWritable",
    "MapProblem::Unfit, no confidence",
    "MapProblem::Unfit, sections",
];

const TESS: &str = include_str!("../formats/one_cell.tess");

/// In place of a file with a cell that is not that of its seed.
const OTHER_CELLS: &str = "other cells";

/// In place of a file with a domain that is a sphere.
const ROUND: &str = "round";

const SEEDS: File = ("s.csv", "0.1,0.2,0.3\n0.7,0.6,0.5\n");

const OCTAHEDRON: File =
    ("h.csv", "1,1,1,1\n1,1,-1,1\n1,-1,1,1\n1,-1,-1,1\n-1,1,1,1\n-1,1,-1,1\n-1,-1,1,1\n-1,-1,-1,1\n");
const PYRAMID: File = ("h.csv", "0,0,-1,0\n1,0,1,1\n-1,0,1,0\n0,1,1,1\n0,-1,1,0\n");

const REMEDIES: &[Remedy] = &[
    ("CoarseReference", &[], "--seeds 3 --elements-per-grain 4", &[], "--seeds 3 --elements-per-grain 0.9"),
    (
        "ElementsWithoutSize",
        &[],
        "--seeds 3 --size-growth 0.3",
        &[],
        "--seeds 3 --size-growth 0.3 --elements-per-grain 0.9",
    ),
    (
        "TrianglesWithoutSize",
        &[],
        "--seeds 3 --dim 2 --volume-mesh -o a.vtu",
        &[],
        "--seeds 3 --dim 2 --elements-per-grain 2 --volume-mesh -o a.vtu",
    ),
    (
        "PlaneStateInSpace",
        &[],
        "--seeds 3 --plane-state strain -o a.inp",
        &[],
        "--seeds 3 --dim 2 --elements-per-grain 2 --plane-state strain -o a.inp",
    ),
    (
        "NoElementSize",
        &[],
        "--seeds 3 --dim 2 -o a.inp",
        &[],
        "--seeds 3 --dim 2 --elements-per-grain 2 -o a.inp",
    ),
    ("EquationsWithoutPeriods", &[], "--seeds 3 --periodic-equations -o a.inp", &[], "--seeds 3 -o a.vtp"),
    ("CohesiveOrder", &[], "--seeds 3 --cohesive --order 2 -o a.inp", &[], "--seeds 3 -o a.vtp"),
    ("CohesiveDeck", &[], "--seeds 3 --cohesive --solver-deck tension-x -o a.inp", &[], "--seeds 3 -o a.vtp"),
    (
        "DeckDomain",
        &[],
        "--seeds 3 --domain sphere --solver-deck tension-x -o a.inp",
        &[],
        "--seeds 3 --domain sphere -o a.vtp",
    ),
    ("NoTexture", &[], "--seeds 2 -o a.ori", &[], "--seeds 2 -o a.ori --texture random"),
    (
        "BadLine, no orientation",
        &[("t.csv", "# nothing\n")],
        "--seeds 2 --texture t.csv",
        &[("t.csv", "1,2,3\n")],
        "--seeds 2 --texture t.csv",
    ),
    (
        "BadLine, no diameters",
        &[("d.csv", "diameter\n")],
        "--seeds 2 --diameters d.csv",
        &[("d.csv", "diameter\n1\n")],
        "--seeds 2 --diameters d.csv",
    ),
    (
        "InsideError::NothingDivided",
        &[],
        "--seeds 5 --inside lamellae(width=9)",
        &[],
        "--seeds 5 --inside lamellae(width=0.57)",
    ),
    (
        "VoxelsExceedMemory",
        &[],
        "--seeds 2 --voxels 65536 65536 65536 -o a.inp",
        &[],
        "--seeds 2 --voxels 9 9 9 -o a.inp",
    ),
    (
        "PartsExceedMemory",
        &[],
        "--seeds 5 --inside lamellae(width=1e-12)",
        &[],
        "--seeds 5 --inside lamellae(width=0.05)",
    ),
    ("GrainTooLarge", &[], "--diameters uniform(0.5,1.1)", &[], "--diameters uniform(0.5,1.1,to=1)"),
    (
        "GrainTooLarge",
        &[],
        "--phase a:0.9,diameters=equal(0.2) --phase b:0.1,diameters=equal(0.7)",
        &[],
        "--phase a:0.9,diameters=equal(0.2) --phase b:0.1,diameters=equal(0.575)",
    ),
    (
        "PhasesError::FewGrains",
        &[],
        "--seeds 1 --phase a:0.5 --phase b:0.5",
        &[],
        "--seeds 2 --phase a:0.5 --phase b:0.5",
    ),
    ("GrainTooLarge", &[], "--diameters uniform(0.5,1.1)", &[], "--diameters uniform(0.5,1.1) --box 2 2 2"),
    (
        "VolumeCount",
        &[SEEDS, ("v.csv", "1\n2\n3\n")],
        "--seeds-file s.csv --volumes v.csv",
        &[("v.csv", "1\n2\n")],
        "--seeds-file s.csv --volumes v.csv",
    ),
    ("UnknownExtension", &[], "--seeds 2 -o a.xyz", &[], "--seeds 2 -o a.vtp"),
    ("FormatDimension", &[], "--seeds 2 --dim 2 -o a.stl", &[], "--seeds 2 --dim 2 -o a.vtp"),
    ("FormatDimension", &[], "--seeds 2 -o a.ang --voxels 2 2 2", &[], "--seeds 2 -o a.vtp"),
    ("NoVoxels", &[], "--seeds 2 -o a.vti", &[], "--seeds 2 -o a.vti --voxels 2 3 4"),
    ("NoVoxels", &[], "--seeds 2 --dim 2 -o a.vti", &[], "--seeds 2 --dim 2 -o a.vti --voxels 2 3"),
    ("FormatSeveralFiles", &[], "--seeds 2 -o - --format vtm", &[], "--seeds 2 -o - --format vtp"),
    ("FormatSeveralFiles", &[], "--seeds 2 -o - --format vtm", &[], "--seeds 2 -o a.vtm"),
    ("NoOutputDirectory", &[], "--seeds 2 -o no/a.vtp", &[("no/", "")], "--seeds 2 -o no/a.vtp"),
    ("OutputNotAFile", &[("a.vtp/", "")], "--seeds 2 -o a.vtp", &[], "--seeds 2 -o b.vtp"),
    (
        "OutputDirectoryTaken",
        &[("d/", ""), ("d/f", "")],
        "--seeds 2 -o a.vtp --grains-dir d",
        &[],
        "--seeds 2 -o a.vtp --grains-dir e",
    ),
    ("Unreadable", &[], "--seeds-file s.csv", &[SEEDS], "--seeds-file s.csv"),
    ("Unreadable", &[], "--seeds 2 --half-spaces h.csv", &[PYRAMID], "--seeds 2 --half-spaces h.csv"),
    (
        "NoLatticeSeeds",
        &[OCTAHEDRON],
        "--half-spaces h.csv --lattice bcc 1",
        &[],
        "--half-spaces h.csv --lattice bcc 4",
    ),
    ("NoSeedsInFile", &[("s.csv", "x,y,z\n")], "--seeds-file s.csv", &[SEEDS], "--seeds-file s.csv"),
    (
        "SeedProblem::ColumnNames",
        &[("s.csv", "y,x,height\n.1,.2,.3\n")],
        "--seeds-file s.csv",
        &[("s.csv", "y,x,z\n.1,.2,.3\n")],
        "--seeds-file s.csv",
    ),
    (
        "SeedProblem::ColumnCount",
        &[("s.csv", "1,.1,.2,.3,9\n")],
        "--seeds-file s.csv",
        &[("s.csv", "id,x,y,z,age\n1,.1,.2,.3,9\n")],
        "--seeds-file s.csv",
    ),
    (
        "SeedProblem::UnequalColumns",
        &[("s.csv", ".1,.2,.3\n.5,.6,.7,.1\n")],
        "--seeds-file s.csv",
        &[("s.csv", ".1,.2,.3,.1\n.5,.6,.7,.1\n")],
        "--seeds-file s.csv",
    ),
    (
        "SeedProblem::OpenQuote",
        &[("s.csv", "x,y,z,n\n.1,.2,.3,\"a\n.5,.6,.7,b\n")],
        "--seeds-file s.csv",
        &[("s.csv", "x,y,z,n\n.1,.2,.3,\"a\"\n.5,.6,.7,b\n")],
        "--seeds-file s.csv",
    ),
    (
        "SeedProblem::NamedTwice, SizedTwice",
        &[("s.csv", "x,y,z,x\n.1,.2,.3,.4\n")],
        "--seeds-file s.csv",
        &[("s.csv", "x,y,z,old\n.1,.2,.3,.4\n")],
        "--seeds-file s.csv",
    ),
    (
        "SeedProblem::NamedTwice, SizedTwice",
        &[("s.csv", "x,y,z,radius,diameter\n.1,.2,.3,.1,.2\n")],
        "--seeds-file s.csv",
        &[("s.csv", "x,y,z,radius,width\n.1,.2,.3,.1,.2\n")],
        "--seeds-file s.csv",
    ),
    (
        "SeedProblem::NotANumber",
        &[("s.csv", ".1,.2,.3\n.1,half,.5\n")],
        "--seeds-file s.csv",
        &[("s.csv", ".1,.2,.3\n.1,0.5,.5\n")],
        "--seeds-file s.csv",
    ),
    (
        "SeedProblem::NotFinite",
        &[("s.csv", ".1,.2,.3\n.1,inf,.5\n")],
        "--seeds-file s.csv",
        &[("s.csv", ".1,.2,.3\n")],
        "--seeds-file s.csv",
    ),
    (
        "SeedProblem::NegativeRadius",
        &[("s.csv", ".1,.2,.3,-.1\n")],
        "--seeds-file s.csv",
        &[("s.csv", ".1,.2,.3,0\n")],
        "--seeds-file s.csv",
    ),
    (
        "SeedProblem::NegativeDiameter",
        &[("s.csv", "x,y,z,diameter\n.1,.2,.3,-.1\n")],
        "--seeds-file s.csv",
        &[("s.csv", "x,y,z,diameter\n.1,.2,.3,0\n")],
        "--seeds-file s.csv",
    ),
    (
        "SeedProblem::Tess, of other cells",
        &[("a.tess", OTHER_CELLS)],
        "--seeds-file a.tess",
        &[("a.tess", TESS)],
        "--seeds-file a.tess",
    ),
    (
        "SeedProblem::Tess, of the domain",
        &[("a.tess", ROUND)],
        "--seeds-file a.tess",
        &[("a.tess", TESS)],
        "--seeds-file a.tess",
    ),
    (
        "SeedProblem::BadId",
        &[("s.csv", "id,x,y,z\nA7,.1,.2,.3\n")],
        "--seeds-file s.csv",
        &[("s.csv", "name,x,y,z\nA7,.1,.2,.3\n")],
        "--seeds-file s.csv",
    ),
    (
        "SeedProblem::IdTwice, NoId",
        &[("s.csv", "id,x,y,z\n7,.1,.2,.3\n7,.5,.5,.5\n")],
        "--seeds-file s.csv",
        &[("s.csv", "id,x,y,z\n7,.1,.2,.3\n8,.5,.5,.5\n")],
        "--seeds-file s.csv",
    ),
    (
        "SeedProblem::IdTwice, NoId",
        &[("s.csv", "id,x,y,z\n7,.1,.2,.3\n7,.5,.5,.5\n")],
        "--seeds-file s.csv",
        &[("s.csv", "kind,x,y,z\n7,.1,.2,.3\n7,.5,.5,.5\n")],
        "--seeds-file s.csv",
    ),
    (
        "SeedProblem::EmptyId",
        &[("s.csv", "id,x,y,z\n7,.1,.2,.3\n,.5,.5,.5\n")],
        "--seeds-file s.csv",
        &[("s.csv", "id,x,y,z\n7,.1,.2,.3\n0,.5,.5,.5\n")],
        "--seeds-file s.csv",
    ),
    ("SeedProblem::NotInPlane", &[SEEDS], "--dim 2 --seeds-file s.csv", &[], "--seeds-file s.csv"),
    (
        "SeedProblem::NotInPlane",
        &[SEEDS],
        "--dim 2 --seeds-file s.csv",
        &[("s.csv", "x,y,radius\n0.1,0.2,0.3\n0.7,0.6,0.5\n")],
        "--dim 2 --seeds-file s.csv",
    ),
    (
        "HalfSpaceInFile",
        &[("h.csv", "0,0,0,1\n")],
        "--seeds 2 --half-spaces h.csv",
        &[PYRAMID],
        "--seeds 2 --half-spaces h.csv",
    ),
    ("OutsideDomain", &[("s.csv", ".1,.2,3\n")], "--seeds-file s.csv", &[], "--seeds-file s.csv --box 1 1 4"),
    (
        "DuplicateSeedsInFile",
        &[("s.csv", ".1,.2,.3\n.5,.5,.5\n.1,.2,.3\n")],
        "--seeds-file s.csv",
        &[("s.csv", ".1,.2,.3\n.5,.5,.5\n")],
        "--seeds-file s.csv",
    ),
    (
        "EmptyGrains",
        &[("s.csv", ".5,.5,.5,.4\n.5,.5,.6,0\n.1,.1,.1,0\n")],
        "--seeds-file s.csv",
        &[],
        "--seeds-file s.csv --drop-empty",
    ),
    (
        "EmptyGrains",
        &[("s.csv", ".5,.5,.5,.4\n.5,.5,.6,0\n.1,.1,.1,0\n")],
        "--seeds-file s.csv",
        &[("s.csv", ".5,.5,.5,.1\n.5,.5,.6,.1\n.1,.1,.1,0\n")],
        "--seeds-file s.csv",
    ),
    (
        "UnboundedDomain",
        &[("h.csv", "0,0,-1,0\n1,0,0,1\n-1,0,0,0\n0,1,0,1\n0,-1,0,0\n")],
        "--seeds 2 --half-spaces h.csv",
        &[("h.csv", "0,0,-1,0\n1,0,0,1\n-1,0,0,0\n0,1,0,1\n0,-1,0,0\n0,0,1,1\n")],
        "--seeds 2 --half-spaces h.csv",
    ),
    (
        "EmptyDomain",
        &[("h.csv", "0,0,-1,0\n0,0,1,-1\n1,0,1,1\n-1,0,1,0\n0,1,1,1\n0,-1,1,0\n")],
        "--seeds 2 --half-spaces h.csv",
        &[("h.csv", "0,0,-1,0\n0,0,1,0.2\n1,0,1,1\n-1,0,1,0\n0,1,1,1\n0,-1,1,0\n")],
        "--seeds 2 --half-spaces h.csv",
    ),
    (
        "BadDomain",
        &[("h.csv", "1,0,0,1e-40\n0,1,0,1e-40\n0,0,1,1e-40\n-1,-1,-1,0\n")],
        "--seeds 2 --half-spaces h.csv",
        &[("h.csv", "1,0,0,1e-29\n0,1,0,1e-29\n0,0,1,1e-29\n-1,-1,-1,0\n")],
        "--seeds 2 --half-spaces h.csv",
    ),
    (
        "FlatDomain",
        &[("h.csv", "1,0,0,1\n-1,0,0,0\n0,1,0,1\n0,-1,0,0\n0,0,1,0\n0,0,-1,0\n")],
        "--seeds 2 --half-spaces h.csv",
        &[("h.csv", "1,0,0,1\n-1,0,0,0\n0,1,0,1\n0,-1,0,0\n0,0,1,0.5\n0,0,-1,0\n")],
        "--seeds 2 --half-spaces h.csv",
    ),
    (
        "TooManyWalls",
        &[],
        "--seeds 2 --domain sphere --chord-error 1e-9",
        &[],
        "--seeds 2 --domain sphere --chord-error 0.05",
    ),
    (
        "CellsExceedMemory",
        &[],
        "--seeds 4000000000 --no-mesh --cells-csv c.csv",
        &[],
        "--seeds 4 --no-mesh --cells-csv c.csv",
    ),
    (
        "TouchesItself",
        &[],
        "--lattice fcc 1 --periodic x,y,z --periodic-cut box",
        &[],
        "--lattice fcc 1 --periodic x,y,z",
    ),
    (
        "TouchesItself",
        &[],
        "--lattice fcc 1 --periodic x,y,z --periodic-cut box",
        &[],
        "--lattice fcc 2 --periodic x,y,z --periodic-cut box",
    ),
];

#[test]
fn text_in_another_encoding_is_read_once_it_is_saved_as_utf8() {
    let workplace = Workplace::new();
    workplace.put("s.csv", b"# K\xf6rner\nx,y,z,Gr\xf6\xdfe\n.1,.2,.3,4\n");
    let arguments = "--seeds-file s.csv -n 0 --relax 0";
    let message = "s.csv line 2: not UTF-8 text; save the file as UTF-8";
    workplace.refuses(arguments, FAILED, message);
    workplace.put("s.csv", "# Körner\nx,y,z,Größe\n.1,.2,.3,4\n");
    workplace.run(arguments);
}

#[test]
fn a_read_only_result_is_replaced_once_that_is_allowed() {
    let workplace = Workplace::new();
    let path = workplace.path("grains.vtp");
    let set_read_only = |is_read_only: bool| {
        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(is_read_only);
        fs::set_permissions(&path, permissions).unwrap();
    };
    set_read_only(true);
    let arguments = "--seeds 2 -n 0 --relax 0";
    let message = "grains.vtp: cannot be written: the present file is read-only; make it writable or choose another path";
    workplace.refuses(arguments, FAILED, message);
    workplace.run(&format!("{arguments} -o other.vtp"));
    set_read_only(false);
    workplace.run(arguments);
}

/// The number of levels that would fit in memory does.
#[test]
fn as_many_levels_fit_as_the_message_says() {
    let workplace = Workplace::new();
    let arguments = |levels: &str| format!("--seeds 20 --relax 0 --dry-run -n {levels}");
    let said = workplace.command(&arguments("40")).assert().failure().get_output().stderr.clone();
    let said = String::from_utf8(said).unwrap();
    assert_eq!(refusal(&said), Some("LevelsExceedMemory"), "{said}");
    let (start, _) = said.split_once(" levels would fit").unwrap();
    let levels: u32 = start.rsplit_once(' ').unwrap().1.parse().unwrap();
    assert!(levels > 1, "{said}");
    // What is available changes while other programs run.
    workplace.command(&arguments(&(levels - 1).to_string())).assert().success();
}

/// For each kind of refusal that the campaign knows.
#[test]
fn what_messages_advise_helps() {
    let cut_tess = TESS.replacen(
        "   7 1.000000000000 1.000000000000 1.000000000000",
        "   7 1.000000000000 1.000000000000 0.500000000000",
        1,
    );
    let round_tess = TESS.replacen("\n   cube", "\n   sphere", 1);
    let mut wrong = Vec::new();
    for (kind, files, refused, mended_files, mended) in REMEDIES {
        let workplace = Workplace::new();
        let put = |files: &[File]| {
            for (name, content) in files {
                match name.strip_suffix('/') {
                    Some(name) => fs::create_dir(workplace.path(name)).unwrap(),
                    None if *content == OTHER_CELLS => workplace.put(name, &cut_tess),
                    None if *content == ROUND => workplace.put(name, &round_tess),
                    None => workplace.put(name, content),
                }
            }
        };
        put(files);
        let said = |output: &Output| String::from_utf8(output.stderr.clone()).unwrap();
        let quick = |arguments: &str| format!("{arguments} -n 0 --relax 0");
        let output = workplace.command(&quick(refused)).output().unwrap();
        // What holds the words of two kinds counts as the first of them.
        let is_kind = |(name, words): &&(&str, &[&str])| {
            name == kind && words.iter().all(|word| said(&output).contains(word))
        };
        if output.status.success() || !REFUSALS.iter().any(|row| is_kind(&row)) {
            wrong.push(format!("{refused} is not refused as {kind}: {}", said(&output)));
        }
        put(mended_files);
        let output = workplace.command(&quick(mended)).output().unwrap();
        if !output.status.success() {
            wrong.push(format!("{kind}: {mended}: {}", said(&output)));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    for (kind, _) in REFUSALS {
        let tried = REMEDIES.iter().any(|remedy| remedy.0 == *kind);
        let elsewhere = BEYOND.contains(kind)
            || NOT_HERE.contains(kind)
            || map_remedies::kinds().any(|of_maps| of_maps == *kind);
        assert!(tried != elsewhere, "{kind}");
    }
}
