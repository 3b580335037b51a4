//! Networks in domains other than boxes: closed, of true volume, and on their walls.

use crate::common::random_seeds;
use glam::DVec3;
use polycrystal::{
    FaceMesh, Freedom, Junctions, Network, NetworkRecipe, Relaxation, relax, relax_cells, remove_short_edges,
    validate,
};
use voronoi::{Domain, Tessellation, WallPlane};

fn domains() -> Vec<(&'static str, Domain)> {
    let signs = [-1.0, 1.0];
    let corners: Vec<DVec3> = signs
        .iter()
        .flat_map(|x| signs.iter().flat_map(move |y| signs.map(|z| DVec3::new(*x, *y, z))))
        .collect();
    let solid = |normals: &mut dyn Iterator<Item = &DVec3>| {
        let walls = normals.map(|normal| WallPlane::HalfSpace { normal: *normal, offset: 1.0 });
        Domain::polyhedron(walls.collect()).expect("a solid")
    };
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.4, 0.5, 0.9]]
        .map(DVec3::from);
    let faces = [vec![3, 2, 1, 0], vec![0, 1, 4], vec![1, 2, 4], vec![2, 3, 4], vec![3, 0, 4]];
    vec![
        ("octahedron", solid(&mut corners.iter())),
        ("tetrahedron", solid(&mut corners.iter().filter(|corner| corner.element_product() > 0.0))),
        ("pyramid", Domain::convex_surface(&points, &faces).expect("a pyramid")),
        ("ball", Domain::ball(DVec3::splat(0.5), 0.5, 0.005).expect("a ball")),
        ("cylinder", Domain::cylinder(DVec3::ZERO, 0.5, 0.8, 0.005).expect("a cylinder")),
        ("disc", Domain::disc(DVec3::ZERO, 0.5, 0.005).expect("a disc")),
    ]
}

#[test]
fn networks_are_valid_flat_and_relaxed() {
    for (name, domain) in domains() {
        let seeds: Vec<DVec3> = random_seeds(&domain, 150, 2)
            .into_iter()
            .filter(|seed| domain.contains(*seed))
            .take(25)
            .collect();
        for levels in [0, 2] {
            let cells = Tessellation::new(&domain, &seeds).expect("seeds");
            let (network, flat) = Network::new(&cells, Junctions::Crease, levels).expect("a network");
            let certificate = validate(&network, &network.subdivide(&flat))
                .unwrap_or_else(|fault| panic!("{name}: {fault}"));
            assert!(certificate.largest_volume_error < 1e-12, "{name}");
            let volumes = cells.cell_measures().iter().map(|cell| cell.volume).collect();
            let (regular, _) = remove_short_edges(&cells, 0.1);
            let (network, flat) = Network::new(&regular, Junctions::Crease, levels).expect("a network");
            let network = network.with_cell_volumes(volumes);
            let relaxed = relax(&network, &flat, &Relaxation::KEPT_TOPOLOGY, |_, _| ())
                .unwrap_or_else(|error| panic!("{name}: {error}"));
            let points = relaxed.finest_points(&network);
            let certificate = validate(&network, &points).unwrap_or_else(|fault| panic!("{name}: {fault}"));
            assert!(certificate.largest_volume_error < 1e-9, "{name}");
            let sets = network.wall_sets();
            let mut moved = 0.0f64;
            let before = network.subdivide(&flat);
            for ((point, before), set) in points.iter().zip(&before).zip(&network.finest().held().walls) {
                for wall in sets.walls(*set) {
                    let (normal, distance) = domain.wall_equation(*wall);
                    assert!((normal.dot(*point) - distance).abs() < 1e-13, "{name}: {point} leaves {wall:?}");
                }
                if sets.freedom(*set) == Freedom::Nowhere {
                    assert!(point.distance(*before) < 1e-13, "{name}: a corner of the domain moves");
                }
                moved = moved.max(point.distance(*before));
            }
            assert!(moved > 0.01, "{name}: nothing relaxes");
        }
    }
}

/// Vertices that events add at walls that meet at small angles once were off them, and grains of balls lost their volumes.
#[test]
fn grains_switch_neighbors_at_the_walls_of_any_domain() {
    for (name, domain) in domains().into_iter().filter(|(name, _)| *name != "disc") {
        let seeds: Vec<DVec3> = random_seeds(&domain, 150, 2)
            .into_iter()
            .filter(|seed| domain.contains(*seed))
            .take(25)
            .collect();
        let cells = Tessellation::new(&domain, &seeds).expect("seeds");
        for face_mesh in [FaceMesh::Fan, FaceMesh::Plain, FaceMesh::Refined { edge_length: 0.2 }] {
            let recipe = NetworkRecipe {
                face_mesh,
                junctions: Junctions::Crease,
                levels: 1,
                tension: &|boundary| f64::from(u8::from(boundary.wall.is_none())),
            };
            let relaxed = relax_cells(&cells, &recipe, &Relaxation::USUAL, |_| ())
                .unwrap_or_else(|error| panic!("{name} {face_mesh:?}: {error}"));
            assert!(relaxed.reconnections.count() > 5, "{name}");
            assert!(relaxed.validation.largest_volume_error < 1e-9, "{name}");
            let network = &relaxed.network;
            let points = relaxed.relaxed.finest_points(network);
            for (point, set) in points.iter().zip(&network.finest().held().walls) {
                for wall in network.wall_sets().walls(*set) {
                    let (normal, distance) = domain.wall_equation(*wall);
                    assert!((normal.dot(*point) - distance).abs() < 1e-12, "{name}: {point} leaves {wall:?}");
                }
            }
        }
    }
}

#[test]
fn one_grain_is_the_domain() {
    for (name, domain) in domains() {
        let seed =
            random_seeds(&domain, 50, 3).into_iter().find(|seed| domain.contains(*seed)).expect("one inside");
        let cells = Tessellation::new(&domain, &[seed]).expect("a seed");
        let (network, flat) = Network::new(&cells, Junctions::Crease, 1).expect("a network");
        let points = network.subdivide(&flat);
        validate(&network, &points).unwrap_or_else(|fault| panic!("{name}: {fault}"));
        let volume = network.grain_volumes(network.finest(), &points)[0];
        assert!((volume - domain.measure()).abs() < 1e-12 * volume, "{name}: {volume}");
    }
}

/// At rest nothing but rounding is left of the forces, beside what the walls hold: it grew until the points left their walls, and both
/// grains lost a ten-thousandth of their volume.
#[test]
fn points_of_two_grains_at_rest_in_a_cylinder_stay_on_its_walls() {
    let domain = Domain::cylinder(DVec3::new(0.5, 0.5, 1.0), 0.5, 2.0, 0.0054).expect("a cylinder");
    let seeds = [
        DVec3::new(0.5000000573535424, 0.49999999949846097, 0.7499996861757698),
        DVec3::new(0.5000001725487475, 0.5000001544817483, 1.2499997610022198),
    ];
    let cells = Tessellation::new(&domain, &seeds).expect("valid seeds");
    let (network, flat) = Network::new(&cells, Junctions::Crease, 0).expect("a network");
    let relaxed = relax(&network, &flat, &Relaxation::Time(0.3), |_, _| ()).expect("relaxes");
    for (point, before) in relaxed.points.iter().zip(&flat) {
        for wall in domain.walls() {
            let (normal, distance) = domain.wall_equation(wall);
            if (normal.dot(*before) - distance).abs() < 1e-12 {
                assert!((normal.dot(*point) - distance).abs() < 1e-12, "{before} {point}");
            }
        }
    }
}
