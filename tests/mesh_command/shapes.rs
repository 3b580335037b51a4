//! Meshes to try, and where the reference files are.

use std::path::{Path, PathBuf};

use serde_json::Value;

/// A cube with corners at -1 and 1, its faces squares that wind counter-clockwise from outside.
pub const CUBE_OBJ: &str = "\
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// A tetrahedron whose coordinates lose digits in single precision.
pub const TETRAHEDRON_OFF: &str = "\
OFF\n4 4 0\n0.1 0 0\n1 0.30000000000000004 0\n0 1e-7 0\n0 0 3.3333333333333335\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

/// Numbers of independent programs, as `subzero` is tested with; their README names the origin.
pub fn reference_path(name: &str) -> PathBuf {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/subzero/tests/data/subdivision");
    directory.join(name).with_extension("json")
}

pub fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).unwrap()
}

pub fn points(value: &Value) -> Vec<[f64; 3]> {
    serde_json::from_value(value.clone()).unwrap()
}

pub fn faces(value: &Value) -> Vec<Vec<u32>> {
    serde_json::from_value(value.clone()).unwrap()
}

#[track_caller]
pub fn assert_close(ours: &[f64; 3], theirs: &[f64; 3], what: &str) {
    for (a, b) in ours.iter().zip(theirs) {
        assert!((a - b).abs() <= 1e-12, "{what}: {ours:?} is not {theirs:?}");
    }
}
