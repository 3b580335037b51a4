//! What holds for every tessellation: nearest seeds, permutations, threads, and the statistics of random seeds.

#![allow(clippy::cast_possible_truncation, reason = "a handful of seeds")]

use crate::common::{assert_complex, assert_power_complex, random_seeds, tessellate};
use glam::DVec3;
use proptest::prelude::*;
use voronoi::{CellId, Domain, Side, Tessellation};

/// Random coordinates mixed with coarse ones, so that exact ties are common.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        0.0..=1.0f64,
        (0..=8u32).prop_map(|i| f64::from(i) / 8.0),
        (0..=10u32).prop_map(|i| f64::from(i) / 10.0)
    ]
}

fn distinct_seeds(flat: bool) -> impl Strategy<Value = Vec<DVec3>> {
    let point = (coordinate(), coordinate(), coordinate());
    let point = point.prop_map(move |(x, y, z)| DVec3::new(x, y, if flat { 0.0 } else { z }));
    prop::collection::vec(point, 1..60).prop_map(|mut seeds| {
        seeds.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
        seeds.dedup();
        seeds
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn mixtures_of_random_and_degenerate_seeds_give_complexes(seeds in distinct_seeds(false)) {
        assert_complex(&tessellate(&seeds));
    }

    #[test]
    fn mixtures_in_the_plane_give_complexes(seeds in distinct_seeds(true)) {
        assert_complex(&Tessellation::new(&Domain::unit_square(), &seeds).expect("valid seeds"));
    }

    #[test]
    fn corners_of_a_cell_are_nearest_to_its_seed(seeds in distinct_seeds(false)) {
        let tessellation = tessellate(&seeds);
        for face in tessellation.faces() {
            for side in tessellation.face_sides(face) {
                let Side::Cell(cell) = side else { continue };
                for corner in tessellation.face_corners(face) {
                    let corner = tessellation.vertices()[corner.index()];
                    let own = seeds[cell.index()].distance(corner);
                    prop_assert!(seeds.iter().all(|seed| seed.distance(corner) >= own - 1e-12));
                }
            }
        }
    }

    #[test]
    fn power_cells_give_complexes_and_corners_are_nearest_by_power(
        seeds in distinct_seeds(false),
        radii in prop::collection::vec(prop_oneof![Just(0.0), Just(0.125), 0.0..0.3f64], 60),
        flat in any::<bool>(),
    ) {
        let (domain, seeds) = if flat {
            let mut seeds: Vec<DVec3> = seeds.iter().map(|seed| seed.with_z(0.0)).collect();
            seeds.dedup();
            (Domain::unit_square(), seeds)
        } else {
            (Domain::unit_cube(), seeds)
        };
        let weights: Vec<f64> = radii[..seeds.len()].iter().map(|radius| radius * radius).collect();
        let tessellation = Tessellation::power(&domain, &seeds, &weights).expect("valid seeds");
        assert_power_complex(&tessellation, &weights);
        let power = |point: DVec3, seed: usize| point.distance_squared(seeds[seed]) - weights[seed];
        for face in tessellation.faces() {
            for side in tessellation.face_sides(face) {
                let Side::Cell(cell) = side else { continue };
                for corner in tessellation.face_corners(face) {
                    let corner = tessellation.vertices()[corner.index()];
                    let own = power(corner, cell.index());
                    prop_assert!((0..seeds.len()).all(|seed| power(corner, seed) >= own - 1e-12));
                }
            }
        }
    }

    #[test]
    fn equal_weights_change_nothing(seeds in distinct_seeds(false), weight in 0.0..10.0f64) {
        let power = Tessellation::power(&Domain::unit_cube(), &seeds, &vec![weight; seeds.len()]).expect("valid seeds");
        let plain = tessellate(&seeds);
        prop_assert_eq!(power.vertices().len(), plain.vertices().len());
        for (a, b) in power.vertices().iter().zip(plain.vertices()) {
            prop_assert!(a.distance(*b) < 1e-12);
        }
        for face in plain.faces() {
            prop_assert_eq!(power.face_sides(face), plain.face_sides(face));
            prop_assert_eq!(power.face_corners(face), plain.face_corners(face));
        }
    }

    #[test]
    fn a_permutation_of_the_seeds_permutes_the_cells(seeds in distinct_seeds(false), translation in 0usize..60) {
        let count = seeds.len();
        let translation = translation % count;
        let rotated: Vec<DVec3> = (0..count).map(|i| seeds[(i + translation) % count]).collect();
        let (before, after) = (tessellate(&seeds), tessellate(&rotated));
        prop_assert_eq!(before.vertices().len(), after.vertices().len());
        let old = |side: Side| match side {
            Side::Cell(CellId(id)) => Side::Cell(CellId(((id as usize + translation) % count) as u32)),
            wall => wall,
        };
        for id in 0..count as u32 {
            let mut renamed: Vec<Side> = after.neighbors(CellId(id)).into_iter().map(old).collect();
            renamed.sort_unstable();
            prop_assert_eq!(renamed, before.neighbors(CellId(((id as usize + translation) % count) as u32)));
        }
    }
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let seeds = random_seeds(3000, 11);
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads");
        pool.install(|| tessellate(&seeds))
    };
    assert_eq!(with_threads(1), with_threads(2));
}

/// Mean and standard error of a sample.
fn mean_and_error(sample: &[f64]) -> (f64, f64) {
    let count = sample.len() as f64;
    let mean = sample.iter().sum::<f64>() / count;
    let variance = sample.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

/// Poisson-Voronoi means (Meijering 1953) and the volume variance (Gilbert 1962, evaluated anew) over 20 000 inner cells.
#[test]
fn random_cells_have_the_statistics_of_poisson_voronoi() {
    const SEEDS: usize = 12_000;
    // Cells of seeds at least three mean distances from the walls never feel them.
    let margin = 3.0 * (SEEDS as f64).powf(-1.0 / 3.0);
    let (mut faces, mut vertices, mut areas, mut volumes) = (vec![], vec![], vec![], vec![]);
    for random_seed in 1..=5 {
        let seeds = random_seeds(SEEDS, random_seed);
        let tessellation = tessellate(&seeds);
        let inner = |seed: &DVec3| seed.min_element() > margin && seed.max_element() < 1.0 - margin;
        for (seed, cell) in seeds.iter().zip(tessellation.cell_measures()) {
            if inner(seed) {
                faces.push(cell.face_count as f64);
                vertices.push(cell.vertex_count as f64);
                areas.push(cell.area * (SEEDS as f64).powf(2.0 / 3.0));
                volumes.push(cell.volume * SEEDS as f64);
            }
        }
    }
    assert!(faces.len() >= 20_000, "{} inner cells", faces.len());
    let squared_deviations: Vec<f64> = volumes.iter().map(|volume| (volume - 1.0).powi(2)).collect();
    let expectations = [
        ("faces", &faces, 15.535_46),
        ("vertices", &vertices, 27.070_91),
        ("area", &areas, 5.820_87),
        ("volume", &volumes, 1.0),
        ("volume variance", &squared_deviations, 0.179_032_437_845),
    ];
    for (name, sample, exact) in expectations {
        let (mean, error) = mean_and_error(sample);
        assert!((mean - exact).abs() <= 4.0 * error, "{name}: {mean} +- {error}, exactly {exact}");
    }
}
