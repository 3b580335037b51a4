//! Curves against reference numbers.
#![allow(clippy::cast_possible_truncation)] // Curves of tests are short.

use crate::common::{assert_close, load};
use glam::DVec3;
use serde::Deserialize;
use subzero::{BezierCurve, BezierSurface, CurveMesh, teapot};

#[derive(Deserialize)]
struct LineReference {
    closed: bool,
    corners: Vec<u32>,
    vertices: Vec<DVec3>,
    levels: Vec<LineLevel>,
    limit: Vec<DVec3>,
    limit_tangent_half_difference: Vec<[Option<f64>; 3]>,
}

#[derive(Deserialize)]
struct LineLevel {
    vertices: Vec<DVec3>,
}

/// The vertices in the order in which the segments pass them.
fn in_order(mesh: &CurveMesh, closed: bool) -> Vec<u32> {
    let mut order: Vec<u32> = mesh.segments().iter().map(|segment| segment[0]).collect();
    order.extend(mesh.segments().last().filter(|_| !closed).map(|segment| segment[1]));
    order
}

#[test]
fn lines_match_their_reference() {
    for name in ["line_open", "line_closed", "line_open_corner"] {
        let reference: LineReference = load(name);
        let count = reference.vertices.len() as u32;
        let segments = (0..count - u32::from(!reference.closed)).map(|i| [i, (i + 1) % count]).collect();
        let mut mesh = CurveMesh::new(count as usize, segments, &reference.corners).unwrap();
        let mut points = reference.vertices.clone();

        let limits = mesh.limit_positions().apply(&points);
        let tangents = mesh.limit_tangents().apply(&points);
        for v in 0..count as usize {
            assert_close(limits[v], reference.limit[v], 1e-12, name);
            if let [Some(x), Some(y), Some(z)] = reference.limit_tangent_half_difference[v] {
                let before = (v + count as usize - 1) % count as usize;
                assert_close(tangents[2 * v], DVec3::new(x, y, z), 1e-12, name);
                assert_close(tangents[2 * before + 1], DVec3::new(x, y, z), 1e-12, name);
            }
        }
        if !reference.closed {
            assert_close(tangents[0], points[1] - points[0], 1e-12, name);
        }

        for level in &reference.levels {
            let refined = mesh.refine().unwrap();
            points = refined.stencils.apply(&points);
            mesh = refined.mesh;
            let order = in_order(&mesh, reference.closed);
            assert_eq!(order.len(), level.vertices.len());
            for (&v, &expected) in order.iter().zip(&level.vertices) {
                assert_close(points[v as usize], expected, 1e-12, name);
            }
        }
    }
}

#[derive(Deserialize)]
struct BezierReference {
    curves: Vec<BezierCurveReference>,
    surface: BezierSurfaceReference,
}

#[derive(Deserialize)]
struct BezierCurveReference {
    degree: usize,
    control: Vec<DVec3>,
    t: Vec<f64>,
    point: Vec<DVec3>,
    derivative: Vec<DVec3>,
    split_at: f64,
    left: Vec<DVec3>,
    right: Vec<DVec3>,
}

#[derive(Deserialize)]
struct BezierSurfaceReference {
    control: Vec<Vec<DVec3>>,
    uv: Vec<[f64; 2]>,
    point: Vec<DVec3>,
    du: Vec<DVec3>,
    dv: Vec<DVec3>,
}

#[test]
fn bezier_curves_match_bernstein() {
    for reference in load::<BezierReference>("bezier").curves {
        let curve = BezierCurve::new(reference.control).unwrap();
        assert_eq!(curve.degree(), reference.degree);
        for (i, &t) in reference.t.iter().enumerate() {
            assert_close(curve.point(t), reference.point[i], 1e-12, "point");
            assert_close(curve.derivative(t), reference.derivative[i], 1e-12, "derivative");
            let levels = curve.casteljau(t);
            assert_eq!(levels.len(), curve.degree() + 1);
            assert_close(levels[curve.degree()][0], reference.point[i], 1e-12, "last level");
        }
        for (half, expected) in
            curve.split(reference.split_at).iter().zip([&reference.left, &reference.right])
        {
            for (&ours, &theirs) in half.control().iter().zip(expected) {
                assert_close(ours, theirs, 1e-12, "split");
            }
        }
        let samples = curve.sample(8);
        assert_eq!(samples.len(), 9);
        assert_close(samples[4], curve.point(0.5), 1e-15, "sample");
    }
}

