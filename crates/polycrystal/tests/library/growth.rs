//! Grain growth in the plane, whatever vanishes on the way.

use std::f64::consts::FRAC_PI_3;

use crate::common::random_seeds;
use glam::{BVec3, DVec3};
use polycrystal::{
    Boundary, FaceMesh, GrainId, GrownCells, GrowthRecipe, Junctions, Moving, NetworkError, NetworkRecipe,
    RelaxationStep, grow_cells, measure_network,
};
use proptest::prelude::*;
use voronoi::{Domain, Tessellation};

const TORUS: BVec3 = BVec3::new(true, true, false);

fn one(_: &Boundary) -> f64 {
    1.0
}

/// One level, boundaries alike.
const EQUAL: GrowthRecipe<'_> = GrowthRecipe { network: recipe(1, &one), mobility: &one };

const fn recipe(levels: usize, tension: &(dyn Fn(&Boundary) -> f64 + Sync)) -> NetworkRecipe<'_> {
    NetworkRecipe { face_mesh: FaceMesh::Fan, junctions: Junctions::Crease, levels, tension }
}

fn square(periodic: BVec3) -> Domain {
    Domain::unit_square().with_periods(periodic)
}

fn cells(domain: &Domain, count: usize, random_seed: u64) -> Tessellation {
    let seeds = random_seeds(domain, count, random_seed).into_iter().map(|seed| seed.with_z(0.0));
    Tessellation::new(domain, &seeds.collect::<Vec<_>>()).expect("valid seeds")
}

/// Of each grain of a step that is left, its number of sides and its area.
type Grains = Vec<(GrainId, usize, f64)>;

fn sides_and_areas(step: &RelaxationStep<'_>) -> Grains {
    let Moving::Grains(network) = step.now else { panic!("grains grow") };
    let (network, points) = network().expect("a network");
    let measures = measure_network(&network, &network.subdivide(&points)).in_plane().expect("lines");
    measures.grains.iter().map(|grain| (grain.grain, grain.side_count, grain.area)).collect()
}

/// Von Neumann 1952, Mullins 1956, of grains that keep their sides for a step, while others vanish and switch neighbours.
#[test]
fn grains_grow_by_the_law_of_von_neumann_and_mullins_while_others_vanish() {
    let count = 100;
    let mut errors = Vec::new();
    let mut last: Option<(f64, Grains)> = None;
    let watch = |step: RelaxationStep<'_>| {
        let now = sides_and_areas(&step);
        // Angles come to rest at first.
        if let Some((before, grains)) = last.take().filter(|(before, _)| *before > 0.1) {
            let passed = (step.time - before) / count as f64;
            for (grain, sides, area) in grains {
                let place = now.binary_search_by_key(&grain, |(grain, ..)| *grain);
                let Some((_, _, after)) = place.ok().map(|place| now[place]).filter(|after| after.1 == sides)
                else {
                    continue;
                };
                let law = FRAC_PI_3 * (sides as f64 - 6.0);
                errors.push(((after - area) / passed - law).abs() / law.abs().max(FRAC_PI_3));
            }
        }
        last = Some((step.time, now));
    };
    let grown = grow_cells(&cells(&square(TORUS), count, 3), &EQUAL, 2.0, watch).expect("grains grow");
    let switches = grown.cells.reconnections.neighbor_switches;
    assert!(grown.vanished.len() > 50 && switches > 20, "{} {switches}", grown.vanished.len());
    errors.sort_by(f64::total_cmp);
    let [median, most] = [2, 10].map(|part| errors[errors.len() - 1 - errors.len() / part]);
    assert!(median < 0.01 && most < 0.05, "{median} {most}");
}

/// Grains coarsen: their mean area grows in proportion to time, and the mean number of sides stays six. The rate is that which others found by front
/// tracking (Lazar, MacPherson and Srolovitz 2010, "A more accurate two-dimensional grain growth algorithm").
#[test]
fn five_thousand_grains_coarsen_to_five_hundred() {
    let count = 5000;
    let mut means = Vec::new();
    let watch = |step: RelaxationStep<'_>| {
        if step.time >= means.len() as f64 {
            let now = sides_and_areas(&step);
            let sides: usize = now.iter().map(|(_, sides, _)| sides).sum();
            let area: f64 = now.iter().map(|(.., area)| area).sum();
            assert_eq!(sides, 6 * now.len());
            assert!((area - 1.0).abs() < 1e-9, "{area}");
            means.push((step.time, count as f64 / now.len() as f64));
        }
    };
    let cells = cells(&square(TORUS), count, 1);
    let GrownCells { cells, vanished } = grow_cells(&cells, &EQUAL, 8.2, watch).expect("grains grow");
    let left = cells.network.grains_left();
    assert_eq!(left + vanished.len(), count);
    assert!(left < 560, "{left}");
    // The first half of the time is that in which random cells become grains.
    let late = &means[4..];
    let [times, areas] =
        [0, 1].map(|k| late.iter().map(|at| [at.0, at.1][k]).sum::<f64>() / late.len() as f64);
    let slope = late.iter().map(|at| (at.0 - times) * (at.1 - areas)).sum::<f64>()
        / late.iter().map(|at| (at.0 - times).powi(2)).sum::<f64>();
    for (time, area) in late {
        let line = areas + slope * (time - times);
        assert!((area / line - 1.0).abs() < 0.02, "{area} at {time}, not {line}");
    }
    assert!((slope - 1.15).abs() < 0.15, "{slope}");
}

