//! Domains that half-spaces bound: the same complexes, whatever meets where.

#![allow(clippy::cast_possible_truncation, reason = "a handful of walls")]

use crate::common::{assert_complex, assert_power_complex, complex_counts, random_seeds};
use glam::DVec3;
use proptest::prelude::*;
use voronoi::{CellId, Dimension, Domain, Side, Tessellation, VoronoiError, Wall, WallPlane};

fn half_space(normal: impl Into<DVec3>, offset: f64) -> WallPlane {
    WallPlane::HalfSpace { normal: normal.into(), offset }
}

/// All vectors with these absolute coordinates in this order.
fn with_signs(x: f64, y: f64, z: f64) -> Vec<DVec3> {
    let signs = |value: f64| if value == 0.0 { vec![0.0] } else { vec![-value, value] };
    let mut vectors = Vec::new();
    for x in signs(x) {
        for y in signs(y) {
            vectors.extend(signs(z).into_iter().map(|z| DVec3::new(x, y, z)));
        }
    }
    vectors
}

/// Half-spaces round the origin; where many meet in a point, they do so exactly. With the volume.
fn solids() -> Vec<(&'static str, Vec<WallPlane>, f64)> {
    let at = |offset: f64| move |normal: DVec3| half_space(normal, offset);
    let axes = [with_signs(1.0, 0.0, 0.0), with_signs(0.0, 1.0, 0.0), with_signs(0.0, 0.0, 1.0)].concat();
    let diagonals =
        [with_signs(1.0, 1.0, 0.0), with_signs(1.0, 0.0, 1.0), with_signs(0.0, 1.0, 1.0)].concat();
    let corners = with_signs(1.0, 1.0, 1.0);
    let octahedron: Vec<WallPlane> = corners.iter().copied().map(at(1.0)).collect();
    let cube: Vec<WallPlane> = axes.iter().copied().map(at(1.0)).collect();
    let even = |corner: &&DVec3| corner.x * corner.y * corner.z > 0.0;
    let tetrahedron = corners.iter().filter(even).copied().map(at(1.0)).collect();
    let rhombic = diagonals.iter().copied().map(at(1.0)).collect();
    let cuboctahedron = [cube.clone(), corners.iter().copied().map(at(2.0)).collect()].concat();
    // Touching the octahedron in corners and edges only, and twice the same wall.
    let touching = [
        octahedron.clone(),
        axes.iter().copied().map(at(1.0)).collect(),
        diagonals.iter().copied().map(at(1.0)).collect(),
        octahedron.clone(),
    ]
    .concat();
    let apex = DVec3::new(0.1, 0.2, 0.7);
    let base = [[0.9, 0.1], [0.3, 0.95], [-0.8, 0.4], [-0.7, -0.6], [0.55, -0.8]]
        .map(|[x, y]| DVec3::new(x, y, -0.3));
    let mut pyramid: Vec<WallPlane> =
        (0..5).map(|k| WallPlane::Through([apex, base[k], base[(k + 1) % 5]])).collect();
    pyramid.push(WallPlane::Through([base[2], base[1], base[0]]));
    let area: f64 = (0..5).map(|k| base[k].truncate().perp_dot(base[(k + 1) % 5].truncate()) / 2.0).sum();
    vec![
        ("octahedron", octahedron, 4.0 / 3.0),
        ("cube", cube, 8.0),
        ("tetrahedron", tetrahedron, 8.0 / 3.0),
        ("rhombic dodecahedron", rhombic, 2.0),
        ("cuboctahedron", cuboctahedron, 20.0 / 3.0),
        ("octahedron that more walls touch", touching, 4.0 / 3.0),
        ("pyramid with five sides", pyramid, area / 3.0),
    ]
}

