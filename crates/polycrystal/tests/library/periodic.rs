//! Periodic networks: whole, closed grains, and copies that match their originals on every level.

use std::collections::{BTreeMap, BTreeSet};

use crate::common::random_seeds;
use glam::{BVec3, DVec3};
use polycrystal::{
    FaceMesh, Junctions, Level, Mesh, Network, NetworkError, NodeType, RegularCells, Relaxation, Side,
    dihedral_angles, regular_cells, relax, validate,
};
use voronoi::{Domain, PeriodicPair, Tessellation, Translation};

fn domains() -> [Domain; 5] {
    let x = BVec3::new(true, false, false);
    let plate = Domain::cuboid(DVec3::ZERO, DVec3::new(3.0, 1.0, 0.2)).expect("positive sides");
    [
        Domain::unit_cube().with_periods(BVec3::TRUE),
        Domain::unit_cube().with_periods(x),
        plate.with_periods(BVec3::new(true, true, false)),
        Domain::unit_square().with_periods(BVec3::TRUE),
        Domain::unit_square().with_periods(x),
    ]
}

fn network(domain: &Domain, seeds: &[DVec3], levels: usize) -> (Tessellation, Network, Vec<DVec3>) {
    let tessellation = Tessellation::new(domain, seeds).expect("valid seeds");
    let (network, flat) = Network::new(&tessellation, Junctions::Crease, levels).expect("a small network");
    (tessellation, network, flat)
}

fn elements(level: &Level) -> Vec<Vec<usize>> {
    let indices = |corners: &[u32]| corners.iter().map(|corner| *corner as usize).collect();
    match &level.mesh {
        Mesh::Triangles(mesh) => mesh.triangles().iter().map(|corners| indices(corners)).collect(),
        Mesh::Segments(mesh) => mesh.segments().iter().map(|ends| indices(ends)).collect(),
    }
}

/// Of each vertex, its original and the translation from there.
fn originals(level: &Level) -> Vec<(usize, Translation)> {
    let mut originals: Vec<(usize, Translation)> =
        (0..level.vertex_count()).map(|v| (v, Translation::ZERO)).collect();
    for pair in &level.copies.vertices {
        originals[pair.secondary as usize] = (pair.primary as usize, pair.translation);
    }
    originals
}

#[test]
fn periodic_networks_are_valid() {
    for domain in domains() {
        for count in [1, 2, 5, 40] {
            let (_, network, flat) = network(&domain, &random_seeds(&domain, count, 3), 2);
            let validation = validate(&network, &network.subdivide(&flat)).expect("valid");
            assert!(validation.largest_volume_error < 1e-12, "{count} in {domain}");
        }
    }
}

#[test]
fn copies_stand_a_shift_from_their_originals_on_every_level() {
    for domain in domains() {
        for count in [1, 3, 40] {
            let seeds = random_seeds(&domain, count, 1);
            for level in 0..3 {
                let (_, network, flat) = network(&domain, &seeds, level);
                let points = network.subdivide(&flat);
                let originals = originals(network.finest().held());
                for &PeriodicPair { secondary, primary, translation } in
                    &network.finest().held().copies.vertices
                {
                    assert_eq!(originals[primary as usize], (primary as usize, Translation::ZERO));
                    let moved = points[primary as usize] + translation.vector(&domain);
                    assert_eq!(points[secondary as usize], moved);
                }
            }
        }
    }
}

