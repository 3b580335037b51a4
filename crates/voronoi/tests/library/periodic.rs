//! Periodic domains: few seeds, seeds in special position, any box, any subset of axes.

#![allow(clippy::cast_possible_truncation, reason = "a handful of seeds")]

use crate::common::{
    BODY_CENTRED, FACE_CENTRED, SIMPLE_CUBIC, assert_complex, assert_power_complex, complex_counts, jittered,
    lattice, random_seeds, square,
};
use glam::{BVec3, DVec3};
use proptest::prelude::*;
use voronoi::{CellId, Domain, Side, Tessellation, Translation, VoronoiError};

const XYZ: BVec3 = BVec3::TRUE;
const X: BVec3 = BVec3::new(true, false, false);
const YZ: BVec3 = BVec3::new(false, true, true);

/// All subsets of the axes but the empty one.
fn periods() -> impl Iterator<Item = BVec3> {
    (1..8u8).map(|axes| BVec3::new(axes & 1 != 0, axes & 2 != 0, axes & 4 != 0))
}

fn cube(axes: BVec3) -> Domain {
    Domain::unit_cube().with_periods(axes)
}

fn tessellate(seeds: &[DVec3], axes: BVec3) -> Tessellation {
    let tessellation = Tessellation::new(&cube(axes), seeds).expect("valid seeds");
    assert_complex(&tessellation);
    tessellation
}

#[test]
fn one_seed_is_its_own_neighbor() {
    for seed in [DVec3::splat(0.3), DVec3::ZERO, DVec3::ONE, DVec3::new(0.0, 0.5, 1.0)] {
        let tessellation = tessellate(&[seed], XYZ);
        let cell = tessellation.cell_measures()[0];
        assert_eq!((cell.face_count, cell.edge_count, cell.vertex_count), (6, 12, 8));
        assert!(cell.centroid.distance(seed) < 1e-15);
        let own = CellId(0);
        let images = [[-1, 0, 0], [0, -1, 0], [0, 0, -1], [0, 0, 1], [0, 1, 0], [1, 0, 0]];
        assert_eq!(
            tessellation.neighbors(own),
            images.map(|translation| Side::Image(own, Translation(translation)))
        );
        let counts = complex_counts(&tessellation);
        assert_eq!((counts.vertices, counts.edges, counts.faces), (1, 3, 3));
    }
    for axes in periods() {
        tessellate(&[DVec3::new(0.1, 0.2, 0.9)], axes);
    }
    let square = Domain::unit_square().with_periods(XYZ);
    let tessellation = Tessellation::new(&square, &[DVec3::new(0.1, 0.9, 0.0)]).expect("valid seeds");
    assert_complex(&tessellation);
    let counts = complex_counts(&tessellation);
    assert_eq!((counts.vertices, counts.faces), (1, 2));
}

#[test]
fn few_seeds() {
    for count in 1..=5 {
        for axes in periods() {
            for random_seed in 0..5 {
                tessellate(&random_seeds(count, random_seed), axes);
            }
        }
        let flat: Vec<DVec3> = random_seeds(count, 3).iter().map(|seed| seed.with_z(0.0)).collect();
        for axes in [XYZ, X, BVec3::new(false, true, false)] {
            let square = Domain::unit_square().with_periods(axes);
            assert_complex(&Tessellation::new(&square, &flat).expect("valid seeds"));
        }
    }
}

#[test]
fn lattices_whose_spacing_is_no_binary_number() {
    let cells = [(&SIMPLE_CUBIC[..], (6, 8)), (&BODY_CENTRED[..], (14, 24)), (&FACE_CENTRED[..], (12, 14))];
    for (offsets, counts) in cells {
        for n in [1, 2, 4] {
            let tessellation = tessellate(&lattice(n, offsets), XYZ);
            for cell in tessellation.cell_measures() {
                assert_eq!((cell.face_count, cell.vertex_count), counts, "lattice of {n}");
            }
        }
        for n in [3, 5, 10] {
            if n < 10 || offsets.len() == 1 {
                tessellate(&lattice(n, offsets), XYZ);
                tessellate(&lattice(n, offsets), X);
            }
        }
    }
}

