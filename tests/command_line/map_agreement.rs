//! `grainsmooth check --labels`: networks beside the maps that they should show.

use serde_json::Value;

use crate::check::Cubes;
use crate::maps::npy;
use crate::workplace::{FAILED, USAGE, Workplace};

const MAP: &[u8] = include_bytes!("../data/maps/volume.raw");

const OF_MAP: &str = "--labels volume.raw --shape 24 20 16 --type u16 --exterior-label 0";

fn workplace() -> Workplace {
    let workplace = Workplace::new();
    workplace.put("volume.raw", MAP);
    workplace
}

fn agreement(workplace: &Workplace, arguments: &str) -> Value {
    let output = workplace.command(&format!("check --json {arguments}")).assert().success().stderr("");
    let mut reports: Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    reports["files"][0]["map"].take()
}

fn number(agreement: &Value, key: &str) -> f64 {
    agreement[key].as_f64().unwrap_or_else(|| panic!("{key} of {agreement}"))
}

#[test]
fn a_network_is_beside_its_map() {
    let workplace = workplace();
    for (options, file) in [
        ("--decimate 0", "a.vtp"),
        ("--decimate 0 --names dream3d", "a.vtu"),
        ("--decimate 0 --names pyvista", "a.vtk"),
        ("", "a.vtp"),
    ] {
        let smooth = OF_MAP.replace("--labels", "smooth");
        workplace.run(&format!("{smooth} {options} -o {file}"));
        let found = agreement(&workplace, &format!("{file} {OF_MAP}"));
        let is_exact = !options.is_empty();
        assert_eq!(number(&found, "voxels"), 7680.0);
        let differing = number(&found, "differing_voxels");
        assert!(if is_exact { differing == 0.0 } else { (1.0..200.0).contains(&differing) }, "{differing}");
        assert!(number(&found, "largest_volume_error") < 1e-12, "{found}");
        // Points stay within 0.49 voxels along each axis of the corners of voxels.
        let [mean, largest] = ["mean_distance", "largest_distance"].map(|key| number(&found, key));
        assert!(0.05 < mean && mean < 0.3 && (!is_exact || largest < 0.87), "{mean}, {largest}");
        assert_eq!((number(&found, "neighbors"), number(&found, "lost_neighbors")), (19.0, 0.0));
        assert_eq!(number(&found, "new_neighbors"), 0.0);
        let grains = found["grains"].as_array().unwrap();
        let labels: Vec<_> = grains.iter().map(|grain| grain["label"].as_u64().unwrap()).collect();
        assert_eq!(labels, (1..10).collect::<Vec<_>>());
    }
}

#[test]
fn whole_grains_are_beside_a_map_that_repeats() {
    let workplace = Workplace::new();
    workplace.run("--seeds 30 --rng-seed 3 --periodic x,y,z -n 1 --voxels 32 32 32 -o map.vti -o made.vtp");
    workplace.run("smooth map.vti --periodic x,y,z --decimate 0 -o exact.vtp");
    workplace.run("smooth map.vti --periodic x,y,z -o decimated.vtp");
    for name in ["exact.vtp", "decimated.vtp"] {
        let found = agreement(&workplace, &format!("{name} --labels map.vti --periodic x,y,z"));
        let differing = number(&found, "differing_voxels");
        // Chords cut curved boundaries, by the square of their length: the default takes 317 of 32 768 voxels.
        assert!(if name == "exact.vtp" { differing == 0.0 } else { differing < 330.0 }, "{differing}");
        assert!(number(&found, "largest_volume_error") < 1e-9, "{found}");
        let [mean, largest] = ["mean_distance", "largest_distance"].map(|key| number(&found, key));
        assert!(0.05 < mean && mean < 0.3 && largest < 1.2, "{mean}, {largest}");
        assert!(number(&found, "neighbors") > 20.0, "{found}");
        assert_eq!((number(&found, "lost_neighbors"), number(&found, "new_neighbors")), (0.0, 0.0));
    }
    workplace.run("smooth map.vti -o apart.vtp");
    for (network, axes) in [("apart.vtp", "x,y,z"), ("exact.vtp", "x")] {
        workplace.refuses(
            &format!("check {network} --labels map.vti --periodic {axes}"),
            FAILED,
            "map.vti: is taken to repeat, and the network does not so; leave --periodic out, or give the axes with which the network was made",
        );
    }
}

