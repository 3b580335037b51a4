//! Relaxation: what it must keep, what it must change, and where it must change nothing.

use std::f64::consts::FRAC_PI_2;

use crate::common::{network, network_of_regular, random_network, random_seeds, regular_network, relaxed};
use glam::{BVec3, DVec3};
use polycrystal::{
    Boundary, FaceMesh, GrainId, Junctions, Mesh, Network, NetworkError, Relaxation, Side, TriangleQuality,
    Tuning, Volumes, dihedral_angles, folded_edges, regular_cells, relax, relax_tuned, remove_short_edges,
    validate,
};
use proptest::prelude::*;
use voronoi::{Domain, Tessellation};

fn spread(network: &Network, points: &[DVec3]) -> f64 {
    dihedral_angles(network, network.finest(), points).expect("triple lines").standard_deviation
}

#[test]
fn random_grains_keep_their_volumes_and_come_closer_to_equilibrium() {
    for (levels, random_seed, largest) in [(0, 1, 14.0), (1, 3, 9.0), (2, 5, 8.0), (3, 6, 8.0)] {
        let (network, flat) = regular_network(&Domain::unit_cube(), 200, random_seed, levels);
        let smooth = relaxed(&network, &flat);
        let validation = validate(&network, &smooth).expect("a valid network");
        assert!(validation.largest_volume_error < 1e-10, "{validation:?}");
        assert!(folded_edges(network.finest(), &smooth, 0.0).is_empty());
        let before = spread(&network, &network.subdivide(&flat));
        assert!((22.0..26.0).contains(&before), "{before}");
        let after = spread(&network, &smooth);
        assert!(after < largest, "{after} at {levels} levels");
        let angles = dihedral_angles(&network, network.finest(), &smooth).expect("triple lines");
        assert!((angles.mean - 120.0).abs() < 0.1, "{angles:?}");
    }
}

/// A hundredth of the triangles once had angles below 9 degrees: at lines that shrank, and far from centres.
#[test]
fn few_triangles_are_needles() {
    for random_seed in [1, 16] {
        let (network, flat) = regular_network(&Domain::unit_cube(), 200, random_seed, 2);
        let points = relaxed(&network, &flat);
        let Mesh::Triangles(mesh) = &network.finest().held().mesh else { unreachable!("three dimensions") };
        let smallest_angle = |corners: &[u32; 3]| {
            let angle = |k: usize| {
                let [apex, from, to] = [0, 1, 2].map(|step| points[corners[(k + step) % 3] as usize]);
                (from - apex).angle_between(to - apex).to_degrees()
            };
            (0..3).map(angle).fold(f64::INFINITY, f64::min)
        };
        let mut angles: Vec<f64> = mesh.triangles().iter().map(smallest_angle).collect();
        angles.sort_by(f64::total_cmp);
        let hundredth = angles[angles.len() / 100];
        assert!(hundredth > 12.0, "{hundredth} degrees");
    }
}

/// Half of such networks once had triangles below 1 degree, down to 0.01: beside bent lines, and at short ones.
#[test]
fn no_triangle_is_thin() {
    let periodic = Domain::unit_cube().with_periods(BVec3::TRUE);
    let boxes = [(Domain::unit_cube(), 12), (Domain::unit_cube(), 30), (periodic, 40)];
    for (levels, (domain, count)) in [3, 1, 2, 0].into_iter().zip(boxes.into_iter().cycle()) {
        for random_seed in 1..=4 {
            let (network, flat) = regular_network(&domain, count, random_seed, levels);
            let certificate = validate(&network, &relaxed(&network, &flat)).expect("a valid network");
            let triangles = certificate.triangles.expect("three dimensions");
            assert!(triangles.least >= TriangleQuality::BOUND, "{triangles:?} of {count} grains");
            assert_eq!(triangles.thin, 0);
            assert!(certificate.largest_volume_error < 1e-10, "{certificate:?}");
        }
    }
}

/// Without regularisation small features fold unless they are held.
#[test]
fn grains_with_small_features_relax_too() {
    for (levels, random_seed) in [(0, 2), (1, 4), (3, 3)] {
        let (network, flat) = random_network(&Domain::unit_cube(), 200, random_seed, levels);
        let smooth = relaxed(&network, &flat);
        assert!(validate(&network, &smooth).expect("a valid network").largest_volume_error < 1e-10);
        assert!(spread(&network, &smooth) < 14.5);
    }
}

