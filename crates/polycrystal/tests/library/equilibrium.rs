//! Relaxation to equilibrium with changes of topology.

use crate::common::random_seeds;
use glam::{BVec3, DVec3};
use polycrystal::{
    Balance, Boundary, FaceMesh, Junctions, NetworkRecipe, Reconnections, Relaxation, RelaxedCells,
    dihedral_angles, measure_network, relax_cells, validate,
};
use voronoi::{Domain, Tessellation};

fn balanced(domain: &Domain, seeds: &[DVec3], levels: usize) -> (RelaxedCells, Vec<DVec3>) {
    let tessellation = Tessellation::new(domain, seeds).expect("valid seeds");
    let tension = |boundary: &Boundary| if boundary.wall.is_some() { 0.0 } else { 1.0 };
    let recipe =
        NetworkRecipe { face_mesh: FaceMesh::Fan, junctions: Junctions::Crease, levels, tension: &tension };
    let balanced = relax_cells(&tessellation, &recipe, &Relaxation::Equilibrium, |_| ()).expect("relaxes");
    let points = balanced.relaxed.finest_points(&balanced.network);
    (balanced, points)
}

fn check_random_grains(domain: &Domain, count: usize, random_seed: u64, largest_spread: f64) {
    let (RelaxedCells { network, reconnections, balance, .. }, points) =
        balanced(domain, &random_seeds(domain, count, random_seed), 2);
    let balance = balance.expect("equilibrium");
    let validation = validate(&network, &points).expect("closed grains, no folds, no crossings");
    assert!(validation.largest_volume_error < 1e-10, "{validation:?}");
    assert!(reconnections.count() > 0);
    let angles = dihedral_angles(&network, network.finest(), &points).expect("triple lines");
    assert!((angles.mean - 120.0).abs() < 0.2, "{angles:?}");
    assert!(angles.standard_deviation < largest_spread, "{angles:?}, {balance:?}");
}

#[test]
fn random_periodic_grains_come_to_equilibrium() {
    check_random_grains(&Domain::unit_cube().with_periods(BVec3::TRUE), 24, 1, 1.9);
}

#[test]
fn random_grains_between_walls_come_to_equilibrium() {
    check_random_grains(&Domain::unit_cube(), 24, 1, 2.3);
}

/// All events of one look together once took 81 % of a cell's volume, and no later step brought that back: the flow ended folded.
#[test]
fn events_leave_cells_their_volumes() {
    let domain = Domain::unit_cube();
    let tessellation = Tessellation::new(&domain, &random_seeds(&domain, 60, 1)).expect("valid seeds");
    let tension = |boundary: &Boundary| if boundary.wall.is_some() { 0.0 } else { 1.0 };
    let recipe = NetworkRecipe {
        face_mesh: FaceMesh::Fan,
        junctions: Junctions::Crease,
        levels: 2,
        tension: &tension,
    };
    let relaxed = relax_cells(&tessellation, &recipe, &Relaxation::USUAL, |_| ()).expect("relaxes");
    let RelaxedCells { network, relaxed, reconnections, balance, validation, attempts, .. } = relaxed;
    assert!(attempts.is_empty() && relaxed.given_up.is_empty(), "{attempts:?}");
    assert!(reconnections.count() > 0 && balance.is_none());
    assert!(validation.largest_volume_error < 1e-10, "{validation:?}");
    let counts = network.junction_counts();
    let of_more = |counts: &std::collections::BTreeMap<u8, usize>, usual: u8| -> usize {
        counts.iter().filter(|(number, _)| **number > usual).map(|(_, count)| count).sum()
    };
    assert!(of_more(&counts.lines_by_sides, 3) <= 2, "{counts:?}");
    assert!(50 * of_more(&counts.points_by_sides, 4) < counts.quadruple_points, "{counts:?}");
    let points = relaxed.finest_points(&network);
    let angles = dihedral_angles(&network, network.finest(), &points).expect("triple lines");
    assert!(angles.standard_deviation < 6.0, "{angles:?}");
}

/// A time of none moves nothing, and where nothing has tension, nothing comes together.
#[test]
fn cells_stay_flat_without_time_or_tension() {
    let domain = Domain::unit_cube();
    let tessellation = Tessellation::new(&domain, &random_seeds(&domain, 8, 1)).expect("valid seeds");
    for (tension, relaxation) in [(1.0, Relaxation::Time(0.0)), (0.0, Relaxation::USUAL)] {
        let recipe = NetworkRecipe {
            face_mesh: FaceMesh::Fan,
            junctions: Junctions::Crease,
            levels: 1,
            tension: &|_| tension,
        };
        let relaxed = relax_cells(&tessellation, &recipe, &relaxation, |_| ()).expect("valid cells");
        assert!(relaxed.relaxed.is_flat && relaxed.reconnections == Reconnections::default());
    }
    let recipe = NetworkRecipe {
        face_mesh: FaceMesh::Fan,
        junctions: Junctions::Crease,
        levels: 1,
        tension: &|_| 1.0,
    };
    let refused = relax_cells(&tessellation, &recipe, &Relaxation::Time(f64::NAN), |_| ());
    assert_eq!(
        refused.expect_err("no time").to_string(),
        polycrystal::NetworkError::BadRelaxationTime(f64::NAN).to_string()
    );
}

/// Three lines once ended 15 to 25 degrees off, and nothing was flagged.
#[test]
fn lines_that_are_not_at_rest_are_flagged() {
    let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
    for random_seed in [2, 3] {
        let (RelaxedCells { network, balance, .. }, points) =
            balanced(&domain, &random_seeds(&domain, 24, random_seed), 2);
        let balance = balance.expect("equilibrium");
        let measures = measure_network(&network, &points).in_space().expect("space");
        let residuals = || measures.triple_lines.iter().filter_map(|line| line.residual);
        let off = residuals().filter(|residual| *residual > Balance::LARGEST_RESIDUAL).count();
        assert!(balance.flagged_lines >= off, "{balance:?}, {off} off");
        assert!(balance.largest_residual <= Balance::LARGEST_RESIDUAL, "{balance:?}");
        let largest = residuals().fold(0.0, f64::max);
        assert!(off > 0 || largest == balance.largest_residual || balance.flagged_lines > 0, "{largest}");
    }
}

/// Kelvin's foam is in equilibrium as it is, but for curvature.
#[test]
fn kelvin_cells_keep_their_neighbours() {
    let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
    let mut seeds = Vec::new();
    for i in 0..8 {
        let corner = DVec3::new(f64::from(i % 2), f64::from(i / 2 % 2), f64::from(i / 4));
        seeds.extend([(corner + 0.25) / 2.0, (corner + 0.75) / 2.0]);
    }
    let (RelaxedCells { reconnections, balance, .. }, _) = balanced(&domain, &seeds, 2);
    let balance = balance.expect("equilibrium");
    assert_eq!(reconnections, Reconnections::default());
    assert_eq!(balance.flagged_lines, 0);
    assert!(balance.largest_residual < 0.013, "{balance:?}");
}

#[test]
fn the_same_grains_come_to_the_same_equilibrium_with_any_number_of_threads() {
    let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
    let seeds = random_seeds(&domain, 12, 5);
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads");
        pool.install(|| balanced(&domain, &seeds, 1).1)
    };
    assert_eq!(with_threads(1), with_threads(2));
}
