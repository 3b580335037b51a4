//! The network of flat grains: connectivity, node types, orientation, and that subdivision leaves it flat.

use std::collections::BTreeSet;

use crate::common::{network, random_network, random_seeds};
use glam::{BVec3, DVec3};
use polycrystal::{
    Certificate, Expected, Junctions, Level, Mesh, Network, NetworkError, NodeType, Side, Surface, certify,
    validate,
};
use voronoi::{Domain, Tessellation};

fn elements(level: &Level) -> Vec<Vec<usize>> {
    let indices = |corners: &[u32]| corners.iter().map(|corner| *corner as usize).collect();
    match &level.mesh {
        Mesh::Triangles(mesh) => mesh.triangles().iter().map(|corners| indices(corners)).collect(),
        Mesh::Segments(mesh) => mesh.segments().iter().map(|ends| indices(ends)).collect(),
    }
}

/// The sides that touch each vertex.
fn sides_around(network: &Network, level: &Level) -> Vec<Vec<Side>> {
    let mut around = vec![BTreeSet::new(); level.vertex_count()];
    for (corners, boundary) in elements(level).iter().zip(&level.boundary_of) {
        for corner in corners {
            around[*corner].extend(network.boundaries()[boundary.index()].sides);
        }
    }
    around.into_iter().map(|sides| sides.into_iter().collect()).collect()
}

#[test]
fn control_mesh_has_virmats_points() {
    let seeds = random_seeds(&Domain::unit_cube(), 40, 1);
    let tessellation = Tessellation::new(&Domain::unit_cube(), &seeds).expect("valid seeds");
    let (network, points) = Network::new(&tessellation, Junctions::Crease, 0).expect("a small network");
    let edges = tessellation.edges();
    let (vertex_count, edge_count) = (tessellation.vertices().len(), edges.ends.len());
    assert_eq!(points.len(), vertex_count + edge_count + tessellation.face_count());
    assert_eq!(points[..vertex_count], *tessellation.vertices());
    for (middle, ends) in points[vertex_count..].iter().zip(&edges.ends) {
        let [start, end] = ends.map(|end| tessellation.vertices()[end.index()]);
        assert_eq!(*middle, (start + end) / 2.0);
    }
    assert_eq!(network.control_mesh().element_count(), 2 * edges.of_corner.len());
}

#[test]
fn node_types_are_those_of_the_sides_around_on_every_level() {
    for domain in [Domain::unit_cube(), Domain::unit_square()] {
        let (network, _) = random_network(&domain, 30, 2, 2);
        for level in network.levels() {
            for (vertex, sides) in sides_around(&network, level).iter().enumerate() {
                assert_eq!(level.node_types[vertex], NodeType::of_sides(sides), "vertex {vertex}");
                let grains = sides.iter().filter(|side| side.grain().is_some()).count();
                assert_eq!(usize::from(level.grain_counts[vertex]), grains, "vertex {vertex}");
            }
        }
    }
}

#[test]
fn normals_point_from_the_first_side_to_the_second() {
    let seeds = random_seeds(&Domain::unit_cube(), 30, 3);
    let (network, flat) = network(&Domain::unit_cube(), &seeds, 1);
    let points = network.subdivide(&flat);
    let level = network.finest().held();
    for (corners, boundary) in elements(level).iter().zip(&level.boundary_of) {
        let [a, b, c] = [points[corners[0]], points[corners[1]], points[corners[2]]];
        let [Side::Grain(inside), beyond] = network.boundaries()[boundary.index()].sides else {
            panic!("the first side is a grain")
        };
        let normal = (b - a).cross(c - a);
        assert!(normal.dot(a - seeds[inside.index()]) > 0.0);
        if let Side::Grain(beyond) = beyond {
            assert!(inside < beyond);
            assert!(normal.dot(seeds[beyond.index()] - a) > 0.0);
        }
    }
}

