//! Networks of grains that are put into others, with few triangles.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use glam::{BVec3, DVec3};
use polycrystal::{
    Elements, FaceMesh, GrainId, GrainPart, Junctions, Network, Relaxation, Volumes, relax_watched, validate,
};
use voronoi::Domain;
use voronoi::volumes::{
    InclusionPlace, InsertedGrains, PowerDiagram, insert_grains, place_inclusions, place_spheres,
};

const MATRIX: usize = 20;
const INCLUSIONS: usize = 12;
const SHARE: f64 = 0.03;

/// Numbers from 0 to 1 by a linear congruential generator (Knuth's constants).
pub fn fractions(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 * 2f64.powi(-53)
    }
}

fn inserted(domain: &Domain, place: InclusionPlace) -> InsertedGrains {
    let mut fraction = fractions(11);
    let volumes = vec![1.0 / MATRIX as f64; MATRIX];
    let seeds = place_spheres(domain, &volumes, &mut fraction).unwrap();
    let matrix = PowerDiagram::with_volumes(domain, &seeds, &volumes).unwrap().lloyd(10).unwrap();
    let wanted = [(place, SHARE / INCLUSIONS as f64); INCLUSIONS];
    let placed = place_inclusions(matrix.tessellation(), matrix.weights(), &wanted, fraction).unwrap();
    let rest: Vec<f64> = volumes.iter().map(|volume| volume * (1.0 - SHARE)).collect();
    insert_grains(matrix.tessellation(), matrix.weights(), &rest, &placed).unwrap()
}

fn network(grains: &InsertedGrains, coarsening: f64, levels: usize) -> (Network, Vec<DVec3>) {
    let of_cells = grains.grain_of_cell.iter().copied().map(GrainId).zip(&grains.moves);
    let parts: Vec<GrainPart> = of_cells.map(|(grain, moved)| GrainPart { grain, moved: *moved }).collect();
    let (mesh, junctions) = (FaceMesh::Fan, Junctions::Crease);
    Network::of_grains(&grains.tessellation, &parts, mesh, junctions, coarsening, levels).unwrap()
}

const PLACES: [InclusionPlace; 3] =
    [InclusionPlace::Interior, InclusionPlace::Boundaries, InclusionPlace::TripleLines];

#[test]
fn grains_around_inclusions_relax_and_stay_valid_with_their_volumes() {
    let walled = [Domain::unit_cube(), Domain::unit_square()];
    let periodic = walled.clone().map(|domain| domain.with_periods(BVec3::TRUE));
    for domain in walled.into_iter().chain(periodic) {
        for place in PLACES {
            let grains = inserted(&domain, place);
            let (network, flat) = network(&grains, 0.25, 1);
            let time = Relaxation::Time(0.05);
            let relaxed = relax_watched(&network, &flat, &time, Volumes::Kept, |_| {}).unwrap();
            let points = relaxed.finest_points(&network);
            validate(&network, &points).unwrap_or_else(|error| panic!("{domain} {place}: {error}"));
            let volumes = network.grain_volumes(network.finest(), &points);
            assert_eq!(volumes.len(), MATRIX + INCLUSIONS);
            for volume in &volumes[MATRIX..] {
                let wanted = SHARE / INCLUSIONS as f64;
                assert!((volume / wanted - 1.0).abs() < 1e-10, "{domain} {place}: {volume}");
            }
        }
    }
}

#[test]
fn coarsening_leaves_fewer_elements_and_every_boundary() {
    for domain in [Domain::unit_cube(), Domain::unit_square()] {
        for place in PLACES {
            let grains = inserted(&domain, place);
            let [(fine, _), (coarse, points)] = [0.0, 0.25].map(|length| network(&grains, length, 0));
            assert_eq!(fine.grain_count(), coarse.grain_count());
            let count = |network: &Network| network.control_mesh().element_count();
            assert!(count(&coarse) * 2 < count(&fine), "{place}: {} of {}", count(&coarse), count(&fine));
            // The walls are where they were.
            let size =
                |network: &Network, points: &[DVec3]| network.grain_volumes(network.control_mesh(), points);
            let sum: f64 = size(&coarse, &points).iter().sum();
            assert!((sum - 1.0).abs() < 1e-12, "{place}: {sum}");
        }
    }
}

#[test]
fn an_inclusion_inside_a_grain_is_a_closed_boundary_without_lines() {
    let grains = inserted(&Domain::unit_cube(), InclusionPlace::Interior);
    let (network, _) = network(&grains, 0.25, 0);
    let level = network.control_mesh();
    let of_inclusions = |boundary: &polycrystal::Boundary| {
        boundary.sides.iter().filter_map(|side| side.grain()).any(|grain| grain.index() >= MATRIX)
    };
    let own: Vec<usize> = network
        .boundaries()
        .iter()
        .enumerate()
        .filter(|(_, boundary)| of_inclusions(boundary))
        .map(|(number, _)| number)
        .collect();
    assert_eq!(own.len(), INCLUSIONS);
    let polycrystal::Mesh::Triangles(mesh) = &level.mesh else { panic!("triangles in space") };
    for boundary in own {
        let corners: Vec<[u32; 3]> = mesh
            .triangles()
            .iter()
            .zip(&level.boundary_of)
            .filter(|(_, of)| of.index() == boundary)
            .map(|(corners, _)| *corners)
            .collect();
        let mut points: Vec<u32> = corners.iter().flatten().copied().collect();
        points.sort_unstable();
        points.dedup();
        // A sphere: V - E + F = 2, and three edges for two triangles.
        assert_eq!(2 * points.len(), corners.len() + 4);
        let elements = Elements::Triangles(&corners);
        assert_eq!(elements.len(), corners.len());
    }
}
