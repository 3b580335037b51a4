//! Measures of bodies whose exact values are known.

#[allow(dead_code, reason = "every test file uses its own share")]
mod common;

use std::f64::consts::PI;

use common::{network, random_network};
use glam::{DMat3, DVec3};
use polycrystal::{BoundaryId, Elements, GrainId, Side, Surface, measure};
use voronoi::Domain;

fn close(found: f64, exact: f64, tolerance: f64) {
    assert!((found / exact - 1.0).abs() < tolerance, "{found} is not {exact}");
}

/// An icosahedron whose triangles are cut into four so often, pushed out to a sphere.
fn ball(radius: f64, center: DVec3, levels: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points: Vec<DVec3> = Vec::new();
    for [a, b] in [[1.0, golden], [1.0, -golden], [-1.0, golden], [-1.0, -golden]] {
        points.extend([DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]);
    }
    let mut triangles = Vec::new();
    for a in 0..12u32 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let corners = [a, b, c].map(|id| points[id as usize]);
                let is_edge = |i: usize, j: usize| (corners[i].distance(corners[j]) - 2.0).abs() < 1e-9;
                if is_edge(0, 1) && is_edge(1, 2) && is_edge(2, 0) {
                    let outward =
                        (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(corners[0]) > 0.0;
                    triangles.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    assert_eq!(triangles.len(), 20);
    for _ in 0..levels {
        let mesh = subzero::TriangleMesh::new(points.len(), triangles, &subzero::Features::default());
        let refined = mesh.expect("a sphere").midpoint_refine();
        points = refined.stencils.apply(&points);
        triangles = refined.mesh.triangles().to_vec();
    }
    (points.iter().map(|point| center + radius * point.normalize()).collect(), triangles)
}

#[test]
fn a_ball_has_its_mean_width_and_shrinks_by_the_law() {
    let radius = 0.7;
    let center = DVec3::new(3.0, -1.0, 2.0);
    let (points, triangles) = ball(radius, center, 4);
    let boundary_of = vec![BoundaryId(0); triangles.len()];
    let sides = [[Side::Grain(GrainId(4)), Side::Grain(GrainId(9))]];
    let elements = Elements::Triangles(&triangles);
    let measures = measure(&Surface { points: &points, elements, boundary_of: &boundary_of, sides: &sides });
    let [ball, around] = &measures.grains[..] else { panic!("two grains") };
    assert_eq!((ball.grain, ball.face_count, &ball.neighbors[..]), (GrainId(4), 1, &[GrainId(9)][..]));
    close(ball.volume, 4.0 / 3.0 * PI * radius.powi(3), 0.01);
    close(ball.area, 4.0 * PI * radius.powi(2), 0.01);
    close(ball.sphericity, 1.0, 0.01);
    close(ball.equivalent_diameter, 2.0 * radius, 0.01);
    close(ball.mean_width, 2.0 * radius, 0.01);
    close(ball.integral_mean_curvature, 4.0 * PI * radius, 0.01);
    close(ball.growth_rate.expect("no exterior"), -8.0 * PI * radius, 0.01);
    assert!(ball.centroid.distance(center) < 1e-12);
    let moment = 0.4 * ball.volume * radius.powi(2);
    assert!(
        (ball.inertia - DMat3::from_diagonal(DVec3::splat(moment))).abs_diff_eq(DMat3::ZERO, 0.02 * moment)
    );
    close(measures.boundaries[0].mean_curvature, 1.0 / radius, 0.01);
    // What lies around grows by as much.
    close(around.growth_rate.expect("no exterior"), 8.0 * PI * radius, 0.01);
}

#[test]
fn a_box_has_half_the_sum_of_its_sides_as_mean_width() {
    let [a, b, c] = [1.0, 2.0, 0.5];
    let domain = Domain::cuboid(DVec3::ZERO, DVec3::new(a, b, c)).expect("positive sides");
    let (network, flat) = network(&domain, &[DVec3::splat(0.3)], 1);
    let (points, sides) = (network.subdivide(&flat), network.sides());
    let measures = measure(&Surface::of_level(network.finest(), &points, &sides));
    let [grain] = &measures.grains[..] else { panic!("one grain") };
    close(grain.mean_width, (a + b + c) / 2.0, 1e-12);
    close(grain.volume, a * b * c, 1e-12);
    close(grain.area, 2.0 * (a * b + b * c + c * a), 1e-12);
    assert!(grain.centroid.distance(DVec3::new(a, b, c) / 2.0) < 1e-12);
    let inertia = DVec3::new(b * b + c * c, a * a + c * c, a * a + b * b) * (a * b * c / 12.0);
    assert!(grain.inertia.abs_diff_eq(DMat3::from_diagonal(inertia), 1e-12));
    assert_eq!((grain.face_count, grain.growth_rate), (6, None));
    assert!(measures.boundaries.iter().all(|boundary| boundary.mean_curvature.abs() < 1e-12));
}

/// Eight quarters of a cube meet in lines of four: the cube in the middle of 27 is a grain of its own.
#[test]
fn a_cube_among_cubes_has_twelve_lines() {
    let centre = |i: u32| (f64::from(i) + 0.5) / 3.0;
    let seeds: Vec<DVec3> =
        (0..27).map(|i| DVec3::new(centre(i % 3), centre(i / 3 % 3), centre(i / 9))).collect();
    let (network, flat) = network(&Domain::unit_cube(), &seeds, 0);
    let sides = network.sides();
    let measures = measure(&Surface::of_level(network.finest(), &flat, &sides));
    let middle = &measures.grains[13];
    close(middle.mean_width, 0.5, 1e-9);
    close(middle.triple_line_length, 4.0, 1e-9);
    assert_eq!(middle.neighbors.len(), 6);
    close(middle.growth_rate.expect("inside"), -2.0 * PI * (1.0 - 4.0 / 6.0), 1e-9);
    assert!(measures.grains.iter().filter(|grain| grain.growth_rate.is_some()).count() == 1);
}

#[test]
fn grains_of_a_network_fill_it() {
    let (network, flat) = random_network(&Domain::unit_cube(), 30, 8, 1);
    let (points, sides) = (network.subdivide(&flat), network.sides());
    let measures = measure(&Surface::of_level(network.finest(), &points, &sides));
    close(measures.grains.iter().map(|grain| grain.volume).sum(), 1.0, 1e-12);
    let moment: DVec3 = measures.grains.iter().map(|grain| grain.volume * grain.centroid).sum();
    assert!(moment.distance(DVec3::splat(0.5)) < 1e-12);
    // Both sides of a boundary know each other.
    for grain in &measures.grains {
        for other in &grain.neighbors {
            assert!(measures.grains[other.index()].neighbors.contains(&grain.grain));
        }
        // Among bodies of one volume the ball is the least wide.
        assert!(grain.mean_width > grain.equivalent_diameter && grain.sphericity < 1.0);
    }
}
