//! Remeshed networks in the plane: the same lines and areas, and triangles of the size asked for between them.

use std::collections::BTreeMap;

use crate::common::random_seeds;
use glam::{BVec3, DVec3};
use polycrystal::{
    BoxCut, ElementSize, Elements, FaceMesh, GrainId, Junctions, Network, NetworkRecipe, PlaneMesh,
    Relaxation, Remeshed, Side, relax_cells,
};
use voronoi::{Domain, Tessellation};

/// Number of grains.
const GRAINS: usize = 60;

/// Grains at equilibrium, or as flat cells.
fn grains(domain: &Domain, seed: u64, relaxation: &Relaxation) -> (Network, Vec<DVec3>) {
    let seeds: Vec<DVec3> = random_seeds(domain, GRAINS, seed).iter().map(|seed| seed.with_z(0.0)).collect();
    let cells = Tessellation::new(domain, &seeds).expect("cells");
    if *relaxation == Relaxation::Time(0.0) {
        let (network, flat) = Network::new(&cells, Junctions::Crease, 1).expect("a network");
        let points = network.subdivide(&flat);
        return (network, points);
    }
    let recipe = NetworkRecipe {
        face_mesh: FaceMesh::Fan,
        junctions: Junctions::Crease,
        levels: 1,
        tension: &|boundary| if boundary.wall.is_none() { 1.0 } else { 0.0 },
    };
    let relaxed = relax_cells(&cells, &recipe, relaxation, |_| ()).expect("equilibrium");
    (relaxed.network, relaxed.points)
}

fn size(network: &Network, per_diameter: f64) -> ElementSize {
    let area = network.domain().measure() / network.grain_count() as f64;
    ElementSize::new(2.0 * (area / std::f64::consts::PI).sqrt() / per_diameter)
}

/// The least angle in degrees, and the shape, twice the radius of the circle within by that around: 1 of a regular triangle.
fn least_angle_and_shape([a, b, c]: [DVec3; 3]) -> (f64, f64) {
    let angle = |at: DVec3, one: DVec3, other: DVec3| (one - at).angle_between(other - at);
    let angles = [angle(a, b, c), angle(b, c, a), angle(c, a, b)];
    let shape = 8.0 * angles.iter().map(|angle| (0.5 * angle).sin()).product::<f64>();
    (angles.into_iter().fold(f64::INFINITY, f64::min).to_degrees(), shape)
}

/// Everything that holds of every mesh: it fills the grains, and its edges between grains are the segments of the network.
fn check(network: &Network, size: &ElementSize, remeshed: &Remeshed) {
    let Remeshed { network: new, points, certificate, triangles, .. } = remeshed;
    let mesh = triangles.as_ref().expect("triangles");
    assert_eq!((&mesh.points[..mesh.line_points], new.boundaries()), (&points[..], network.boundaries()));
    assert!(certificate.largest_volume_error < 1e-9);
    let mut areas = vec![0.0; network.grain_count()];
    let mut across: BTreeMap<[u32; 2], GrainId> = BTreeMap::new();
    for (triangle, (corners, grain)) in mesh.triangles.iter().zip(&mesh.grains).enumerate() {
        let [a, b, c] = mesh.corners(triangle);
        let area = 0.5 * (b - a).cross(c - a).z;
        assert!(area > 0.0);
        areas[grain.index()] += area;
        for k in 0..3 {
            let edge = [corners[k], corners[(k + 1) % 3]];
            assert!(across.insert(edge, *grain).is_none(), "two triangles on one side of an edge");
        }
    }
    for (area, wanted) in areas.iter().zip(network.cell_volumes()) {
        assert!((area / wanted - 1.0).abs() < 1e-9);
    }
    let level = new.finest_level();
    let Elements::Segments(segments) = Elements::from(&level.mesh) else { panic!("lines in the plane") };
    let mut sides: BTreeMap<[u32; 2], Side> = BTreeMap::new();
    for ([from, to], boundary) in segments.iter().zip(&level.boundary_of) {
        let [left, right] = new.boundaries()[boundary.index()].sides;
        sides.extend([([*from, *to], left), ([*to, *from], right)]);
    }
    for (edge, grain) in &across {
        let beyond = across.get(&[edge[1], edge[0]]);
        if beyond != Some(grain) {
            assert_eq!(sides.get(edge), Some(&Side::Grain(*grain)), "a boundary where the network has none");
        }
    }
    let grain_sides = sides.values().filter(|side| side.grain().is_some()).count();
    let of_network = across.keys().filter(|edge| sides.contains_key(*edge)).count();
    assert_eq!(of_network, grain_sides, "every segment is an edge of triangles");
    let longest = across.keys().map(|[a, b]| mesh.points[*a as usize].distance(mesh.points[*b as usize]));
    assert!(longest.fold(0.0, f64::max) < 2.0 * size.length);
}