/// Volume without any cells: corners are all points of three walls that no wall cuts off, to `tolerance`; then the
/// divergence theorem.
fn volume_by_brute_force(planes: &[(DVec3, f64)], tolerance: f64) -> f64 {
    let mut corners: Vec<DVec3> = Vec::new();
    let count = planes.len();
    for (i, j, k) in (0..count).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| (i, j, k)))) {
        let [(a, da), (b, db), (c, dc)] = [planes[i], planes[j], planes[k]];
        let determinant = a.dot(b.cross(c));
        if determinant.abs() < 1e-9 {
            continue;
        }
        let corner = (b.cross(c) * da + c.cross(a) * db + a.cross(b) * dc) / determinant;
        let is_inside = planes.iter().all(|(normal, offset)| normal.dot(corner) <= offset + tolerance);
        if is_inside && corners.iter().all(|other| other.distance(corner) > 1e-9) {
            corners.push(corner);
        }
    }
    let mut volume = 0.0;
    for (normal, offset) in planes {
        let on_plane = corners.iter().filter(|corner| (normal.dot(**corner) - offset).abs() <= tolerance);
        let mut ring: Vec<DVec3> = on_plane.copied().collect();
        if ring.len() < 3 {
            continue;
        }
        let center = ring.iter().sum::<DVec3>() / ring.len() as f64;
        let (u, v) = normal.any_orthonormal_pair();
        let angle = |corner: &DVec3| (*corner - center).dot(v).atan2((*corner - center).dot(u));
        ring.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        let doubled: f64 = (0..ring.len())
            .map(|k| (ring[k] - center).cross(ring[(k + 1) % ring.len()] - center).length())
            .sum();
        volume += offset * doubled / 6.0;
    }
    volume
}

/// A complex whose cells hold their own seeds' surroundings and whose outer faces lie in their walls.
fn assert_fills(domain: &Domain, seeds: &[DVec3]) -> Tessellation {
    let tessellation = Tessellation::new(domain, seeds).expect("valid seeds");
    assert_complex(&tessellation);
    let size = domain.size().length();
    for face in tessellation.faces() {
        let corners =
            tessellation.face_corners(face).iter().map(|corner| tessellation.vertices()[corner.index()]);
        let corners: Vec<DVec3> = corners.collect();
        if let [Side::Cell(cell), Side::Wall(wall)] = tessellation.face_sides(face) {
            let normal = domain.outward_normal(wall);
            let heights: Vec<f64> = corners.iter().map(|corner| normal.dot(*corner - corners[0])).collect();
            assert!(heights.iter().all(|height| height.abs() < 1e-12 * size), "wall {wall:?}: {heights:?}");
            assert!(normal.dot(corners[0] - seeds[cell.index()]) > -1e-12 * size);
        }
        for side in tessellation.face_sides(face) {
            let Side::Cell(cell) = side else { continue };
            for corner in &corners {
                let own = seeds[cell.index()].distance(*corner);
                assert!(seeds.iter().all(|seed| seed.distance(*corner) >= own - 1e-12 * size));
            }
        }
    }
    tessellation
}

fn seeds_in(domain: &Domain, points: impl Iterator<Item = DVec3>) -> Vec<DVec3> {
    let mut seeds: Vec<DVec3> = points.filter(|point| domain.contains(*point)).collect();
    seeds.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
    seeds.dedup();
    seeds
}

#[test]
fn volumes_of_solids() {
    for (name, walls, volume) in solids() {
        let domain = Domain::polyhedron(walls).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(
            (domain.measure() - volume).abs() < 1e-13 * volume,
            "{name}: {} not {volume}",
            domain.measure()
        );
    }
}

