//! Plain cells in the plane come from a triangulation, power cells from cutting: with equal weights both are the same.

#![allow(clippy::cast_possible_truncation, reason = "some thousand seeds")]

use crate::common::{assert_complex, random_seeds};
use glam::DVec3;
use proptest::prelude::*;
use voronoi::{CellId, Domain, Tessellation};

/// Enough for several of the squares that are triangulated one by one.
const SEEDS: usize = 25_000;

fn flat_seeds(count: usize) -> Vec<DVec3> {
    random_seeds(count, 3).into_iter().map(|seed| seed.with_z(0.0)).collect()
}

fn rectangle(upper: DVec3) -> Domain {
    Domain::rectangle(DVec3::ZERO, upper).expect("positive sides")
}

fn assert_same(domain: &Domain, seeds: &[DVec3]) {
    let plain = Tessellation::new(domain, seeds).expect("valid seeds");
    let power = Tessellation::power(domain, seeds, &vec![0.0; seeds.len()]).expect("valid seeds");
    assert_complex(&plain);
    assert_eq!(plain.vertices().len(), power.vertices().len());
    assert_eq!(plain.face_count(), power.face_count());
    let scale = domain.measure() / seeds.len() as f64;
    let pairs = plain.cell_measures().into_iter().zip(power.cell_measures());
    for (cell, (ours, theirs)) in (0..).map(CellId).zip(pairs) {
        assert_eq!(plain.neighbors(cell), power.neighbors(cell), "cell {}", cell.0);
        let difference = (ours.volume - theirs.volume).abs();
        assert!(difference <= 1e-12 * (scale + theirs.volume), "cell {}: {difference:e}", cell.0);
        let difference = ours.centroid.distance(theirs.centroid);
        assert!(difference <= 1e-9 * domain.size().max_element(), "cell {}: {difference:e}", cell.0);
    }
}

#[test]
fn random_seeds_in_a_square() {
    assert_same(&Domain::unit_square(), &flat_seeds(SEEDS));
}

#[test]
fn oblong_rectangles() {
    for upper in [DVec3::new(1000.0, 1.0, 0.0), DVec3::new(1e-3, 1.0, 0.0), DVec3::new(1e9, 2e9, 0.0)] {
        let seeds: Vec<DVec3> = flat_seeds(SEEDS).into_iter().map(|seed| seed * upper).collect();
        assert_same(&rectangle(upper), &seeds);
    }
}

#[test]
fn density_that_grows_a_hundredfold() {
    let seeds: Vec<DVec3> = flat_seeds(SEEDS).into_iter().map(|seed| seed * seed.with_y(1.0)).collect();
    assert_same(&Domain::unit_square(), &seeds);
}

/// Cells at the rim of the empty part look farther than any square does.
#[test]
fn an_empty_half_and_a_cluster() {
    let mut seeds: Vec<DVec3> =
        flat_seeds(SEEDS).into_iter().map(|seed| seed * DVec3::new(0.5, 1.0, 0.0)).collect();
    seeds.push(DVec3::new(0.9, 0.7, 0.0));
    assert_same(&Domain::unit_square(), &seeds);
    let cluster: Vec<DVec3> = flat_seeds(SEEDS).into_iter().map(|seed| seed * 1e-4).collect();
    assert_same(&Domain::unit_square(), &cluster);
}

/// One square lattice cell among random seeds, and seeds on walls and in corners.
#[test]
fn a_few_exact_ties() {
    let mut seeds = flat_seeds(SEEDS);
    let hole = |seed: &DVec3| seed.x > 0.48 && seed.x < 0.52 && seed.y > 0.48 && seed.y < 0.52;
    seeds.retain(|seed| !hole(seed));
    for (x, y) in [(0.49, 0.49), (0.51, 0.49), (0.49, 0.51), (0.51, 0.51)] {
        seeds.push(DVec3::new(x, y, 0.0));
    }
    assert_same(&Domain::unit_square(), &seeds);
}

#[test]
fn seeds_on_walls_and_in_corners() {
    let mut seeds = flat_seeds(SEEDS);
    for (k, seed) in seeds.iter_mut().enumerate().take(400) {
        match k % 4 {
            0 => seed.x = 0.0,
            1 => seed.x = 1.0,
            2 => seed.y = 0.0,
            _ => seed.y = 1.0,
        }
    }
    seeds.extend([DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)]);
    assert_same(&Domain::unit_square(), &seeds);
}

#[test]
fn a_duplicate_among_many_is_named() {
    let mut seeds = flat_seeds(SEEDS);
    seeds.push(seeds[1234]);
    let error = Tessellation::new(&Domain::unit_square(), &seeds).expect_err("a duplicate");
    assert!(error.to_string().contains("1234") && error.to_string().contains("25000"), "{error}");
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let seeds = flat_seeds(SEEDS);
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads");
        pool.install(|| Tessellation::new(&Domain::unit_square(), &seeds).expect("valid seeds"))
    };
    assert_eq!(with_threads(1), with_threads(2));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn mixtures_of_random_and_coarse_coordinates(
        places in prop::collection::hash_set((0..=64u32, 0..=64u32), 1..40),
        jitters in prop::collection::vec((0.0..1.0f64, 0.0..1.0f64), 40),
        share in 0..3,
    ) {
        let mut places: Vec<_> = places.into_iter().collect();
        places.sort_unstable();
        let seeds: Vec<DVec3> = (places.into_iter().zip(jitters).enumerate())
            .map(|(k, ((x, y), (dx, dy)))| {
                // Within a cell of the grid, so that no two are the same.
                let moves = if i32::try_from(k % 3).expect("below 3") < share { DVec3::new(dx, dy, 0.0) / 65.0 } else { DVec3::ZERO };
                DVec3::new(f64::from(x), f64::from(y), 0.0) / 65.0 + moves
            })
            .collect();
        assert_same(&Domain::unit_square(), &seeds);
    }
}
