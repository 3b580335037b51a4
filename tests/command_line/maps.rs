//! `grainsmooth smooth`: networks of measured maps.

use std::collections::BTreeMap;
use std::path::Path;

use grainsmooth::{MapOptions, read_map};

use crate::programs;
use crate::surface_file::SurfaceFile;
use crate::workplace::{FAILED, USAGE, Workplace};

/// The voxels of each grain of the maps in `tests/data/maps`, and of their pore.
const COUNTS: [f64; 10] = [27.0, 1217.0, 901.0, 2422.0, 166.0, 70.0, 87.0, 2535.0, 251.0, 4.0];

/// The forms of that map, what reads them, and the volume of a voxel as the file tells it.
const FORMS: [(&str, &str, f64); 10] = [
    ("volume_damask.vti", "", 0.2),
    ("volume_points.vti", "", 0.2),
    ("volume.npy", "", 1.0),
    ("volume_zyx_c.npy", "--axes zyx", 1.0),
    ("volume.raw", "--shape 24 20 16 --type u16", 1.0),
    ("volume.nrrd", "", 0.2),
    // These take their numbers from `volume.raw`.
    ("volume.nhdr", "", 0.2),
    ("volume.mhd", "", 0.2),
    ("volume_raw.tesr", "", 0.2),
    ("volume.tesr", "", 0.2),
];

fn workplace() -> Workplace {
    let workplace = Workplace::new();
    for (name, ..) in FORMS {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/maps").join(name);
        workplace.put(name, std::fs::read(path).unwrap());
    }
    workplace
}

/// An array of whole numbers as NumPy writes it, the last index fastest.
pub fn npy(shape: &[usize], labels: &[u8]) -> Vec<u8> {
    campaign::npy(shape, labels, false)
}

#[test]
fn every_form_of_a_map_gives_grains_of_exact_volume() {
    let workplace = workplace();
    for (name, options, voxel) in FORMS {
        let said =
            workplace.run(&format!("smooth {name} {options} --exterior-label 0 -o a.vtp --stats a.json"));
        assert!(said.contains("\nmap         24 x 20 x 16 voxels\n"), "{said}");
        assert!(said.contains("validation  good: every grain closed, nothing crossed or folded"), "{said}");
        workplace.command("check a.vtp").assert().success();
        let statistics = workplace.json("a.json");
        let grains = statistics["grains"].as_array().unwrap();
        assert_eq!(grains.len(), 9);
        for (grain, count) in grains.iter().zip(&COUNTS[1..]) {
            let volume = grain["volume"].as_f64().unwrap();
            assert!((volume / (voxel * count) - 1.0).abs() < 1e-12, "{name}: {grain}");
        }
        // The map's own labels.
        let ids: Vec<_> = grains.iter().map(|grain| grain["SeedId"].as_u64().unwrap()).collect();
        assert_eq!(ids, (1..10).collect::<Vec<_>>());
    }
}

#[test]
fn voxels_of_the_network_are_those_of_the_map() {
    let workplace = workplace();
    let raw = "smooth volume.raw --shape 24 20 16 --type u16";
    workplace.run(&format!("{raw} --decimate 0 --voxels 24 20 16 -o a.npy -o a.vti -o a.vtp"));
    let given = workplace.bytes("volume.raw");
    let made = workplace.bytes("a.npy")[128..].to_vec();
    let given: Vec<i32> =
        given.chunks_exact(2).map(|label| i32::from(u16::from_le_bytes([label[0], label[1]]))).collect();
    let made = made.chunks_exact(4).take(given.len());
    let made: Vec<i32> = made.map(|label| i32::from_le_bytes(label.try_into().unwrap())).collect();
    assert!(given == made);
    // What was written is read again.
    workplace.run("smooth a.vti --decimate 0 -o b.vtp");
    let [first, second] = ["a.vtp", "b.vtp"].map(|name| SurfaceFile::read(&workplace.path(name)));
    assert!((first.points, first.cells) == (second.points, second.cells));
}