/// Measured from the middle of the box, volumes of these grains would lose all digits that tell them apart; and their long, thin
/// boundaries fold where subdivision moves points within them.
#[test]
fn grains_clustered_in_a_corner_are_valid_without_relaxation() {
    let domain = Domain::unit_cube();
    for extent in [1e-3, 1e-5] {
        let seeds: Vec<DVec3> = random_seeds(&domain, 40, 1).iter().map(|seed| *seed * extent).collect();
        let (network, flat) = network(&domain, &seeds, 2);
        let relaxed = relax(&network, &flat, &Relaxation::Time(0.0), |_, _| ()).expect("nothing moves");
        assert!(relaxed.is_flat && relaxed.points == flat);
        let certificate = validate(&network, &relaxed.finest_points(&network)).expect("valid");
        assert!(certificate.largest_volume_error < 1e-9, "{}", certificate.largest_volume_error);
    }
}

#[test]
fn time_zero_gives_regularised_grains_the_volumes_of_their_cells() {
    let (network, flat) = regular_network(&Domain::unit_cube(), 50, 4, 1);
    assert!(validate(&network, &network.subdivide(&flat)).is_err());
    let restored = relax(&network, &flat, &Relaxation::Time(0.0), |_, _| ()).expect("restores volumes");
    assert!(validate(&network, &restored.finest_points(&network)).is_ok());
}

#[test]
fn grains_in_the_plane_keep_their_areas_and_come_closer_to_equilibrium() {
    for (levels, random_seed) in [(0, 1), (1, 2), (3, 3), (5, 4)] {
        let (network, flat) = random_network(&Domain::unit_square(), 200, random_seed, levels);
        let flat: Vec<DVec3> = flat.iter().map(|point| point.with_z(0.0)).collect();
        let smooth = relaxed(&network, &flat);
        assert!(validate(&network, &smooth).expect("valid").largest_volume_error < 1e-10);
        assert!(smooth.iter().all(|point| point.z == 0.0));
        let before = spread(&network, &network.subdivide(&flat));
        assert!((26.0..33.0).contains(&before), "{before}");
        let after = spread(&network, &smooth);
        assert!(after < 18.0, "{after}");
    }
}

/// The body-centred lattice of spacing 1/4: binary numbers hold it exactly.
#[test]
fn kelvin_cells_relax() {
    let mut seeds = Vec::new();
    for i in 0..64 {
        let corner = DVec3::new(f64::from(i % 4), f64::from(i / 4 % 4), f64::from(i / 16));
        seeds.extend([(corner + 0.25) / 4.0, (corner + 0.75) / 4.0]);
    }
    let (network, flat) = network(&Domain::unit_cube(), &seeds, 2);
    let smooth = relaxed(&network, &flat);
    assert!(validate(&network, &smooth).is_ok());
    // Twice 125.26 degrees and once 109.47 where Kelvin's flat faces meet; 120 in equilibrium.
    assert!((spread(&network, &network.subdivide(&flat)) - 7.445).abs() < 1e-3);
    assert!(spread(&network, &smooth) < 5.0);
}

/// A spacing that binary numbers cannot hold leaves faces of size 1e-17 between grains that should meet in a point.
#[test]
fn grains_that_all_but_meet_are_named() {
    let mut seeds = Vec::new();
    for i in 0..27 {
        let corner = DVec3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9));
        seeds.extend([(corner + 0.25) / 3.0, (corner + 0.75) / 3.0]);
    }
    let tessellation = Tessellation::new(&Domain::unit_cube(), &seeds).expect("valid seeds");
    let error =
        Network::new(&tessellation, Junctions::Crease, 1).expect_err("no such boundary can be meshed");
    assert!(matches!(error, NetworkError::BoundaryTooSmall { .. }), "{error}");
    assert!(error.to_string().starts_with("the boundary between grain "), "{error}");
}

