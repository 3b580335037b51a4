//! Real measured maps: their grains are those that others find.

use std::path::Path;

use grainsmooth::{EbsdOptions, MapOptions, MeasuredMap, read_map};

/// A corner of the first slice of Small IN100, whose points are taken for good with a confidence above 0.1 and a quality above 120.
fn in100(threshold: f64, min_pore: Option<u64>, min_voxels: u64) -> MeasuredMap {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/maps/in100_crop.dream3d");
    let ebsd = EbsdOptions {
        threshold: Some(threshold),
        min_ci: Some(0.1),
        // Above 120: the program asks for at least so much.
        min_iq: Some(120.05),
        min_pore,
        ..EbsdOptions::default()
    };
    read_map(&path, &MapOptions { ebsd, min_voxels, ..MapOptions::default() }).unwrap()
}

fn largest_first(map: &MeasuredMap) -> Vec<u64> {
    let mut counts = map.voxel_counts.clone();
    counts.sort_unstable_by(|one, other| other.cmp(one));
    counts
}

/// Numbers of grains, of those of 3 and of 16 points, and the points of the largest, by a program in NumPy that was written for these data alone.
#[test]
fn grains_of_small_in100_are_those_that_others_find() {
    for (threshold, [all, of_three, of_sixteen], largest) in [
        (5.0, [79, 60, 43], [319, 240, 222, 188, 150, 142, 125, 122]),
        (10.0, [74, 56, 39], [319, 300, 271, 222, 221, 150, 142, 127]),
        (15.0, [72, 54, 37], [319, 300, 282, 271, 222, 203, 150, 142]),
    ] {
        // What is masked stays open.
        let map = in100(threshold, Some(1), 1);
        let points = &map.crystals.as_ref().unwrap().points;
        assert_eq!((points.shape, points.unsolved + points.masked), ([64, 64, 1], 568));
        let counts = largest_first(&map);
        let of = |least: u64| counts.iter().filter(|count| **count >= least).count();
        assert_eq!([counts.len(), of(3), of(16)], [all, of_three, of_sixteen], "{threshold}");
        assert_eq!(counts[..8], largest, "{threshold}");
    }
    let cleaned = largest_first(&in100(5.0, None, 3));
    assert_eq!((cleaned.len(), cleaned.iter().sum::<u64>()), (60, 64 * 64));
    assert_eq!(cleaned[..8], [332, 264, 245, 211, 166, 160, 142, 141]);
}
