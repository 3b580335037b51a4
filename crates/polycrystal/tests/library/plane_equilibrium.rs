//! Relaxation to equilibrium in the plane, with the changes of topology that it takes.

use crate::common::random_seeds;
use glam::{BVec3, DVec2, DVec3};
use polycrystal::{
    Boundary, FaceMesh, Junctions, Mesh, Network, NetworkError, NetworkRecipe, PlaneMeasures, Reconnections,
    Relaxation, RelaxedCells, Side, measure_network, relax, relax_cells, remove_short_edges, validate,
};
use proptest::prelude::*;
use voronoi::{Domain, Tessellation};

const WALLS: BVec3 = BVec3::FALSE;
const TORUS: BVec3 = BVec3::new(true, true, false);

fn one_tension(boundary: &Boundary) -> f64 {
    if boundary.wall.is_some() { 0.0 } else { 1.0 }
}

fn equilibrium_of(
    tessellation: &Tessellation,
    tension: &(dyn Fn(&Boundary) -> f64 + Sync),
) -> Result<RelaxedCells, NetworkError> {
    let recipe = NetworkRecipe { face_mesh: FaceMesh::Fan, junctions: Junctions::Crease, levels: 2, tension };
    relax_cells(tessellation, &recipe, &Relaxation::Equilibrium, |_| ())
}

fn random_cells(domain: &Domain, count: usize, random_seed: u64) -> Tessellation {
    let seeds = random_seeds(domain, count, random_seed).into_iter().map(|seed| seed.with_z(0.0));
    Tessellation::new(domain, &seeds.collect::<Vec<_>>()).expect("valid seeds")
}

/// Power cells of those of so many seeds that have any.
fn weighted_cells(count: usize, random_seed: u64) -> Tessellation {
    let domain = Domain::unit_square();
    let places = random_seeds(&domain, count, random_seed);
    let weighted: Vec<(DVec3, f64)> =
        places.iter().map(|place| (place.with_z(0.0), 0.6 / count as f64 * place.z)).collect();
    let cells_of = |weighted: &[(DVec3, f64)]| {
        let (seeds, weights): (Vec<DVec3>, Vec<f64>) = weighted.iter().copied().unzip();
        Tessellation::power(&domain, &seeds, &weights).expect("valid seeds")
    };
    let empty = cells_of(&weighted).empty_cells();
    let kept = weighted.iter().enumerate().filter(|(seed, _)| empty.iter().all(|cell| cell.index() != *seed));
    cells_of(&kept.map(|(_, weighted)| *weighted).collect::<Vec<_>>())
}

/// The centres of so many squares.
fn square_lattice(domain: &Domain, count: u32) -> Tessellation {
    let place = |k| (f64::from(k) + 0.5) / f64::from(count);
    let seeds = (0..count * count).map(|k| DVec3::new(place(k % count), place(k / count), 0.0));
    Tessellation::new(domain, &seeds.collect::<Vec<_>>()).expect("valid seeds")
}

fn measures(RelaxedCells { network, relaxed, .. }: &RelaxedCells) -> PlaneMeasures {
    measure_network(network, &relaxed.points).in_plane().expect("lines")
}

/// The points of each boundary from start to end.
fn lines(network: &Network, points: &[DVec3]) -> Vec<Vec<DVec2>> {
    let level = network.finest().held();
    let Mesh::Segments(mesh) = &level.mesh else { panic!("a network in the plane") };
    let mut lines: Vec<Vec<DVec2>> = vec![Vec::new(); network.boundaries().len()];
    for (segment, boundary) in mesh.segments().iter().zip(&level.boundary_of) {
        let line = &mut lines[boundary.index()];
        let [start, end] = segment.map(|end| points[end as usize].truncate());
        if line.is_empty() {
            line.push(start);
        }
        line.push(end);
    }
    lines
}

