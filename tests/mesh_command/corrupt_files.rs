//! Truncated and corrupt files are errors, never panics.

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use grainsmooth::mesh::file::{MeshFile, read_mesh};
use grainsmooth::read_bezier;
use proptest::prelude::*;
use tempfile::TempDir;

use crate::quiet_reader::keep_reader_quiet;
use crate::shapes::TETRAHEDRON_OFF;
use crate::workplace::Workplace;

const EXTENSIONS: [&str; 8] = ["obj", "off", "ply", "stl", "vtp", "vtu", "vtk", "json"];

/// A good file of each format.
static GOOD: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let workplace = Workplace::new();
    workplace.put("in.off", TETRAHEDRON_OFF);
    let good = |extension: &&str| {
        let name = format!("in.{extension}");
        if *extension != "off" {
            workplace.run(&format!("mesh normals in.off -o {name}"));
        }
        workplace.bytes(&name)
    };
    EXTENSIONS.iter().map(good).collect()
});

/// Reads bytes as a file of that format; whether that fails or not, it returns.
fn read(directory: &Path, extension: &str, bytes: &[u8]) -> Option<MeshFile> {
    let path = directory.join("file").with_extension(extension);
    fs::write(&path, bytes).unwrap();
    let _ = read_bezier(&path);
    match read_mesh(&path) {
        Ok(mesh) => {
            // What is read can be used.
            let _ = mesh.triangle_mesh();
            let _ = mesh.polygon_mesh();
            Some(mesh)
        }
        Err(error) => {
            let message = error.to_string();
            assert!(!message.contains('\n'), "{message}");
            assert!(message.starts_with(&path.display().to_string()), "{message}");
            None
        }
    }
}

#[test]
fn truncated_files_are_refused() {
    keep_reader_quiet();
    let directory = TempDir::new().unwrap();
    for (extension, good) in EXTENSIONS.iter().zip(GOOD.iter()) {
        let whole = read(directory.path(), extension, good);
        assert!(whole.is_some(), "{extension}");
        let step = good.len() / 150 + 1;
        for length in (0..good.len()).step_by(step) {
            let part = read(directory.path(), extension, &good[..length]);
            // OBJ has no end. In the others at most arrays, such as normals, and closing words may be missing.
            let mesh =
                |file: &Option<MeshFile>| file.as_ref().map(|mesh| (mesh.points.clone(), mesh.faces.clone()));
            let is_same = part.is_none() || mesh(&part) == mesh(&whole);
            assert!(is_same || *extension == "obj", "{extension} cut at {length}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn corrupt_files_never_panic(
        format in 0..EXTENSIONS.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        cut in any::<prop::sample::Index>(),
        is_cut in any::<bool>(),
    ) {
        keep_reader_quiet();
        let directory = TempDir::new().unwrap();
        let mut bytes = GOOD[format].clone();
        for (index, byte) in changes {
            let at = index.index(bytes.len());
            bytes[at] = byte;
        }
        if is_cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        read(directory.path(), EXTENSIONS[format], &bytes);
    }

    #[test]
    fn any_bytes_never_panic(format in 0..EXTENSIONS.len(), bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        keep_reader_quiet();
        let directory = TempDir::new().unwrap();
        read(directory.path(), EXTENSIONS[format], &bytes);
    }
}