/// Kelvin's foam: 5.3063 V^(2/3) a cell in equilibrium, 5.3147 while its faces are flat (Kusner and Sullivan 1996).
#[test]
fn kelvins_foam_has_its_area() {
    let mut seeds = Vec::new();
    for i in 0..8 {
        let corner = DVec3::new(f64::from(i % 2), f64::from(i / 2 % 2), f64::from(i / 4));
        seeds.extend([(corner + 0.25) / 2.0, (corner + 0.75) / 2.0]);
    }
    let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
    let (network, flat) = network(&domain, &seeds, 3);
    // Boundaries through the walls come twice, once for each of their grains.
    let area_of_a_cell = |points: &[DVec3]| {
        let Mesh::Triangles(mesh) = &network.finest().held().mesh else { unreachable!("three dimensions") };
        let areas =
            mesh.triangles().iter().zip(&network.finest().held().boundary_of).map(|(corners, boundary)| {
                let [a, b, c] = corners.map(|corner| points[corner as usize]);
                let share = if network.boundaries()[boundary.index()].twin.is_some() { 0.5 } else { 1.0 };
                0.5 * share * (b - a).cross(c - a).length()
            });
        areas.sum::<f64>() / 8.0 / (1.0f64 / 16.0).powf(2.0 / 3.0)
    };
    assert!((area_of_a_cell(&network.subdivide(&flat)) / 5.3147 - 1.0).abs() < 1e-4);
    let relaxed = relax(&network, &flat, &Relaxation::Equilibrium, |_, _| ()).expect("relaxes");
    let smooth = relaxed.finest_points(&network);
    assert!((area_of_a_cell(&smooth) / 5.3063 - 1.0).abs() < 5e-4, "{}", area_of_a_cell(&smooth));
    assert!(spread(&network, &smooth) < 2.0, "{}", spread(&network, &smooth));
}

/// Young's law: a boundary of tension 1 meets a wall at the angle whose cosine is the difference of the walls' tensions. Between
/// walls at equal angles, it is an arc of a circle.
///
/// Subdivision lets curves end straight, on a length of half a segment of the level that moves: so angles at the wall converge
/// with the first order.
#[test]
fn tensions_of_walls_set_the_angle_there() {
    let seeds = [DVec3::new(0.25, 0.5, 0.0), DVec3::new(0.75, 0.5, 0.0)];
    let tessellation = Tessellation::new(&Domain::unit_square(), &seeds).expect("valid seeds");
    for difference in [0.0f64, 0.3, 0.6] {
        let wanted = difference.acos();
        let [coarse, fine] = [0.1, 0.025].map(|edge_length| {
            let (network, flat) = Network::with_face_mesh(
                &tessellation,
                FaceMesh::Refined { edge_length },
                Junctions::Crease,
                2,
            )
            .expect("a small network");
            let of_first = |boundary: &Boundary| boundary.sides[0] == Side::Grain(GrainId(0));
            let tension = |boundary: &Boundary| match boundary.wall {
                None => 1.0,
                Some(_) if of_first(boundary) => difference,
                Some(_) => 0.0,
            };
            let network = network.with_tensions(tension).expect("good tensions");
            let relaxed = relax(&network, &flat, &Relaxation::Equilibrium, |_, _| ()).expect("relaxes");
            let points = relaxed.finest_points(&network);
            let Mesh::Segments(mesh) = &network.finest().held().mesh else { unreachable!("the plane") };
            let between = mesh.segments().iter().zip(&network.finest().held().boundary_of);
            let between =
                between.filter(|(_, boundary)| network.boundaries()[boundary.index()].is_interior());
            let (mut angles, mut ends, mut middle) = (Vec::new(), Vec::new(), DVec3::INFINITY);
            for [a, b] in between.map(|(ends, _)| ends.map(|end| points[end as usize])) {
                let [wall, inside] = if [0.0, 1.0].contains(&a.y) { [a, b] } else { [b, a] };
                if [0.0, 1.0].contains(&wall.y) {
                    // Dear walls of the first grain get shorter, so the boundary leans away from it.
                    angles.push((inside - wall).normalize().x.acos());
                    ends.push(wall.x);
                }
                let from_middle = |point: &DVec3| (point.y - 0.5).abs();
                middle = if from_middle(&a) < from_middle(&middle) { a } else { middle };
            }
            assert_eq!(angles.len(), 2);
            // The height of an arc over a chord of 1 that it meets at the angle a is tan(a / 2) / 2.
            let height = 0.5 * ((FRAC_PI_2 - wanted) / 2.0).tan();
            assert!(ends.iter().all(|end| (middle.x - end - height).abs() < 1e-3), "{ends:?}, {middle}");
            angles.iter().map(|angle| (angle - wanted).abs().to_degrees()).fold(0.0, f64::max)
        });
        assert!(coarse < 1.5 && fine < 0.4, "{coarse} and {fine} degrees from {}", wanted.to_degrees());
        assert!(difference == 0.0 || (3.0..5.0).contains(&(coarse / fine)), "{coarse} and {fine}");
    }
}

