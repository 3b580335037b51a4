//! Relaxation without constraints on volumes: grain growth by its laws.

use std::f64::consts::{FRAC_PI_3, PI};

use crate::common::{Labelled, ball, random_seeds};
use glam::{BVec3, DVec3};
use polycrystal::{
    BoundaryId, Elements, FaceMesh, GrainId, Junctions, Moving, Network, NetworkError, PlaneMeasures,
    Relaxation, Relaxed, Side, Surface, Volumes, measure_network, relax_watched,
};
use voronoi::{Domain, Tessellation};

/// Grains in the periodic square whose boundaries have many control points each, and these.
fn fine_network(count: usize, random_seed: u64) -> (Network, Vec<DVec3>) {
    let domain = Domain::unit_square().with_periods(BVec3::TRUE);
    let tessellation =
        Tessellation::new(&domain, &random_seeds(&domain, count, random_seed)).expect("valid seeds");
    // Even grains: none has a side so short that it vanishes within the test.
    let tessellation = (0..20).fold(tessellation, |cells, _| {
        Tessellation::new(&domain, &cells.centroids()).expect("centroids lie in their cells")
    });
    let edge_length = 0.02 / (count as f64).sqrt();
    Network::with_face_mesh(&tessellation, FaceMesh::Refined { edge_length }, Junctions::Crease, 0)
        .expect("a small network")
}

fn flow(network: &Network, points: &[DVec3], time: f64) -> Result<Relaxed, NetworkError> {
    relax_watched(network, points, &Relaxation::Time(time), Volumes::Free, |_| ())
}

fn measures(network: &Network, points: &[DVec3]) -> PlaneMeasures {
    measure_network(network, points).in_plane().expect("lines")
}

/// Von Neumann 1952, Mullins 1956: a grain of n sides grows by (pi / 3) (n - 6), wherever its boundaries are.
///
/// Junctions whose segments are not equally long once had a wrong share in it: 3.4 per cent of the rate with seed 5.
#[test]
fn grains_in_the_plane_grow_by_the_law_of_von_neumann_and_mullins() {
    let mut sides = Vec::new();
    for random_seed in [2, 5] {
        let (network, flat) = fine_network(30, random_seed);
        // Angles come to equilibrium long before areas change much. Shorter and shorter steps, for triple points are to
        // move by less than an edge in each.
        let times = [0.1, 1e-3, 1e-4];
        let start = times
            .into_iter()
            .fold(flat, |points, time| flow(&network, &points, time).expect("no side vanishes").points);
        let time = 2e-5;
        let end = flow(&network, &start, time).expect("no side vanishes").points;
        let whole_time = time * network.mean_grain_size().powi(2);
        let [before, after] = [&start, &end].map(|points| measures(&network, points));
        assert!(before.dihedral_angles.expect("triple points").standard_deviation < 0.5);
        for (before, after) in before.grains.iter().zip(&after.grains) {
            let rate = (after.area - before.area) / whole_time;
            let law = FRAC_PI_3 * (before.side_count as f64 - 6.0);
            // Half a per cent, of grains with six sides half a per cent of what one side makes.
            let tolerance = 0.005 * law.abs().max(FRAC_PI_3);
            assert!((rate - law).abs() < tolerance, "{} sides: {rate}, not {law}", before.side_count);
            assert!((before.growth_rate.expect("no walls") - law).abs() < 1e-12);
            // What the boundaries' own curvature says lacks half an edge at each end.
            assert!((before.curvature_rate - law).abs() < 0.13 * law.abs().max(FRAC_PI_3));
            sides.push(before.side_count);
        }
    }
    sides.sort_unstable();
    sides.dedup();
    assert!(sides.len() >= 3, "grains of {sides:?} sides");
}

/// As the program does it. The time once passed on level 0 and once more on level 1, and stiffness along triple lines held junctions up
/// by a tenth of their way.
#[test]
fn grains_grow_for_the_time_that_is_asked_for() {
    let domain = Domain::unit_square().with_periods(BVec3::TRUE);
    let tessellation = Tessellation::new(&domain, &random_seeds(&domain, 60, 2)).expect("valid seeds");
    let tessellation = (0..20).fold(tessellation, |cells, _| {
        Tessellation::new(&domain, &cells.centroids()).expect("centroids lie in their cells")
    });
    let (network, flat) = Network::new(&tessellation, Junctions::Crease, 3).expect("a small network");
    let [before, after] = [0.1, 0.102].map(|time| {
        let points = flow(&network, &flat, time).expect("no side vanishes").finest_points(&network);
        measures(&network, &points).grains
    });
    let whole_time = 0.002 * network.mean_grain_size().powi(2);
    for (before, after) in before.iter().zip(&after) {
        let rate = (after.area - before.area) / whole_time;
        let law = FRAC_PI_3 * (before.side_count as f64 - 6.0);
        let tolerance = 0.02 * law.abs().max(FRAC_PI_3);
        assert!((rate - law).abs() < tolerance, "{} sides: {rate}, not {law}", before.side_count);
    }
}

