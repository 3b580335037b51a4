//! Measured maps in HDF5, written by h5py, and the same points in HKL's pair of files.

use std::path::Path;
use std::process::Command;

use glam::DVec3;
use grainsmooth::polycrystal::{GrainId, certify};
use grainsmooth::{EbsdOptions, LabelledFile, MapOptions, MeasuredMap, read_map};

use crate::maps::{refused_in_200_ways, refused_when_damaged};
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

/// Sections of columns of six grains, each scanned from another corner: shifted back, all are the same.
#[test]
fn sections_are_stacked_and_aligned() {
    let Some(folder) = maps("sections_are_stacked_and_aligned") else { return };
    let read = |name: &str, align: bool| {
        let ebsd = EbsdOptions { align, ..EbsdOptions::default() };
        let spacing = (name == "sections").then(|| vec![0.25, 0.25, 0.4]);
        read_map(&folder.path().join(name), &MapOptions { ebsd, spacing, ..MapOptions::default() }).unwrap()
    };
    for name in ["sections", "sections.h5ebsd", "sections_hkl.h5ebsd"] {
        let as_scanned = read(name, false);
        assert_eq!(as_scanned.map.shape, [14, 12, 4], "{name}");
        let crystals = as_scanned.crystals.as_ref().unwrap();
        assert_eq!((crystals.points.shape, crystals.points.shifted), ([14, 12, 4], 0), "{name}");
        assert!((as_scanned.map.spacing - DVec3::new(0.25, 0.25, 0.4)).length() < 1e-6, "{name}");

        let aligned = read(name, true);
        let crystals = aligned.crystals.as_ref().unwrap();
        // The corners differ by 3 points along x and 2 along y.
        assert_eq!((crystals.points.shape, crystals.points.shifted), ([11, 10, 4], 3), "{name}");
        assert_eq!(crystals.points.grains, 6, "{name}");
        let sections: Vec<&[i32]> = aligned.map.labels.chunks(110).collect();
        assert!(sections.iter().all(|section| *section == sections[0]), "{name}");
        // Rows count downward in the file: these are grains at the lower left and upper right, by the sample.
        let grain = |at: usize| aligned.map.labels[at].cast_unsigned() as usize;
        let angles = |at: usize| crystals.orientations[grain(at)].euler_degrees();
        let expected = |grain: f64, tilt: f64| [10.0 + 25.0 * grain, tilt, 30.0];
        for (at, expected) in [(0, expected(2.0, 70.0)), (109, expected(3.0, 35.0))] {
            let found = angles(at);
            let is_near = |(one, two): (&f64, &f64)| (one - two).abs() < 1e-3;
            assert!(found.iter().zip(&expected).all(is_near), "{name}: {found:?}");
        }
    }
}

/// What DREAM.3D needs to know of each array, read by h5py, and the same grains when it is read again.
#[test]
fn dream3d_gets_the_map_as_cleaned() {
    let test = "dream3d_gets_the_map_as_cleaned";
    let Some(folder) = maps(test) else { return };
    let program = || Command::new(env!("CARGO_BIN_EXE_grainsmooth"));
    for (map, again) in [("points.ang", "plane.dream3d"), ("sections.h5ebsd", "space.dream3d")] {
        let mut smooth = program();
        // Where short edges collapse some voxels change their grain.
        smooth.args(["smooth", map, "-q", "--decimate", "0", "-o", again]).current_dir(folder.path());
        let output = smooth.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let read = |name: &str| read_map(&folder.path().join(name), &MapOptions::default()).unwrap();
        let [expected, found] = [map, again].map(read);
        assert_eq!(expected.map.shape, found.map.shape);
        assert!(expected.map.labels == found.map.labels && expected.voxel_counts == found.voxel_counts);
        assert!((expected.map.spacing - found.map.spacing).length() < 1e-6);
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats/dream3d.py");
    let mut python = Command::new("python3");
    python.arg(script).args(["plane.dream3d", "space.dream3d"]).current_dir(folder.path());
    let Some(output) = run(test, &mut python) else { return };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Cubes of volume 1, numbered as features; what belongs to no feature is outside.
#[test]
fn surface_meshes_of_dream3d_are_networks() {
    let Some(folder) = maps("surface_meshes_of_dream3d_are_networks") else { return };
    for name in ["triangles_6.dream3d", "triangles_nx.dream3d"] {
        let path = folder.path().join(name);
        assert!(LabelledFile::is_known(&path));
        let file = LabelledFile::read(&path).unwrap();
        let certificate = certify(&file.surface(), &file.expected());
        assert!(certificate.is_good(), "{name}: {}", certificate.faults);
        assert_eq!(certificate.grain_volumes, [(GrainId(1), 1.0), (GrainId(2), 1.0)], "{name}");
        assert_eq!((file.points.len(), file.node_types.is_some()), (12, name == "triangles_6.dream3d"));
    }
    let path = folder.path().join("labels_6.dream3d");
    assert!(!LabelledFile::is_known(&path));
    let refused = LabelledFile::read(&path).unwrap_err().to_string();
    assert!(refused.contains("no triangle geometry"), "{refused}");
}

#[test]
fn damaged_hdf5_is_read_or_refused() {
    let Some(folder) = maps("damaged_hdf5_is_read_or_refused") else { return };
    for name in
        LABELS.into_iter().chain(POINTS).chain(["points.cpr", "sections.h5ebsd", "sections_hkl.h5ebsd"])
    {
        let refused = refused_when_damaged(&folder.path().join(name));
        assert!(refused > 40, "{name}: {refused}");
    }
    for name in ["triangles_6.dream3d", "triangles_nx.dream3d"] {
        let refused = refused_in_200_ways(&folder.path().join(name), |path| {
            let file = LabelledFile::read(path)?;
            // Judged, good or not.
            certify(&file.surface(), &file.expected());
            Ok(())
        });
        assert!(refused > 40, "{name}: {refused}");
    }
}