/// Eight hexagons in a periodic rectangle, whose seeds are jittered by so much of their distance.
fn honeycomb(jitter: f64) -> Tessellation {
    let height = 3f64.sqrt();
    let domain = Domain::rectangle(DVec3::ZERO, DVec3::new(2.0, 2.0 * height, 1.0)).expect("positive sides");
    let domain = domain.with_periods(BVec3::TRUE);
    let noise = random_seeds(&Domain::unit_square(), 8, 5);
    let seeds: Vec<DVec3> = (0..8)
        .zip(noise)
        .map(|(k, noise)| {
            let place = DVec3::new(
                f64::from(k % 2) + 0.5 * f64::from(k / 2 % 2) + 0.2,
                f64::from(k / 2) * height / 2.0 + 0.1,
                0.0,
            );
            place + (noise - DVec3::new(0.5, 0.5, 0.0)) * jitter
        })
        .collect();
    Tessellation::new(&domain, &seeds).expect("valid seeds")
}

/// Hales 2001: of all divisions of the plane into equal areas A the honeycomb has the shortest lines, 12^(1/4) sqrt(A) a cell.
#[test]
fn a_honeycomb_stays_one_and_a_jittered_one_becomes_one() {
    for (jitter, relaxation) in
        [(0.0, Relaxation::KEPT_TOPOLOGY), (0.0, Relaxation::Equilibrium), (0.2, Relaxation::Time(5.0))]
    {
        let (network, flat) =
            Network::new(&honeycomb(jitter), Junctions::Crease, 2).expect("a small network");
        let area = 3f64.sqrt() / 2.0;
        let network = network.with_cell_volumes(vec![area; 8]);
        let relaxed = relax(&network, &flat, &relaxation, |_, _| ()).expect("relaxes");
        let points = relaxed.finest_points(&network);
        if jitter == 0.0 {
            let straight = network.subdivide(&flat);
            assert!(points.iter().zip(&straight).all(|(a, b)| a.distance(*b) < 1e-9));
        }
        let measures = polycrystal::measure_network(&network, &points).in_plane().expect("lines");
        let length: f64 = measures.boundaries.iter().map(|boundary| boundary.length).sum();
        let excess = length / (8.0 * 12f64.powf(0.25) * area.sqrt()) - 1.0;
        let angles = dihedral_angles(&network, network.finest(), &points).expect("triple points");
        assert!(excess.abs() < if jitter == 0.0 { 1e-12 } else { 5e-6 }, "{excess}");
        assert!(angles.standard_deviation < if jitter == 0.0 { 1e-4 } else { 0.15 }, "{angles:?}");
    }
}

#[test]
fn tensions_that_are_none_are_refused() {
    let (network, _) = random_network(&Domain::unit_cube(), 3, 1, 0);
    for tension in [-1.0, f64::NAN, f64::INFINITY] {
        let result = network.clone().with_tensions(|_| tension);
        assert!(matches!(result, Err(NetworkError::BadTension { .. })));
    }
}

#[test]
fn flat_equilibria_stay_as_they_are() {
    let two = vec![DVec3::new(0.25, 0.5, 0.5), DVec3::new(0.75, 0.5, 0.5)];
    let cubes: Vec<DVec3> = (0..27)
        .map(|i| DVec3::new(f64::from(i % 3) + 0.5, f64::from(i / 3 % 3) + 0.5, f64::from(i / 9) + 0.5) / 3.0)
        .collect();
    for seeds in [two, cubes] {
        let (network, flat) = network(&Domain::unit_cube(), &seeds, 2);
        let moved = network.subdivide(&flat).into_iter().zip(relaxed(&network, &flat));
        for ((before, after), node_type) in moved.zip(&network.finest().held().node_types) {
            // Points inside a boundary may slide within its plane, which is square to an axis.
            let is_inside = node_type.code() % 10 == 2;
            let change = (before - after).abs();
            let change = if is_inside { change.min_element() } else { change.length() };
            assert!(change < 1e-9, "{before} went to {after}");
        }
    }
}