#[test]
fn voxels_that_changed_are_found() {
    let workplace = workplace();
    let smooth = OF_MAP.replace("--labels", "smooth");
    workplace.run(&format!("{smooth} --decimate 0 -o a.vtp"));
    // Some of the voxels of grain 3 get label 7, some become a pore.
    let mut changed = MAP.to_vec();
    let of_grain: Vec<usize> = (0..MAP.len() / 2).filter(|voxel| MAP[2 * voxel] == 3).collect();
    for (voxel, label) in of_grain.iter().step_by(100).zip([7, 7, 7, 7, 0, 0, 0]) {
        changed[2 * voxel] = label;
    }
    workplace.put("volume.raw", changed);
    let found = agreement(&workplace, &format!("a.vtp {OF_MAP}"));
    assert_eq!(number(&found, "differing_voxels"), 7.0);
    let differing: Vec<f64> =
        found["grains"].as_array().unwrap().iter().map(|grain| number(grain, "differing_voxels")).collect();
    assert_eq!(differing, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
    let said = workplace.command(&format!("check a.vtp {OF_MAP}")).assert().success();
    let said = String::from_utf8(said.get_output().stdout.clone()).unwrap();
    assert!(
        said.contains(
            "\n  labels      7 of 7680 voxels lie in another grain than their labels say, 911 in a million\n"
        ),
        "{said}"
    );
}

/// Two halves of a unit cube beside four slices of voxels, one of which has the other's label.
#[test]
fn distances_and_volumes_are_those_of_geometry() {
    let workplace = Workplace::new();
    workplace.put("cubes.vtk", Cubes::new().file("FaceLabels"));
    for (labels, differing, errors, distance) in
        [([0, 0, 1, 1], 0.0, [0.0, 0.0], 0.0), ([0, 1, 1, 1], 4.0, [2.0 / 3.0, 1.0], 1.0)]
    {
        let all: Vec<u8> = labels.iter().flat_map(|label| [*label; 4]).collect();
        workplace.put("map.npy", npy(&[4, 2, 2], &all));
        let found = agreement(&workplace, "cubes.vtk --labels map.npy --spacing 0.25 0.5 0.5");
        assert_eq!(number(&found, "differing_voxels"), differing);
        for (key, expected) in ["mean_volume_error", "largest_volume_error"].into_iter().zip(errors) {
            assert!((number(&found, key) - expected).abs() < 1e-12, "{found}");
        }
        assert_eq!(["mean_distance", "largest_distance"].map(|key| number(&found, key)), [distance; 2]);
    }
    // A third grain, which the network lacks, lies beside the first.
    workplace.put("map.npy", npy(&[4, 2, 2], &[2, 2, 2, 2, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1]));
    let found = agreement(&workplace, "cubes.vtk --labels map.npy --spacing 0.25 0.5 0.5");
    assert_eq!(number(&found, "differing_voxels"), 4.0);
    assert_eq!(
        ["neighbors", "lost_neighbors", "new_neighbors"].map(|key| number(&found, key)),
        [2.0, 1.0, 0.0]
    );
    assert_eq!(found["grains"][2]["grain"], Value::Null);
}

#[test]
fn pixels_are_beside_lines() {
    let workplace = Workplace::new();
    let labels: Vec<u8> = (0..20 * 30).map(|pixel| 5 + u8::from(pixel % 30 + pixel / 30 > 24)).collect();
    workplace.put("map.npy", npy(&[20, 30], &labels));
    workplace.run("smooth map.npy -o a.vtp");
    let found = agreement(&workplace, "a.vtp --labels map.npy");
    assert_eq!((number(&found, "voxels"), number(&found, "differing_voxels")), (600.0, 0.0));
    assert!(number(&found, "largest_volume_error") < 1e-12);
    // A straight line under 45 degrees passes the middles of pixels' edges at a distance of sqrt(2) / 4 in the mean at most.
    assert!((0.01..0.36).contains(&number(&found, "mean_distance")), "{found}");
}

#[test]
fn maps_of_elsewhere_are_refused() {
    let workplace = Workplace::new();
    workplace.put("cubes.vtk", Cubes::new().file("FaceLabels"));
    workplace.put("map.npy", npy(&[8, 8, 8], &[1; 512]));
    workplace.put("pixels.npy", npy(&[8, 8], &[1; 64]));
    workplace.refuses(
        "check cubes.vtk --labels map.npy",
        FAILED,
        "map.npy: its grains fill [0, 8] x [0, 8] x [0, 8], those of cubes.vtk [0, 1] x [0, 1] x [0, 1]; give --spacing, --crop or --exterior-label so that they agree",
    );
    workplace.refuses(
        "check cubes.vtk --labels pixels.npy",
        FAILED,
        "pixels.npy: its grains fill [0, 8] x [0, 8], those of cubes.vtk [0, 1] x [0, 1] x [0, 1]; give --spacing, --crop or --exterior-label so that they agree",
    );
    workplace.refuses(
        "check cubes.vtk --labels none.npy",
        FAILED,
        "none.npy: cannot be read: No such file or directory (os error 2); give the path of a readable map",
    );
    workplace.refuses(
        "check cubes.vtk --spacing 2",
        USAGE,
        "the following required arguments were not provided:",
    );
}
