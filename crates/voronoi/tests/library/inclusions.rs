//! Grains that are put into others.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::BTreeMap;

use glam::{BVec3, DVec3};
use voronoi::volumes::{
    Inclusion, InclusionPlace, InsertedGrains, PlaceError, PowerDiagram, TOLERANCE, insert_grains,
    place_inclusions, place_spheres,
};
use voronoi::{CellId, Dimension, Domain, Side};

const MATRIX: usize = 30;

/// Numbers from 0 to 1 by a linear congruential generator (Knuth's constants).
fn fractions(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 * 2f64.powi(-53)
    }
}

fn matrix(domain: &Domain, fraction: &mut impl FnMut() -> f64) -> PowerDiagram {
    let volumes = vec![domain.measure() / MATRIX as f64; MATRIX];
    let seeds = place_spheres(domain, &volumes, fraction).unwrap();
    PowerDiagram::with_volumes(domain, &seeds, &volumes).unwrap().lloyd(10).unwrap()
}

fn inserted(
    domain: &Domain,
    place: InclusionPlace,
    share: f64,
    count: usize,
) -> Result<(InsertedGrains, Vec<f64>), PlaceError> {
    let mut fraction = fractions(7);
    let matrix = matrix(domain, &mut fraction);
    let volume = share * domain.measure() / count as f64;
    let placed =
        place_inclusions(matrix.tessellation(), matrix.weights(), &vec![(place, volume); count], fraction)?;
    let rest: Vec<f64> = matrix.volumes().iter().map(|volume| volume * (1.0 - share)).collect();
    let grains = insert_grains(matrix.tessellation(), matrix.weights(), &rest, &placed).unwrap();
    let volumes = rest.into_iter().chain(vec![volume; count]).collect();
    Ok((grains, volumes))
}

/// Numbers of other grains that have a fiftieth of the surface of each inclusion at least.
fn touched(grains: &InsertedGrains, count: usize) -> Vec<usize> {
    let cells = &grains.tessellation;
    let mut areas: Vec<BTreeMap<u32, f64>> = vec![BTreeMap::new(); MATRIX + count];
    for face in cells.faces() {
        if let [Side::Cell(first), Side::Cell(second) | Side::Image(second, _)] = cells.face_sides(face) {
            let [first, second] = [first, second].map(|cell: CellId| grains.grain_of_cell[cell.index()]);
            if first != second {
                for (own, other) in [(first, second), (second, first)] {
                    *areas[own as usize].entry(other).or_default() += cells.face_area(face);
                }
            }
        }
    }
    let touched = |areas: &BTreeMap<u32, f64>| {
        let all: f64 = areas.values().sum();
        areas.values().filter(|area| **area > 0.02 * all).count()
    };
    areas[MATRIX..].iter().map(touched).collect()
}

#[test]
fn inclusions_have_their_volumes_and_touch_the_cells_that_meet_at_their_place() {
    let space = [
        (InclusionPlace::Interior, 20),
        (InclusionPlace::Boundaries, 20),
        (InclusionPlace::TripleLines, 20),
        (InclusionPlace::QuadruplePoints, 20),
    ];
    for (domain, places) in [(Domain::unit_cube(), &space[..]), (Domain::unit_square(), &space[..3])] {
        let is_plane = domain.dimension() == Dimension::Two;
        for domain in [domain.clone(), domain.with_periods(BVec3::new(true, true, !is_plane))] {
            for (place, count) in places {
                let (grains, volumes) = inserted(&domain, *place, 0.01, *count).unwrap();
                let mut reached = vec![0.0; volumes.len()];
                let cells = grains.tessellation.cell_measures();
                cells
                    .iter()
                    .zip(&grains.grain_of_cell)
                    .for_each(|(cell, grain)| reached[*grain as usize] += cell.volume);
                for (reached, wanted) in reached.iter().zip(&volumes) {
                    assert!((reached / wanted - 1.0).abs() <= TOLERANCE, "{place}: {reached} for {wanted}");
                }
                let in_place =
                    touched(&grains, *count).into_iter().filter(|touched| *touched == place.cells()).count();
                // Vertices are often so near to each other that a grain at one touches what meets at the next.
                let least = if *place == InclusionPlace::QuadruplePoints { count / 2 } else { count - 3 };
                assert!(in_place >= least, "{domain} {place}: {in_place} of {count}");
            }
        }
    }
}

#[test]
fn a_place_without_room_is_told_with_how_many_there_are() {
    let count = |place| match inserted(&Domain::unit_cube(), place, 0.1, 400) {
        Err(PlaceError::NoRoom { placed, wanted: 400, .. }) => placed,
        other => panic!("{:?}", other.map(|(_, volumes)| volumes.len())),
    };
    // Four cells meet in some 6.8 vertices a cell, fewer at walls.
    assert!((20..200).contains(&count(InclusionPlace::QuadruplePoints)));
    let one = PowerDiagram::with_volumes(&Domain::unit_cube(), &[DVec3::splat(0.5)], &[1.0]).unwrap();
    let wanted = [(InclusionPlace::TripleLines, 0.1)];
    let error = place_inclusions(one.tessellation(), one.weights(), &wanted, fractions(1)).unwrap_err();
    assert_eq!(error.to_string(), "there is no place on triple lines");
}

#[test]
fn a_ball_in_the_middle_of_a_single_cell_becomes_a_dodecahedron() {
    let one = PowerDiagram::with_volumes(&Domain::unit_cube(), &[DVec3::splat(0.5)], &[1.0]).unwrap();
    let inclusion = Inclusion { cell: CellId(0), center: DVec3::splat(0.5), volume: 0.1 };
    let grains = insert_grains(one.tessellation(), one.weights(), &[0.9], &[inclusion]).unwrap();
    assert_eq!(grains.grain_of_cell.iter().filter(|grain| **grain == 1).count(), 1);
    let cell = grains.grain_of_cell.iter().position(|grain| *grain == 1).unwrap();
    let measure = grains.tessellation.cell_measures()[cell];
    assert_eq!((measure.face_count, measure.edge_count, measure.vertex_count), (12, 30, 20));
    assert!((measure.volume - 0.1).abs() < 1e-11);
    // Area of a regular dodecahedron of volume V: 5.311613997 V^(2/3) (Weisstein).
    assert!((measure.area / (5.311_613_997 * 0.1f64.powf(2.0 / 3.0)) - 1.0).abs() < 1e-6, "{}", measure.area);
    assert!(measure.centroid.distance(DVec3::splat(0.5)) < 1e-9);
}