/// The least angle, how many triangles are below 25 degrees, and the mean shape.
fn quality(mesh: &PlaneMesh) -> (f64, usize, f64) {
    let all: Vec<(f64, f64)> =
        (0..mesh.triangles.len()).map(|triangle| least_angle_and_shape(mesh.corners(triangle))).collect();
    let least = all.iter().map(|(angle, _)| *angle).fold(f64::INFINITY, f64::min);
    let narrow = all.iter().filter(|(angle, _)| *angle < 25.0).count();
    (least, narrow, all.iter().map(|(_, shape)| shape).sum::<f64>() / all.len() as f64)
}

#[test]
fn grains_at_equilibrium_have_no_narrow_triangles() {
    for (periods, per_diameter) in [(BVec3::FALSE, 5.0), (BVec3::new(true, true, false), 10.0)] {
        let domain = Domain::unit_square().with_periods(periods);
        let (network, points) = grains(&domain, 3, &Relaxation::Equilibrium);
        let size = size(&network, per_diameter);
        let remeshed = network.remeshed(&points, &size, BVec3::FALSE).expect("remeshed");
        check(&network, &size, &remeshed);
        let (least, narrow, shape) = quality(remeshed.triangles.as_ref().expect("triangles"));
        assert!(least > 25.0 && narrow == 0 && shape > 0.95, "{least} {narrow} {shape}");
        for pair in &remeshed.network.finest().held().copies.vertices {
            let [copy, original] =
                [pair.secondary, pair.primary].map(|point| remeshed.points[point as usize]);
            assert_eq!(copy, original + pair.translation.vector(&domain));
        }
        assert_eq!(periods.any(), !remeshed.network.finest().held().copies.vertices.is_empty());
    }
}

/// Flat cells have corners that are narrower, and lines that are short.
#[test]
fn flat_cells_and_grains_cut_at_a_box_are_filled() {
    let (network, points) = grains(&Domain::unit_square(), 1, &Relaxation::Time(0.0));
    let remeshed = network.remeshed(&points, &size(&network, 5.0), BVec3::FALSE).expect("remeshed");
    check(&network, &size(&network, 5.0), &remeshed);
    let (least, narrow, shape) = quality(remeshed.triangles.as_ref().expect("triangles"));
    assert!(least > 15.0 && narrow < 10 && shape > 0.93, "{least} {narrow} {shape}");

    let periods = BVec3::new(true, true, false);
    let domain = Domain::unit_square().with_periods(periods);
    let (network, points) = grains(&domain, 1, &Relaxation::Equilibrium);
    let volumes = network.cell_volumes().to_vec();
    let BoxCut { network, points, .. } = network.cut_at_box(&points, false).expect("cut");
    let network = network.with_cell_volumes(volumes);
    let remeshed = network.remeshed(&points, &size(&network, 5.0), periods).expect("remeshed");
    check(&network, &size(&network, 5.0), &remeshed);
    let pairs =
        remeshed.network.periodic_vertices(&remeshed.points, periods).expect("opposite sides are alike");
    assert!(pairs.len() > 20);
}

#[test]
fn elements_are_smaller_where_boundaries_are_curved() {
    let (network, points) = grains(&Domain::unit_square(), 2, &Relaxation::Equilibrium);
    let count = |of_radius: Option<f64>| {
        let size = ElementSize { of_radius, ..size(&network, 3.0) };
        let remeshed = network.remeshed(&points, &size, BVec3::FALSE).expect("remeshed");
        remeshed.network.finest().element_count()
    };
    assert!(count(Some(0.1)) as f64 > 1.2 * count(None) as f64);
}