/// Grains cannot vanish: the network was once called invalid for what rounding left of one.
#[test]
fn a_grain_that_shrinks_to_nothing_is_named() {
    let domain = Domain::unit_square().with_periods(BVec3::TRUE);
    let tessellation = Tessellation::new(&domain, &random_seeds(&domain, 60, 3)).expect("valid seeds");
    let (network, flat) = Network::new(&tessellation, Junctions::Crease, 1).expect("a small network");
    // Some have three sides or four.
    let relaxed = flow(&network, &flat, 1.0).map(|relaxed| relaxed.steps);
    let Err(NetworkError::GrainVanished { time, .. }) = relaxed else { panic!("{relaxed:?}") };
    assert!(time > 0.1 && time < 0.9, "{time}");
    assert!(flow(&network, &flat, 0.5 * time).is_ok(), "{time}");
}

/// The square of the radius of a ball falls by 4 a time, of a disc by 2, at any resolution. Ten steps, whatever the time, were off by 11 % of
/// the rate at a time of 0.03.
#[test]
fn balls_and_discs_shrink_by_their_curvature_until_nothing_is_left() {
    let radius = 0.45;
    for resolution in 2..=4 {
        let (points, triangles) = ball(radius, DVec3::splat(0.5), resolution);
        let (network, start) = Labelled::inclusion(&points, &triangles).network(1).expect("a ball");
        check_shrinking(&network, &start, 4.0, |volume| (0.75 * volume / PI).powf(2.0 / 3.0), resolution);
        let (network, start) = discs(&[0.5], radius, 20 << resolution, 1);
        check_shrinking(&network, &start, 2.0, |area| area / PI, resolution);
    }
}

/// Checks the rate at which the square of the radius of grain 1 falls, until a hundredth of the volume (in the plane: area) is left.
fn check_shrinking(
    network: &Network,
    start: &[DVec3],
    rate: f64,
    square: impl Fn(f64) -> f64,
    resolution: usize,
) {
    let unit = network.mean_grain_size().powi(2);
    let left = square(0.01 * network.cell_volumes()[1]) / square(network.cell_volumes()[1]);
    let mut first = None;
    let mut steps = 0;
    let watch = |step: polycrystal::RelaxationStep<'_>| {
        let Moving::Points { level, points } = step.now else { panic!("cells do not change") };
        let now = square(network.grain_volumes(&network.levels()[level], points)[1]);
        let before = *first.get_or_insert(now);
        if step.done > 0 {
            let found = (before - now) / (step.time * unit);
            assert!((found / rate - 1.0).abs() < 0.01, "{found} at {now}, resolution {resolution}");
            steps = step.done;
        }
    };
    // The polygons' own squares are a little less than those of the ball.
    let time = (1.0 - left) * square(network.cell_volumes()[1]) / rate / unit;
    let end = relax_watched(network, start, &Relaxation::Time(time), Volumes::Free, watch).expect("is left");
    let volume = network.grain_volumes(&network.levels()[end.level], &end.points)[1];
    assert!((volume / network.cell_volumes()[1] - 0.01).abs() < 0.005, "{volume}");
    assert!(steps > 10 && steps < 100, "{steps} steps");
}

/// Discs of so many segments in the unit square, as grains from 1; their centres have these first coordinates.
fn discs(centers: &[f64], radius: f64, count: u32, levels: usize) -> (Network, Vec<DVec3>) {
    let mut points = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
    let mut segments = vec![[0, 1], [1, 2], [2, 3], [3, 0]];
    let mut boundary_of = vec![BoundaryId(0); 4];
    let host = Side::Grain(GrainId(0));
    let mut sides = vec![[host, Side::Exterior]];
    for (disc, x) in (1..).zip(centers) {
        let first = u32::try_from(points.len()).expect("few points");
        let place = |k: u32| {
            let angle = 2.0 * PI * f64::from(k) / f64::from(count);
            DVec3::new(x + radius * angle.cos(), 0.5 + radius * angle.sin(), 0.0)
        };
        points.extend((0..count).map(place));
        segments.extend((0..count).map(|k| [first + k, first + (k + 1) % count]));
        boundary_of.resize(segments.len(), BoundaryId(disc));
        sides.push([Side::Grain(GrainId(disc)), host]);
    }
    let elements = Elements::Segments(&segments);
    let surface = Surface { points: &points, elements, boundary_of: &boundary_of, sides: &sides };
    Network::of_surface(&Domain::unit_square(), &surface, Junctions::Crease, levels)
        .expect("discs in a square")
}

