//! A catenoid: the boundary of a pillar between two walls that pull its rims outward.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use polycrystal::{
    Boundary, BoundaryId, Elements, GrainId, Junctions, Network, Relaxation, Side, Surface, herring_residual,
    measure_network, relax, validate,
};
use voronoi::Domain;

/// Distance of the walls, and radius of the catenoid where it is narrowest.
const HEIGHT: f64 = 0.3;
const NECK: f64 = 0.2;

fn domain() -> Domain {
    Domain::cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, HEIGHT)).expect("a plate")
}

/// A straight pillar, grain 1, in grain 0, which fills the rest of the domain; with so many points around, a multiple of 8 so that some are at
/// the corners of the domain.
fn pillar(radius: f64, around: u32) -> (Network, Vec<DVec3>) {
    let layers = around / 4;
    let angle = |k: u32| TAU * f64::from(k) / f64::from(around);
    let on_circle =
        |k: u32, z: f64| DVec3::new(0.5 + radius * angle(k).cos(), 0.5 + radius * angle(k).sin(), z);
    let on_square = |k: u32, z: f64| {
        let (sine, cosine) = angle(k).sin_cos();
        let away = sine.abs().max(cosine.abs());
        // The larger one is exactly 0 or 1.
        let coordinate = |along: f64| {
            let share = along / away;
            if share.abs() > 1.0 - 1e-12 { 0.5 + 0.5 * share.signum() } else { 0.5 + 0.5 * share }
        };
        DVec3::new(coordinate(cosine), coordinate(sine), z)
    };
    let mut points = Vec::new();
    for layer in 0..=layers {
        let z = if layer == layers { HEIGHT } else { HEIGHT * f64::from(layer) / f64::from(layers) };
        points.extend((0..around).map(|k| on_circle(k, z)));
    }
    let first_outer = around * (layers + 1);
    points.extend((0..around).map(|k| on_square(k, 0.0)));
    points.extend((0..around).map(|k| on_square(k, HEIGHT)));
    let centers = first_outer + 2 * around;
    points.extend([DVec3::new(0.5, 0.5, 0.0), DVec3::new(0.5, 0.5, HEIGHT)]);
    let [outside, pillar] = [0, 1].map(|grain| Side::Grain(GrainId(grain)));
    let sides = [[pillar, outside], [pillar, Side::Exterior], [outside, Side::Exterior]];
    let (mut triangles, mut boundary_of) = (Vec::new(), Vec::new());
    let mut add = |boundary: u32, corners: [u32; 3]| {
        triangles.push(corners);
        boundary_of.push(BoundaryId(boundary));
    };
    for k in 0..around {
        let next = (k + 1) % around;
        for layer in 0..layers {
            let [low, high] = [layer * around, (layer + 1) * around];
            add(0, [low + k, low + next, high + next]);
            add(0, [low + k, high + next, high + k]);
        }
        let [inner, outer] = [[0, layers * around], [first_outer, first_outer + around]];
        add(1, [centers, inner[0] + next, inner[0] + k]);
        add(1, [centers + 1, inner[1] + k, inner[1] + next]);
        add(2, [inner[0] + k, inner[0] + next, outer[0] + next]);
        add(2, [inner[0] + k, outer[0] + next, outer[0] + k]);
        add(2, [inner[1] + k, outer[1] + next, inner[1] + next]);
        add(2, [inner[1] + k, outer[1] + k, outer[1] + next]);
        add(2, [outer[0] + k, outer[0] + next, outer[1] + next]);
        add(2, [outer[0] + k, outer[1] + next, outer[1] + k]);
    }
    let elements = Elements::Triangles(&triangles);
    let surface = Surface { points: &points, elements, boundary_of: &boundary_of, sides: &sides };
    Network::of_surface(&domain(), &surface, Junctions::Crease, 2).expect("a network")
}

/// Walls pull with what makes the angle at the rim that of a catenoid (Young 1805), and the pillar has its volume: then no pressure is left.
#[test]
fn a_pillar_between_walls_that_pull_is_a_catenoid() {
    // The radius is NECK cosh(z / NECK), z from the middle.
    let squares = HEIGHT / 2.0 + NECK / 2.0 * (HEIGHT / NECK).sinh();
    let [volume, area] = [PI * NECK.powi(2) * squares, TAU * NECK * squares];
    let pull = (HEIGHT / 2.0 / NECK).tanh();
    let domain = domain();
    let law = |boundary: &Boundary| match boundary.wall {
        None => 1.0,
        Some(wall) => {
            let is_plate = domain.across_axis(wall).is_some_and(|(axis, _)| axis == 2);
            if is_plate && boundary.sides[0] == Side::Grain(GrainId(0)) { pull } else { 0.0 }
        }
    };
    let curvature = |around: u32| {
        let (network, start) = pillar((volume / PI / HEIGHT).sqrt(), around);
        let network = network.with_cell_volumes(vec![HEIGHT - volume, volume]);
        let network = network.with_tensions(law).expect("good tensions");
        let relaxed = relax(&network, &start, &Relaxation::Equilibrium, |_, _| ()).expect("relaxes");
        let points = relaxed.finest_points(&network);
        validate(&network, &points).expect("valid");
        let measures = measure_network(&network, &points).in_space().expect("space");
        let own = measures.boundaries.iter().find(|boundary| !boundary.sides.contains(&Side::Exterior));
        let own = own.expect("between the grains");
        assert!((own.area / area - 1.0).abs() < 1e-3, "{} not {area}", own.area);
        let inside = points.iter().filter(|point| point.z > 0.0 && point.z < HEIGHT);
        let radii = inside.map(|point| point.truncate().distance(DVec2::splat(0.5)));
        let narrowest = radii.fold(f64::INFINITY, f64::min);
        assert!((narrowest / NECK - 1.0).abs() < 5e-3, "{narrowest}");
        let residual = herring_residual(&network, &points).expect("rims");
        assert!(residual.rms < 0.03, "{residual:?}");
        own.mean_curvature.abs()
    };
    // In units of a cylinder's. The angle at the rim is that of flat triangles, so that what is left falls with their length.
    let [coarse, fine] = [16, 32].map(|around| curvature(around) * 2.0 * NECK);
    assert!(fine < 0.6 * coarse && fine < 0.03, "{coarse} {fine}");
}
