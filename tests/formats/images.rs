//! Measured maps as images, written by Pillow: pages of TIFF, and folders of slices.

use std::path::Path;
use std::process::Command;

use glam::DVec3;
use grainsmooth::{MapOptions, read_map};

use crate::maps::refused_when_damaged;
use crate::programs::run;

const PROGRAM: &str = r#"
import os
import sys
import numpy as np
from PIL import Image
labels = np.load(sys.argv[1])  # labels[x, y, z]
pages = [np.ascontiguousarray(page.T) for page in np.moveaxis(labels, 2, 0)]  # page[y, x]
def save(name, images, **more):
    images[0].save(name, save_all=True, append_images=images[1:], **more)
of = lambda kind: [Image.fromarray(page.astype(kind)) for page in pages]
save("plain.tif", of(np.uint8))
save("lzw.tif", of(np.uint16), compression="tiff_lzw")
save("deflate.tiff", of(np.int32), compression="tiff_adobe_deflate")
save("packbits.tif", of(np.uint8), compression="packbits")
save("float.tif", of(np.float32))
save("big.tif", of(np.uint16), big_tiff=True)
imagej = f"ImageJ=1.54f\nimages={len(pages)}\nslices={len(pages)}\nunit=micron\nspacing=0.8\n"
save("imagej.tif", of(np.uint8), description=imagej, x_resolution=2.0, y_resolution=4.0)
save("behind.tif", of(np.uint8)[:1], description=imagej)
save("papers.tif", of(np.uint8)[:2] + [Image.new("L", (5, 4))])
Image.new("RGB", (5, 4)).save("colors.tif")
Image.new("RGB", (5, 4)).save("colors.png")
for folder in ["tiffs", "pngs", "uneven", "both", "none"]:
    os.mkdir(folder)
for z, (eight, sixteen) in enumerate(zip(of(np.uint8), of(np.uint16))):
    eight.save(f"tiffs/scan3_z{z}.tif")  # not in the order of names
    (sixteen if z % 2 else eight).save(f"pngs/{z:04}.png")
eight.save("both/1.png"); eight.save("both/2.tif"); eight.save("uneven/1.png")
Image.new("L", (5, 4)).save("uneven/2.png")
open("pngs/notes.txt", "w").close()
"#;

fn images(test: &str) -> Option<tempfile::TempDir> {
    let folder = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/maps/volume.npy");
    let mut python = Command::new("python3");
    let output = run(test, python.args(["-c", PROGRAM]).arg(data).current_dir(folder.path()))?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(folder)
}

#[test]
fn stacks_of_images_hold_the_labels_of_the_array() {
    let Some(folder) = images("stacks_of_images_hold_the_labels_of_the_array") else { return };
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/maps/volume.npy");
    let options = MapOptions { exterior_label: Some(0), ..MapOptions::default() };
    let expected = read_map(&data, &options).unwrap();
    let stacks = [
        "plain.tif",
        "lzw.tif",
        "deflate.tiff",
        "packbits.tif",
        "float.tif",
        "big.tif",
        "imagej.tif",
        "tiffs",
        "pngs",
    ];
    for name in stacks {
        let found = read_map(&folder.path().join(name), &options).unwrap();
        assert_eq!(found.map.shape, [24, 20, 16], "{name}");
        assert!(found.map.labels == expected.map.labels, "{name}");
        let spacing = if name == "imagej.tif" { DVec3::new(0.5, 0.25, 0.8) } else { DVec3::ONE };
        assert!((found.map.spacing - spacing).length() < 1e-6, "{name}: {}", found.map.spacing);
    }
}

#[test]
fn images_that_are_no_maps_are_refused() {
    let Some(folder) = images("images_that_are_no_maps_are_refused") else { return };
    let colors = "its pixels are colours, or have fewer than 8 bits; save the labels of grains as shades of grey of 8, 16 or 32 bits";
    for (name, message) in [
        (
            "behind.tif",
            "its slices lie behind its only page, as ImageJ writes above 4 GB; save it as .nrrd, .mhd or .raw",
        ),
        ("papers.tif", "its pages differ in size; save the slices of the map without other images"),
        ("colors.tif", colors),
        ("colors.png", colors),
        ("uneven", "2.png has 5 x 4 pixels, the first slice 24 x 20; give slices of one size"),
        (
            "both",
            "is a folder with slices of two kinds; leave only the slices of the map there, all .tif, .png, .ang or .ctf",
        ),
        (
            "none",
            "is a folder without slices; give one that holds the slices of a map, each a .tif, .png, .ang or .ctf file",
        ),
    ] {
        let error = read_map(&folder.path().join(name), &MapOptions::default()).unwrap_err().to_string();
        assert!(error.ends_with(&format!("{name}: {message}")), "{error}");
    }
}

#[test]
fn damaged_images_are_read_or_refused() {
    let Some(folder) = images("damaged_images_are_read_or_refused") else { return };
    for name in ["plain.tif", "lzw.tif", "deflate.tiff", "float.tif", "imagej.tif", "pngs/0003.png"] {
        let refused = refused_when_damaged(&folder.path().join(name));
        assert!(refused > 20, "{name}: {refused}");
    }
}