#[test]
fn voxels_of_a_pore_are_in_no_grain() {
    let workplace = workplace();
    workplace.run("smooth volume_damask.vti --exterior-label 0 --decimate 0 --voxels 24 20 16 -o a.npy");
    let made = workplace.bytes("a.npy")[128..].to_vec();
    let (made, _) = made.as_chunks();
    let mut counts = BTreeMap::new();
    made[..7680].iter().for_each(|label| *counts.entry(i32::from_le_bytes(*label)).or_insert(0.0) += 1.0);
    assert_eq!(counts.into_values().collect::<Vec<_>>(), COUNTS);
}

#[test]
fn the_surface_of_a_pore_is_named_as_the_outer_one() {
    let workplace = workplace();
    workplace.run("smooth volume_damask.vti --exterior-label 0 --names dream3d -o a.vtp");
    let file = SurfaceFile::read(&workplace.path("a.vtp"));
    // Those of DREAM.3D put the exterior first.
    assert!(file.face_labels.iter().any(|[first, _]| *first == -1));
    assert!(file.face_labels.iter().all(|[_, second]| *second > 0));
}

/// The surface of a pore and the side of the box that it reaches lie between the same grain and nothing.
#[test]
fn surfaces_of_pores_and_sides_of_the_box_are_no_folds() {
    let workplace = Workplace::new();
    let label = |[x, y, z]: [u32; 3]| if (3..8).contains(&x) && (3..8).contains(&y) && z < 4 { 0 } else { 1 };
    let voxels = (0..12 * 12 * 12).map(|at| label([at / 144, at / 12 % 12, at % 12]));
    workplace.put("pore.npy", npy(&[12, 12, 12], &voxels.collect::<Vec<_>>()));
    workplace.run("smooth pore.npy --exterior-label 0 -o a.vtp");
    workplace.command("check a.vtp").assert().success();
}

#[test]
fn short_edges_collapse_unless_told_otherwise() {
    let workplace = workplace();
    let triangles = |options: &str| {
        workplace
            .run(&format!("smooth volume_damask.vti --exterior-label 0 {options} -o a.vtp --stats a.json"));
        workplace.command("check a.vtp").assert().success();
        let statistics = workplace.json("a.json");
        for (grain, count) in statistics["grains"].as_array().unwrap().iter().zip(&COUNTS[1..]) {
            assert!(
                (grain["volume"].as_f64().unwrap() / (0.2 * count) - 1.0).abs() < 1e-12,
                "{options}: {grain}"
            );
        }
        SurfaceFile::read(&workplace.path("a.vtp")).cells
    };
    let [all, usual, same, three] = ["--decimate 0", "", "--decimate 1.68", "--decimate 3"].map(triangles);
    assert!(usual == same);
    assert!(
        three.len() < usual.len() && 3 * usual.len() < all.len(),
        "{}, {}, {}",
        all.len(),
        usual.len(),
        three.len()
    );
}

#[test]
fn a_map_stands_where_its_file_says() {
    let workplace = workplace();
    // Offsets of MetaImage are those of the middle of the first voxel.
    for (name, domain) in [
        ("volume.tesr", "[1, 13] x [2, 12] x [-3, 9.8]"),
        ("volume.mhd", "[0.75, 12.75] x [1.75, 11.75] x [-3.4, 9.4]"),
        ("volume.nrrd", "[0, 12] x [0, 10] x [0, 12.8]"),
    ] {
        let said = workplace.run(&format!("smooth {name} -o a.vtp"));
        assert!(said.contains(&format!(" in {domain}\n")), "{name}: {said}");
    }
}