/// To the last grains: some meet themselves through the periods, others are cut off by walls and corners. A grain between another one and its own
/// image could once not vanish, nor could one along several walls.
#[test]
fn growth_goes_on_until_a_few_grains_are_left() {
    for periodic in [BVec3::FALSE, TORUS, BVec3::new(true, false, false)] {
        for random_seed in 1..=5 {
            let cells = cells(&square(periodic), 40, random_seed);
            let grown = grow_cells(&cells, &EQUAL, 40.0, |_| ()).expect("grains grow");
            let left = grown.cells.network.grains_left();
            assert!((1..10).contains(&left), "{left} with seed {random_seed}");
            let areas: f64 = grown.cells.network.cell_volumes().iter().sum();
            assert!((areas - 1.0).abs() < 1e-12, "{areas}");
            let gone = grown
                .vanished
                .iter()
                .all(|gone| grown.cells.network.cell_volumes()[gone.grain.index()] == 0.0);
            assert!(gone && grown.vanished.is_sorted_by_key(|gone| gone.time));
        }
    }
}

/// Points of four edges open, whichever way.
#[test]
fn squares_grow() {
    let place = |k| (f64::from(k) + 0.5) / 6.0;
    let seeds: Vec<DVec3> = (0..36).map(|k| DVec3::new(place(k % 6), place(k / 6), 0.0)).collect();
    for periodic in [BVec3::FALSE, TORUS] {
        let cells = Tessellation::new(&square(periodic), &seeds).expect("valid seeds");
        let grown = grow_cells(&cells, &EQUAL, 0.3, |_| ()).expect("grains grow");
        assert!(grown.cells.reconnections.lines_to_boundaries >= 25, "{:?}", grown.cells.reconnections);
    }
}

#[test]
fn tensions_and_mobilities_are_free_of_units() {
    let cells = cells(&square(TORUS), 30, 4);
    let law = |unit: f64| {
        move |boundary: &Boundary| {
            let [first, second] = boundary.sides.map(|side| side.grain().map_or(0, |grain| grain.0));
            unit * (1.0 + 0.25 * f64::from((first + second) % 3))
        }
    };
    let grown = |unit: f64| {
        let law = law(unit);
        let recipe = GrowthRecipe { network: recipe(0, &law), mobility: &law };
        grow_cells(&cells, &recipe, 0.5, |_| ()).expect("grains grow")
    };
    let usual = grown(1.0);
    for unit in [1e-6, 1e6] {
        let other = grown(unit);
        assert_eq!(usual.vanished.len(), other.vanished.len());
        let pairs = usual.cells.network.cell_volumes().iter().zip(other.cells.network.cell_volumes());
        pairs.for_each(|(one, other)| assert!((one - other).abs() < 1e-9, "{one} {other}"));
    }
    let none = |_: &Boundary| 0.0;
    let still = GrowthRecipe { network: recipe(0, &none), mobility: &one };
    let kept = grow_cells(&cells, &still, 0.5, |_| ()).expect("nothing moves");
    let areas = cells.cell_measures();
    let pairs = kept.cells.network.cell_volumes().iter().zip(&areas);
    pairs.for_each(|(one, other)| assert!((one - other.volume).abs() < 1e-6, "{one} {}", other.volume));
}

#[test]
fn bad_numbers_are_named() {
    let cells = cells(&square(TORUS), 5, 1);
    let error = |recipe: &GrowthRecipe<'_>, time| grow_cells(&cells, recipe, time, |_| ()).expect_err("bad");
    assert!(matches!(error(&EQUAL, f64::NAN), NetworkError::BadRelaxationTime(_)));
    let bad = |_: &Boundary| -1.0;
    assert!(matches!(
        error(&GrowthRecipe { network: recipe(1, &bad), ..EQUAL }, 1.0),
        NetworkError::BadTension { .. }
    ));
    assert!(matches!(
        error(&GrowthRecipe { mobility: &bad, ..EQUAL }, 1.0),
        NetworkError::BadMobility { .. }
    ));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// The same whatever the threads, and wherever it stops on the way, as far as steps are exact.
    #[test]
    fn growth_does_not_depend_on_threads(random_seed in 0u64..1000, is_periodic: bool) {
        let cells = cells(&square(if is_periodic { TORUS } else { BVec3::FALSE }), 60, random_seed);
        let with_threads = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| grow_cells(&cells, &EQUAL, 1.0, |_| ())).expect("grains grow")
        };
        let [one, two] = [1, 2].map(with_threads);
        prop_assert_eq!(one.vanished, two.vanished);
        prop_assert_eq!(one.cells.relaxed.points, two.cells.relaxed.points);
    }
}
