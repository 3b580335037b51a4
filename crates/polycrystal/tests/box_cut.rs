//! Periodic networks cut at the box: closed, as large as they were, and the same on opposite walls.

#[allow(dead_code, reason = "every test file uses its own share")]
mod common;

use std::collections::BTreeSet;

use common::random_seeds;
use glam::{BVec3, DVec3};
use polycrystal::{Junctions, Network, NetworkError, Relaxation, relax, validate};
use voronoi::{Domain, Tessellation};

fn relaxed(domain: &Domain, seeds: &[DVec3]) -> (Network, Vec<DVec3>) {
    let tessellation = Tessellation::new(domain, seeds).expect("valid seeds");
    let (network, flat) = Network::new(&tessellation, Junctions::Crease, 2).expect("a small network");
    let relaxed = relax(&network, &flat, &Relaxation::default(), |_, _| ()).expect("relaxes");
    let points = relaxed.finest_points(&network);
    (network, points)
}

#[test]
fn cut_grains_are_closed_and_match_on_opposite_walls() {
    let cuboid = Domain::cuboid(DVec3::new(-1.0, 0.3, 2.0), DVec3::new(1.0, 1.7, 3.1)).expect("a box");
    for (domain, count) in [
        (Domain::unit_cube().with_periods(BVec3::TRUE), 40),
        (cuboid.with_periods(BVec3::TRUE), 30),
        (Domain::unit_cube().with_periods(BVec3::new(true, false, true)), 25),
        (Domain::unit_cube().with_periods(BVec3::new(false, false, true)), 25),
        (Domain::unit_square().with_periods(BVec3::TRUE), 40),
        (Domain::unit_square().with_periods(BVec3::new(false, true, false)), 20),
    ] {
        let seeds: Vec<DVec3> = random_seeds(&Domain::unit_cube(), count, 2)
            .iter()
            .map(|seed| domain.lower() + *seed * (domain.upper() - domain.lower()))
            .map(|seed| if domain.dimension() == voronoi::Dimension::Two { seed.with_z(0.0) } else { seed })
            .collect();
        let (network, points) = relaxed(&domain, &seeds);
        let (cut, cut_points) =
            network.cut_at_box(&points).unwrap_or_else(|error| panic!("{domain}: {error}"));
        let cut = cut.with_cell_volumes(network.cell_volumes().to_vec());
        let validation = validate(&cut, &cut_points).expect("valid");
        assert!(validation.largest_volume_error < 1e-9, "{validation:?}");
        let axes = if domain.dimension() == voronoi::Dimension::Two { 2 } else { 3 };
        for axis in (0..axes).filter(|axis| domain.periodic().test(*axis)) {
            let [lower, upper] = [domain.lower(), domain.upper()].map(|wall| {
                let on_wall = cut_points.iter().filter(|point| point[axis] == wall[axis]);
                let others = on_wall.map(|point| [1, 2].map(|other| point[(axis + other) % 3].to_bits()));
                others.collect::<BTreeSet<_>>()
            });
            assert!(lower.len() > 4 && lower == upper, "{} and {} points", lower.len(), upper.len());
        }
        let inside = |point: &DVec3| {
            let [lower, upper] = [domain.lower(), domain.upper()];
            (0..axes).all(|axis| (lower[axis]..=upper[axis]).contains(&point[axis]))
        };
        assert!(cut_points.iter().all(inside));
    }
}

#[test]
fn what_the_box_cannot_cut_is_named() {
    let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
    let (network, points) = relaxed(&domain, &[DVec3::new(0.31, 0.42, 0.23), DVec3::new(0.6, 0.7, 0.8)]);
    let error = network.cut_at_box(&points).expect_err("two grains");
    assert!(matches!(error, NetworkError::MeetsItself { .. }), "{error}");
    let lattice: Vec<DVec3> = (0..27)
        .map(|k| (DVec3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9)) + 0.5) / 3.0)
        .collect();
    let (network, points) = relaxed(&domain, &lattice);
    let error = network.cut_at_box(&points).expect_err("boundaries in the walls");
    assert!(matches!(error, NetworkError::PointOnCut { .. }), "{error}");
}