/// The elements of a boundary and those of its twin have the same corners but for the translation, the other way round.
#[test]
fn twins_are_the_same_triangles_turned_round() {
    for domain in domains() {
        for count in [1, 3, 40] {
            let (_, network, _) = network(&domain, &random_seeds(&domain, count, 2), 2);
            let level = network.finest().held();
            let originals = originals(level);
            let corners_of =
                |boundary: usize, translation: Translation| -> BTreeSet<Vec<(usize, Translation)>> {
                    let of_boundary = elements(level).into_iter().zip(&level.boundary_of);
                    let of_boundary = of_boundary.filter(|(_, of)| of.index() == boundary);
                    let named = |corners: Vec<usize>| -> Vec<(usize, Translation)> {
                        corners.iter().map(|v| (originals[*v].0, originals[*v].1 + translation)).collect()
                    };
                    of_boundary.map(|(corners, _)| named(corners)).collect()
                };
            let first_smallest = |mut corners: Vec<(usize, Translation)>| {
                let smallest = (0..corners.len()).min_by_key(|k| corners[*k]).expect("corners");
                if corners.len() == 3 {
                    corners.rotate_left(smallest);
                }
                corners
            };
            let mut twins = 0;
            for (id, boundary) in network.boundaries().iter().enumerate() {
                let Some(twin) = boundary.twin else { continue };
                assert_eq!(boundary.sides[1], Side::Exterior);
                let back = network.boundaries()[twin.boundary.index()].twin.expect("twins know each other");
                assert_eq!(
                    (back.boundary.index(), back.translation),
                    (id, Translation::ZERO - twin.translation)
                );
                if twins < 6 {
                    let turned = |mut corners: Vec<(usize, Translation)>| {
                        corners.reverse();
                        first_smallest(corners)
                    };
                    let here: BTreeSet<_> =
                        corners_of(id, twin.translation).into_iter().map(turned).collect();
                    let there = corners_of(twin.boundary.index(), Translation::ZERO);
                    assert_eq!(here, there.into_iter().map(first_smallest).collect());
                }
                twins += 1;
            }
            assert!(twins > 0);
        }
    }
}

#[test]
fn junctions_are_counted_once() {
    let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
    let (tessellation, network, _) = network(&domain, &random_seeds(&domain, 60, 4), 1);
    let edges = tessellation.edges();
    let lines = edges.ends.len() - tessellation.periodic_edges(&edges).len();
    let points = tessellation.vertices().len() - tessellation.periodic_vertices().len();
    // In general position three grains meet at each edge and four at each vertex.
    assert_eq!(network.junction_counts().triple_lines, lines);
    assert_eq!(network.junction_counts().quadruple_points, points);
    assert_eq!(lines, 2 * points);
    assert_eq!(network.junction_counts().lines_by_sides, BTreeMap::from([(3, lines)]));
    assert_eq!(network.junction_counts().points_by_sides, BTreeMap::from([(4, points)]));
    for level in network.levels() {
        for pair in &level.copies.vertices {
            let [copy, original] =
                [pair.secondary, pair.primary].map(|v| level.node_types[v as usize].code() % 10);
            assert_eq!(copy, original);
        }
    }
    let outer = |boundary: usize| network.boundaries()[boundary].twin.is_some();
    for (corners, boundary) in
        elements(network.finest().held()).iter().zip(&network.finest().held().boundary_of)
    {
        let is_outer = corners.iter().all(|v| network.finest().held().node_types[*v].code() >= 10);
        assert!(!outer(boundary.index()) || is_outer);
    }
    assert!(network.finest().held().node_types.contains(&NodeType::OUTER));
}

/// A cube that repeats: eight images of the one grain meet at a corner, four along an edge, two in a face.
#[test]
fn images_of_a_grain_count_as_grains() {
    let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
    let (_, network, flat) = network(&domain, &[DVec3::splat(0.5)], 2);
    let level = network.finest().held();
    let points = network.subdivide(&flat);
    for (point, grains) in points.iter().zip(&level.grain_counts) {
        let on_planes = point.to_array().iter().filter(|at| (**at - at.round()).abs() < 1e-12).count();
        assert_eq!(*grains, [1, 2, 4, 8][on_planes], "{point}");
    }
    let counts = network.junction_counts();
    assert_eq!(counts.lines_by_sides, BTreeMap::from([(4, 3)]));
    assert_eq!(counts.points_by_sides, BTreeMap::from([(8, 1)]));
    validate(&network, &points).expect("the grains at all copies of a point are as many as it states");
}