#[test]
fn one_grain_and_time_zero_change_nothing() {
    let (one, points) = network(&Domain::unit_cube(), &[DVec3::splat(0.3)], 2);
    let still = relax(&one, &points, &Relaxation::KEPT_TOPOLOGY, |_, _| ()).expect("nothing to do");
    assert!(still.is_flat && still.points == points);
    let (many, points) = random_network(&Domain::unit_cube(), 20, 1, 1);
    let off = Relaxation::Time(0.0);
    assert_eq!(relax(&many, &points, &off, |_, _| ()).expect("nothing to do").points, points);
}

#[test]
fn times_that_are_no_times_are_refused() {
    let (network, points) = random_network(&Domain::unit_cube(), 5, 1, 0);
    for time in [-1.0, f64::NAN, f64::INFINITY] {
        let result = relax(&network, &points, &Relaxation::Time(time), |_, _| ());
        assert!(matches!(result, Err(NetworkError::BadRelaxationTime(_))));
    }
}

#[test]
fn size_of_the_box_only_scales_the_result() {
    let seeds = random_seeds(&Domain::unit_cube(), 30, 7);
    let (network_of_one, flat) = network(&Domain::unit_cube(), &seeds, 1);
    let expected = relaxed(&network_of_one, &flat);
    for scale in [1e-8, 1e6] {
        let domain = Domain::cuboid(DVec3::ZERO, DVec3::splat(scale)).expect("positive sides");
        let scaled: Vec<DVec3> = seeds.iter().map(|seed| *seed * scale).collect();
        let (network, flat) = network(&domain, &scaled, 1);
        for (point, expected) in relaxed(&network, &flat).iter().zip(&expected) {
            assert!((*point / scale).distance(*expected) < 1e-9);
        }
    }
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads");
        pool.install(|| {
            let (network, flat) = random_network(&Domain::unit_cube(), 100, 8, 2);
            relaxed(&network, &flat)
        })
    };
    assert_eq!(with_threads(1), with_threads(2));
}

/// Rigid parts once left a grain no way to change its volume, and the pressures of the others grew without bound.
#[test]
fn volumes_are_restored_in_thin_boxes_and_where_much_is_rigid() {
    for (size, count, random_seed, time) in [
        (DVec3::new(1.0, 1.0, 0.001), 16, 1, 0.3),
        (DVec3::new(1.0, 1e-5, 1.0), 4, 2, 0.3),
        (DVec3::new(1.0, 1000.0, 1.0), 30, 3, 0.1),
        (DVec3::ONE, 15, 4, 3.0),
    ] {
        let domain = Domain::cuboid(DVec3::ZERO, size).expect("positive sides");
        let (network, flat) = random_network(&domain, count, random_seed, 2);
        let relaxed = relax(&network, &flat, &Relaxation::Time(time), |_, _| ()).expect("relaxes");
        assert!(validate(&network, &relaxed.finest_points(&network)).is_ok());
    }
}

/// Springs on edges of length 1e-9 once made the matrix of a step indefinite, and the whole network froze.
#[test]
fn nearly_touching_quadruple_points_do_not_freeze_the_network() {
    let excess = |random_seed: u64| {
        let mut seeds = random_seeds(&Domain::unit_cube(), 60, random_seed);
        let (network_before, flat) = network(&Domain::unit_cube(), &seeds, 1);
        let expected = spread(&network_before, &relaxed(&network_before, &flat));
        // A fifth seed on the circumsphere of four neighbours, but for 1e-9, splits their vertex in two.
        let tessellation = Tessellation::new(&Domain::unit_cube(), &seeds).expect("valid seeds");
        let vertex = tessellation
            .vertices()
            .iter()
            .copied()
            .min_by(|a, b| a.distance(DVec3::splat(0.5)).total_cmp(&b.distance(DVec3::splat(0.5))));
        let vertex = vertex.expect("vertices");
        let radius = seeds.iter().map(|seed| seed.distance(vertex)).fold(f64::INFINITY, f64::min);
        seeds.push(vertex + DVec3::new(0.48, 0.6, 0.64).normalize() * radius * (1.0 + 1e-9));
        let (network, flat) = network(&Domain::unit_cube(), &seeds, 1);
        spread(&network, &relaxed(&network, &flat)) - expected
    };
    // One fold elsewhere changes that of a single network by two degrees.
    let mean = (9..13).map(excess).sum::<f64>() / 4.0;
    assert!(mean < 1.0, "{mean} degrees");
}