#[test]
fn lines_in_the_plane_have_their_first_side_on_the_left() {
    let seeds: Vec<DVec3> =
        random_seeds(&Domain::unit_square(), 30, 3).iter().map(|seed| seed.with_z(0.0)).collect();
    let (network, flat) = network(&Domain::unit_square(), &seeds, 1);
    let points = network.subdivide(&flat);
    let level = network.finest().held();
    for (ends, boundary) in elements(level).iter().zip(&level.boundary_of) {
        let [a, b] = [points[ends[0]], points[ends[1]]];
        let Side::Grain(left) = network.boundaries()[boundary.index()].sides[0] else {
            panic!("the first side is a grain")
        };
        let to_seed = (seeds[left.index()] - a).truncate();
        assert!((b - a).truncate().perp_dot(to_seed) > 0.0);
    }
}

/// DESIGN.md: every mask is an affine combination inside one plane or one line.
#[test]
fn subdivision_alone_leaves_every_boundary_flat() {
    let (network, flat) = random_network(&Domain::unit_cube(), 60, 4, 4);
    let points = network.subdivide(&flat);
    let level = network.finest().held();
    let mut planes = vec![None; network.boundaries().len()];
    let control = network.control_mesh();
    for (corners, boundary) in elements(control).iter().zip(&control.boundary_of) {
        let [a, b, c] = [flat[corners[0]], flat[corners[1]], flat[corners[2]]];
        let normal = (b - a).cross(c - a);
        // The largest triangle of a boundary tells its plane best.
        let plane = &mut planes[boundary.index()];
        if plane.is_none_or(|(_, known): (DVec3, DVec3)| known.length() < normal.length()) {
            *plane = Some((a, normal));
        }
    }
    for (corners, boundary) in elements(level).iter().zip(&level.boundary_of) {
        let (origin, normal) = planes[boundary.index()].expect("every boundary has triangles");
        let distance = (points[corners[0]] - origin).dot(normal.normalize());
        assert!(distance.abs() < 1e-12, "{distance}");
    }
}

#[test]
fn points_on_walls_stay_on_them_exactly() {
    let domain =
        Domain::cuboid(DVec3::new(0.1, -0.7, 3.0), DVec3::new(0.4, 1.3, 3.3)).expect("positive sides");
    let (network, flat) = random_network(&domain, 30, 5, 3);
    let points = network.subdivide(&flat);
    let level = network.finest().held();
    let mut on_walls = 0;
    for (point, (walls, node_type)) in points.iter().zip(level.walls.iter().zip(&level.node_types)) {
        assert_eq!(walls.is_empty(), node_type.code() < 10);
        for wall in network.wall_sets().walls(*walls) {
            assert_eq!(point[wall.axis()], domain.wall_coordinate(*wall));
            on_walls += 1;
        }
    }
    assert!(on_walls > 1000);
}

#[test]
fn one_grain_is_the_box() {
    for levels in [0, 1, 3] {
        let (network, flat) = network(&Domain::unit_cube(), &[DVec3::splat(0.4)], levels);
        assert_eq!((network.boundaries().len(), network.junction_counts().triple_lines), (6, 0));
        let points = network.subdivide(&flat);
        assert!(validate(&network, &points).is_ok());
        let area: f64 = elements(network.finest().held())
            .iter()
            .map(|corners| {
                let [a, b, c] = [points[corners[0]], points[corners[1]], points[corners[2]]];
                (b - a).cross(c - a).length() / 2.0
            })
            .sum();
        assert!((area - 6.0).abs() < 1e-12);
    }
}

#[test]
fn lattices_make_valid_networks_with_lines_of_four_grains() {
    let centre = |i: usize| (i as f64 + 0.5) / 4.0;
    let seeds: Vec<DVec3> =
        (0..64).map(|i| DVec3::new(centre(i % 4), centre(i / 4 % 4), centre(i / 16))).collect();
    let (network, flat) = network(&Domain::unit_cube(), &seeds, 2);
    let points = network.subdivide(&flat);
    assert!(validate(&network, &points).is_ok());
    let inner_cubes = network.control_mesh().node_types.iter().filter(|node_type| node_type.code() == 4);
    // 27 vertices of eight grains and the middles of 108 lines of four.
    assert_eq!(inner_cubes.count(), 27 + 108);
}

