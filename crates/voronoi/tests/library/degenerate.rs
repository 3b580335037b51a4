//! Seeds in special position: lattices, walls, lines, planes, spheres, near-duplicates, thin boxes.

use crate::common::{
    BODY_CENTRED, FACE_CENTRED, SIMPLE_CUBIC, assert_closed, assert_complex, assert_power_complex, jittered,
    lattice, random_seeds, square, tessellate,
};
use glam::{BVec3, DVec3};
use voronoi::{CellId, Domain, Side, Tessellation, VoronoiError};

/// Face and vertex counts of the cell that holds the centre of the cube's inner part.
fn inner_counts(tessellation: &Tessellation, near: DVec3) -> (usize, usize) {
    let seeds = tessellation.seeds().iter().enumerate();
    let distances = seeds.map(|(id, seed)| (seed.distance(near), id));
    let (_, id) = distances.min_by(|a, b| a.0.total_cmp(&b.0)).expect("seeds");
    let measure = tessellation.cell_measures()[id];
    (measure.face_count, measure.vertex_count)
}

#[test]
fn simple_cubic_lattices_have_cubes_with_six_faces() {
    // The largest has more than one compact part to cut at once.
    for n in [1, 2, 3, 5, 8, 22] {
        let tessellation = tessellate(&lattice(n, &SIMPLE_CUBIC));
        assert_complex(&tessellation);
        let corners = (n as usize + 1).pow(3);
        assert_eq!(tessellation.vertices().len(), corners, "lattice of {n}");
        for (cell, seed) in tessellation.cell_measures().iter().zip(tessellation.seeds()) {
            assert_eq!((cell.face_count, cell.vertex_count, cell.edge_count), (6, 8, 12));
            assert!(cell.centroid.distance(*seed) < 1e-14);
        }
    }
}

#[test]
fn body_centred_lattices_have_kelvin_cells() {
    for n in [4, 5] {
        let tessellation = tessellate(&lattice(n, &BODY_CENTRED));
        assert_complex(&tessellation);
        assert_eq!(inner_counts(&tessellation, DVec3::splat(0.45)), (14, 24));
    }
}

#[test]
fn face_centred_lattices_have_rhombic_dodecahedra() {
    let tessellation = tessellate(&lattice(4, &FACE_CENTRED));
    assert_complex(&tessellation);
    assert_eq!(inner_counts(&tessellation, DVec3::splat(0.45)), (12, 14));
}

#[test]
fn jittered_lattices_are_complexes() {
    for offsets in [&SIMPLE_CUBIC[..], &BODY_CENTRED[..], &FACE_CENTRED[..]] {
        for size in [1e-15, 1e-13, 1e-10, 1e-7] {
            assert_complex(&tessellate(&jittered(&lattice(4, offsets), size)));
        }
    }
}

#[test]
fn few_seeds() {
    for count in 1..=5 {
        assert_complex(&tessellate(&random_seeds(count, 3)));
    }
    let alone = tessellate(&[DVec3::splat(0.3)]);
    assert_eq!((alone.vertices().len(), alone.face_count()), (8, 6));
}

/// Such a cell was cut by all its neighbours one by one, which took a time that grew with the square of their number.
#[test]
fn cells_of_thousands_of_neighbours() {
    let center = DVec3::splat(0.5);
    let mut sphere: Vec<DVec3> =
        random_seeds(3000, 3).iter().map(|seed| center + 0.45 * (*seed - center).normalize()).collect();
    sphere.push(center);
    let tessellation = tessellate(&sphere);
    assert_complex(&tessellation);
    assert_eq!(tessellation.cell_faces(CellId(3000)).len(), 3000);

    let radius = |seed: &DVec3| 0.45 * DVec3::new(seed.x - 0.5, seed.y - 0.5, 0.0).normalize();
    let in_plane = center.with_z(0.0);
    let mut circle: Vec<DVec3> = random_seeds(3000, 3).iter().map(|seed| in_plane + radius(seed)).collect();
    circle.push(in_plane);
    let weights = vec![1.0; circle.len()];
    let tessellation =
        Tessellation::power(&Domain::unit_square(), &circle, &weights).expect("seeds are good");
    assert_power_complex(&tessellation, &weights);
    assert_eq!(tessellation.cell_faces(CellId(3000)).len(), 3000);
}

#[test]
fn seeds_on_a_line_in_a_plane_and_on_a_sphere() {
    let line: Vec<DVec3> = (1..9).map(|i| DVec3::splat(f64::from(i) / 9.0)).collect();
    let plane: Vec<DVec3> = random_seeds(100, 1).iter().map(|seed| seed.with_z(0.5)).collect();
    let mut sphere: Vec<DVec3> = random_seeds(300, 2)
        .iter()
        .map(|seed| DVec3::splat(0.5) + (*seed - 0.5).normalize_or(DVec3::X) * 0.3)
        .collect();
    sphere.push(DVec3::splat(0.5));
    for seeds in [line, plane, sphere] {
        assert_complex(&tessellate(&seeds));
    }
}

