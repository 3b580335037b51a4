//! Measured maps whose files are damaged.

use std::path::Path;

use grainsmooth::{Error, MapOptions, read_map};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::programs::run;

/// Flips, changes and cuts off bytes of a map in 200 ways: each gives a map, or an error in one line. Returns how many are refused.
pub fn refused_when_damaged(path: &Path) -> usize {
    refused_with(path, &MapOptions::default())
}

/// As [`refused_when_damaged`], where options tell what a file does not.
fn refused_with(path: &Path, options: &MapOptions) -> usize {
    refused_in_200_ways(path, |path| {
        let map = read_map(path, options)?;
        assert_eq!(map.map.labels.len(), map.map.shape.iter().product::<usize>());
        Ok(())
    })
}

/// As [`refused_when_damaged`], of a file that something else reads.
pub fn refused_in_200_ways(path: &Path, read: impl Fn(&Path) -> Result<(), Error>) -> usize {
    let whole = std::fs::read(path).unwrap();
    let mut generator = ChaCha8Rng::seed_from_u64(23);
    let mut below = |count: usize| usize::try_from(generator.next_u64() % count as u64).unwrap();
    let mut refused = 0;
    for variant in 0..200 {
        let mut bytes = whole.clone();
        // What is broken is the head of the file more often than its numbers.
        let within = if variant % 2 == 0 { whole.len() } else { whole.len().min(900) };
        match variant / 2 % 4 {
            0 => bytes.truncate(below(within)),
            1 => bytes[below(within)] ^= 1 << below(8),
            2 => (0..8).for_each(|_| bytes[below(within)] ^= 1 << below(8)),
            _ => bytes[below(within)] = b"0123456789-\"<> \x00\xff"[below(17)],
        }
        std::fs::write(path, &bytes).unwrap();
        if let Err(error) = read(path) {
            refused += 1;
            let said = error.to_string();
            assert!(said.starts_with(&*path.to_string_lossy()) && !said.contains('\n'), "{said}");
        }
    }
    refused
}

#[test]
fn damaged_maps_are_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/maps");
    let numbers = std::fs::read(data.join("volume.raw")).unwrap();
    // Some take their numbers from there.
    std::fs::write(folder.path().join("volume.raw"), &numbers).unwrap();
    for name in [
        "volume_damask.vti",
        "volume_points.vti",
        "volume.npy",
        "volume_zyx_c.npy",
        "volume.nrrd",
        "volume.nhdr",
        "volume.mhd",
        "volume.tesr",
        "volume_raw.tesr",
    ] {
        let path = folder.path().join(name);
        std::fs::copy(data.join(name), &path).unwrap();
        let refused = refused_when_damaged(&path);
        // At least those that are cut off.
        assert!(refused >= 50, "{name}: {refused}");
    }
    let head = std::fs::read_to_string(data.join("volume.mhd")).unwrap();
    let path = folder.path().join("volume.mha");
    std::fs::write(&path, [head.replace("volume.raw", "LOCAL").as_bytes(), &numbers].concat()).unwrap();
    let refused = refused_when_damaged(&path);
    assert!(refused > 20, "volume.mha: {refused}");
    let options = MapOptions {
        shape: Some(vec![24, 20, 16]),
        number_type: Some("u16".parse().unwrap()),
        ..MapOptions::default()
    };
    // Nothing is wrong with any numbers but how many they are: those that are cut off are refused.
    let refused = refused_with(&folder.path().join("volume.raw"), &options);
    assert!(refused > 20, "volume.raw: {refused}");
}

#[test]
fn archives_of_numpy_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/maps/volume.npy");
    let program = r#"
import sys
import numpy as np
labels = np.load(sys.argv[1])
np.savez("plain.npz", labels)
np.savez_compressed("several.npz", phases=np.ones(3), labels=labels)
np.savez("unknown.npz", a=labels, b=labels)
"#;
    let mut python = std::process::Command::new("python3");
    python.args(["-c", program]).arg(&data).current_dir(folder.path());
    let Some(output) = run("archives_of_numpy_are_read", &mut python) else { return };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let expected = read_map(&data, &MapOptions::default()).unwrap();
    let of = |name: &str, array: Option<&str>| {
        let options = MapOptions { label_array: array.map(str::to_owned), ..MapOptions::default() };
        read_map(&folder.path().join(name), &options)
    };
    for (name, array) in [("plain.npz", None), ("several.npz", None), ("unknown.npz", Some("b"))] {
        assert!(of(name, array).unwrap().map == expected.map, "{name}");
    }
    for (array, message) in [
        (None, "has several arrays that may be labels; choose one with --label-array: a, b"),
        (Some("c"), "has no array `c` with one number for each voxel; name one that it has: a, b"),
    ] {
        let said = of("unknown.npz", array).unwrap_err().to_string();
        assert!(said.ends_with(message), "{said}");
    }
    for name in ["plain.npz", "several.npz"] {
        let refused = refused_when_damaged(&folder.path().join(name));
        assert!(refused > 20, "{name}: {refused}");
    }
}