#[test]
fn pinned_junctions_stay_polylines() {
    let seeds = random_seeds(&Domain::unit_cube(), 20, 6);
    let tessellation = Tessellation::new(&Domain::unit_cube(), &seeds).expect("valid seeds");
    let (network, mut points) = Network::new(&tessellation, Junctions::Corner, 3).expect("a small network");
    let junctions = tessellation.vertices().len() + tessellation.edges().ends.len();
    for (i, point) in points.iter_mut().enumerate() {
        *point += DVec3::splat((i as f64).sin() * 1e-2);
    }
    let smooth = network.subdivide(&points);
    let walls = &network.control_mesh().walls;
    for vertex in (0..junctions).filter(|vertex| walls[*vertex].is_empty()) {
        assert_eq!(smooth[vertex], points[vertex]);
    }
}

#[test]
fn networks_beyond_32_bit_ids_are_refused() {
    let tessellation = Tessellation::new(&Domain::unit_cube(), &[DVec3::splat(0.5)]).expect("valid seeds");
    let error = Network::new(&tessellation, Junctions::Crease, 20).expect_err("too large");
    assert!(matches!(error, NetworkError::TooLarge { level: 13, .. }), "{error}");
    assert!(Network::new(&tessellation, Junctions::Crease, usize::MAX).is_err());
}

/// Levels that follow from one in memory are those that refinement makes, in what they have and what is found of them.
#[test]
fn the_finest_levels_are_known_without_being_held() {
    let periodic = Domain::unit_cube().with_periods(BVec3::TRUE);
    for domain in [Domain::unit_cube(), periodic] {
        let (network, flat) = random_network(&domain, 8, 5, 3);
        assert_eq!((network.level_count(), network.levels().len()), (3, 2));
        for level in 2..=3 {
            let (known, whole) = (network.level(level), network.whole_level(level));
            assert_eq!(known.vertex_count(), whole.vertex_count());
            assert_eq!(known.element_count(), whole.element_count());
            let of_whole = elements(&whole);
            for (element, (corners, boundary)) in (0u32..).zip(of_whole.iter().zip(&whole.boundary_of)) {
                let known_corners: Vec<usize> =
                    known.elements().corners(element).iter().map(|corner| *corner as usize).collect();
                assert_eq!((&known_corners, known.boundary(element)), (corners, *boundary));
            }
            for vertex in 0..whole.vertex_count() {
                assert_eq!(known.node_type(vertex), whole.node_types[vertex]);
                assert_eq!(known.grain_count(vertex), whole.grain_counts[vertex]);
                assert_eq!(known.generation(vertex), whole.generations[vertex]);
                assert_eq!(known.walls(vertex, network.wall_sets()), whole.walls[vertex]);
            }
            assert_eq!(known.copies(), &whole.copies);
        }
        let (known, whole) = (network.finest(), network.finest_level());

        let mut points = network.subdivide(&flat);
        let sides = network.sides();
        // Edges of elements that come without a mesh are in another order, in which sums of angles differ by rounding.
        let both = |points: &[DVec3]| -> [Certificate; 2] {
            let surfaces =
                [Surface::of_level(known, points, &sides), Surface::of_level(&*whole, points, &sides)];
            let [known, whole] = surfaces.map(|surface| certify(&surface, &Expected::default()));
            let [of_known, of_whole] = [&known, &whole].map(|of| of.angles.expect("boundaries meet"));
            assert!((of_known.mean - of_whole.mean).abs() < 1e-10);
            assert!((of_known.standard_deviation - of_whole.standard_deviation).abs() < 1e-10);
            // So are elements that are not held, in which volumes do.
            for ((grain, volume), whole) in known.grain_volumes.iter().zip(&whole.grain_volumes) {
                assert!(*grain == whole.0 && (volume / whole.1 - 1.0).abs() < 1e-12);
            }
            [known, whole].map(|certificate| Certificate {
                angles: None,
                grain_volumes: Vec::new(),
                ..certificate
            })
        };
        let [of_known, of_whole] = both(&points);
        assert!(of_known.is_good());
        assert_eq!(of_known, of_whole);
        // Folds, crossings, points at one place, triangles without area.
        let count = points.len();
        (points[count / 2], points[count / 3]) = (points[count / 3], points[count / 2]);
        points[count - 1] = points[count - 2];
        let [of_known, of_whole] = both(&points);
        let kinds: BTreeSet<&str> = of_known.faults.0.iter().map(|fault| fault.kind()).collect();
        assert!(kinds.len() > 2, "{kinds:?}");
        assert_eq!(of_known, of_whole);
    }
}