/// A grain inside a cluster of seeds, far smaller than what is rigid, once had a pressure against rounding alone: it missed its volume by NaN.
#[test]
fn grains_that_move_as_a_whole_get_no_pressure() {
    let domain = Domain::unit_cube();
    let mut seeds = random_seeds(&domain, 40, 1);
    seeds.extend(random_seeds(&domain, 12, 2).into_iter().map(|seed| 0.4 + 1e-3 * seed));
    let (network, flat) = network(&domain, &seeds, 0);
    match relax(&network, &flat, &Relaxation::KEPT_TOPOLOGY, |_, _| ()) {
        Ok(_) => {}
        // What is left is rounding, of a volume of 1e-10 in a box of 1.
        Err(error) => match error.into_attempts().1 {
            NetworkError::VolumeNotRestored { relative_error, .. } => {
                assert!(relative_error < 1e-8, "{relative_error}");
            }
            error => panic!("{error}"),
        },
    }
}

/// As the program does it: where regularised cells tangle, less is taken out of them, or nothing.
fn relaxes_to_a_valid_network(
    domain: &Domain,
    count: usize,
    random_seed: u64,
    levels: usize,
    time: f64,
) -> bool {
    let tessellation =
        Tessellation::new(domain, &random_seeds(domain, count, random_seed)).expect("valid seeds");
    let cells: [&dyn Fn() -> Tessellation; 3] = [
        &|| regular_cells(&tessellation, 0.15).expect("a network").cells,
        &|| remove_short_edges(&tessellation, 0.15).0,
        &|| tessellation.clone(),
    ];
    cells.iter().any(|cells| {
        let (network, flat) = network_of_regular(&cells(), &tessellation, levels);
        let relaxed = relax(&network, &flat, &Relaxation::Time(time), |_, _| ());
        relaxed.is_ok_and(|relaxed| validate(&network, &relaxed.finest_points(&network)).is_ok())
    })
}

#[test]
fn cells_that_tangle_when_regularised_relax_with_less_taken_out() {
    let height = 2.245_413_952_434_040_6;
    let domain = Domain::cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, height)).expect("positive sides");
    assert!(relaxes_to_a_valid_network(&domain, 25, 645_662, 0, 0.01));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_few_grains_relax_to_a_valid_network(
        random_seed in 0u64..1_000_000,
        count in 1usize..40,
        levels in 0usize..3,
        (height, time) in (0.1..3.0f64, 0.01..0.6f64),
    ) {
        let domain = Domain::cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, height)).expect("positive sides");
        prop_assert!(relaxes_to_a_valid_network(&domain, count, random_seed, levels, time));
    }

    #[test]
    fn a_permutation_of_the_seeds_permutes_the_grains(random_seed in 0u64..1_000_000, translation in 1usize..20) {
        let seeds = random_seeds(&Domain::unit_cube(), 20, random_seed);
        let mut rotated = seeds.clone();
        rotated.rotate_left(translation % 20);
        // The search for wide triangles makes of rounding what can be seen, of points inside boundaries: it may take 100 steps.
        let not_widened = Tuning { widening: 0.0, ..Tuning::default() };
        let mean_point_and_volumes = |seeds: &[DVec3]| {
            let (network, flat) = network(&Domain::unit_cube(), seeds, 1);
            let (time, kept) = (Relaxation::KEPT_TOPOLOGY, Volumes::Kept);
            let flow = relax_tuned(&network, &flat, &time, kept, &not_widened, &mut |_| ()).expect("relaxes");
            let points = flow.finest_points(&network);
            let volumes = network.grain_volumes(network.finest(), &relaxed(&network, &flat));
            (points.iter().sum::<DVec3>() / points.len() as f64, volumes)
        };
        let (place, mut volumes) = mean_point_and_volumes(&seeds);
        let (rotated_place, rotated_volumes) = mean_point_and_volumes(&rotated);
        volumes.rotate_left(translation % 20);
        prop_assert!(place.distance(rotated_place) < 1e-10, "{}", place.distance(rotated_place));
        for (a, b) in volumes.iter().zip(&rotated_volumes) {
            prop_assert!((a - b).abs() < 1e-12);
        }
    }
}
