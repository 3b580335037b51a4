//! What messages about measured maps advise helps.

use campaign::refusal;

use crate::maps::npy;
use crate::workplace::Workplace;

/// A map as NumPy has it, the last index fastest.
struct Map {
    shape: &'static [usize],
    labels: &'static [u8],
}

const TWO: Map = Map { shape: &[2, 4], labels: &[1, 1, 2, 2, 1, 1, 2, 2] };
const WITH_PORE: Map = Map { shape: &[4, 3], labels: &[0, 0, 0, 1, 1, 1, 2, 2, 2, 2, 2, 2] };
const RING: Map = Map { shape: &[3, 3], labels: &[2, 2, 2, 2, 1, 2, 2, 2, 2] };
const BANDS: Map = Map { shape: &[4, 4], labels: &[1, 1, 2, 2, 1, 1, 2, 2, 1, 1, 2, 2, 1, 1, 2, 2] };
const ISLAND: Map = Map { shape: &[4, 4], labels: &[1, 1, 1, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 1, 1, 1] };
/// Found at random.
const MIXED: Map = Map {
    shape: &[5, 4, 4],
    labels: b"11212122112112222211111222111111212111212221221211211211111111121121212121212212",
};
const THIN: Map = Map { shape: &[5, 3, 3], labels: b"313111113131311112123333331312223222223123333" };

/// Also found at random.
const HELD: [Map; 3] = [
    Map { shape: &[4, 4, 3], labels: b"131123322221211123322222112323232222133312122133" },
    Map {
        shape: &[5, 4, 4],
        labels: b"11222122222121222211221211222122211211221211121211121111112111121212221122121222",
    },
    Map {
        shape: &[5, 4, 4],
        labels: b"22121222111111111112122121122121112221121222211222221112121111121211221222211112",
    },
];

/// A kind of refusal, a map, the options that are refused, and those after the remedy.
const REMEDIES: [(&str, Map, &str, &str); 9] = [
    ("MapProblem::Unfit", WITH_PORE, "--exterior-label 0 --fit-cells", "--exterior-label 0"),
    ("MapProblem::NoCells", RING, "--fit-cells", ""),
    ("MapProblem::Unfit, small grains", TWO, "--min-voxels 5", "--min-voxels 4"),
    ("ShortPeriod", TWO, "--periodic x", ""),
    ("EndlessGrain", BANDS, "--periodic x,y", "--periodic y"),
    ("MapProblem::Crop", TWO, "--crop 0:2,0:5", "--crop 0:2,0:4"),
    ("MixedVoxels", MIXED, "--parts split", "--parts split --min-voxels 4"),
    ("RelaxesFolded", THIN, "--relax 0.05", ""),
    ("PeriodicPores", ISLAND, "--exterior-label 0 --periodic x,y", "--exterior-label 0"),
];

/// The kinds of which the remedy is tried here.
pub fn kinds() -> impl Iterator<Item = &'static str> {
    REMEDIES.iter().map(|(kind, ..)| *kind)
}

#[test]
fn what_messages_about_maps_advise_helps() {
    for (kind, Map { shape, labels }, refused, mended) in &REMEDIES {
        let workplace = Workplace::new();
        workplace.put("map.npy", npy(shape, labels));
        let output = workplace.command(&format!("smooth map.npy {refused} -o a.vtp")).assert().failure();
        let said = String::from_utf8(output.get_output().stderr.clone()).unwrap();
        assert_eq!(refusal(&said), Some(*kind), "{said}");
        workplace.run(&format!("smooth map.npy {mended} -o a.vtp"));
    }
}

/// Points where elements cross go toward a place at which grains have their volumes, and those of grains that cannot have theirs all the way: else a grain whose points are all
/// held never had its own.
#[test]
fn grains_whose_points_are_all_held_have_their_volumes() {
    for Map { shape, labels } in HELD {
        let workplace = Workplace::new();
        workplace.put("map.npy", npy(shape, labels));
        workplace.run("smooth map.npy --parts split --decimate 0 -o a.vtp");
    }
}
