//! Grain growth in space, whatever vanishes on the way.

use std::collections::HashMap;

use crate::common::random_seeds;
use glam::{BVec3, DVec3};
use polycrystal::{
    Boundary, FaceMesh, GrainId, GrownCells, GrowthRecipe, Junctions, Mesh, Moving, Network, NetworkError,
    NetworkRecipe, RelaxationStep, grow_cells, measure_network,
};
use voronoi::{Domain, Tessellation};

fn one(_: &Boundary) -> f64 {
    1.0
}

fn by_grains(boundary: &Boundary) -> f64 {
    let [first, second] = boundary.sides.map(|side| side.grain().map_or(0, |grain| grain.0));
    1.0 + 0.25 * f64::from((first + second) % 3)
}

type Law<'a> = &'a (dyn Fn(&Boundary) -> f64 + Sync);

fn recipe<'a>(levels: usize, law: Law<'a>) -> GrowthRecipe<'a> {
    let network =
        NetworkRecipe { face_mesh: FaceMesh::Fan, junctions: Junctions::Crease, levels, tension: law };
    GrowthRecipe { network, mobility: law }
}

fn cells(periodic: BVec3, count: usize, random_seed: u64) -> Tessellation {
    let domain = Domain::unit_cube().with_periods(periodic);
    Tessellation::new(&domain, &random_seeds(&domain, count, random_seed)).expect("valid seeds")
}

fn network_of(step: &RelaxationStep<'_>) -> (Network, Vec<DVec3>) {
    let Moving::Grains(network) = step.now else { panic!("grains grow") };
    network().expect("a network")
}

/// Checks that each grain that is left is a closed ball: its triangles run along each edge once each way, and V - E + F = 2.
fn check_balls(network: &Network) {
    let level = network.control_mesh();
    let Mesh::Triangles(mesh) = &level.mesh else { panic!("triangles") };
    let mut runs: HashMap<(GrainId, u32, u32), u32> = HashMap::new();
    let mut counts = vec![0i64; network.grain_count()];
    let mut corners = Vec::new();
    for (triangle, boundary) in mesh.triangles().iter().zip(&level.boundary_of) {
        for (grain, sign) in network.boundaries()[boundary.index()].signed_grains() {
            let [a, b, c] = *triangle;
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let (from, to) = if sign > 0.0 { (from, to) } else { (to, from) };
                *runs.entry((grain, from, to)).or_default() += 1;
                corners.push((grain, from));
            }
            counts[grain.index()] += 1;
        }
    }
    corners.sort_unstable();
    corners.dedup();
    corners.iter().for_each(|(grain, _)| counts[grain.index()] += 1);
    for (&(grain, from, to), &count) in &runs {
        assert!(count == 1 && runs.contains_key(&(grain, to, from)), "{grain:?} is open");
        counts[grain.index()] -= i64::from(from < to);
    }
    let volumes = network.cell_volumes().iter();
    assert!(volumes.zip(&counts).all(|(volume, euler)| *euler == if *volume == 0.0 { 0 } else { 2 }));
}