/// All bisectors of the shell meet in the seed at the corner: from there, nothing is near enough to tell how far to look for an edge's end.
#[test]
fn a_seed_in_the_corner_and_seeds_on_a_shell_around_it() {
    let on_shell = |seed: &DVec3| 0.9 * seed.normalize();
    let mut seeds: Vec<DVec3> = random_seeds(1000, 3).iter().map(on_shell).collect();
    seeds.push(DVec3::ZERO);
    let tessellation = tessellate(&seeds);
    assert_closed(&tessellation);
    // Around the corner lies an eighth of nearly a ball of half the radius.
    let volume = tessellation.cell_measures()[1000].volume;
    let ball = std::f64::consts::PI / 6.0 * 0.45f64.powi(3);
    assert!(volume > ball && volume < 1.1 * ball, "{volume} around the corner, {ball} in the ball");
}

#[test]
fn exactly_cospherical_seeds_meet_in_one_vertex() {
    // The points of the form (±3, ±4, 0) / 16 and their permutations lie on one sphere, exactly representable.
    let mut seeds = Vec::new();
    for (a, b) in [(3.0, 4.0), (3.0, -4.0), (-3.0, 4.0), (-3.0, -4.0)] {
        for vector in [DVec3::new(a, b, 0.0), DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a)] {
            seeds.push(DVec3::splat(0.5) + vector / 16.0);
        }
    }
    let tessellation = tessellate(&seeds);
    assert_complex(&tessellation);
    let at_centre = tessellation.vertices().iter().filter(|v| v.distance(DVec3::splat(0.5)) < 0.1);
    assert_eq!(at_centre.count(), 1);
}

#[test]
fn seeds_on_walls_edges_and_corners() {
    let mut seeds = lattice(2, &[DVec3::ZERO, DVec3::new(0.5, 0.0, 0.0), DVec3::new(0.5, 0.5, 0.0)]);
    seeds.extend([DVec3::ONE, DVec3::new(1.0, 1.0, 0.3), DVec3::new(0.2, 1.0, 0.7)]);
    assert_complex(&tessellate(&seeds));
}

#[test]
fn near_duplicates_keep_cells_of_their_own() {
    for distance in [1e-8, 1e-12, 1e-15] {
        let mut seeds = random_seeds(20, 8);
        seeds.push(seeds[4] + DVec3::new(distance, 0.0, 0.0));
        assert_complex(&tessellate(&seeds));
    }
}

