//! What several test files need: random seeds, and the check that a tessellation is a cell complex.

#![allow(dead_code, reason = "each test file uses its share")]

mod exact_vertices;

use std::collections::HashMap;

use exact_vertices::assert_vertices_differ;
use glam::DVec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use voronoi::{CellMeasure, Dimension, Domain, PeriodicPair, Side, Tessellation, Translation, VertexId};

/// Uniform random seeds in the unit cube.
pub fn random_seeds(count: usize, random_seed: u64) -> Vec<DVec3> {
    let mut generator = ChaCha8Rng::seed_from_u64(random_seed);
    let mut fraction = || (generator.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    (0..count).map(|_| DVec3::new(fraction(), fraction(), fraction())).collect()
}

/// Volumes sum to the domain, only cells without faces are empty, no two vertices are one point, and all that
/// [`assert_closed`] asks for. Cells need not be those of their seeds any more.
pub fn assert_changed_complex(tessellation: &Tessellation) {
    assert_vertices_differ(tessellation, None);
    assert_fills_domain(tessellation);
}

/// The same for the cells of seeds, which are also those that come one after another.
pub fn assert_complex(tessellation: &Tessellation) {
    assert_changed_complex(tessellation);
    assert_streams_alike(tessellation, None);
}

/// The same for power cells.
pub fn assert_power_complex(tessellation: &Tessellation, weights: &[f64]) {
    assert_vertices_differ(tessellation, Some(weights));
    assert_fills_domain(tessellation);
    assert_streams_alike(tessellation, Some(weights));
}

/// Cells that come one after another have the same neighbours, counts and sizes.
fn assert_streams_alike(tessellation: &Tessellation, weights: Option<&[f64]>) {
    let domain = tessellation.domain();
    let cells = Tessellation::stream(domain, tessellation.seeds(), weights).expect("valid seeds");
    assert_eq!(cells.len(), tessellation.cell_count());
    assert!(cells.measures().eq(cells.iter().map(|cell| cell.measure)));
    for (cell, whole) in cells.iter().zip(tessellation.cell_measures()) {
        let id = cell.cell;
        assert_eq!(cell.seed, tessellation.seeds()[id.index()]);
        assert_eq!(cell.neighbors, tessellation.neighbors(id), "neighbours of {id:?}");
        let counts = |measure: &CellMeasure| (measure.face_count, measure.edge_count, measure.vertex_count);
        assert_eq!(counts(&cell.measure), counts(&whole), "{id:?}");
        let difference = (cell.measure.volume - whole.volume).abs();
        assert!(difference <= 1e-13 * domain.measure(), "volume of {id:?}: {cell:?} {whole:?}");
        assert!((cell.measure.area - whole.area).abs() <= 1e-12 * (1.0 + whole.area), "{cell:?} {whole:?}");
        if whole.volume > 1e-6 * domain.measure() {
            let offset = cell.measure.centroid.distance(whole.centroid);
            assert!(offset <= 1e-9 * domain.size().max_element(), "{cell:?} {whole:?}");
        }
    }
}

fn assert_fills_domain(tessellation: &Tessellation) {
    let measures = tessellation.cell_measures();
    let volumes: Vec<f64> = measures.iter().map(|cell| cell.volume).collect();
    // The volume of a cell thinner than the last place of its coordinates may round to nothing.
    let rounding = 1e-15 * tessellation.domain().measure();
    let is_good = |cell: &CellMeasure| match cell.face_count {
        0 => cell.volume == 0.0,
        _ => cell.volume > -rounding,
    };
    assert!(measures.iter().all(is_good), "{volumes:?}");
    let (sum, whole) = (volumes.iter().sum::<f64>(), tessellation.domain().measure());
    assert!((sum - whole).abs() <= 1e-12 * whole, "volumes sum to {sum}, not {whole}");
    assert_closed(tessellation);
}

/// The Euler number is that of a box (of a torus where the domain is periodic), each cell is a closed polyhedron, and periodic
/// copies match.
pub fn assert_closed(tessellation: &Tessellation) {
    let cell_count = tessellation.cell_count() - tessellation.empty_cells().len();
    assert_copies_match(tessellation);
    let euler_number = usize::from(!tessellation.domain().is_periodic());
    let counts = complex_counts(tessellation);
    if tessellation.domain().dimension() == Dimension::Two {
        assert_eq!(counts.vertices + cell_count, counts.faces + euler_number, "Euler number in the plane");
        return;
    }
    assert_eq!(counts.vertices + counts.faces, counts.edges + cell_count + euler_number, "Euler number");
    let mut walks: HashMap<(Side, VertexId, VertexId), i32> = HashMap::new();
    for face in tessellation.faces() {
        let corners = tessellation.face_corners(face);
        for (&from, &to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            let [first, second] = tessellation.face_sides(face);
            *walks.entry((first, from, to)).or_default() += 1;
            *walks.entry((second, to, from)).or_default() += 1;
        }
    }
    for ((side, from, to), count) in &walks {
        if matches!(side, Side::Cell(_)) {
            assert_eq!(*count, 1, "an edge of a cell is walked once each way");
            assert!(walks.contains_key(&(*side, *to, *from)), "{side:?} is open at {from:?}-{to:?}");
        }
    }
}

/// Numbers of vertices, edges and faces, periodic copies not counted.
pub struct ComplexCounts {
    pub vertices: usize,
    pub edges: usize,
    pub faces: usize,
}

pub fn complex_counts(tessellation: &Tessellation) -> ComplexCounts {
    let edges = tessellation.edges();
    ComplexCounts {
        vertices: tessellation.vertices().len() - tessellation.periodic_vertices().len(),
        edges: edges.ends.len() - tessellation.periodic_edges(&edges).len(),
        faces: tessellation.face_count() - tessellation.periodic_faces().len(),
    }
}

/// Secondaries stand at their primaries plus the translation, bit for bit, and are named by both of their cells.
fn assert_copies_match(tessellation: &Tessellation) {
    let domain = tessellation.domain();
    let mut place: Vec<(VertexId, Translation)> = (0u32..)
        .take(tessellation.vertices().len())
        .map(|vertex| (VertexId(vertex), Translation::ZERO))
        .collect();
    for &PeriodicPair { secondary, primary, translation } in tessellation.periodic_vertices() {
        let moved = tessellation.vertices()[primary.index()] + translation.vector(domain);
        assert_eq!(place[primary.index()], (primary, Translation::ZERO), "a primary is no secondary");
        assert!(translation != Translation::ZERO);
        place[secondary.index()] = (primary, translation);
        for axis in 0..3 {
            let on_wall = !domain.periodic().test(axis);
            assert!(on_wall || tessellation.vertices()[secondary.index()][axis] == moved[axis]);
        }
    }
    let images =
        tessellation.faces().filter(|face| matches!(tessellation.face_sides(*face)[1], Side::Image(..)));
    assert_eq!(images.count(), 2 * tessellation.periodic_faces().len());
    for &PeriodicPair { secondary, primary, translation } in tessellation.periodic_faces() {
        let [Side::Cell(first), Side::Image(second, to_second)] = tessellation.face_sides(primary) else {
            panic!("a primary face with a copy has a moved cell beyond it")
        };
        let back = Translation::ZERO - to_second;
        assert_eq!(translation, back);
        assert_eq!(tessellation.face_sides(secondary), [Side::Cell(second), Side::Image(first, back)]);
        let moved = tessellation.face_corners(primary).iter().rev().map(|corner| {
            let (vertex, at) = place[corner.index()];
            (vertex, at + translation)
        });
        let corners = tessellation.face_corners(secondary).iter().map(|corner| place[corner.index()]);
        assert!(corners.eq(moved), "{secondary:?} is not the moved {primary:?}");
    }
    let edges = tessellation.edges();
    for PeriodicPair { secondary, primary, translation } in tessellation.periodic_edges(&edges) {
        let ends = |edge: u32| edges.ends[edge as usize].map(|end| place[end.index()]);
        let moved = ends(primary).map(|(vertex, at)| (vertex, at + translation));
        let [a, b] = ends(secondary);
        assert!(moved == [a, b] || moved == [b, a], "edge {secondary} is not the moved {primary}");
    }
}

/// Centres of the n x n x n cubes that fill the unit cube, and `offsets` from there in units of their edge.
pub fn lattice(n: u32, offsets: &[DVec3]) -> Vec<DVec3> {
    let mut seeds = Vec::new();
    for (x, y, z) in (0..n).flat_map(|x| (0..n).flat_map(move |y| (0..n).map(move |z| (x, y, z)))) {
        for offset in offsets {
            let corner = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
            seeds.push((corner + *offset) / f64::from(n));
        }
    }
    seeds
}

/// The centres of n x n squares in the unit square.
pub fn square(n: u32) -> Vec<DVec3> {
    let center = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
    (0..n * n).map(|i| DVec3::new(center(i % n), center(i / n), 0.0)).collect()
}

pub fn jittered(seeds: &[DVec3], size: f64) -> Vec<DVec3> {
    let noise = random_seeds(seeds.len(), 5);
    seeds.iter().zip(noise).map(|(seed, noise)| *seed + (noise - 0.5) * size).collect()
}

pub const SIMPLE_CUBIC: [DVec3; 1] = [DVec3::splat(0.5)];
pub const BODY_CENTRED: [DVec3; 2] = [DVec3::splat(0.25), DVec3::splat(0.75)];
pub const FACE_CENTRED: [DVec3; 4] = [
    DVec3::splat(0.25),
    DVec3::new(0.25, 0.75, 0.75),
    DVec3::new(0.75, 0.25, 0.75),
    DVec3::new(0.75, 0.75, 0.25),
];

pub fn tessellate(seeds: &[DVec3]) -> Tessellation {
    Tessellation::new(&Domain::unit_cube(), seeds).expect("valid seeds")
}