#[test]
fn bezier_surface_matches_bernstein() {
    let reference = load::<BezierReference>("bezier").surface;
    let surface = BezierSurface::new(reference.control).unwrap();
    for (i, &[u, v]) in reference.uv.iter().enumerate() {
        assert_close(surface.point(u, v), reference.point[i], 1e-12, "point");
        let [du, dv] = surface.derivatives(u, v);
        assert_close(du, reference.du[i], 1e-12, "du");
        assert_close(dv, reference.dv[i], 1e-12, "dv");
        let normal = surface.normal(u, v).unwrap();
        assert_close(normal, du.cross(dv).normalize(), 1e-12, "normal");
    }
    let (points, triangles) = surface.tessellate(3, 5).unwrap();
    assert_eq!((points.len(), triangles.len()), (24, 30));
    assert_close(points[8], surface.point(1.0 / 3.0, 0.4), 1e-15, "grid point");
    // A triangle's normal is near the surface's.
    let [a, b, c] = triangles[0].map(|v| points[v as usize]);
    assert!((b - a).cross(c - a).dot(surface.normal(0.1, 0.1).unwrap()) > 0.0);
}

#[test]
fn the_teapot_looks_outward() {
    let patches = teapot();
    assert_eq!(patches.len(), 32);
    let mut heights = (f64::INFINITY, f64::NEG_INFINITY);
    let mut volume = 0.0;
    for patch in &patches {
        let (points, triangles) = patch.tessellate(8, 8).unwrap();
        for point in &points {
            heights = (heights.0.min(point.z), heights.1.max(point.z));
        }
        for triangle in triangles {
            let [a, b, c] = triangle.map(|v| points[v as usize]);
            volume += a.dot(b.cross(c)) / 6.0;
        }
    }
    assert!(heights.0 == 0.0 && (heights.1 - 3.15).abs() < 1e-12, "{heights:?}");
    // The pot fills a little less than a cylinder of radius 2 and height 2.4; the lid and rim add their shells.
    assert!((15.0..32.0).contains(&volume), "{volume}");
    // At the middle of a body patch the normal points away from the axis, at the bottom down, on top up.
    for patch in &patches[12..16] {
        let [point, normal] = [patch.point(0.5, 0.5), patch.normal(0.5, 0.5).unwrap()];
        assert!(normal.truncate().dot(point.truncate()) > 0.9 * point.truncate().length());
    }
    assert!(patches[20].normal(0.9, 0.5).unwrap().z < -0.9);
    assert!(patches[4].normal(0.5, 0.5).unwrap().z > 0.7);
    // Handle and spout: away from the plane of symmetry.
    for patch in &patches[24..] {
        let [point, normal] = [patch.point(0.5, 0.5), patch.normal(0.5, 0.5).unwrap()];
        assert!(normal.y * point.y > 0.0);
    }
}

/// The mask of Dyn, Levin and Gregory, and what it is known for: cubic polynomials come back.
#[test]
fn four_points_make_the_next() {
    let cubic = |x: f64| DVec3::new(x, 2.0 - x + 0.5 * x * x * x, x * x);
    let points: Vec<DVec3> = (0..8).map(|i| cubic(f64::from(i))).collect();
    let open = CurveMesh::new(8, (0..7).map(|i| [i, i + 1]).collect(), &[]).unwrap();
    let refined = open.four_point_refine().unwrap();
    let finer = refined.stencils.apply(&points);
    assert_eq!(finer[..8], points);
    for i in 1..6 {
        assert_close(finer[8 + i], cubic(i as f64 + 0.5), 1e-12, "inside");
    }
    // At the end the next point is the reflection of the one before.
    let beyond = 2.0 * points[0] - points[1];
    assert_close(finer[8], (9.0 * (points[0] + points[1]) - beyond - points[2]) / 16.0, 1e-12, "end");

    let closed = CurveMesh::new(8, (0..8).map(|i| [i, (i + 1) % 8]).collect(), &[2]).unwrap();
    let finer = closed.four_point_refine().unwrap().stencils.apply(&points);
    assert_close(finer[15], (9.0 * (points[7] + points[0]) - points[6] - points[1]) / 16.0, 1e-12, "closing");
    let beyond = 2.0 * points[2] - points[3];
    assert_close(finer[10], (9.0 * (points[2] + points[3]) - beyond - points[4]) / 16.0, 1e-12, "corner");
    assert_eq!(closed.refine().unwrap().mesh, closed.four_point_refine().unwrap().mesh);
}