/// Squares of such distances underflow: the search for neighbours once went on for ever.
#[test]
fn seeds_nearer_than_numbers_can_square() {
    for distance in [1e-200, 1e-300, 5e-324] {
        let mut seeds = vec![DVec3::new(0.5, 0.5, 0.0), DVec3::new(0.5, 0.5, distance)];
        seeds.extend(random_seeds(10, 12));
        let volumes = tessellate(&seeds).cell_measures();
        assert!((volumes.iter().map(|cell| cell.volume).sum::<f64>() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn clusters_and_extreme_boxes() {
    for size in [1e-2, 1e-6] {
        let cluster: Vec<DVec3> = random_seeds(10_000, 4).iter().map(|seed| 0.4 + *seed * size).collect();
        assert_complex(&tessellate(&cluster));
    }
    for size in
        [DVec3::new(1.0, 1.0, 1000.0), DVec3::new(3.0, 1.0, 0.2), DVec3::splat(1e-9), DVec3::splat(1e9)]
    {
        let domain = Domain::cuboid(DVec3::ZERO, size).expect("positive sides");
        let seeds: Vec<DVec3> = random_seeds(300, 6).iter().map(|seed| *seed * size).collect();
        assert_complex(&Tessellation::new(&domain, &seeds).expect("valid seeds"));
    }
}

#[test]
fn degenerate_seeds_in_the_plane() {
    let circle: Vec<DVec3> = [(3.0, 4.0), (4.0, 3.0), (5.0, 0.0), (0.0, 5.0)]
        .iter()
        .flat_map(|(x, y)| [(*x, *y), (-*x, *y), (*x, -*y), (-*x, -*y)])
        .map(|(x, y)| DVec3::new(0.5 + x / 16.0, 0.5 + y / 16.0, 0.0))
        .collect();
    let mut circle = circle;
    circle.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    circle.dedup();
    let line: Vec<DVec3> = (1..9).map(|i| DVec3::new(f64::from(i) / 9.0, 0.5, 0.0)).collect();
    let diagonal: Vec<DVec3> = line.iter().map(|seed| DVec3::new(seed.x, seed.x, 0.0)).collect();
    let alone = vec![DVec3::new(0.1, 0.9, 0.0)];
    for seeds in [square(2), square(3), square(7), circle, line, diagonal, alone] {
        let tessellation = Tessellation::new(&Domain::unit_square(), &seeds).expect("valid seeds");
        assert_complex(&tessellation);
    }
    let lattice = Tessellation::new(&Domain::unit_square(), &square(7)).expect("valid seeds");
    for (cell, seed) in lattice.cell_measures().iter().zip(lattice.seeds()) {
        assert_eq!((cell.edge_count, cell.vertex_count), (4, 4));
        assert!(cell.centroid.distance(*seed) < 1e-14);
    }
    assert_eq!(lattice.vertices().len(), 64);
}

#[test]
fn weights_on_lattices() {
    // Every other cube outweighs its neighbours: by little, by so much that the others all but vanish, and by more.
    for radius in [0.05, 0.1249, 0.125, 0.2, 0.5] {
        let seeds = lattice(4, &SIMPLE_CUBIC);
        let is_odd = |seed: &DVec3| (*seed * 4.0).floor().element_sum() % 2.0 == 1.0;
        let weights: Vec<f64> =
            seeds.iter().map(|seed| if is_odd(seed) { radius * radius } else { 0.0 }).collect();
        let tessellation = Tessellation::power(&Domain::unit_cube(), &seeds, &weights).expect("valid seeds");
        assert_power_complex(&tessellation, &weights);
        assert_eq!(tessellation.empty_cells().len(), if radius > 0.25 { 32 } else { 0 }, "radius {radius}");
    }
}

/// Bisectors at z = 0.5 with both neighbours leave the middle seeds a square each, and then the two squares nothing.
/// Weights count by their differences: equal ones leave the cells alone, however small these are.
#[test]
fn equal_weights_far_above_all_distances() {
    let cluster: Vec<DVec3> = random_seeds(200, 4).iter().map(|seed| 0.3 + *seed * 1e-10).collect();
    for domain in [Domain::unit_cube(), Domain::unit_cube().with_periods(BVec3::new(true, false, false))] {
        let plain = Tessellation::new(&domain, &cluster).expect("seeds are good");
        let power = Tessellation::power(&domain, &cluster, &[0.01; 200]).expect("seeds are good");
        assert_power_complex(&power, &[0.01; 200]);
        assert_eq!(power, plain);
    }
}

/// Seeds on a grid of 24 bits; the bisectors of the first one with the next eight pass through it. Vertices were once compared
/// by their distances from that seed, which are nothing there, so that two of them stayed in one place.
#[test]
fn a_vertex_at_a_seed_is_one_vertex() {
    let on_grid = |seed: &DVec3| (*seed * f64::from(1 << 24)).round() / f64::from(1 << 24);
    for random_seed in 0..400 {
        let is_flat = random_seed % 2 == 1;
        let domain = if is_flat { Domain::unit_square() } else { Domain::unit_cube() };
        let mut seeds: Vec<DVec3> = random_seeds(40, random_seed).iter().map(on_grid).collect();
        if is_flat {
            seeds.iter_mut().for_each(|seed| seed.z = 0.0);
        }
        let mut weights = vec![0.0; seeds.len()];
        for (weight, seed) in weights.iter_mut().zip(&seeds).take(9) {
            *weight = seed.distance_squared(seeds[0]);
        }
        let tessellation = Tessellation::power(&domain, &seeds, &weights).expect("valid seeds");
        assert_power_complex(&tessellation, &weights);
        let at_seed = tessellation.vertices().iter().filter(|vertex| vertex.distance(seeds[0]) < 1e-9);
        assert_eq!(at_seed.count(), 1, "random seed {random_seed}");
    }
}

#[test]
fn cells_that_are_flat_are_empty() {
    let seeds: Vec<DVec3> = [0.25, 0.375, 0.625, 0.75].map(|z| DVec3::new(0.5, 0.5, z)).to_vec();
    let weights = [0.0, -3.0 / 64.0, -3.0 / 64.0, 0.0];
    let tessellation = Tessellation::power(&Domain::unit_cube(), &seeds, &weights).expect("valid seeds");
    assert_power_complex(&tessellation, &weights);
    assert_eq!(tessellation.empty_cells(), [CellId(1), CellId(2)]);
    assert_eq!(tessellation.neighbors(CellId(0))[0], Side::Cell(CellId(3)));
}

/// In decimals both bisectors of the first seed are one line; as doubles they are not quite.
#[test]
fn cells_thinner_than_the_last_place() {
    let seeds = [(0.875, 0.25), (0.9, 0.2), (0.75, 0.5)].map(|(x, y)| DVec3::new(x, y, 0.0));
    let weights = [0.0, 0.015625, 0.015625];
    let tessellation = Tessellation::power(&Domain::unit_square(), &seeds, &weights).expect("valid seeds");
    assert_power_complex(&tessellation, &weights);
    assert!(tessellation.cell_measures()[0].volume.abs() < 1e-15);
}

#[test]
fn one_weight_can_take_all() {
    let seeds = random_seeds(30, 9);
    let mut weights = vec![0.0; 30];
    weights[7] = 4.0;
    let tessellation = Tessellation::power(&Domain::unit_cube(), &seeds, &weights).expect("valid seeds");
    assert_power_complex(&tessellation, &weights);
    assert_eq!(tessellation.empty_cells().len(), 29);
    weights[3] = f64::NAN;
    let error = Tessellation::power(&Domain::unit_cube(), &seeds, &weights);
    assert!(matches!(error, Err(VoronoiError::BadWeight { seed: 3, .. })));
}

#[test]
fn bad_seeds_are_named() {
    let cube = Domain::unit_cube();
    let message = |seeds: &[DVec3]| Tessellation::new(&cube, seeds).map(|_| ()).map_err(|e| e.to_string());
    assert_eq!(Tessellation::new(&cube, &[]), Err(VoronoiError::NoSeeds));
    let mut seeds = random_seeds(20, 1);
    seeds[17] = DVec3::new(1.2, 0.0, 0.0);
    assert_eq!(
        message(&seeds),
        Err("seed 17 at (1.2, 0, 0) lies outside the domain [0, 1] x [0, 1] x [0, 1]; move it inside or enlarge the domain"
            .to_string())
    );
    seeds[17] = DVec3::new(0.5, f64::NAN, 0.0);
    assert!(matches!(Tessellation::new(&cube, &seeds), Err(VoronoiError::NotFinite { seed: 17, .. })));
    seeds[17] = seeds[3];
    let expected = VoronoiError::DuplicateSeeds { first: 3, second: 17, position: seeds[3] };
    assert_eq!(Tessellation::new(&cube, &seeds), Err(expected));
    assert!(matches!(
        Domain::cuboid(DVec3::ZERO, DVec3::new(1.0, 0.0, 1.0)),
        Err(VoronoiError::BadDomain { axis: 'y', .. })
    ));
}

#[test]
fn a_seed_on_a_wall_touches_it() {
    let tessellation = tessellate(&[DVec3::new(0.0, 0.5, 0.5), DVec3::new(0.7, 0.5, 0.5)]);
    let walls = tessellation.neighbors(CellId(0));
    assert!(walls.iter().filter(|side| matches!(side, Side::Wall(_))).count() == 5);
}

/// Opposite cells of a face-centred lattice touch in points; where there are four in a periodic box and they are 1e-8 off, they share
/// faces 1e-16 wide. Cells of larger lattices that are 1e-14 off do so as well.
#[test]
fn edges_below_double_precision_are_points_once_resolved() {
    let periodic = Domain::unit_cube().with_periods(BVec3::TRUE);
    for (domain, cells_along, size) in
        [(&periodic, 1, 1e-8), (&periodic, 2, 1e-14), (&Domain::unit_cube(), 2, 1e-14)]
    {
        let seeds = lattice(cells_along, &FACE_CENTRED);
        let exact = Tessellation::new(domain, &seeds).expect("valid seeds");
        assert!(exact.resolved().is_none(), "nothing is short on the lattice itself");
        let near = Tessellation::new(domain, &jittered(&seeds, size)).expect("valid seeds");
        let resolved = near.resolved().expect("faces between opposite cells are small");
        assert_closed(&resolved);
        assert_eq!(resolved.face_count(), exact.face_count());
        for (cell, before) in resolved.cell_measures().iter().zip(near.cell_measures()) {
            assert!((cell.volume - before.volume).abs() < 1e-12 * before.volume);
        }
    }
}

/// A grid whose rows have the same decimals, but not the same last places.
#[test]
fn a_grid_of_decimals_has_rectangles_once_resolved() {
    let coordinate =
        |place: u32, row: u32| (0.1 * f64::from(row) + 0.13 * f64::from(place)) - 0.1 * f64::from(row);
    let seeds: Vec<DVec3> = (0..49)
        .map(|seed| (seed / 7, seed % 7))
        .map(|(x, y)| DVec3::new(0.1 + coordinate(x, y), 0.1 + coordinate(y, x), 0.0))
        .collect();
    let cells = Tessellation::new(&Domain::unit_square(), &seeds).expect("valid seeds");
    assert!(cells.vertices().len() > 64, "not quite a grid");
    let resolved = cells.resolved().expect("some edges are short");
    assert_eq!(resolved.vertices().len(), 64);
    assert!(resolved.cell_measures().iter().all(|cell| cell.face_count == 4));
}
