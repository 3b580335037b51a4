//! Swaps toward a histogram of disorientations.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use texture::{AngleHistogram, CrystalSymmetry, HistogramError, Pair, RandomDisorientations, Texture};

const CUBIC: CrystalSymmetry = CrystalSymmetry::Octahedral;

/// Neighbours of a periodic grid of `side`^3 grains, through faces and diagonals of the cube: 14 each, of random areas.
fn neighbors(side: usize) -> Vec<Pair> {
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    let mut pairs = Vec::new();
    let index = |[x, y, z]: [usize; 3]| (x % side * side + y % side) * side + z % side;
    for grain in 0..side.pow(3) {
        let [x, y, z] = [grain / side / side, grain / side % side, grain % side];
        let before = side - 1;
        for other in [
            [x + 1, y, z],
            [x, y + 1, z],
            [x, y, z + 1],
            [x + 1, y + 1, z + 1],
            [x + 1, y + 1, z + before],
            [x + 1, y + before, z + 1],
            [x + before, y + 1, z + 1],
        ] {
            pairs.push((grain, index(other), 0.1 + f64::from(generator.next_u32()) / 4e9));
        }
    }
    pairs
}

/// Mackenzie's shares in bins of 5 degrees, with those below 15 degrees times a factor.
fn target(low: f64) -> AngleHistogram {
    let random = RandomDisorientations::new(CUBIC);
    let bins: Vec<(f64, f64)> = (0..13)
        .map(|bin| {
            let start = 5.0 * f64::from(bin);
            let share = random.share_below(start + 5.0) - random.share_below(start);
            (start + 5.0, if bin < 3 { low * share } else { share })
        })
        .collect();
    AngleHistogram::new(&bins, CUBIC).expect("the bins are good")
}

#[test]
fn twenty_tries_a_grain_reach_a_histogram_within_a_hundredth_and_keep_the_texture_by_volume() {
    let side = 12;
    let pairs = neighbors(side);
    let mut generator = ChaCha8Rng::seed_from_u64(2);
    let volumes: Vec<f64> = (0..side.pow(3)).map(|_| 0.1 + f64::from(generator.next_u32()) / 4e9).collect();
    let texture: Texture = "cube(15)*0.3+random*0.7".parse().expect("the text is a texture");
    for (texture, low) in [(Texture::random(), 1.0), (Texture::random(), 2.0), (texture, 3.0)] {
        let drawn = texture.draw(&volumes, &mut generator).expect("volumes are positive");
        let target = target(low);
        let before = target.distance(&drawn.orientations, CUBIC, &pairs);
        let count = drawn.orientations.len();
        let sources = target.swaps(&drawn.orientations, CUBIC, &pairs, &volumes, 20 * count, &mut generator);
        let swapped: Vec<_> = sources.iter().map(|source| drawn.orientations[*source]).collect();
        let after = target.distance(&swapped, CUBIC, &pairs);
        assert!(after < 0.01 && after < before, "{low}: from {before} to {after}");
        let mut each = sources.clone();
        each.sort_unstable();
        assert!(each.into_iter().eq(0..count), "every orientation once");
        let share = |components: &dyn Fn(usize) -> usize| -> f64 {
            (0..count).filter(|grain| components(*grain) == 0).map(|grain| volumes[grain]).sum()
        };
        let before = share(&|grain| drawn.components[grain]);
        let after = share(&|grain| drawn.components[sources[grain]]);
        assert!((after / before - 1.0).abs() < 0.01, "from {before} to {after}");
    }
}

#[test]
fn few_grains_and_none_are_left_as_they_are_where_nothing_gets_better() {
    let target = target(1.0);
    let drawn = Texture::random().draw(&[1.0; 2], &mut ChaCha8Rng::seed_from_u64(1));
    let orientations = drawn.expect("volumes are positive").orientations;
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    for count in 0..=2 {
        let pairs: &[Pair] = if count == 2 { &[(0, 1, 1.0)] } else { &[] };
        let sources =
            target.swaps(&orientations[..count], CUBIC, pairs, &[1.0; 2][..count], 40, &mut generator);
        assert_eq!(sources.len(), count);
    }
}

#[test]
fn histograms_that_no_crystals_have_are_refused() {
    let error = |bins: &[(f64, f64)]| AngleHistogram::new(bins, CUBIC).expect_err("the bins are bad");
    assert_eq!(error(&[]), HistogramError::NoBins);
    assert_eq!(error(&[(5.0, 1.0), (5.0, 1.0)]), HistogramError::Order { bin: 2, end: 5.0 });
    assert_eq!(error(&[(5.0, -1.0)]), HistogramError::Weight { bin: 1, weight: -1.0 });
    assert_eq!(error(&[(5.0, 0.0)]), HistogramError::Weight { bin: 1, weight: 0.0 });
    let message = error(&[(63.0, 1.0), (65.0, 0.1)]).to_string();
    assert!(
        message
            .starts_with("bin 2 begins at 63 degrees, where no two cubic crystals are: they differ by 62.")
    );
    assert!(AngleHistogram::new(&[(63.0, 1.0), (65.0, 0.0)], CUBIC).is_ok(), "the remedy works");
}