/// Angles, right angles at walls, areas, and that each boundary is an arc whose curvature is a difference of pressures.
fn check_equilibrium(equilibrium: &RelaxedCells) -> Result<(), TestCaseError> {
    let RelaxedCells { network, relaxed, balance, .. } = equilibrium;
    let balance = balance.expect("equilibrium");
    let certificate = validate(network, &relaxed.points).expect("closed grains, no folds, no crossings");
    prop_assert!(certificate.largest_volume_error < 1e-10, "{certificate:?}");
    prop_assert_eq!(balance.flagged_lines, 0);
    // Half of a segment's bend at each boundary.
    prop_assert!(balance.largest_residual < 2.3e-3, "{balance:?}");
    if let Some(angles) = certificate.angles {
        prop_assert!((angles.mean - 120.0).abs() < 1e-9, "{angles:?}");
        prop_assert!(angles.standard_deviation < 0.25, "{angles:?}");
    }
    let size = network.mean_grain_size();
    let mut differences = Vec::new();
    for (line, boundary) in lines(network, &relaxed.points).iter().zip(network.boundaries()) {
        if boundary.wall.is_some() {
            continue;
        }
        let along: Vec<DVec2> = line.windows(2).map(|ends| ends[1] - ends[0]).collect();
        let curvatures =
            along.windows(2).map(|pair| pair[0].perp_dot(pair[1]) / pair[0].length().powi(3) * size);
        let curvatures: Vec<f64> = curvatures.collect();
        let mean = curvatures.iter().sum::<f64>() / curvatures.len() as f64;
        prop_assert!(curvatures.iter().all(|curvature| (curvature - mean).abs() < 1e-6), "an arc");
        if let [Side::Grain(one), Side::Grain(other)] = boundary.sides {
            differences.push((one.index(), other.index(), mean));
        }
        for (end, along) in [(line[0], along[0]), (line[line.len() - 1], along[along.len() - 1])] {
            if let Some(wall) = wall_at(network, end) {
                let off = along.normalize().perp_dot(wall).abs().asin().to_degrees();
                prop_assert!(off < 0.13, "{off} degrees from the wall's normal");
            }
        }
    }
    check_pressures(network.grain_count(), &differences)
}

/// The normal of the only wall of a box that a point lies on.
fn wall_at(network: &Network, point: DVec2) -> Option<DVec2> {
    let domain = network.domain();
    let normals = [DVec2::X, DVec2::Y].into_iter().zip([domain.periodic().x, domain.periodic().y]);
    let mut on = normals.filter(|(normal, is_periodic)| {
        let at = |corner: DVec3| (point - corner.truncate()).dot(*normal) == 0.0;
        !is_periodic && (at(domain.lower()) || at(domain.upper()))
    });
    on.next().map(|(normal, _)| normal)
}

/// Whether differences between pairs are those of one number for each.
fn check_pressures(count: usize, differences: &[(usize, usize, f64)]) -> Result<(), TestCaseError> {
    let mut pressures = vec![None; count];
    pressures[0] = Some(0.0);
    for _ in 0..count {
        for &(one, other, difference) in differences {
            match (pressures[one], pressures[other]) {
                (Some(known), None) => pressures[other] = Some(known - difference),
                (None, Some(known)) => pressures[one] = Some(known + difference),
                _ => {}
            }
        }
    }
    for &(one, other, difference) in differences {
        let [Some(one), Some(other)] = [one, other].map(|grain| pressures[grain]) else { continue };
        // Curvatures of polylines lack a share of the order of a segment's bend squared.
        prop_assert!((one - other - difference).abs() < 2e-4, "{} for {difference}", one - other);
    }
    Ok(())
}