/// Spacing 1/3, 1/5 and so on, in a box whose sides are multiples of it: exact lattices again.
#[test]
fn lattices_with_whole_coordinates() {
    for n in [3, 5] {
        for (offsets, counts) in [(&SIMPLE_CUBIC[..], (6, 8)), (&FACE_CENTRED[..], (12, 14))] {
            let domain =
                Domain::cuboid(DVec3::ZERO, DVec3::splat(f64::from(n) * 4.0)).expect("positive sides");
            let seeds: Vec<DVec3> =
                lattice(n, offsets).iter().map(|seed| (*seed * f64::from(n) * 4.0).round()).collect();
            let tessellation = Tessellation::new(&domain.with_periods(XYZ), &seeds).expect("valid seeds");
            assert_complex(&tessellation);
            for cell in tessellation.cell_measures() {
                assert_eq!((cell.face_count, cell.vertex_count), counts, "lattice of {n}");
            }
        }
    }
}

#[test]
fn jittered_lattices() {
    for offsets in [&SIMPLE_CUBIC[..], &BODY_CENTRED[..], &FACE_CENTRED[..]] {
        for size in [1e-15, 1e-13, 1e-10, 1e-7] {
            for n in [2, 3] {
                tessellate(&jittered(&lattice(n, offsets), size), XYZ);
            }
            tessellate(&jittered(&lattice(3, offsets), size), YZ);
        }
    }
}

#[test]
fn seeds_on_a_line_in_a_plane_and_on_a_sphere() {
    let diagonal: Vec<DVec3> = (1..9).map(|i| DVec3::splat(f64::from(i) / 9.0)).collect();
    let axis: Vec<DVec3> = (0..8).map(|i| DVec3::new(0.5, 0.25, f64::from(i) / 8.0)).collect();
    let plane: Vec<DVec3> = random_seeds(60, 1).iter().map(|seed| seed.with_z(0.5)).collect();
    let grid: Vec<DVec3> = lattice(4, &SIMPLE_CUBIC).into_iter().filter(|seed| seed.z < 0.2).collect();
    let mut sphere: Vec<DVec3> = random_seeds(300, 2)
        .iter()
        .map(|seed| DVec3::splat(0.5) + (*seed - 0.5).normalize_or(DVec3::X) * 0.3)
        .collect();
    sphere.push(DVec3::splat(0.5));
    let mut exact_sphere = Vec::new();
    for (a, b) in [(3.0, 4.0), (3.0, -4.0), (-3.0, 4.0), (-3.0, -4.0)] {
        for vector in [DVec3::new(a, b, 0.0), DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a)] {
            exact_sphere.push(DVec3::splat(0.5) + vector / 16.0);
        }
    }
    for seeds in [diagonal, axis, plane, grid, sphere, exact_sphere] {
        for axes in [XYZ, X, YZ] {
            tessellate(&seeds, axes);
        }
    }
}

#[test]
fn seeds_on_walls_edges_and_corners() {
    let offsets = [DVec3::ZERO, DVec3::new(0.5, 0.0, 0.0), DVec3::new(0.5, 0.5, 0.0)];
    let mut seeds = lattice(2, &offsets);
    seeds.extend([DVec3::new(1.0, 1.0, 0.3), DVec3::new(0.2, 1.0, 0.7), DVec3::new(0.3, 0.4, 1.0)]);
    for axes in periods() {
        tessellate(&seeds, axes);
    }
    // The same places, written from the other side.
    let turned: Vec<DVec3> =
        seeds.iter().map(|seed| DVec3::select(seed.cmpeq(DVec3::ZERO), DVec3::ONE, *seed)).collect();
    let (here, there) = (tessellate(&seeds, XYZ), tessellate(&turned, XYZ));
    for cell in (0..seeds.len() as u32).map(CellId) {
        let number = |side: Side| match side {
            Side::Cell(cell) | Side::Image(cell, _) => cell,
            Side::Wall(_) => panic!("no walls"),
        };
        let numbers = |tessellation: &Tessellation| {
            let mut numbers: Vec<CellId> = tessellation.neighbors(cell).into_iter().map(number).collect();
            numbers.sort_unstable();
            numbers
        };
        assert_eq!(numbers(&here), numbers(&there));
    }
}

