//! Swaps toward a histogram of disorientations.

use glam::DVec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use texture::{
    AngleHistogram, CrystalSymmetry, HistogramError, Orientation, Pair, RandomDisorientations, Texture,
};

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
    assert!(message.starts_with("bin 2 begins at 63 degrees, but two cubic crystals differ by at most 62."));
    assert!(AngleHistogram::new(&[(63.0, 1.0), (65.0, 0.0)], CUBIC).is_ok(), "the remedy works");
}

#[test]
fn twins_are_found_in_each_of_their_forms() {
    let [x, diagonal] = [DVec3::X, DVec3::new(1.0, 1.0, 1.0)];
    let start = Orientation::from_euler_degrees([33.0, 71.0, 12.0]);
    // 60 degrees about any of the four <111>, and the same twin as 180 degrees about <112> and 109.47 degrees about <110>.
    for (angle, axis) in [
        (60.0, diagonal),
        (60.0, DVec3::new(-1.0, 1.0, 1.0)),
        (180.0, DVec3::new(1.0, 1.0, 2.0)),
        (109.471_220_634_490_69, DVec3::new(1.0, -1.0, 0.0)),
    ] {
        let twin = start.turned(start.to_sample(axis), angle);
        assert!(CUBIC.twin_deviation(start, twin, 60.0, diagonal) < 1e-6, "{angle} about {axis}");
        assert!(CUBIC.twin_deviation(twin, start, 60.0, diagonal) < 1e-6);
        let off = twin.turned(DVec3::Y, 2.0);
        assert!((CUBIC.twin_deviation(start, off, 60.0, diagonal) - 2.0).abs() < 1e-6);
    }
    assert!(CUBIC.twin_deviation(start, start, 60.0, diagonal) > 50.0);
    // Magnesium's {10-12} twins: 86.3 degrees about a.
    let hexagonal = CrystalSymmetry::Hexagonal;
    let third = DVec3::new(-0.5, 0.75_f64.sqrt(), 0.0);
    let twin = start.turned(start.to_sample(third), 86.3);
    assert!(hexagonal.twin_deviation(start, twin, 86.3, x) < 1e-6);
}

#[test]
fn turns_of_the_sample_carry_crystals_along() {
    let start = Orientation::from_euler_degrees([20.0, 30.0, 40.0]);
    let turned = start.turned(DVec3::Z, 25.0).euler_degrees();
    assert!(turned.iter().zip([45.0, 30.0, 40.0]).all(|(found, expected)| (found - expected).abs() < 1e-9));
    let direction = DVec3::new(1.0, 2.0, 3.0);
    let tilted = start.turned(DVec3::X * 2.0, 90.0).to_sample(direction);
    let before = start.to_sample(direction);
    assert!(tilted.distance(DVec3::new(before.x, -before.z, before.y)) < 1e-12);
}
