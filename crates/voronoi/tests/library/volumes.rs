//! Power diagrams whose cells have given volumes.

use crate::common::{BODY_CENTRED, SIMPLE_CUBIC, assert_power_complex, lattice, random_seeds, square};
use glam::{BVec3, DVec3};
use rayon::ThreadPoolBuilder;
use voronoi::volumes::{PowerDiagram, TOLERANCE, VolumesError, place_spheres};
use voronoi::{Dimension, Domain, Tessellation, VoronoiError};

fn periodic_cube() -> Domain {
    Domain::unit_cube().with_periods(BVec3::TRUE)
}

/// Numbers from 0 to 1.
fn fractions(count: usize, random_seed: u64) -> Vec<f64> {
    random_seeds(count.div_ceil(3), random_seed)
        .into_iter()
        .flat_map(|point| point.to_array())
        .take(count)
        .collect()
}

/// Volumes of lognormal diameters with a coefficient of variation that fill the domain.
fn lognormal(domain: &Domain, count: usize, variation: f64) -> Vec<f64> {
    let spread = (1.0 + variation * variation).ln().sqrt();
    let normal = fractions(2 * count, 7);
    let normal = normal
        .chunks(2)
        .map(|pair| (-2.0 * (1.0 - pair[0]).ln()).sqrt() * (std::f64::consts::TAU * pair[1]).cos());
    let axes = if domain.dimension() == Dimension::Two { 2.0 } else { 3.0 };
    filling(domain, normal.map(|normal| (axes * spread * normal).exp()).collect())
}

fn filling(domain: &Domain, volumes: Vec<f64>) -> Vec<f64> {
    let scale = domain.measure() / volumes.iter().sum::<f64>();
    volumes.into_iter().map(|volume| volume * scale).collect()
}

fn placed(domain: &Domain, volumes: &[f64]) -> Vec<DVec3> {
    let mut fractions = fractions(1_000_000, 3).into_iter();
    place_spheres(domain, volumes, || fractions.next().expect("a million numbers are enough"))
        .expect("good volumes")
}

fn assert_volumes(diagram: &PowerDiagram, volumes: &[f64]) {
    assert_power_complex(diagram.tessellation(), diagram.weights());
    for (grain, (cell, volume)) in diagram.tessellation().cell_measures().iter().zip(volumes).enumerate() {
        let error = (cell.volume / volume - 1.0).abs();
        assert!(error <= 1.1 * TOLERANCE, "grain {grain} has {} for {volume}: {error:e}", cell.volume);
    }
}

#[test]
fn each_grain_has_its_volume_in_any_domain() {
    let rectangle = Domain::rectangle(DVec3::ZERO, DVec3::new(2.0, 1.0, 0.0)).expect("a good rectangle");
    let domains = [
        Domain::unit_cube(),
        periodic_cube(),
        Domain::unit_cube().with_periods(BVec3::new(false, true, false)),
        Domain::ball(DVec3::splat(0.3), 0.5, 1e-2).expect("a good ball"),
        Domain::cylinder(DVec3::ZERO, 0.4, 2.0, 1e-2).expect("a good cylinder"),
        rectangle.clone(),
        rectangle.with_periods(BVec3::TRUE),
        Domain::disc(DVec3::ZERO, 1.0, 1e-3).expect("a good disc"),
    ];
    for domain in domains {
        for variation in [0.35, 1.0] {
            let volumes = lognormal(&domain, 150, variation);
            let seeds = placed(&domain, &volumes);
            let diagram = PowerDiagram::with_volumes(&domain, &seeds, &volumes).expect("volumes are reached");
            assert_eq!(diagram.tessellation().seeds(), seeds);
            assert_volumes(&diagram, &volumes);
            let rounder = diagram.lloyd(3).expect("volumes are kept");
            assert_ne!(rounder.tessellation().seeds(), seeds);
            assert_volumes(&rounder, &volumes);
        }
    }
}

/// Large grains a thousand times as large as small ones.
#[test]
fn diameters_of_one_to_ten_are_reached() {
    for domain in [periodic_cube(), Domain::unit_cube()] {
        let volumes: Vec<f64> = (0..500).map(|grain| if grain % 50 == 0 { 1000.0 } else { 1.0 }).collect();
        let volumes = filling(&domain, volumes);
        let diagram = PowerDiagram::with_volumes(&domain, &placed(&domain, &volumes), &volumes);
        assert_volumes(&diagram.expect("volumes are reached"), &volumes);
    }
}

/// Uniform random seeds whose first weights leave cells empty.
#[test]
fn seeds_may_stand_anywhere() {
    let domain = periodic_cube();
    let (seeds, volumes) = (random_seeds(300, 11), lognormal(&domain, 300, 1.0));
    let diagram = PowerDiagram::with_volumes(&domain, &seeds, &volumes).expect("volumes are reached");
    assert_volumes(&diagram, &volumes);
}

