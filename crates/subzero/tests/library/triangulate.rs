//! Polygons cut into triangles.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};
use proptest::prelude::*;
use subzero::{FaceId, MeshError, triangulate};

fn area_vector(corners: &[DVec3]) -> DVec3 {
    corners.windows(2).map(|pair| pair[0].cross(pair[1])).sum::<DVec3>()
        + corners[corners.len() - 1].cross(corners[0])
}

/// Checks that triangles cover a polygon in a plane, all facing its way, and returns them.
fn cut(corners: &[DVec3]) -> Vec<[u32; 3]> {
    let face: Vec<u32> = (0..).take(corners.len()).collect();
    let (triangles, face_of) = triangulate(corners, &[face]).unwrap();
    assert_eq!(triangles.len(), corners.len() - 2);
    assert!(face_of.iter().all(|face| *face == FaceId(0)));
    let whole = area_vector(corners);
    let normal = whole.normalize();
    let areas = triangles.iter().map(|t| area_vector(&t.map(|v| corners[v as usize])).dot(normal));
    let areas: Vec<f64> = areas.collect();
    assert!(areas.iter().all(|area| *area > 0.0), "{areas:?}");
    assert!((areas.iter().sum::<f64>() - whole.length()).abs() < 1e-12 * whole.length());
    triangles
}

#[test]
fn a_chevron_is_cut_where_it_is_notched() {
    let corners = [[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.5, 1.0]].map(|[x, y]| DVec3::new(x, y, 3.0));
    // A fan from the first corner would leave it.
    let mut triangles = cut(&corners);
    triangles.iter_mut().for_each(|t| t.sort_unstable());
    triangles.sort_unstable();
    assert_eq!(triangles, [[0, 1, 3], [1, 2, 3]]);
    // Seen from behind and along the other axes too.
    let turned = corners.map(|p| DVec3::new(p.z, p.y, p.x));
    assert_eq!(cut(&turned).len(), 2);
    assert_eq!(cut(&corners.map(|p| DVec3::new(p.z, p.x, p.y))).len(), 2);
}

#[test]
fn squares_are_cut_from_their_first_corner_and_oblongs_between_obtuse_ones() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    assert_eq!(cut(&square), [[0, 1, 2], [0, 2, 3]]);
    let rhombus = [[0.0, 0.0], [3.0, 0.0], [4.0, 1.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    assert!(cut(&rhombus).iter().all(|t| t.contains(&1) && t.contains(&3)));
}

#[test]
fn corners_on_sides_get_triangles_with_area() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]];
    cut(&corners.map(|[x, y]| DVec3::new(x, y, 0.0)));
    let triangle = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 2.0], [0.0, 1.0]];
    cut(&triangle.map(|[x, y]| DVec3::new(x, y, 0.0)));
}

#[test]
fn a_slit_polygon_is_cut_around_its_hole() {
    // A square with a square hole, joined by a slit whose corners come twice.
    let outer = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0], [0.0, 0.0]];
    let inner = [[1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0], [1.0, 1.0]];
    let corners: Vec<DVec3> = outer.iter().chain(&inner).map(|&[x, y]| DVec3::new(x, y, 0.0)).collect();
    cut(&corners);
}

#[test]
fn skew_polygons() {
    // A hexagon along the edges of a cube, which no plane holds.
    let corners = [[0, 0, 1], [1, 0, 1], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 1]];
    let corners = corners.map(|c| DVec3::from_array(c.map(f64::from)));
    let (triangles, _) = triangulate(&corners, &[vec![0, 1, 2, 3, 4, 5]]).unwrap();
    let total: DVec3 = triangles.iter().map(|t| area_vector(&t.map(|v| corners[v as usize]))).sum();
    assert!((total - area_vector(&corners)).length() < 1e-15);
    let normal = total.normalize();
    assert!(triangles.iter().all(|t| area_vector(&t.map(|v| corners[v as usize])).dot(normal) > 0.0));
}

#[test]
fn bad_polygons_are_named() {
    let plane =
        |places: &[[f64; 2]]| -> Vec<DVec3> { places.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect() };
    let star: Vec<[f64; 2]> =
        (0..5).map(|k| f64::from(2 * k) * TAU / 5.0).map(|angle| [angle.cos(), angle.sin()]).collect();
    let crossed = MeshError::CrossedFace { face: FaceId(0) };
    for (corners, expected) in [
        (plane(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]), MeshError::FlatFace { face: FaceId(0) }),
        (plane(&[[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 3.0]]), crossed.clone()),
        (plane(&star), crossed),
    ] {
        let face: Vec<u32> = (0..).take(corners.len()).collect();
        assert_eq!(triangulate(&corners, &[face]).unwrap_err(), expected);
    }
    let square = plane(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    let error = triangulate(&square, &[vec![0, 1, 2], vec![0, 1, 2, 9]]).unwrap_err().to_string();
    assert_eq!(error, "face 1 refers to vertex 9, but there are only 4 vertices, counted from 0");
}

proptest! {
    /// Polygons with any radii around a point, in any plane: covered, and Delaunay where a diagonal could be turned.
    #[test]
    fn any_star_shaped_polygon(
        radii in prop::collection::vec(0.05_f64..1.0, 4..40),
        [x, y, z] in prop::array::uniform3(-3.0_f64..3.0),
    ) {
        let turned = DMat3::from_euler(glam::EulerRot::XYZ, x, y, z);
        let count = radii.len() as f64;
        let corner = |(k, radius): (usize, &f64)| {
            let angle = k as f64 * TAU / count;
            turned * DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.3)
        };
        let corners: Vec<DVec3> = radii.iter().enumerate().map(corner).collect();
        let normal = area_vector(&corners).normalize();
        // Such polygons may wind about their middle only if no two neighbours are half a turn apart.
        let triangles = cut(&corners);
        let at = |v: u32| corners[v as usize];
        for first in &triangles {
            for second in &triangles {
                let Some(k) = (0..3).find(|&k| {
                    let (a, b) = (first[k], first[(k + 1) % 3]);
                    (0..3).any(|m| second[m] == b && second[(m + 1) % 3] == a)
                }) else { continue };
                let [a, b, c] = [first[k], first[(k + 1) % 3], first[(k + 2) % 3]];
                let d = *second.iter().find(|v| **v != a && **v != b).unwrap();
                let area = |t: [u32; 3]| area_vector(&t.map(at)).dot(normal);
                if area([d, c, a]) > 1e-12 && area([c, d, b]) > 1e-12 {
                    let angle = |apex: u32| (at(a) - at(apex)).angle_between(at(b) - at(apex));
                    prop_assert!(angle(c) + angle(d) < TAU / 2.0 + 1e-6);
                }
            }
        }
    }
}
