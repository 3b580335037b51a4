//! Measured maps in HDF5, written by h5py, and the same points in HKL's pair of files.

use std::path::Path;
use std::process::Command;

use glam::DVec3;
use grainsmooth::{EbsdOptions, MapOptions, MeasuredMap, read_map};

use crate::maps::refused_when_damaged;
use crate::programs::run;

const LABELS: [&str; 3] = ["labels_6.dream3d", "labels_nx.dream3d", "labels_dct.h5"];
const POINTS: [&str; 5] =
    ["points.crc", "points.h5oina", "points_edax.h5", "points_bruker.h5", "points.dream3d"];

/// A folder with all maps; nothing without h5py.
fn maps(test: &str) -> Option<tempfile::TempDir> {
    let folder = tempfile::tempdir().unwrap();
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let mut python = Command::new("python3");
    python.arg(sources.join("formats/hdf5.py")).arg(sources.join("data/maps/volume.npy"));
    let output = run(test, python.current_dir(folder.path()))?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(folder)
}

#[test]
fn labels_in_hdf5_are_those_of_the_array() {
    let Some(folder) = maps("labels_in_hdf5_are_those_of_the_array") else { return };
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/maps/volume.npy");
    let options = MapOptions { exterior_label: Some(0), ..MapOptions::default() };
    let expected = read_map(&data, &options).unwrap();
    for name in LABELS {
        let found = read_map(&folder.path().join(name), &options).unwrap();
        assert_eq!(found.map.shape, [24, 20, 16], "{name}");
        assert!(found.map.labels == expected.map.labels && found.labels == expected.labels, "{name}");
        let spacing = found.map.spacing - DVec3::new(0.5, 0.5, 0.8);
        let origin = found.map.origin - DVec3::new(1.0, 2.0, -3.0);
        assert!(spacing.length() < 1e-6 && origin.length() < 1e-5, "{name}: {:?}", found.map.origin);
    }
}

/// The same points in five files give the same grains, phases, mean orientations and masks as the text of EDAX does.
#[test]
fn orientations_in_hdf5_are_those_of_the_text() {
    let Some(folder) = maps("orientations_in_hdf5_are_those_of_the_text") else { return };
    for min_iq in [None, Some(100.0)] {
        let ebsd = EbsdOptions { min_iq, ..EbsdOptions::default() };
        let options = MapOptions { ebsd, ..MapOptions::default() };
        let read = |name: &str| read_map(&folder.path().join(name), &options).unwrap();
        let expected = read("points.ang");
        let MeasuredMap { crystals: Some(crystals), .. } = &expected else { panic!("a map of orientations") };
        assert_eq!(crystals.points.grains, 4);
        assert_eq!(crystals.points.unsolved, 3);
        assert_eq!(crystals.points.masked, if min_iq.is_some() { 3 } else { 0 });
        for name in POINTS {
            let found = read(name);
            assert!(found.map.labels == expected.map.labels, "{name}");
            assert!((found.map.spacing - expected.map.spacing).length() < 1e-6, "{name}");
            let own = found.crystals.as_ref().unwrap();
            assert_eq!(own.phases, crystals.phases, "{name}");
            assert_eq!(own.phase_of, crystals.phase_of, "{name}");
            assert_eq!(
                (own.points.unsolved, own.points.masked),
                (crystals.points.unsolved, crystals.points.masked)
            );
            for ((one, other), phase) in
                own.orientations.iter().zip(&crystals.orientations).zip(&own.phase_of)
            {
                let angle = own.phases[*phase].1.disorientation_angle(*one, *other);
                assert!(angle < 1e-3, "{name}: {angle}");
            }
            // Only the head of EDAX's file says something else than the points do.
            assert_eq!(own.points.contradicted.is_some(), name == "points_edax.h5", "{name}");
        }
    }
}

#[test]
fn damaged_hdf5_is_read_or_refused() {
    let Some(folder) = maps("damaged_hdf5_is_read_or_refused") else { return };
    for name in LABELS.into_iter().chain(POINTS).chain(["points.cpr"]) {
        let refused = refused_when_damaged(&folder.path().join(name));
        assert!(refused > 40, "{name}: {refused}");
    }
}