#[test]
fn images_of_vtk_are_read() {
    let workplace = workplace();
    // Offset, compressed or not, in one file or two.
    let program = r#"
import vtk
reader = vtk.vtkXMLImageDataReader()
reader.SetFileName("volume_points.vti")
for name, compression in [("a.mha", 0), ("b.mha", 1), ("c.mhd", 0), ("d.mhd", 1)]:
    writer = vtk.vtkMetaImageWriter()
    writer.SetInputConnection(reader.GetOutputPort())
    writer.SetFileName(name)
    writer.SetCompression(compression)
    writer.Write()
"#;
    let mut python = std::process::Command::new("python3");
    python.args(["-c", program]).current_dir(workplace.path(""));
    let Some(output) = programs::run("images_of_vtk_are_read", &mut python) else { return };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let options = MapOptions::default();
    let read = |name: &str| read_map(&workplace.path(name), &options).unwrap();
    let expected = read("volume_points.vti");
    for name in ["a.mha", "b.mha", "c.mhd", "d.mhd"] {
        let found = read(name);
        assert!(found.map.labels == expected.map.labels, "{name}");
        assert_eq!(found.map.shape, expected.map.shape, "{name}");
        assert!((found.map.origin - expected.map.origin).length() < 1e-12, "{name}: {}", found.map.origin);
        assert!((found.map.spacing - expected.map.spacing).length() < 1e-12, "{name}");
    }
}

#[test]
fn pixels_give_lines() {
    let workplace = Workplace::new();
    let labels: Vec<u8> = (0..20 * 15).map(|pixel| u8::from(pixel / 15 > pixel % 15)).collect();
    workplace.put("map.npy", npy(&[20, 15], &labels));
    let said = workplace.run(
        "smooth map.npy --spacing 0.5 0.25 -o a.vtp --picture a.png --picture-size 200 200 --report a.html",
    );
    assert!(said.contains("map         20 x 15 pixels\n"), "{said}");
    assert!(said.starts_with("grains      2 in [0, 10] x [0, 3.75]\n"), "{said}");
    workplace.command("check a.vtp").assert().success();
    // Between the two grains, and around them.
    assert_eq!(SurfaceFile::read(&workplace.path("a.vtp")).boundary_count(), 7);
}

#[test]
fn every_format_takes_the_network_of_a_map() {
    let workplace = workplace();
    let formats = ["vtp", "vtu", "vtk", "vtm", "obj", "ply", "stl", "msh", "fe"];
    let outputs: String = formats.map(|format| format!(" -o a.{format}")).concat();
    workplace.run(&format!("smooth volume_damask.vti{outputs} --grains-dir grains --json-summary a.txt"));
    let summary = workplace.json("a.txt");
    assert_eq!(summary["grains"], 10);
    assert_eq!(summary["regularization"], serde_json::Value::Null);
    for format in formats {
        assert!(!workplace.bytes(&format!("a.{format}")).is_empty(), "{format}");
    }
    let command =
        format!("grainsmooth smooth volume_damask.vti{outputs} --grains-dir grains --json-summary a.txt");
    for format in ["vtp", "obj", "ply", "fe"] {
        let text = String::from_utf8_lossy(&workplace.bytes(&format!("a.{format}"))).into_owned();
        assert!(text.contains(&command), "{format} does not tell how it was made");
    }
}

#[test]
fn grains_of_a_map_that_repeats_are_whole() {
    let workplace = Workplace::new();
    let labels = |name: &str| workplace.bytes(name)[128..128 + 4 * 600].to_vec();
    for (dimension, axes, voxels) in [
        ("", "x,y,z", "18 20 16"),
        ("", "y", "18 20 16"),
        ("--dim 2", "x,y", "30 20"),
        ("--dim 2", "x", "30 20"),
    ] {
        let synthetic = format!(
            "--seeds 20 --seeding poisson-disc {dimension} --periodic {axes} --relax 0 --voxels {voxels} -o a.npy"
        );
        workplace.run(&synthetic);
        let said = workplace
            .run(&format!("smooth a.npy --periodic {axes} --decimate 0 --voxels {voxels} -o b.npy -o b.vtp"));
        assert!(said.contains("one period apart"), "{said}");
        assert!(labels("a.npy") == labels("b.npy"), "{axes}");
        workplace.run(&format!("smooth a.npy --periodic {axes} --relax 0.02 -o c.vtp"));
        let good = workplace.command("check c.vtp").assert().success().get_output().clone();
        let said = String::from_utf8(good.stdout).unwrap();
        assert_eq!(said.matches("20 grains").count(), 1, "{said}");
    }
    for (axes, message) in [
        (
            "x,y,z",
            "a.npy: is a map of pixels, which does not repeat along z; give x, y or x,y with --periodic",
        ),
        (
            "x,y",
            "a.npy: grain 0 meets its own image through the sides of the box, so it has no end; leave out the axes along which it does, or take a larger map",
        ),
    ] {
        workplace.put("a.npy", npy(&[4, 3], &[0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1]));
        workplace.refuses(&format!("smooth a.npy --periodic {axes}"), FAILED, message);
    }
    workplace.refuses(
        "check b.vtp --labels a.npy --periodic x",
        FAILED,
        "a.npy: is taken to repeat, and the network does not so; leave --periodic out, or give the axes with which the network was made",
    );
}