/// To the last grains, between walls and through periods: all are closed balls and fill the box after every step.
#[test]
fn growth_goes_on_until_a_few_grains_are_left() {
    for periodic in [BVec3::FALSE, BVec3::TRUE, BVec3::new(true, false, false)] {
        for random_seed in 1..=2 {
            let count = 25;
            let mut left = count;
            let watch = |step: RelaxationStep<'_>| {
                let (network, _) = network_of(&step);
                check_balls(&network);
                let volume: f64 = network.cell_volumes().iter().sum();
                assert!((volume - 1.0).abs() < 1e-9, "{volume}");
                assert!(network.grains_left() <= left, "{left}");
                left = network.grains_left();
            };
            let cells = cells(periodic, count, random_seed);
            let grown = grow_cells(&cells, &recipe(1, &one), 4.0, watch).expect("grains grow");
            let GrownCells { cells, vanished } = grown;
            assert_eq!(cells.network.grains_left(), left);
            assert_eq!(left + vanished.len(), count);
            assert!((1..10).contains(&left), "{left} with seed {random_seed}");
            let volumes = cells.network.cell_volumes();
            assert!((volumes.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            assert!(vanished.iter().all(|gone| volumes[gone.grain.index()] == 0.0));
            assert!(vanished.is_sorted_by_key(|gone| gone.time));
        }
    }
}

/// A grain, its number of faces, its volume, and its rate of growth by the law.
type GrainState = (GrainId, usize, f64, f64);

/// MacPherson and Srolovitz 2007, of grains that keep their faces for a step, while others vanish. The mean number of faces of grains that have grown is 13.77
/// (Lazar, Mason, MacPherson and Srolovitz 2011, "Complete topology of cells, grains, and bubbles in three-dimensional microstructures").
#[test]
fn grains_grow_by_the_law_of_macpherson_and_srolovitz_while_others_vanish() {
    let count = 100;
    let mut errors = Vec::new();
    let (mut faces, mut grains) = (0, 0);
    let mut last: Option<(f64, Vec<GrainState>)> = None;
    let watch = |step: RelaxationStep<'_>| {
        let (network, points) = network_of(&step);
        let measures = measure_network(&network, &points).in_space().expect("surfaces");
        let now: Vec<_> = measures
            .grains
            .iter()
            .map(|grain| (grain.grain, grain.face_count, grain.volume, grain.growth_rate.expect("no walls")))
            .collect();
        if step.time > 0.3 {
            faces += now.iter().map(|grain| grain.1).sum::<usize>();
            grains += now.len();
        }
        // Angles come to rest at first.
        if let Some((before, grains)) = last.take().filter(|(before, _)| *before > 0.1) {
            let passed = (step.time - before) / (count as f64).powf(2.0 / 3.0);
            for (grain, faces, volume, law) in grains {
                let place = now.binary_search_by_key(&grain, |grain| grain.0);
                let same = place.ok().map(|place| now[place]).filter(|after| after.1 == faces);
                let Some((_, _, after, law_after)) = same else { continue };
                errors.push(((after - volume) / passed / (0.5 * (law + law_after)) - 1.0).abs());
            }
        }
        last = Some((step.time, now));
    };
    let grown = grow_cells(&cells(BVec3::TRUE, count, 3), &recipe(0, &one), 0.6, watch).expect("grains grow");
    assert!(grown.vanished.len() > 40, "{}", grown.vanished.len());
    errors.sort_by(f64::total_cmp);
    let median = errors[errors.len() / 2];
    assert!(median < 0.01, "{median}");
    let faces = faces as f64 / grains as f64;
    assert!((faces - 13.77).abs() < 0.5, "{faces}");
}

#[test]
fn tensions_and_mobilities_are_free_of_units() {
    let cells = cells(BVec3::TRUE, 15, 4);
    let grown = |unit: f64| {
        let law = move |boundary: &Boundary| unit * by_grains(boundary);
        grow_cells(&cells, &recipe(1, &law), 0.2, |_| ()).expect("grains grow")
    };
    let usual = grown(1.0);
    assert!(!usual.vanished.is_empty());
    for unit in [1e-6, 1e6] {
        let other = grown(unit);
        let [one, other] = [&usual, &other].map(|grown| &grown.cells.relaxed.points);
        assert_eq!(one.len(), other.len());
        assert!(one.iter().zip(other).all(|(one, other)| one.distance(*other) < 1e-9), "{unit}");
    }
    let none = |_: &Boundary| 0.0;
    let network = NetworkRecipe { tension: &none, ..recipe(0, &one).network };
    let kept =
        grow_cells(&cells, &GrowthRecipe { network, mobility: &one }, 0.5, |_| ()).expect("nothing moves");
    assert!(kept.cells.relaxed.is_flat && kept.vanished.is_empty());
}

#[test]
fn growth_does_not_depend_on_threads() {
    let cells = cells(BVec3::new(true, true, false), 40, 6);
    let [one, two] = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| grow_cells(&cells, &recipe(1, &by_grains), 0.5, |_| ())).expect("grains grow")
    });
    assert!(one.vanished.len() > 10);
    assert_eq!(one.vanished, two.vanished);
    assert_eq!(one.cells.relaxed.points, two.cells.relaxed.points);
}

#[test]
fn bad_numbers_are_named() {
    let cells = cells(BVec3::TRUE, 5, 1);
    let error = |recipe: &GrowthRecipe<'_>, time| grow_cells(&cells, recipe, time, |_| ()).expect_err("bad");
    assert!(matches!(error(&recipe(0, &one), -1.0), NetworkError::BadRelaxationTime(_)));
    let bad = |_: &Boundary| f64::NAN;
    assert!(matches!(error(&recipe(0, &bad), 1.0), NetworkError::BadTension { .. }));
    let unlike = GrowthRecipe { mobility: &bad, ..recipe(0, &one) };
    assert!(matches!(error(&unlike, 1.0), NetworkError::BadMobility { .. }));
}