/// A line in the plane is a boundary, which goes with it.
#[test]
fn short_lines_become_points_where_four_grains_meet() {
    for domain in [Domain::unit_square(), Domain::unit_square().with_periods(BVec3::new(true, true, false))] {
        let (network, points) = grains(&domain, 1, &Relaxation::Equilibrium);
        let keeping = size(&network, 3.0);
        let merging = ElementSize { merges_short_lines: true, ..keeping };
        let remeshed = network.remeshed(&points, &merging, BVec3::FALSE).expect("remeshed");
        let merged = &remeshed.merged;
        assert!(!merged.is_empty());
        assert!(remeshed.certificate.largest_volume_error < 1e-9);
        let gone = network.boundaries().len() - remeshed.network.boundaries().len();
        assert!((merged.len()..=2 * merged.len()).contains(&gone), "{gone}");
        let four = &remeshed.network.junction_counts().points_by_sides[&4];
        assert_eq!(*four, merged.len());
        assert!(merged.iter().all(|line| line.length < 0.5 * merging.length));
        assert_eq!(
            network.junction_counts().triple_lines - merged.len(),
            remeshed.network.junction_counts().triple_lines
        );
        let kept = network.remeshed(&points, &keeping, BVec3::FALSE).expect("remeshed");
        let count = |remeshed: &Remeshed| remeshed.triangles.as_ref().map_or(0, |mesh| mesh.triangles.len());
        assert!(count(&remeshed) < count(&kept));
    }
}

/// The root mean square of distances from the segments of a network, and the largest distance.
fn distances(network: &Network, points: &[DVec3], places: &[DVec3]) -> (f64, f64) {
    let level = network.finest_level();
    let Elements::Segments(segments) = Elements::from(&level.mesh) else { panic!("lines in the plane") };
    let distance = |place: &DVec3| {
        let to_segment = |ends: &[u32; 2]| {
            let [from, to] = ends.map(|end| points[end as usize]);
            let share = ((place - from).dot(to - from) / from.distance_squared(to)).clamp(0.0, 1.0);
            from.lerp(to, share).distance(*place)
        };
        segments.iter().map(to_segment).fold(f64::INFINITY, f64::min)
    };
    let squares: Vec<f64> = places.iter().map(|place| distance(place).powi(2)).collect();
    let largest = squares.iter().fold(0.0f64, |largest, square| largest.max(*square));
    ((squares.iter().sum::<f64>() / squares.len() as f64).sqrt(), largest.sqrt())
}

#[test]
fn curved_lines_lie_on_the_smooth_ones_and_keep_areas() {
    for periods in [BVec3::FALSE, BVec3::new(true, true, false)] {
        let domain = Domain::unit_square().with_periods(periods);
        let (network, points) = grains(&domain, 3, &Relaxation::Equilibrium);
        let size = ElementSize { has_middles: true, ..size(&network, 5.0) };
        let remeshed = network.remeshed(&points, &size, BVec3::FALSE).expect("remeshed");
        let new = &remeshed.network;
        let mut curved = remeshed.curved.expect("curved boundaries");
        assert!(curved.restore_volumes(new) < 1e-12);
        let level = new.finest_level();
        let Elements::Segments(segments) = Elements::from(&level.mesh) else { panic!("lines in the plane") };
        let chords: Vec<DVec3> = segments
            .iter()
            .map(|ends| ends.map(|end| curved.corners()[end as usize]))
            .map(|[from, to]| from.midpoint(to))
            .collect();
        let (chords, _) = distances(&network, &points, &chords);
        let (corners, _) = distances(&network, &points, curved.corners());
        let (middles, largest) = distances(&network, &points, curved.middles());
        assert!(corners < 0.05 * chords, "{corners} of {chords}");
        assert!(middles < 0.05 * chords && largest < 0.01 * size.length, "{middles} {largest} of {chords}");
        let (beside, _) = distances(&network, &points, &remeshed.points);
        assert!(beside > 0.2 * chords, "corners of straight edges keep areas beside the smooth lines");
    }
}