/// Of a power diagram, voxels tell volumes and centroids well enough to find it again.
#[test]
fn cells_fitted_to_the_voxels_of_cells_are_these() {
    let workplace = Workplace::new();
    for (dimension, voxels, periodic) in [
        ("", "32 24 20", ""),
        ("--dim 2 --box 3 2", "90 60", ""),
        ("--periodic x,y,z", "32 32 32", "--periodic x,y,z"),
        ("--dim 2 --periodic y", "64 64", "--periodic y"),
    ] {
        workplace.run(&format!("--seeds 20 {dimension} --relax 0 -n 0 --voxels {voxels} -o a.vti"));
        let said =
            workplace.run(&format!("smooth a.vti {periodic} --fit-cells -o b.vtp --json-summary a.txt"));
        assert!(said.contains("validation  good"), "{said}");
        workplace.command("check b.vtp").assert().success();
        let summary = workplace.json("a.txt");
        let number = |key: &str| summary["fitted_cells"][key].as_f64().unwrap();
        let share = number("agreeing_voxels") / number("voxels");
        assert!(share > 0.98 && number("centroid_distance") < 0.01, "{share}: {said}");
        // The network's own voxels count the same.
        let mut check = workplace.command(&format!("check b.vtp --labels a.vti {periodic} --json"));
        let said = check.assert().success();
        let report: serde_json::Value = serde_json::from_slice(&said.get_output().stdout).unwrap();
        let map = &report["files"][0]["map"];
        let differing = map["differing_voxels"].as_f64().unwrap();
        assert_eq!(number("voxels") - number("agreeing_voxels"), differing);
        assert!(map["largest_volume_error"].as_f64().unwrap() < 1e-9, "{map}");
    }
    workplace.put("pore.npy", npy(&[4, 3], &[0, 0, 0, 1, 1, 1, 2, 2, 2, 2, 2, 2]));
    workplace.refuses(
        "smooth pore.npy --exterior-label 0 --fit-cells",
        FAILED,
        "pore.npy: has voxels without a grain, and cells fill a box; crop the map to its grains, or leave --fit-cells out",
    );
}

#[test]
fn parts_of_a_label_are_one_grain_or_several() {
    let workplace = Workplace::new();
    // Label 1 at both ends, and in one pixel of the middle.
    let label = |[x, y]: [usize; 2]| if !(3..9).contains(&x) || [x, y] == [6, 4] { 1 } else { 2 };
    let labels: Vec<u8> = (0..12 * 8).map(|pixel| label([pixel / 8, pixel % 8])).collect();
    workplace.put("map.npy", npy(&[12, 8], &labels));
    for (options, ids, dropped) in [
        ("--parts keep --min-voxels 2", &[1, 2][..], ""),
        ("--parts split", &[1, 1, 1, 2], ""),
        ("--parts split --min-voxels 2", &[1, 1, 2], "; 1 in 1 small grain went to neighbours"),
        // Both ends are one.
        ("--parts split --min-voxels 2 --periodic x", &[1, 2], "; 1 in 1 small grain went to neighbours"),
    ] {
        let said = workplace.run(&format!("smooth map.npy {options} -o a.vtp --stats a.json"));
        assert!(said.contains(&format!("map         12 x 8 pixels{dropped}\n")), "{said}");
        let statistics = workplace.json("a.json");
        let grains = statistics["grains"].as_array().unwrap();
        let found: Vec<_> = grains.iter().map(|grain| grain["SeedId"].as_u64().unwrap()).collect();
        assert_eq!(found, ids, "{options}");
        if !options.contains("periodic") {
            let check = format!("check a.vtp --labels map.npy {options}");
            let said = workplace.command(&check).assert().success().get_output().stdout.clone();
            let said = String::from_utf8(said).unwrap();
            assert!(
                said.contains("the centres of all 96 voxels lie in the grains of their labels"),
                "{said}"
            );
        }
    }
}