/// Two cells of a square of sides 1: the difference of weights follows from where the face is.
#[test]
fn weights_of_two_cells_are_those_of_geometry() {
    let seeds = [DVec3::new(0.25, 0.5, 0.0), DVec3::new(0.75, 0.5, 0.0)];
    for at in [0.001, 0.3, 0.9] {
        let diagram =
            PowerDiagram::with_volumes(&Domain::unit_square(), &seeds, &[at, 1.0 - at]).expect("reached");
        let difference = (at - 0.75).powi(2) - (at - 0.25).powi(2);
        assert!((diagram.weights()[1] - diagram.weights()[0] - difference).abs() < 1e-12, "{at}");
        assert!(diagram.weights().iter().sum::<f64>().abs() < 1e-15);
    }
}

#[test]
fn lattices_keep_weights_and_places() {
    let cube = periodic_cube();
    let flat = Domain::unit_square().with_periods(BVec3::TRUE);
    let cases =
        [(cube.clone(), lattice(4, &SIMPLE_CUBIC)), (cube, lattice(3, &BODY_CENTRED)), (flat, square(5))];
    for (domain, seeds) in cases {
        let volumes = vec![domain.measure() / seeds.len() as f64; seeds.len()];
        let diagram = PowerDiagram::with_volumes(&domain, &seeds, &volumes).expect("volumes are reached");
        assert!(diagram.weights().iter().all(|weight| *weight == 0.0));
        let moved = diagram.lloyd(2).expect("volumes are kept");
        assert_eq!(moved.centroid_steps(), 2);
        for (seed, old) in moved.tessellation().seeds().iter().zip(&seeds) {
            assert!(seed.distance(*old) < 1e-14, "{seed} for {old}");
        }
        assert!(moved.weights().iter().all(|weight| weight.abs() < 1e-14), "{:?}", moved.weights());
    }
}

/// Seeds, volumes and weights of a prototype.
#[derive(serde::Deserialize)]
struct Case {
    #[serde(rename = "box")]
    sides: [f64; 3],
    periodic: [bool; 3],
    seeds: Vec<[f64; 3]>,
    target_volumes: Vec<f64>,
    /// Up to a common constant.
    weights: Vec<f64>,
}

#[test]
fn weights_are_those_of_the_reference() {
    let cases: Vec<Case> =
        serde_json::from_str(include_str!("../data/exact_volumes.json")).expect("reference data");
    for Case { sides, periodic, seeds, target_volumes, weights } in cases {
        let domain = Domain::cuboid(DVec3::ZERO, sides.into()).expect("a good box");
        let domain = domain.with_periods(periodic.into());
        let seeds: Vec<DVec3> = seeds.into_iter().map(DVec3::from_array).collect();
        let volumes = filling(&domain, target_volumes);
        let diagram = PowerDiagram::with_volumes(&domain, &seeds, &volumes).expect("volumes are reached");
        assert_volumes(&diagram, &volumes);
        let mean = weights.iter().sum::<f64>() / weights.len() as f64;
        for (weight, expected) in diagram.weights().iter().zip(weights) {
            assert!((weight - (expected - mean)).abs() < 1e-9, "{weight} for {}", expected - mean);
        }
    }
}

#[test]
fn one_cell_is_the_domain() {
    for domain in [Domain::unit_cube(), periodic_cube()] {
        let diagram =
            PowerDiagram::with_volumes(&domain, &[DVec3::splat(0.4)], &[1.0]).expect("it fills the cube");
        assert_eq!(diagram.lloyd(1).expect("it fills the cube").weights(), [0.0]);
    }
}

/// Weights are squared lengths, and do not know where the origin is.
#[test]
fn units_and_origin_do_not_matter() {
    let domain = periodic_cube();
    let volumes = lognormal(&domain, 100, 0.35);
    let seeds = placed(&domain, &volumes);
    let weights = |scale: f64, translation: f64| {
        let place = |point: DVec3| (point + translation) * scale;
        let domain = Domain::cuboid(place(DVec3::ZERO), place(DVec3::ONE))
            .expect("a good box")
            .with_periods(BVec3::TRUE);
        let seeds: Vec<DVec3> = seeds.iter().map(|seed| place(*seed)).collect();
        let volumes = filling(&domain, volumes.clone());
        let diagram = PowerDiagram::with_volumes(&domain, &seeds, &volumes).expect("volumes are reached");
        diagram.weights().iter().map(|weight| weight / (scale * scale)).collect::<Vec<f64>>()
    };
    let expected = weights(1.0, 0.0);
    for (scale, translation) in
        [(1e-8, 0.0), (3e7, 0.0), (1e-25, 0.0), (1e25, 0.0), (1.0, 100.0), (1.0, -0.5)]
    {
        for (weight, expected) in weights(scale, translation).iter().zip(&expected) {
            assert!((weight - expected).abs() < 1e-11, "{weight} for {expected} at {scale}, {translation}");
        }
    }
}