#[test]
fn solids_have_their_own_corners_and_no_others() {
    let count = |name: &str, seed: DVec3| {
        let (_, walls, _) = solids().into_iter().find(|(other, ..)| *other == name).expect("a solid");
        let domain = Domain::polyhedron(walls).expect("a domain");
        let counts = complex_counts(&assert_fills(&domain, &[seed]));
        [counts.vertices, counts.edges, counts.faces]
    };
    let inside = DVec3::new(0.1, 0.2, -0.15);
    for seed in [inside, DVec3::ZERO] {
        assert_eq!(count("octahedron", seed), [6, 12, 8]);
        assert_eq!(count("octahedron that more walls touch", seed), [6, 12, 8]);
        assert_eq!(count("tetrahedron", seed), [4, 6, 4]);
        assert_eq!(count("rhombic dodecahedron", seed), [14, 24, 12]);
        assert_eq!(count("cuboctahedron", seed), [12, 24, 14]);
        assert_eq!(count("pyramid with five sides", seed), [6, 10, 6]);
    }
    // A seed in the apex itself.
    assert_eq!(count("octahedron", DVec3::Z), [6, 12, 8]);
    assert_eq!(count("pyramid with five sides", DVec3::new(0.1, 0.2, 0.7)), [6, 10, 6]);
}

#[test]
fn lattices_fill_solids_with_seeds_on_walls_edges_and_corners() {
    for (name, walls, _) in solids() {
        let domain = Domain::polyhedron(walls).expect("a domain");
        // Quarters lie on the walls, sixths do not, and tenths nearly.
        for n in [2, 4, 5, 6] {
            let coordinate = |i: i32| f64::from(i) / f64::from(n);
            let grid = (-2 * n..=2 * n).flat_map(|x| (-2 * n..=2 * n).map(move |y| (x, y)));
            let grid = grid.flat_map(|(x, y)| (-2 * n..=2 * n).map(move |z| (x, y, z)));
            let points = grid.map(|(x, y, z)| DVec3::new(coordinate(x), coordinate(y), coordinate(z)));
            let seeds = seeds_in(&domain, points);
            assert!(!seeds.is_empty(), "{name}");
            assert_fills(&domain, &seeds);
        }
    }
}

#[test]
fn cube_of_half_spaces_is_the_box() {
    let walls = [
        half_space(DVec3::NEG_X, 0.0),
        half_space(DVec3::X, 1.0),
        half_space(DVec3::NEG_Y * 3.0, 0.0),
        half_space(DVec3::Y * 0.1, 0.1),
        half_space(DVec3::NEG_Z, -0.0),
        WallPlane::Through([DVec3::Z, DVec3::new(1.0, 0.0, 1.0), DVec3::new(0.0, 1.0, 1.0)]),
    ];
    let cube = Domain::polyhedron(walls.to_vec()).expect("a cube");
    let lattice = crate::common::lattice(3, &crate::common::BODY_CENTRED);
    for seeds in [random_seeds(300, 1), lattice, random_seeds(1, 2)] {
        let (a, b) = (
            Tessellation::new(&cube, &seeds).expect("seeds"),
            Tessellation::new(&Domain::unit_cube(), &seeds).expect("seeds"),
        );
        assert!(a.faces().eq(b.faces()));
        assert_eq!(a.vertices().len(), b.vertices().len());
        // The same polygons; their order, and where each begins, depend on which vertex was found first.
        let [faces, of_box] = [&a, &b].map(|all| {
            let mut faces: Vec<_> = all.faces().collect();
            faces.sort_unstable_by_key(|face| all.face_sides(*face));
            faces
        });
        for (face, of_box) in faces.into_iter().zip(of_box) {
            assert_eq!(a.face_sides(face), b.face_sides(of_box));
            let [ring, of_box] = [(&a, face), (&b, of_box)].map(|(all, face)| {
                all.face_corners(face).iter().map(|corner| all.vertices()[corner.index()]).collect::<Vec<_>>()
            });
            assert_eq!(ring.len(), of_box.len());
            let turned = |by: usize| ring.iter().cycle().skip(by).zip(&of_box);
            assert!(
                (0..ring.len()).any(|by| turned(by).all(|(a, b)| a.distance(*b) < 1e-15)),
                "{ring:?} {of_box:?}"
            );
        }
        for cell in (0..seeds.len() as u32).map(CellId) {
            assert_eq!(a.neighbors(cell), b.neighbors(cell));
        }
    }
}