#[test]
fn small_grains_go_to_their_neighbours() {
    let workplace = workplace();
    let said = workplace.run("smooth volume.npy --min-voxels 80 -o a.vtp --stats a.json");
    assert!(
        said.contains("map         24 x 20 x 16 voxels; 101 in 3 small grains went to neighbours\n"),
        "{said}"
    );
    let statistics = workplace.json("a.json");
    let grains = statistics["grains"].as_array().unwrap();
    let volumes: BTreeMap<u64, f64> = grains
        .iter()
        .map(|grain| (grain["SeedId"].as_u64().unwrap(), grain["volume"].as_f64().unwrap()))
        .collect();
    assert_eq!(volumes.keys().copied().collect::<Vec<_>>(), [1, 2, 3, 4, 6, 7, 8]);
    assert!((volumes.values().sum::<f64>() / 7680.0 - 1.0).abs() < 1e-12);
    assert!(volumes.iter().all(|(label, volume)| *volume > COUNTS[usize::try_from(*label).unwrap()] - 0.5));
}

#[test]
fn a_part_of_a_map_stands_where_it_was() {
    let workplace = workplace();
    let said = workplace.run("smooth volume_damask.vti --crop 4:20,0:10,5:13 -o a.vtp");
    assert!(said.contains(" in [3, 11] x [2, 7] x [1, 7.4]\n"), "{said}");
    assert!(said.contains("map         16 x 10 x 8 voxels\n"), "{said}");
}