/// The mean was taken off the weights after the cells were made: made again, these differed in the last digits.
#[test]
fn weights_make_the_same_cells_again() {
    let domain = periodic_cube();
    let volumes = lognormal(&domain, 40, 0.5);
    let diagram = PowerDiagram::with_volumes(&domain, &placed(&domain, &volumes), &volumes);
    let diagram = diagram.and_then(|diagram| diagram.lloyd(2)).unwrap();
    let cells = diagram.tessellation();
    let again = Tessellation::power(&domain, cells.seeds(), diagram.weights()).unwrap();
    assert_eq!(again.vertices(), cells.vertices());
    assert_eq!(again.cell_measures(), cells.cell_measures());
}

#[test]
fn threads_do_not_matter() {
    let domain = periodic_cube();
    let volumes = lognormal(&domain, 400, 0.35);
    let seeds = placed(&domain, &volumes);
    let [one, two] = [1, 2].map(|threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        pool.install(|| {
            PowerDiagram::with_volumes(&domain, &seeds, &volumes).and_then(|diagram| diagram.lloyd(2))
        })
    });
    assert_eq!(one.expect("volumes are reached"), two.expect("volumes are reached"));
}

/// As many faces as measured metals have: 13.72 is the mean of three prototypes with 2000 grains, 0.05 their spread.
#[test]
fn ten_steps_make_cells_like_those_of_metals() {
    let domain = periodic_cube();
    let volumes = lognormal(&domain, 1000, 0.35);
    let diagram = PowerDiagram::with_volumes(&domain, &placed(&domain, &volumes), &volumes);
    let rounder = diagram.and_then(|diagram| diagram.lloyd(10)).expect("volumes are reached");
    assert_volumes(&rounder, &volumes);
    let measures = rounder.tessellation().cell_measures();
    let faces = measures.iter().map(|cell| cell.face_count).sum::<usize>() as f64 / 1000.0;
    assert!((faces - 13.72).abs() < 0.2, "{faces} faces");
    let ball_area = |volume: f64| (36.0 * std::f64::consts::PI * volume * volume).cbrt();
    let sphericity = measures.iter().map(|cell| ball_area(cell.volume) / cell.area).sum::<f64>() / 1000.0;
    assert!((sphericity - 0.855).abs() < 0.01, "sphericity {sphericity}");
}

#[test]
fn spheres_do_not_overlap() {
    let domain = periodic_cube();
    let volumes = lognormal(&domain, 300, 1.0);
    let seeds = placed(&domain, &volumes);
    let radii: Vec<f64> =
        volumes.iter().map(|volume| (0.35 * 0.75 * volume / std::f64::consts::PI).cbrt()).collect();
    for i in 0..seeds.len() {
        for j in 0..i {
            let way = seeds[i] - seeds[j];
            let distance = (way - way.round()).length();
            assert!(distance >= radii[i] + radii[j] - 1e-15, "spheres {i} and {j} overlap");
        }
    }
}

#[test]
fn bad_volumes_are_named() {
    let domain = Domain::unit_cube();
    let seeds = random_seeds(3, 1);
    let error =
        |volumes: &[f64]| PowerDiagram::with_volumes(&domain, &seeds, volumes).expect_err("bad volumes");
    assert_eq!(error(&[0.5, 0.5]), VolumesError::Count { seeds: 3, volumes: 2 });
    assert_eq!(error(&[0.5, 0.0, 0.5]), VolumesError::BadVolume { grain: 1, volume: 0.0 });
    assert_eq!(error(&[0.5, 1.0, -0.5]), VolumesError::BadVolume { grain: 2, volume: -0.5 });
    assert!(matches!(error(&[0.5, f64::NAN, 0.5]), VolumesError::BadVolume { grain: 1, .. }));
    assert_eq!(
        error(&[0.5, 1.0, 0.5]).to_string(),
        "the volumes add up to 2, but the domain [0, 1] x [0, 1] x [0, 1] has 1; multiply each by 0.5"
    );
    let twice = [seeds[0], seeds[1], seeds[0]];
    let same = PowerDiagram::with_volumes(&domain, &twice, &filling(&domain, vec![1.0; 3]));
    assert!(matches!(
        same,
        Err(VolumesError::Voronoi(VoronoiError::DuplicateSeeds { first: 0, second: 2, .. }))
    ));
    let placed = place_spheres(&domain, &[0.7, 0.2], || 0.5);
    assert!(matches!(placed, Err(VolumesError::BadSum { .. })));
}