#[test]
fn polygons_in_the_plane() {
    let angles = (0..7).map(|k| f64::from(k) * std::f64::consts::TAU / 7.0);
    let walls: Vec<WallPlane> =
        angles.map(|angle| half_space((angle.cos(), angle.sin(), 0.0), 1.0)).collect();
    let heptagon = Domain::polygon(walls).expect("a heptagon");
    let area = 7.0 * (std::f64::consts::PI / 7.0).tan();
    assert!((heptagon.measure() - area).abs() < 1e-14);
    let diamond = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, 0.0]];
    let diamond =
        Domain::polygon(diamond.map(|[x, y]| half_space((x, y, 0.0), 1.0)).to_vec()).expect("a diamond");
    assert!((diamond.measure() - 2.0).abs() < 1e-15);
    for domain in [heptagon, diamond] {
        let random = random_seeds(60, 4).into_iter().map(|seed| (seed * 2.0 - 1.0).with_z(0.0));
        assert_complex(&Tessellation::new(&domain, &seeds_in(&domain, random)).expect("seeds"));
        let grid =
            (-4..=4).flat_map(|x| (-4..=4).map(move |y| DVec3::new(f64::from(x), f64::from(y), 0.0) / 4.0));
        assert_complex(&Tessellation::new(&domain, &seeds_in(&domain, grid)).expect("seeds"));
    }
}

#[test]
fn domains_that_are_none_are_named() {
    let cube = || solids().swap_remove(1).1;
    let with = |wall| [cube(), vec![wall]].concat();
    let error = |walls| Domain::polyhedron(walls).expect_err("not a domain");
    assert_eq!(error(with(half_space(DVec3::ZERO, 1.0))), VoronoiError::BadHalfSpace { wall: 6 });
    assert_eq!(error(with(half_space(DVec3::X, f64::NAN))), VoronoiError::BadHalfSpace { wall: 6 });
    assert_eq!(error(with(half_space(DVec3::X, -1.5))), VoronoiError::EmptyDomain { wall: 6 });
    assert_eq!(
        error(with(WallPlane::Through([DVec3::ZERO, DVec3::X, DVec3::X * 2.0]))),
        VoronoiError::BadHalfSpace { wall: 6 }
    );
    assert!(matches!(
        error(with(half_space(DVec3::X, -1.0))),
        VoronoiError::FlatDomain { .. } | VoronoiError::EmptyDomain { wall: 6 }
    ));
    let VoronoiError::UnboundedDomain { direction } = error(cube()[..5].to_vec()) else {
        panic!("open at the top")
    };
    assert!(direction.z > 0.5 && (direction.length() - 1.0).abs() < 1e-12, "{direction}");
    assert!(matches!(error(Vec::new()), VoronoiError::UnboundedDomain { .. }));
    let flat = Domain::polygon(vec![half_space((1.0, 0.0, 0.5), 1.0)]);
    assert_eq!(flat, Err(VoronoiError::BadHalfSpace { wall: 0 }));
}