/// MacPherson and Srolovitz 2007: the growth of a grain by its mean width and the length of its triple lines.
#[test]
fn grains_in_space_grow_by_the_law_of_macpherson_and_srolovitz() {
    let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
    let seeds = random_seeds(&domain, 12, 3);
    let tessellation = Tessellation::new(&domain, &seeds).expect("valid seeds");
    let tessellation = (0..20).fold(tessellation, |cells, _| {
        Tessellation::new(&domain, &cells.centroids()).expect("centroids lie in their cells")
    });
    let edge_length = 0.15 / 12f64.cbrt();
    let (network, flat) =
        Network::with_face_mesh(&tessellation, FaceMesh::Refined { edge_length }, Junctions::Crease, 0)
            .expect("a small network");
    let times = [0.05].into_iter().chain([1e-3; 4]).chain([1e-4; 2]);
    let start =
        times.fold(flat, |points, time| flow(&network, &points, time).expect("no face vanishes").points);
    let time = 1e-4;
    let end = flow(&network, &start, time).expect("no face vanishes").points;
    let whole_time = time * network.mean_grain_size().powi(2);
    let in_space = |points: &[DVec3]| measure_network(&network, points).in_space().expect("surfaces");
    let [before, after] = [&start, &end].map(|points| in_space(points));
    for (before, after) in before.grains.iter().zip(&after.grains) {
        let rate = (after.volume - before.volume) / whole_time;
        let law = before.growth_rate.expect("no walls");
        // The law is a small difference of two large terms, of which this is one.
        let term = 4.0 * PI * before.mean_width;
        assert!((rate - law).abs() < 0.005 * term, "{rate}, not {law}");
    }
}

#[test]
fn a_honeycomb_stays_as_it_is() {
    let height = 3f64.sqrt();
    let domain = Domain::rectangle(DVec3::ZERO, DVec3::new(2.0, 2.0 * height, 1.0)).expect("positive sides");
    let domain = domain.with_periods(BVec3::TRUE);
    let seeds: Vec<DVec3> = (0..8)
        .map(|k| {
            DVec3::new(
                f64::from(k % 2) + 0.5 * f64::from(k / 2 % 2) + 0.2,
                f64::from(k / 2) * height / 2.0 + 0.1,
                0.0,
            )
        })
        .collect();
    let tessellation = Tessellation::new(&domain, &seeds).expect("valid seeds");
    let (network, flat) = Network::new(&tessellation, Junctions::Crease, 2).expect("a small network");
    let relaxed = flow(&network, &flat, 0.1).expect("nothing moves").finest_points(&network);
    let straight = network.subdivide(&flat);
    assert!(relaxed.iter().zip(&straight).all(|(a, b)| a.distance(*b) < 1e-9));
}

#[test]
fn kept_volumes_are_the_default_and_free_ones_change() {
    let (network, flat) = crate::common::random_network(&Domain::unit_cube(), 12, 7, 1);
    let relaxation = Relaxation::Time(0.02);
    let errors = [Volumes::Kept, Volumes::Free].map(|volumes| {
        let mut times = Vec::new();
        let relaxed = relax_watched(&network, &flat, &relaxation, volumes, |step| {
            let Moving::Points { level, points } = step.now else { panic!("the topology stays") };
            assert_eq!(points.len(), network.levels()[level].vertex_count());
            times.push(step.time);
        })
        .expect("relaxes");
        assert!(
            times[0] == 0.0 && times.is_sorted() && (times[times.len() - 1] - relaxed.time).abs() < 1e-12
        );
        let found = network.grain_volumes(network.finest(), &relaxed.finest_points(&network));
        let errors = found.iter().zip(network.cell_volumes()).map(|(grain, cell)| (grain / cell - 1.0).abs());
        errors.fold(0.0, f64::max)
    });
    assert!(errors[0] < 1e-10 && errors[1] > 1e-3, "{errors:?}");
}

/// A disc loses an area of 2 pi times mobility times tension per time, the mean mobility being the unit of time.
#[test]
fn a_boundary_of_three_times_the_mobility_moves_three_times_as_fast() {
    let (network, flat) = discs(&[0.25, 0.75], 0.2, 200, 0);
    let fast = Side::Grain(GrainId(2));
    for unit in [1.0, 1e-6] {
        let mobility = |sides: [Side; 2]| unit * if sides.contains(&fast) { 3.0 } else { 1.0 };
        let network =
            network.clone().with_mobilities(|boundary| mobility(boundary.sides)).expect("all positive");
        let time = 0.02;
        let end = flow(&network, &flat, time).expect("discs are left").points;
        let whole_time = time * network.mean_grain_size().powi(2);
        let [before, after] = [&flat, &end].map(|points| measures(&network, points).grains);
        for (grain, share) in [(1, 0.5), (2, 1.5)] {
            let rate = (after[grain].area - before[grain].area) / whole_time;
            assert!((rate / (-2.0 * PI * share) - 1.0).abs() < 0.005, "{rate} of disc {grain}");
        }
    }
    let refused = network.with_mobilities(|_| 0.0);
    assert!(matches!(refused, Err(NetworkError::BadMobility { .. })));
}