/// Cells of a disc with up to so many seeds, if it has any.
fn cells_of_disc(count: usize, random_seed: u64) -> Option<Tessellation> {
    let domain = Domain::disc(DVec3::new(0.5, 0.5, 0.0), 0.5, 0.01).expect("a disc");
    let seeds = random_seeds(&Domain::unit_square(), 2 * count, random_seed);
    let seeds: Vec<DVec3> = seeds
        .into_iter()
        .map(|seed| seed.with_z(0.0))
        .filter(|seed| domain.contains(*seed))
        .take(count)
        .collect();
    (!seeds.is_empty()).then(|| Tessellation::new(&domain, &seeds).expect("valid seeds"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Down to grains that are their own neighbours.
    #[test]
    fn random_grains_come_to_equilibrium(
        count in 1..40_usize,
        random_seed in 0..u64::MAX,
        periods in prop::sample::select(vec![WALLS, BVec3::new(true, false, false), BVec3::new(false, true, false), TORUS]),
    ) {
        let domain = Domain::unit_square().with_periods(periods);
        let equilibrium = equilibrium_of(&random_cells(&domain, count, random_seed), &one_tension);
        check_equilibrium(&equilibrium.expect("relaxes"))?;
    }

    /// Grains of very different sizes: one of 1e-7 of the domain once kept all others from their places.
    #[test]
    fn weighted_grains_come_to_equilibrium(random_seed in 0..u64::MAX) {
        check_equilibrium(&equilibrium_of(&weighted_cells(30, random_seed), &one_tension).expect("relaxes"))?;
    }

    /// Walls with many corners, over which boundaries slide. One in some thousands is refused: its boundaries press two sides of a grain together.
    #[test]
    fn grains_in_a_disc_come_to_equilibrium(count in 2..30_usize, random_seed in 0..u64::MAX) {
        let cells = cells_of_disc(count, random_seed);
        prop_assume!(cells.is_some());
        let equilibrium = equilibrium_of(&cells.expect("as assumed"), &one_tension);
        prop_assume!(!matches!(equilibrium, Err(NetworkError::Invalid(_))));
        check_equilibrium(&equilibrium.expect("relaxes"))?;
    }
}

/// Their edges once counted as short beside the others, and went all at once; and the first grain, if it was one of them, bore what rounding
/// leaves of all areas.
#[test]
fn a_cluster_of_small_grains_comes_to_rest() {
    let domain = Domain::unit_square();
    let spread = |k: u32| DVec2::new(0.755, 0.570) * f64::from(k) % 1.0;
    let cluster = (1..=30).map(|k| DVec2::new(0.3, 0.6) + 3e-3 * spread(k));
    let others = (1..=30).map(spread);
    let seeds: Vec<DVec3> = cluster.chain(others).map(|seed| seed.extend(0.0)).collect();
    let cells = Tessellation::new(&domain, &seeds).expect("seeds");
    let equilibrium = equilibrium_of(&cells, &one_tension).expect("relaxes");
    assert!(equilibrium.validation.largest_volume_error < 1e-9);
    assert_eq!(equilibrium.balance.expect("in equilibrium").flagged_lines, 0);
}

/// Two edges switch at once here, which leaves the area of a small grain off by three quarters.
#[test]
fn areas_that_an_event_leaves_far_off_come_back_step_by_step() {
    let cells = cells_of_disc(4, 15_223_321_501_867_968_557).expect("seeds in the disc");
    let equilibrium = equilibrium_of(&cells, &one_tension).expect("relaxes");
    assert!(equilibrium.reconnections.count() > 0);
    check_equilibrium(&equilibrium).expect("an equilibrium");
}

/// The chord of a long arc that a step holds once turned a short one beside it over, however stiff that was.
#[test]
fn a_short_edge_beside_long_ones_that_shrink_does_not_turn_over() {
    let cells = cells_of_disc(5, 1_469_741_589_885_914_832).expect("seeds in the disc");
    check_equilibrium(&equilibrium_of(&cells, &one_tension).expect("relaxes")).expect("an equilibrium");
}

/// A topology kept costs length.
/// Arcs once turned round and round here while areas were restored, each turn costing time.
#[test]
fn a_thin_strip_of_a_lattice_comes_to_an_end() {
    let domain = Domain::rectangle(DVec3::ZERO, DVec3::new(1.0, 0.01, 0.0)).expect("a rectangle");
    let columns = [0.0, 0.25, 0.5, 0.75]
        .into_iter()
        .flat_map(|x| [0.0025, 0.0075, 0.01].map(|y| DVec3::new(x, y, 0.0)));
    let seeds: Vec<DVec3> = columns.chain([DVec3::new(1.0, 0.0025, 0.0)]).collect();
    let cells = Tessellation::new(&domain, &seeds).expect("valid seeds");
    // Grains 25 times as long as wide may not find room to relax, but say so.
    if let Ok(equilibrium) = equilibrium_of(&cells, &one_tension) {
        check_equilibrium(&equilibrium).expect("in equilibrium");
    }
}

#[test]
fn switching_neighbours_saves_length() {
    let domain = Domain::unit_square().with_periods(TORUS);
    let cells = random_cells(&domain, 60, 1);
    let equilibrium = equilibrium_of(&cells, &one_tension).expect("relaxes");
    assert!(equilibrium.reconnections.neighbor_switches > 0);
    let (network, flat) =
        Network::new(&remove_short_edges(&cells, 0.15).0, Junctions::Crease, 4).expect("a small network");
    let volumes = cells.cell_measures().iter().map(|cell| cell.volume).collect();
    let network = network.with_cell_volumes(volumes);
    let kept = relax(&network, &flat, &Relaxation::Equilibrium, |_, _| ()).expect("relaxes");
    let kept = measure_network(&network, &kept.finest_points(&network)).in_plane().expect("lines");
    let length = |measures: &PlaneMeasures| measures.boundaries.iter().map(|line| line.length).sum::<f64>();
    let [switched, kept] = [length(&measures(&equilibrium)), length(&kept)];
    assert!(switched < kept * (1.0 - 1e-3), "{switched}, with the topology kept {kept}");
}

/// Each of the points of four cells opens. On the torus all do the same way, to hexagons: the shortest network that has the square's
/// translations has length sqrt(2 + sqrt 3) a cell.
#[test]
fn a_square_lattice_becomes_a_foam() {
    for (periods, lines_to_boundaries) in [(TORUS, 16), (WALLS, 9)] {
        let domain = Domain::unit_square().with_periods(periods);
        let equilibrium = equilibrium_of(&square_lattice(&domain, 4), &one_tension).expect("relaxes");
        assert_eq!(equilibrium.reconnections.lines_to_boundaries, lines_to_boundaries);
        check_equilibrium(&equilibrium).expect("equilibrium");
        if periods == TORUS {
            let length: f64 = measures(&equilibrium).boundaries.iter().map(|line| line.length).sum();
            assert!((length - 4.0 * (2.0 + 3f64.sqrt()).sqrt()).abs() < 1e-9, "{length}");
        }
    }
}

/// Nothing is to be done, and nothing is.
#[test]
fn a_honeycomb_stays_a_honeycomb() {
    let height = 3f64.sqrt();
    let domain = Domain::rectangle(DVec3::ZERO, DVec3::new(2.0, 2.0 * height, 1.0)).expect("positive sides");
    let domain = domain.with_periods(TORUS);
    let seeds = (0..8).map(|k| {
        let x = f64::from(k % 2) + 0.5 * f64::from(k / 2 % 2) + 0.2;
        DVec3::new(x, f64::from(k / 2) * height / 2.0 + 0.1, 0.0)
    });
    let cells = Tessellation::new(&domain, &seeds.collect::<Vec<_>>()).expect("valid seeds");
    let equilibrium = equilibrium_of(&cells, &one_tension).expect("relaxes");
    assert_eq!(equilibrium.reconnections, Reconnections::default());
    for line in &measures(&equilibrium).boundaries {
        assert!((line.length - 1.0 / height).abs() < 1e-9 && line.mean_curvature.abs() < 1e-7, "{line:?}");
    }
}

/// Where two boundaries pull less than one resists, four grains meet in a point for good: cos 45 degrees is less than 0.8.
#[test]
fn a_point_of_four_grains_stays_where_tensions_hold_it() {
    let domain = Domain::unit_square();
    let cells = square_lattice(&domain, 2);
    let tension = |boundary: &Boundary| match boundary.sides {
        [Side::Grain(one), Side::Grain(other)] if one.0 + other.0 == 3 => 1.5,
        _ => one_tension(boundary),
    };
    let equilibrium = equilibrium_of(&cells, &tension).expect("relaxes");
    assert_eq!(equilibrium.reconnections, Reconnections::default());
    assert_eq!(equilibrium.balance.map(|balance| balance.flagged_lines), Some(1));
}

#[test]
fn any_number_of_threads_leads_to_the_same_equilibrium() {
    let cells = random_cells(&Domain::unit_square().with_periods(TORUS), 50, 5);
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads");
        pool.install(|| equilibrium_of(&cells, &one_tension).expect("relaxes").relaxed)
    };
    assert_eq!(with_threads(1), with_threads(2));
}
