//! The teapot as one mesh.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::BTreeMap;

use glam::DVec3;
use subzero::{BezierSurface, Features, HalfEdgeMesh, MergedSurfaces, TriangleMesh, teapot};

fn volume(mesh: &MergedSurfaces) -> f64 {
    let volumes = mesh.triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|v| mesh.points[v as usize]);
        a.dot(b.cross(c)) / 6.0
    });
    volumes.sum()
}

#[test]
fn the_teapot_is_closed_without_triangles_that_have_no_area() {
    let steps = 8;
    let mesh = MergedSurfaces::new(&teapot(), steps, true).unwrap();
    // Of the rings, all four quarters are poles at the lid's top and at the bottom.
    assert_eq!((mesh.poles, mesh.holes), (8, 0));
    // Lid, rim and body, handle and spout: both of the lid's and body's rims, and both ends of either tube.
    assert_eq!(mesh.filled, 6);
    // Four seams up each of the six rings and four quarters of each of four rings between them; three in either tube, twice.
    let (up, around, tubes) = (6 * 4, 4 * 4, 2 * (2 + 2 * 2));
    assert_eq!(mesh.seams, up + around + tubes);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.points[v as usize]);
        assert!((b - a).cross(c - a).length() > 1e-9, "{triangle:?} has no area");
    }
    let connectivity =
        TriangleMesh::new(mesh.points.len(), mesh.triangles.clone(), &Features::default()).unwrap();
    connectivity.check_closed().unwrap();
    HalfEdgeMesh::new(mesh.points.len(), &mesh.triangles).unwrap();
    // Every part faces outward, as Newell's patches do.
    let mut of_surface: BTreeMap<Option<u32>, usize> = BTreeMap::new();
    for surface in &mesh.surface_of {
        *of_surface.entry(*surface).or_default() += 1;
    }
    assert_eq!(of_surface.len(), 33);
    // At a pole a row of squares has one triangle each.
    assert_eq!(of_surface[&Some(0)], (2 * steps * steps - steps) as usize);
    assert_eq!(of_surface[&Some(12)], (2 * steps * steps) as usize);
    let finer = MergedSurfaces::new(&teapot(), 2 * steps, true).unwrap();
    let [coarse, fine] = [volume(&mesh), volume(&finer)];
    assert!(coarse > 0.0 && (fine - coarse).abs() < 0.02 * fine, "{coarse} {fine}");

    let open = MergedSurfaces::new(&teapot(), steps, false).unwrap();
    assert_eq!((open.filled, open.holes), (0, 6));
    assert_eq!(open.points, mesh.points);
}

#[test]
fn sides_join_in_either_direction_and_by_their_control_points_alone() {
    let bilinear = |corners: [[f64; 3]; 4]| {
        let [a, b, c, d] = corners.map(DVec3::from_array);
        BezierSurface::new(vec![vec![a, b], vec![c, d]]).unwrap()
    };
    let left = bilinear([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    // The next one, its u and v turned, and its shared side run through backward.
    let right = bilinear([[1.0, 1.0, 0.0], [2.0, 1.0, 1.0], [1.0, -0.0, 0.0], [2.0, 0.0, 1.0]]);
    let mesh = MergedSurfaces::new(&[left.clone(), right], 4, false).unwrap();
    assert_eq!((mesh.points.len(), mesh.seams, mesh.holes), (45, 1, 1));
    let near = bilinear([[1.0 + 1e-15, 1.0, 0.0], [2.0, 1.0, 1.0], [1.0, 0.0, 0.0], [2.0, 0.0, 1.0]]);
    let apart = MergedSurfaces::new(&[left, near], 4, false).unwrap();
    // Both have a corner at one place, and no side.
    assert_eq!((apart.points.len(), apart.seams), (50, 0));
}