#[test]
fn curved_domains_keep_their_chord_error_and_volume() {
    let center = DVec3::new(0.3, -2.0, 5.0);
    let (radius, height) = (0.7, 1.5);
    for share in [0.05, 0.005, 0.001] {
        let error = share * radius;
        let ball = Domain::ball(center, radius, error).expect("a ball");
        let cylinder = Domain::cylinder(center, radius, height, error).expect("a cylinder");
        let disc = Domain::disc(center, radius, error).expect("a disc");
        let pi = std::f64::consts::PI;
        for (domain, volume) in [
            (&ball, 4.0 / 3.0 * pi * radius.powi(3)),
            (&cylinder, pi * radius * radius * height),
            (&disc, pi * radius * radius),
        ] {
            assert!((domain.measure() - volume).abs() < 1e-12 * volume, "{} {volume}", domain.measure());
            let place = if domain.dimension() == Dimension::Two { center.with_z(0.0) } else { center };
            let only = Tessellation::new(domain, &[place]).expect("a seed");
            // Corners stand out the most, and the middles of faces are in the farthest.
            let distance = |point: DVec3| match domain {
                _ if domain == &ball => point.distance(center),
                _ => point.truncate().distance(center.truncate()),
            };
            let outermost = only.vertices().iter().map(|vertex| distance(*vertex)).fold(0.0, f64::max);
            assert!(outermost - radius > 0.0 && outermost - radius <= error, "{outermost}");
            let innermost = domain.walls().filter(|wall| !matches!(domain.across_axis(*wall), Some((2, _))));
            let innermost = innermost.map(|wall| {
                let face =
                    only.faces().find(|face| only.face_sides(*face)[1] == Side::Wall(wall)).expect("bounds");
                domain.outward_normal(wall).dot(only.vertices()[only.face_corners(face)[0].index()] - place)
            });
            let innermost = innermost.fold(f64::INFINITY, f64::min);
            assert!(radius - innermost > 0.0 && radius - innermost <= error, "{innermost}");
            // No finer than needed: half the error would take more walls.
            assert!((outermost - radius).max(radius - innermost) > 0.3 * error, "{share}");
        }
    }
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(Domain::ball(center, bad, 0.1), Err(VoronoiError::BadLength { .. })));
        assert!(matches!(Domain::disc(center, 1.0, bad), Err(VoronoiError::BadLength { .. })));
        assert!(matches!(Domain::cylinder(center, 1.0, bad, 0.1), Err(VoronoiError::BadLength { .. })));
    }
    assert!(matches!(Domain::ball(center, 1.0, 1e-9), Err(VoronoiError::TooManyWalls { .. })));
    assert!(matches!(Domain::disc(center, 1.0, 1e-13), Err(VoronoiError::TooManyWalls { .. })));
}

#[test]
fn random_and_lattice_seeds_fill_curved_domains() {
    let center = DVec3::splat(0.5);
    for domain in [
        Domain::ball(center, 0.5, 0.0025).expect("a ball"),
        Domain::cylinder(center, 0.5, 1.0, 0.0025).expect("a cylinder"),
    ] {
        assert_fills(&domain, &seeds_in(&domain, random_seeds(150, 6).into_iter()));
        assert_fills(
            &domain,
            &seeds_in(&domain, crate::common::lattice(4, &crate::common::BODY_CENTRED).into_iter()),
        );
    }
}

#[test]
fn convex_surfaces_and_others() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0]]
        .map(DVec3::from);
    let faces = |lists: &[&[u32]]| lists.iter().map(|list| list.to_vec()).collect::<Vec<_>>();
    let closed = faces(&[&[3, 2, 1, 0], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]]);
    let pyramid = Domain::convex_surface(&points, &closed).expect("a pyramid");
    assert!((pyramid.measure() - 1.0 / 3.0).abs() < 1e-15);
    assert_eq!(pyramid.wall_planes().len(), 5);
    let counts = complex_counts(&assert_fills(&pyramid, &[DVec3::new(0.4, 0.5, 0.3)]));
    assert_eq!([counts.vertices, counts.edges, counts.faces], [5, 8, 5]);
    // Turned inside out, with its base as two triangles: the same.
    let mut inside_out = faces(&[&[0, 1, 2], &[0, 2, 3], &[4, 1, 0], &[4, 2, 1], &[4, 3, 2], &[4, 0, 3]]);
    let again = Domain::convex_surface(&points, &inside_out).expect("a pyramid");
    assert_eq!((again.measure(), again.wall_planes().len()), (pyramid.measure(), 5));
    inside_out.pop();
    let open = VoronoiError::OpenSurface { face: 1, ends: [3, 0] };
    assert_eq!(Domain::convex_surface(&points, &inside_out), Err(open));
    let mut dented = points;
    dented[4] = DVec3::new(0.5, 0.5, -1.0);
    assert!(Domain::convex_surface(&dented, &closed).is_ok(), "upside down");
    let mut roof = points.to_vec();
    roof.push(DVec3::new(0.5, 0.5, 0.2));
    let dented = faces(&[
        &[1, 0, 5],
        &[2, 1, 5],
        &[3, 2, 5],
        &[0, 3, 5],
        &[0, 1, 4],
        &[1, 2, 4],
        &[2, 3, 4],
        &[3, 0, 4],
    ]);
    let error = Domain::convex_surface(&roof, &dented).expect_err("dented below");
    assert!(matches!(error, VoronoiError::NotConvex { face: 0, vertex: 2 | 3 }), "{error:?}");
    assert!(matches!(
        Domain::convex_surface(&points, &[]),
        Err(VoronoiError::OpenSurface { .. } | VoronoiError::UnboundedDomain { .. })
    ));
}