#[test]
fn maps_that_cannot_be_used() {
    let workplace = workplace();
    workplace.put("map.jpg", "");
    workplace.put("no.vti", "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 2 0 2 0 2\" Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece></Piece></ImageData></VTKFile>");
    let two = "<CellData><DataArray type=\"Int32\" Name=\"a\" format=\"ascii\">1 1 1 1 1 1 1 1</DataArray><DataArray type=\"Int32\" Name=\"b\" format=\"ascii\">1 1 1 1 1 1 1 2</DataArray></CellData>";
    let image = |data: &str, spacing: &str| {
        format!(
            "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\"><ImageData WholeExtent=\"0 2 0 2 0 2\" Origin=\"0 0 0\" Spacing=\"{spacing}\"><Piece>{data}</Piece></ImageData></VTKFile>"
        )
    };
    workplace.put("two.vti", image(two, "1 1 1"));
    workplace.put("thin.vti", image(two, "1 0 1"));
    let half = "<PointData></PointData><CellData><DataArray type=\"Float32\" Name=\"a\" format=\"ascii\">1 1 1 1 1.5 1 1 1</DataArray></CellData>";
    workplace.put("half.vti", image(half, "1 1 1"));
    workplace.put("short.npy", &npy(&[4, 3, 2], &[1; 24])[..140]);
    workplace.put("line.npy", npy(&[24], &[1; 24]));
    workplace.put("none.npy", npy(&[0, 3], &[]));
    let nrrd = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\n";
    workplace.put("few.nrrd", format!("{nrrd}\n1 1 1 1 2 2 2"));
    workplace
        .put("turned.nrrd", format!("{nrrd}space directions: (0,1,0) (1,0,0) (0,0,1)\n\n1 1 1 1 2 2 2 2"));
    workplace.put("many.nhdr", format!("{nrrd}data file: LIST\n"));
    let mhd = "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n";
    workplace.put("lost.mhd", format!("{mhd}ElementDataFile = lost.zraw\n"));
    workplace.put("colors.mhd", format!("{mhd}ElementNumberOfChannels = 3\nElementDataFile = LOCAL\n"));
    workplace.put("short.mha", format!("{mhd}ElementDataFile = LOCAL\n1234567"));
    let tesr = "***tesr\n **format 2.1\n **general 2 2 2 1 1\n **cell 1 *id 7\n **data";
    workplace.put("cells.tesr", format!("{tesr} ascii 1 1 0 2"));
    workplace.put("kind.tesr", format!("{tesr} binary64\n"));
    for (arguments, message) in [
        (
            "missing.vti",
            "missing.vti: cannot be read: No such file or directory (os error 2); give the path of a readable map",
        ),
        (
            "map.jpg",
            "map.jpg: unknown extension; give a map *.vti, *.npy, *.npz, *.nrrd, *.nhdr, *.mhd, *.mha, *.tesr, *.dream3d, *.h5, *.h5oina, *.h5ebsd, *.raw, *.tif, *.tiff, *.png, *.ang, *.ctf, *.cpr or *.crc",
        ),
        (
            "no.vti",
            "no.vti: has no array with one whole number for each voxel; save the labels of grains as one",
        ),
        ("two.vti", "two.vti: has several arrays that may be labels; choose one with --label-array: a, b"),
        (
            "two.vti --label-array c",
            "two.vti: has no array `c` with one number for each voxel; name one that it has: a, b",
        ),
        (
            "thin.vti --label-array a",
            "thin.vti: its voxels are 0 wide along y; give their size with --spacing, such as 0.5",
        ),
        (
            "half.vti",
            "half.vti: voxel 4 has the label 1.5; labels are whole numbers from -2147483648 to 2147483647",
        ),
        (
            "short.npy",
            "short.npy: it has too few bytes for [4, 3, 2] numbers of u8; give a complete NumPy file",
        ),
        ("few.nrrd", "few.nrrd: it has 7 numbers for 2 x 2 x 2 voxels; give a complete NRRD file"),
        ("turned.nrrd", "turned.nrrd: its axes are turned; sample the map again along x, y and z"),
        ("many.nhdr", "many.nhdr: its numbers are in several files; save them in one"),
        (
            "lost.mhd",
            "lost.mhd: its numbers are in `lost.zraw`, which cannot be read: No such file or directory (os error 2); put that file where the map says",
        ),
        ("colors.mhd", "colors.mhd: its voxels have several numbers each; save the labels of grains alone"),
        ("short.mha", "short.mha: it has 7 numbers for 2 x 2 x 2 voxels; give a complete MetaImage file"),
        (
            "cells.tesr",
            "cells.tesr: a voxel lies in cell 2, and its list of cells has 1; give a complete .tesr file",
        ),
        ("kind.tesr", "kind.tesr: the kind of its **data is not known; give a complete .tesr file"),
        ("line.npy", "line.npy: its array has 1 indices; a map has two or three"),
        ("none.npy", "none.npy: has no voxels along x; give a map with at least one along each axis"),
        (
            "volume.raw",
            "volume.raw: holds only numbers; describe them with --shape NX NY NZ and --type, such as u16",
        ),
        (
            "volume.raw --shape 24 20 15 --type u16",
            "volume.raw: has 15360 bytes; 7200 voxels of 2 bytes take 14400: correct --shape or --type",
        ),
        (
            "volume.npy --type u16",
            "volume.npy: files of this format contain their shape and type; leave --shape and --type out",
        ),
        (
            "volume_damask.vti --axes zyx",
            "volume_damask.vti: files of this format contain their order of axes; leave --axes out",
        ),
        (
            "volume.npy --crop 0:25,0:9,0:9",
            "volume.npy: has 24 voxels along x; --crop asks for 0:25; give a part of 0:24",
        ),
        (
            "volume.npy --min-voxels 3000",
            "volume.npy: has no grain of 3000 or more voxels besides the exterior; lower --min-voxels, or correct --exterior-label",
        ),
        (
            "volume.npy -o a.tess",
            "a.tess: this format holds convex cells, but grains of --grain-shapes, place= or a map are not convex; choose another, such as .vtp",
        ),
    ] {
        workplace.refuses(&format!("smooth {arguments}"), FAILED, message);
    }
    for (arguments, message) in [
        (
            "volume.npy --crop 5:5,0:1",
            "invalid value '5:5,0:1' for '--crop <X0:X1,Y0:Y1,Z0:Z1>': give the first voxel and the first one behind along each axis, as in 0:64,0:64,10:40",
        ),
        (
            "volume.npy --spacing 0",
            "invalid value '0' for '--spacing <DX> [DY] [DZ]': give a positive, finite length",
        ),
        (
            "volume.npy --decimate -1",
            "invalid value '-1' for '--decimate <H>': give a finite number of voxels, 0 or more",
        ),
        (
            "volume.npy --type f16",
            "invalid value 'f16' for '--type <TYPE>': the types are u8, i8, u16, i16, u32, i32, u64, i64, f32, f64",
        ),
        (
            "volume.npy --picture a.png --color-by ipf-z",
            "--color-by ipf-z needs orientations, which volume.npy does not hold; leave it out",
        ),
    ] {
        workplace.refuses(&format!("smooth {arguments}"), USAGE, message);
    }
}