#[test]
fn periodic_grains_relax_and_stay_periodic() {
    for (domain, count, levels) in [
        (Domain::unit_cube().with_periods(BVec3::TRUE), 30, 2),
        (Domain::unit_cube().with_periods(BVec3::new(true, false, false)), 20, 1),
        (Domain::unit_square().with_periods(BVec3::TRUE), 40, 2),
    ] {
        let (_, network, flat) = network(&domain, &random_seeds(&domain, count, 4), levels);
        let still = relax(&network, &flat, &Relaxation::Time(0.0), |_, _| ()).expect("nothing to do");
        assert_eq!(still.points, flat);
        let relaxed = relax(&network, &flat, &Relaxation::KEPT_TOPOLOGY, |_, _| ()).expect("relaxes");
        let smooth = relaxed.finest_points(&network);
        assert!(validate(&network, &smooth).expect("valid").largest_volume_error < 1e-10);
        let spread = |points: &[DVec3]| {
            let angles = dihedral_angles(&network, network.finest(), points);
            angles.expect("triple lines").standard_deviation
        };
        assert!(spread(&smooth) < 0.6 * spread(&network.subdivide(&flat)));
        for pair in &network.finest().held().copies.vertices {
            let [copy, original] = [pair.secondary, pair.primary].map(|vertex| smooth[vertex as usize]);
            assert_eq!(copy, original + pair.translation.vector(&domain));
        }
    }
}

/// What is short collapses as it does in a box, and what is a copy stays one.
#[test]
fn periodic_grains_are_regularised() {
    for (domain, count) in [
        (Domain::unit_cube().with_periods(BVec3::TRUE), 60),
        (Domain::unit_cube().with_periods(BVec3::new(false, true, false)), 30),
        (Domain::unit_square().with_periods(BVec3::TRUE), 60),
    ] {
        let cells = Tessellation::new(&domain, &random_seeds(&domain, count, 6)).expect("valid seeds");
        let RegularCells { cells: regular, collapsed, given_up } =
            regular_cells(&cells, 0.15).expect("a small network");
        assert_eq!(given_up, []);
        assert!(collapsed.edges > count / 4, "{collapsed:?}");
        let (network, flat) = Network::with_face_mesh(&regular, FaceMesh::SparseFan, Junctions::Crease, 2)
            .expect("a small network");
        let volumes = cells.cell_measures().iter().map(|cell| cell.volume).collect();
        let network = network.with_cell_volumes(volumes);
        let relaxed = relax(&network, &flat, &Relaxation::KEPT_TOPOLOGY, |_, _| ()).expect("relaxes");
        let smooth = relaxed.finest_points(&network);
        assert!(validate(&network, &smooth).expect("valid").largest_volume_error < 1e-10);
        let angles = dihedral_angles(&network, network.finest(), &smooth).expect("triple lines");
        let largest = if domain.dimension() == voronoi::Dimension::Two { 16.0 } else { 8.5 };
        assert!(angles.standard_deviation < largest, "{angles:?}");
        for pair in &network.finest().held().copies.vertices {
            let [copy, original] = [pair.secondary, pair.primary].map(|vertex| smooth[vertex as usize]);
            assert_eq!(copy, original + pair.translation.vector(&domain));
        }
    }
}

#[test]
fn boundaries_that_are_too_small_are_named_by_both_their_grains() {
    let seeds: Vec<DVec3> = [
        [0.0, 0.0, 0.05],
        [0.0, 0.0, 0.15],
        [0.0, 0.75, 0.0],
        [0.25, 0.5, 0.0],
        [0.25, 0.5, 0.15],
        [0.25, 0.75, 0.05],
        [0.5, 0.5, 0.05],
        [0.5, 0.75, 0.0],
        [0.75, 0.25, 0.0],
        [0.75, 0.5, 0.0],
        [0.75, 0.5, 0.1],
        [0.75, 0.75, 0.15],
    ]
    .map(DVec3::from)
    .into();
    let plate = Domain::cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 0.2)).expect("positive sides");
    let cells = Tessellation::new(&plate.with_periods(BVec3::TRUE), &seeds).expect("valid seeds");
    let error = Network::new(&cells, Junctions::Crease, 0).expect_err("nearly a lattice");
    let NetworkError::BoundaryTooSmall { sides } = error else { panic!("{error}") };
    assert!(!sides.contains(&Side::Exterior), "{error}");
}
