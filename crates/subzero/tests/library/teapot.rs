//! The Utah teapot against published patches.
#![allow(clippy::unwrap_used)]

use crate::common::{assert_close, load_from};
use glam::DVec3;
use serde::Deserialize;
use subzero::{BezierCurve, BezierSurface};

#[derive(Deserialize)]
struct Teapot {
    vertices: Vec<DVec3>,
    patches: Vec<Vec<usize>>,
}

/// A point apart from rounding: no two control points are so near each other and not the same.
fn key(point: &DVec3) -> [i64; 3] {
    (point * 1e6).round().as_i64vec3().to_array()
}

/// Patches as a set, each the set of its control points: where it starts, and which way it runs, is free.
fn as_set(mut patches: Vec<Vec<DVec3>>) -> Vec<DVec3> {
    patches.iter_mut().for_each(|patch| patch.sort_by_key(key));
    patches.sort_by_key(|patch| patch.iter().map(key).collect::<Vec<_>>());
    patches.concat()
}

#[test]
fn is_newells_with_blinns_bottom() {
    let published: Teapot = load_from("teapot", "patches");
    let theirs = published.patches.iter().map(|patch| patch.iter().map(|&v| published.vertices[v]).collect());
    let control =
        |patch: &BezierSurface<DVec3>| patch.rows().iter().flat_map(BezierCurve::control).copied().collect();
    let [ours, theirs] = [subzero::teapot().iter().map(control).collect(), theirs.collect()].map(as_set);
    assert_eq!((ours.len(), theirs.len()), (512, 512));
    for (&ours, &theirs) in ours.iter().zip(&theirs) {
        assert_close(ours, theirs, 1e-12, "control point");
    }
}