#[test]
fn seeds_outside_are_named() {
    let domain = Domain::polyhedron(solids().swap_remove(0).1).expect("an octahedron");
    let on_wall = DVec3::new(0.25, 0.25, 0.5);
    let outside = on_wall + DVec3::X * f64::EPSILON;
    assert!(Tessellation::new(&domain, &[on_wall]).is_ok());
    let error = Tessellation::new(&domain, &[on_wall, outside]).expect_err("a seed outside");
    assert!(matches!(error, VoronoiError::OutsideDomain { seed: 1, .. }));
    let message = error.to_string();
    assert!(
        message.contains(
            "seed 1 at (0.2500000000000002, 0.25, 0.5) lies outside the domain 8 half-spaces in [-1, 1]"
        ),
        "{message}"
    );
}

#[test]
fn number_of_threads_changes_nothing() {
    let domain = Domain::polyhedron(solids().swap_remove(3).1).expect("a rhombic dodecahedron");
    let seeds = seeds_in(&domain, random_seeds(12_000, 3).into_iter().map(|seed| seed * 2.0 - 1.0));
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| Tessellation::new(&domain, &seeds).expect("seeds"))
    };
    let one = with(1);
    assert_complex(&one);
    assert_eq!(one, with(2));
}

#[test]
fn weights_empty_cells_beside_oblique_walls_too() {
    for (_, walls, _) in solids() {
        let domain = Domain::polyhedron(walls).expect("a domain");
        let seeds = seeds_in(&domain, random_seeds(150, 8).into_iter().map(|seed| seed * 2.0 - 1.0));
        let weights: Vec<f64> = random_seeds(seeds.len(), 9).iter().map(|number| number.x * 0.2).collect();
        let tessellation = Tessellation::power(&domain, &seeds, &weights).expect("seeds");
        assert_power_complex(&tessellation, &weights);
        // A step of Lloyd's algorithm stays inside.
        assert!(tessellation.centroids().iter().all(|centroid| domain.contains(*centroid)));
    }
}

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![-1.0..=1.0f64, (-8..=8i32).prop_map(|i| f64::from(i) / 8.0)]
}

fn point() -> impl Strategy<Value = DVec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(DVec3::from)
}

