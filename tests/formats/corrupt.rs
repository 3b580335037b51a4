//! Whatever is done to the bytes of a file: an error in one line or something valid, and never a panic.

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use grainsmooth::{
    Config, FileElements, LabelledFile, Output, Picture, Png, Shape, embedded_config, write_together,
};
use proptest::prelude::*;
use proptest::sample::Index;
use tempfile::TempDir;

use crate::quiet_reader::keep_reader_quiet;
use crate::workplace::{PLANE, SPACE};

/// What the files are that carry the settings of their run.
const WITH_SETTINGS: [&str; 13] =
    ["vtp", "vtu", "vtk", "vtm", "ply", "obj", "msh", "fe", "tess", "vti", "npy", "ang", "png"];

/// A good file of each of these.
static GOOD: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let directory = TempDir::new().unwrap();
    let good = |extension: &&str| {
        let path = directory.path().join("good").with_extension(extension);
        match *extension {
            "png" => {
                let output = Output::check_as(&path, Png).unwrap();
                let picture = Picture { size: [64.try_into().unwrap(); 2], ..Picture::default() };
                write_together(|files| SPACE.stage_picture(&picture, &output, files))
            }
            "ang" => PLANE.write(&Output::check(&path).unwrap()),
            _ => SPACE.write(&Output::check(&path).unwrap()),
        }
        .unwrap();
        let blocks = path.with_extension("").join("boundaries.vtp");
        fs::read(if *extension == "vtm" { blocks } else { path }).unwrap()
    };
    WITH_SETTINGS.iter().map(good).collect()
});

/// Networks with labels, in space and in the plane.
static LABELLED: LazyLock<Vec<(&str, Vec<u8>)>> = LazyLock::new(|| {
    let directory = TempDir::new().unwrap();
    let mut files = Vec::new();
    for polycrystal in [&*SPACE, &*PLANE] {
        for extension in ["vtp", "vtu", "vtk"] {
            let path = directory.path().join("good").with_extension(extension);
            polycrystal.write(&Output::check(&path).unwrap()).unwrap();
            files.push((extension, fs::read(path).unwrap()));
        }
    }
    files
});

/// What happens to a file: some bytes change, of which most where it says what it holds, and its end is lost.
#[derive(Debug, Clone)]
struct Damage {
    changes: Vec<(Index, bool, u8)>,
    cut: Option<Index>,
}

/// So many bytes at the beginning are mostly words.
const HEAD: usize = 2000;

impl Damage {
    fn any() -> impl Strategy<Value = Self> {
        let change = (any::<Index>(), any::<bool>(), any::<u8>());
        let cut = prop::option::of(any::<Index>());
        (prop::collection::vec(change, 1..8), cut).prop_map(|(changes, cut)| Self { changes, cut })
    }

    fn done_to(&self, bytes: &[u8]) -> Vec<u8> {
        let mut bytes = bytes.to_vec();
        for (place, is_in_head, byte) in &self.changes {
            let count = if *is_in_head { HEAD.min(bytes.len()) } else { bytes.len() };
            bytes[place.index(count)] = *byte;
        }
        if let Some(cut) = self.cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        bytes
    }
}

fn put(directory: &Path, extension: &str, bytes: &[u8]) -> std::path::PathBuf {
    let path = directory.join("file").with_extension(extension);
    fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn good_files_are_good() {
    let directory = TempDir::new().unwrap();
    for (extension, bytes) in LABELLED.iter() {
        LabelledFile::read(&put(directory.path(), extension, bytes)).unwrap();
    }
    for (extension, bytes) in
        WITH_SETTINGS.iter().zip(GOOD.iter()).filter(|(extension, _)| **extension != "vtm")
    {
        let settings = embedded_config(&put(directory.path(), extension, bytes)).unwrap();
        assert!(settings.is_some_and(|settings| settings.contains("\nlevels = 2\n")), "{extension}");
    }
}

/// The error names what of the file is lost, not how files are encoded.
#[test]
fn truncated_files_are_told_what_is_damaged() {
    let directory = TempDir::new().unwrap();
    for (extension, bytes) in LABELLED.iter().filter(|(extension, _)| *extension != "vtk") {
        let appended = bytes.windows(13).position(|window| window == b"<AppendedData").unwrap();
        for length in [appended, appended + 600, appended + (bytes.len() - appended) / 2] {
            let path = put(directory.path(), extension, &bytes[..length]);
            let error = LabelledFile::read(&path).unwrap_err().to_string();
            let is_named =
                error.contains("the numbers of its array ") && error.contains("damaged or cut off");
            assert!(is_named, "{length} bytes: {error}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn corrupt_networks_are_refused_or_valid(file in any::<Index>(), damage in Damage::any()) {
        keep_reader_quiet();
        let directory = TempDir::new().unwrap();
        let (extension, bytes) = file.get(&LABELLED);
        match LabelledFile::read(&put(directory.path(), extension, &damage.done_to(bytes))) {
            Ok(network) => {
                let (corners, count): (Vec<u32>, usize) = match &network.elements {
                    FileElements::Triangles(triangles) => (triangles.concat(), triangles.len()),
                    FileElements::Segments(segments) => (segments.concat(), segments.len()),
                };
                prop_assert!(corners.iter().all(|&corner| (corner as usize) < network.points.len()));
                prop_assert_eq!(network.boundary_of.len(), count);
                prop_assert!(network.boundary_of.iter().all(|id| id.index() < network.sides.len()));
                prop_assert!(network.node_types.is_none_or(|types| types.len() == network.points.len()));
            }
            Err(error) => prop_assert!(!error.to_string().contains('\n'), "{error}"),
        }
    }

    #[test]
    fn settings_of_corrupt_files_are_none_or_text(
        format in 0..WITH_SETTINGS.len(),
        damage in Damage::any(),
        read_as in prop::sample::select(vec!["", "json", "html", "stl", "csv"]),
    ) {
        let directory = TempDir::new().unwrap();
        let extension = if read_as.is_empty() { WITH_SETTINGS[format] } else { read_as };
        let path = put(directory.path(), extension, &damage.done_to(&GOOD[format]));
        match (extension, embedded_config(&path)) {
            // What holds them is beside, and is not there.
            ("vtm", settings) => prop_assert!(settings.is_err()),
            (_, settings) => {
                let settings = settings.unwrap();
                prop_assert!(settings.is_none_or(|settings| settings.ends_with('\n')));
            }
        }
    }

    /// Two ways to name the same octahedron, damaged.
    #[test]
    fn corrupt_domains_are_refused_or_hold_something(is_surface in any::<bool>(), damage in Damage::any()) {
        keep_reader_quiet();
        let directory = TempDir::new().unwrap();
        let (extension, text) = if is_surface {
            ("off", "OFF\n6 8 12\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n\
                     3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n")
        } else {
            ("csv", "nx,ny,nz,d\n1,1,1,1\n1,1,-1,1\n1,-1,1,1\n1,-1,-1,1\n-1,1,1,1\n-1,1,-1,1\n-1,-1,1,1\n-1,-1,-1,1\n")
        };
        let path = put(directory.path(), extension, &damage.done_to(text.as_bytes()));
        let shape = if is_surface { Shape::Surface(path) } else { Shape::HalfSpaces(path) };
        match (Config { shape, ..Config::default() }).domain() {
            Ok(domain) => prop_assert!(domain.measure() > 0.0 && domain.measure().is_finite()),
            Err(error) => prop_assert!(!error.to_string().contains('\n'), "{error}"),
        }
    }
}