#[test]
fn duplicates_across_the_period_are_named() {
    let mut seeds = random_seeds(10, 1);
    seeds[2] = DVec3::new(0.0, 0.25, 1.0);
    seeds[7] = DVec3::new(1.0, 0.25, 0.0);
    let refused = Err(VoronoiError::DuplicateSeeds { first: 2, second: 7, position: seeds[2] });
    assert_eq!(Tessellation::new(&cube(XYZ), &seeds), refused);
    assert!(Tessellation::new(&cube(X), &seeds).is_ok());
}

#[test]
fn near_duplicates_inside_and_across_the_seam() {
    for distance in [1e-8, 1e-10, 1e-12, 1e-15] {
        for axes in [XYZ, X, YZ] {
            let mut seeds = random_seeds(20, 8);
            seeds.push(seeds[4] + DVec3::new(distance, 0.0, 0.0));
            seeds.push(DVec3::new(0.0, 0.3, 0.3));
            // One last place below 1 is 1.1e-16.
            seeds.push(DVec3::new(1.0 - distance, 0.3, 0.3));
            seeds.push(DVec3::new(distance, 0.7, 0.0));
            seeds.push(DVec3::new(1.0 - distance, 0.7, 1.0 - distance));
            tessellate(&seeds, axes);
        }
        let pair = [DVec3::splat(0.0), DVec3::splat(1.0 - distance)];
        tessellate(&pair, XYZ);
    }
    tessellate(&[DVec3::new(0.0, 0.5, 0.5), DVec3::new(1.0f64.next_down(), 0.5, 0.5)], XYZ);
    tessellate(&[DVec3::new(1e-200, 0.5, 0.5), DVec3::new(1.0, 0.5, 0.5), DVec3::splat(0.2)], XYZ);
}

#[test]
fn clusters() {
    for size in [1e-2, 1e-6] {
        for corner in [0.4, 1.0 - size / 2.0] {
            let wrapped = |seed: &DVec3| (corner + *seed * size).map(|x| if x >= 1.0 { x - 1.0 } else { x });
            let cluster: Vec<DVec3> = random_seeds(300, 4).iter().map(wrapped).collect();
            tessellate(&cluster, XYZ);
        }
    }
}

#[test]
fn extreme_boxes() {
    let sizes = [
        DVec3::new(1.0, 1.0, 1000.0),
        DVec3::new(1e-3, 1.0, 1.0),
        DVec3::new(3.0, 1.0, 0.2),
        DVec3::splat(1e-9),
        DVec3::splat(1e9),
    ];
    for size in sizes {
        for lower in [DVec3::ZERO, DVec3::new(-0.3, 0.7, 1.1) * size] {
            for count in [1, 2, 3, 100] {
                let domain = Domain::cuboid(lower, lower + size).expect("positive sides");
                let seeds: Vec<DVec3> = random_seeds(count, 6)
                    .iter()
                    .map(|seed| (lower + *seed * size).min(domain.upper()))
                    .collect();
                for axes in [XYZ, X, YZ] {
                    assert_complex(
                        &Tessellation::new(&domain.clone().with_periods(axes), &seeds).expect("valid seeds"),
                    );
                }
            }
        }
    }
    for size in [DVec3::new(1.0, 1000.0, 0.0), DVec3::new(1000.0, 1.0, 0.0), DVec3::new(1e-9, 1e-9, 0.0)] {
        for count in [1, 2, 3, 100] {
            let domain = Domain::rectangle(DVec3::ZERO, size).expect("positive sides").with_periods(XYZ);
            let seeds: Vec<DVec3> = random_seeds(count, 6).iter().map(|seed| *seed * size).collect();
            assert_complex(&Tessellation::new(&domain, &seeds).expect("valid seeds"));
        }
    }
}