#[test]
fn the_box_around_a_polyhedron_is_told_in_few_digits() {
    let domain = Domain::ball(DVec3::ZERO, 1.0 / 3.0, 0.05).expect("a ball").to_string();
    let (name, sides) = domain.split_once(" in ").expect("its box");
    assert!(name.starts_with("a ball of radius 0.3333333333333333 with "), "{name}");
    for side in sides.split(" x ") {
        let ends = side.trim_matches(['[', ']']).split(", ");
        assert!(ends.clone().count() == 2 && ends.clone().all(|end| end.len() <= 9), "{side}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn random_half_spaces_give_complexes_of_their_own_volume(
        normals in prop::collection::vec((point(), prop_oneof![Just(0.5), 0.2..1.0f64]), 0..12),
        points in prop::collection::vec(point(), 1..40),
    ) {
        let mut planes: Vec<(DVec3, f64)> =
            [with_signs(1.0, 0.0, 0.0), with_signs(0.0, 1.0, 0.0), with_signs(0.0, 0.0, 1.0)].concat()
            .into_iter().map(|normal| (normal, 1.0)).collect();
        planes.extend(normals.into_iter().filter(|(normal, _)| normal.length() > 0.1));
        let domain = Domain::polyhedron(planes.iter().map(|(normal, offset)| half_space(*normal, *offset)).collect());
        let domain = domain.expect("the origin is inside");
        // Each plane once, for brute force counts its face as often as it comes.
        let mut units: Vec<(DVec3, f64)> = Vec::new();
        for (normal, offset) in &planes {
            let unit = (normal.normalize(), offset / normal.length());
            let is_new = |known: &(DVec3, f64)| known.0.distance(unit.0) > 1e-11 || (known.1 - unit.1).abs() > 1e-11;
            if units.iter().all(is_new) {
                units.push(unit);
            }
        }
        let volume = volume_by_brute_force(&units, 1e-11);
        prop_assert!((domain.measure() - volume).abs() < 1e-9 * volume, "{} {volume}", domain.measure());
        let seeds = seeds_in(&domain, points.into_iter());
        prop_assume!(!seeds.is_empty());
        assert_fills(&domain, &seeds);
    }

    #[test]
    fn random_solids_with_degenerate_seeds(which in 0..7usize, points in prop::collection::vec(point(), 1..60)) {
        let domain = Domain::polyhedron(solids().swap_remove(which).1).expect("a domain");
        let seeds = seeds_in(&domain, points.into_iter());
        prop_assume!(!seeds.is_empty());
        let tessellation = assert_fills(&domain, &seeds);
        // Table of neighbours: walls are those whose faces the cell has.
        for cell in (0..seeds.len() as u32).map(CellId) {
            let walls = tessellation.neighbors(cell).into_iter().filter_map(|side| match side {
                Side::Wall(wall) => Some(wall),
                _ => None,
            });
            let walls: Vec<Wall> = walls.collect();
            prop_assert!(walls.windows(2).all(|pair| pair[0] < pair[1]), "{walls:?}");
            prop_assert!(walls.iter().all(|wall| wall.index() < domain.wall_planes().len()));
        }
    }
}

/// Half-spaces so near that products of their distances are 0 once ended in a panic; those too far gave a domain called flat.
#[test]
fn lengths_whose_powers_are_no_numbers_are_refused() {
    let cube = |distance: f64| {
        let normals = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
        Domain::polyhedron(normals.map(|normal| WallPlane::HalfSpace { normal, offset: distance }).to_vec())
    };
    for distance in [1e-200, 5e-324, 1e-31] {
        assert!(matches!(cube(distance), Err(VoronoiError::BadDomain { axis: 'x', .. })), "{distance}");
    }
    for distance in [1.1e30, 1e160, 1e308] {
        let far = VoronoiError::FarHalfSpace { wall: 0, distance };
        assert_eq!(cube(distance).map(|_| ()), Err(far), "{distance}");
    }
    for distance in [1e-30f64, 1.0, 4e29] {
        let volume = (2.0 * distance).powi(3);
        assert!((cube(distance).expect("a cube").measure() / volume - 1.0).abs() < 1e-14, "{distance}");
    }
    for side in [0.0, 1e-31, 1e31, 1e160, f64::NAN, f64::INFINITY] {
        let cuboid = Domain::cuboid(DVec3::ZERO, DVec3::new(1.0, side, 1.0));
        assert!(matches!(cuboid, Err(VoronoiError::BadDomain { axis: 'y', .. })), "{side}");
    }
}

/// In the plane the diameter of a cell of an area that rounding made negative was no number.
#[test]
fn what_rounding_made_negative_has_no_size() {
    for dimension in [Dimension::Two, Dimension::Three] {
        assert_eq!((dimension.cube_edge(-1e-20), dimension.ball_diameter(-1e-20)), (0.0, 0.0));
    }
}