#[test]
fn cells_of_a_tessellation_relax() {
    let workplace = Workplace::new();
    for how in ["--seeds 12", "--seeds 12 --dim 2", "--seeds 12 --periodic x,y,z --box 2 1 1"] {
        workplace.run(&format!("{how} --relax 0 -o cells.tess --stats before.json"));
        let said = workplace.run("smooth cells.tess --relax equilibrium -o relaxed.vtp --stats after.json");
        assert!(said.contains("validation  good: every grain closed, nothing crossed or folded"), "{said}");
        workplace.command("check relaxed.vtp").assert().success();
        let [before, after] = ["before.json", "after.json"].map(|name| {
            let statistics = workplace.json(name);
            let grains = statistics["grains"].as_array().unwrap().clone();
            let volume = |grain: &serde_json::Value| {
                let name = if how.contains("--dim 2") { "area" } else { "volume" };
                (grain["SeedId"].as_u64().unwrap(), grain[name].as_f64().unwrap())
            };
            grains.iter().map(volume).collect::<Vec<_>>()
        });
        for ((seed, volume), (same, kept)) in before.iter().zip(&after) {
            assert!(seed == same && (kept / volume - 1.0).abs() < 1e-9, "{how}, {seed}: {kept}, {volume}");
        }
    }
    workplace.put("cut.tess", &workplace.bytes("cells.tess")[..500]);
    workplace.command("smooth cut.tess --relax 0.1 -o cut.vtp").assert().failure();
    assert!(!workplace.path("cut.vtp").exists());
}

/// Two halves of a box: the layers of the report show the map, and the boundary in its middle.
#[test]
fn the_report_shows_map_and_network_side_by_side() {
    let workplace = Workplace::new();
    let labels: Vec<u8> = (0..8 * 4 * 4).map(|voxel| u8::from(voxel >= 64)).collect();
    workplace.put("map.npy", npy(&[8, 4, 4], &labels));
    workplace.run("smooth map.npy --decimate 0 -o a.vtp --report a.html");
    let page = String::from_utf8(workplace.bytes("a.html")).unwrap();
    let figures: Vec<&str> = page.split("<figure class=\"wide\">").skip(1).collect();
    assert_eq!(figures.len(), 3);
    for (figure, title) in figures.iter().zip(["across z", "across y", "across x"]) {
        assert!(figure.contains(&format!("Map and network {title}</text>")), "{figure}");
        let figure = figure.split("</figure>").next().unwrap();
        assert_eq!(figure.matches("href=\"data:image/png;base64,").count(), 2);
        let path = figure.split("class=\"boundary\" d=\"").nth(1).unwrap().split('"').next().unwrap();
        let numbers: Vec<f64> = path
            .split(['M', 'L', ' '])
            .filter(|word| !word.is_empty())
            .map(|word| word.parse().unwrap())
            .collect();
        // Inside, the boundary stands upright in the middle of 400; the others are sides of the box.
        let points = numbers.chunks(2);
        let inside =
            points.filter(|point| (1.0..399.0).contains(&point[0]) && (1.0..199.0).contains(&point[1]));
        let inside: Vec<&[f64]> = inside.collect();
        assert!(inside.iter().all(|point| title == "across x" || point[0] == 200.0), "{title}: {path}");
        assert_eq!(inside.is_empty(), title == "across x", "{title}: {path}");
    }
}