#[test]
fn degenerate_seeds_in_the_plane() {
    let line: Vec<DVec3> = (0..8).map(|i| DVec3::new(f64::from(i) / 8.0, 0.5, 0.0)).collect();
    let diagonal: Vec<DVec3> = line.iter().map(|seed| DVec3::new(seed.x, seed.x, 0.0)).collect();
    for seeds in [square(2), square(3), square(4), square(10), jittered(&square(4), 1e-15), line, diagonal] {
        let seeds: Vec<DVec3> = seeds.iter().map(|seed| seed.with_z(0.0)).collect();
        for axes in [XYZ, X] {
            let domain = Domain::unit_square().with_periods(axes);
            assert_complex(&Tessellation::new(&domain, &seeds).expect("valid seeds"));
        }
    }
    let domain = Domain::unit_square().with_periods(XYZ);
    let lattice = Tessellation::new(&domain, &square(4)).expect("valid seeds");
    assert_eq!(lattice.vertices().len() - lattice.periodic_vertices().len(), 16);
    assert!(lattice.cell_measures().iter().all(|cell| cell.edge_count == 4));
}

#[test]
fn weights_on_lattices_and_flat_cells() {
    for radius in [0.05, 0.1249, 0.125, 0.2, 0.5] {
        let seeds = lattice(4, &SIMPLE_CUBIC);
        let is_odd = |seed: &DVec3| (*seed * 4.0).floor().element_sum() % 2.0 == 1.0;
        let weights: Vec<f64> =
            seeds.iter().map(|seed| if is_odd(seed) { radius * radius } else { 0.0 }).collect();
        for axes in [XYZ, X] {
            let tessellation = Tessellation::power(&cube(axes), &seeds, &weights).expect("valid seeds");
            assert_power_complex(&tessellation, &weights);
            assert_eq!(
                tessellation.empty_cells().len(),
                if radius > 0.25 { 32 } else { 0 },
                "radius {radius}"
            );
        }
    }
    // Bisectors of the middle seeds with both neighbours fall into one plane, also across the seam.
    for offset in [0.0, 0.5, 0.625] {
        let z = [0.25, 0.375, 0.625, 0.75].map(|z: f64| (z + offset).fract());
        let seeds = z.map(|z| DVec3::new(0.5, 0.5, z));
        let weights = [0.0, -3.0 / 64.0, -3.0 / 64.0, 0.0];
        for axes in [XYZ, BVec3::new(false, false, true), X] {
            let tessellation = Tessellation::power(&cube(axes), &seeds, &weights).expect("valid seeds");
            assert_power_complex(&tessellation, &weights);
            if axes.z {
                assert_eq!(tessellation.empty_cells(), [CellId(1), CellId(2)], "offset {offset}");
            }
        }
    }
}

#[test]
fn one_weight_can_take_all() {
    for axes in periods() {
        let mut weights = vec![0.0; 30];
        weights[7] = 4.0;
        let tessellation =
            Tessellation::power(&cube(axes), &random_seeds(30, 9), &weights).expect("valid seeds");
        assert_power_complex(&tessellation, &weights);
        assert_eq!(tessellation.empty_cells().len(), 29);
    }
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let seeds = random_seeds(2000, 11);
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads");
        pool.install(|| Tessellation::new(&cube(XYZ), &seeds).expect("valid seeds"))
    };
    assert_eq!(with_threads(1), with_threads(2));
}

/// Random coordinates mixed with coarse ones, so that exact ties are common.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        0.0..=1.0f64,
        (0..=4u32).prop_map(|i| f64::from(i) / 4.0),
        (0..=8u32).prop_map(|i| f64::from(i) / 8.0),
        (0..=10u32).prop_map(|i| f64::from(i) / 10.0)
    ]
}

/// Seeds without duplicates even where all axes are periodic.
fn distinct_seeds(flat: bool) -> impl Strategy<Value = Vec<DVec3>> {
    let point = (coordinate(), coordinate(), coordinate());
    let point = point.prop_map(move |(x, y, z)| DVec3::new(x, y, if flat { 0.0 } else { z }));
    prop::collection::vec(point, 1..40).prop_map(|mut seeds| {
        let key = |seed: &DVec3| seed.map(|x| if x == 1.0 { 0.0 } else { x }).to_array().map(f64::to_bits);
        seeds.sort_by_key(key);
        seeds.dedup_by_key(|seed| key(seed));
        seeds
    })
}

fn any_periods() -> impl Strategy<Value = BVec3> {
    prop_oneof![2 => Just(XYZ), 1 => (1..8usize).prop_map(|axes| periods().nth(axes - 1).expect("seven subsets"))]
}

/// Distance to the nearest image of a seed.
fn periodic_distance(domain: &Domain, seed: DVec3, point: DVec3) -> f64 {
    let size = domain.size();
    let difference = point - seed;
    let wrapped =
        difference - (difference / DVec3::select(size.cmpgt(DVec3::ZERO), size, DVec3::ONE)).round() * size;
    DVec3::select(domain.periodic(), wrapped, difference).length()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn mixtures_give_complexes_and_corners_are_nearest_to_their_seeds(
        seeds in distinct_seeds(false), axes in any_periods()
    ) {
        let tessellation = tessellate(&seeds, axes);
        for face in tessellation.faces() {
            let Side::Cell(cell) = tessellation.face_sides(face)[0] else { panic!("a cell comes first") };
            for corner in tessellation.face_corners(face) {
                let corner = tessellation.vertices()[corner.index()];
                let own = seeds[cell.index()].distance(corner);
                let nearest = seeds.iter().map(|seed| periodic_distance(tessellation.domain(), *seed, corner));
                prop_assert!(nearest.fold(f64::INFINITY, f64::min) >= own - 1e-12);
            }
        }
    }

    #[test]
    fn mixtures_in_the_plane_give_complexes(
        seeds in distinct_seeds(true), axes in any_periods(),
        radii in prop::collection::vec(prop_oneof![Just(0.0), Just(0.125), 0.0..0.3f64], 40),
        is_weighted in any::<bool>(),
    ) {
        let domain = Domain::unit_square().with_periods(axes);
        if is_weighted {
            let weights: Vec<f64> = radii[..seeds.len()].iter().map(|radius| radius * radius).collect();
            let tessellation = Tessellation::power(&domain, &seeds, &weights);
            assert_power_complex(&tessellation.expect("valid seeds"), &weights);
        } else {
            assert_complex(&Tessellation::new(&domain, &seeds).expect("valid seeds"));
        }
    }

    #[test]
    fn power_cells_give_complexes(
        seeds in distinct_seeds(false), axes in any_periods(),
        radii in prop::collection::vec(prop_oneof![Just(0.0), Just(0.125), 0.0..0.3f64], 40),
    ) {
        let weights: Vec<f64> = radii[..seeds.len()].iter().map(|radius| radius * radius).collect();
        let tessellation = Tessellation::power(&cube(axes), &seeds, &weights).expect("valid seeds");
        assert_power_complex(&tessellation, &weights);
    }

    /// Neither the numbers of the seeds nor the place of the seam changes the cells.
    #[test]
    fn cells_do_not_depend_on_numbers_or_seam(seeds in distinct_seeds(false), turn in 0usize..40, eighths in 0u32..8) {
        let count = seeds.len();
        let (turn, move_by) = (turn % count, f64::from(eighths) / 8.0);
        // Coordinates in units of 2^-40, for which moving is exact.
        let coarse = |x: f64| (x * 2f64.powi(40)).round() / 2f64.powi(40);
        let coarse: Vec<DVec3> = seeds.iter().map(|seed| seed.map(coarse)).collect();
        let moved = |seed: DVec3| seed.map(|x| (x + move_by).fract());
        let after: Vec<DVec3> = (0..count).map(|i| moved(coarse[(i + turn) % count])).collect();
        let Ok(before) = Tessellation::new(&cube(XYZ), &coarse) else { return Ok(()) };
        let after = Tessellation::new(&cube(XYZ), &after).expect("valid seeds");
        let old = |side: Side| match side {
            Side::Cell(cell) | Side::Image(cell, _) => (cell.index() + turn) % count,
            Side::Wall(_) => panic!("no walls"),
        };
        for cell in 0..count as u32 {
            let mut renamed: Vec<usize> = after.neighbors(CellId(cell)).into_iter().map(old).collect();
            renamed.sort_unstable();
            let cell = CellId(((cell as usize + turn) % count) as u32);
            let mut expected: Vec<usize> =
                before.neighbors(cell).into_iter().map(|side| (old(side) + count - turn) % count).collect();
            expected.sort_unstable();
            prop_assert_eq!(renamed, expected);
        }
    }
}
