//! The grains of a network in the plane, filled with as few triangles as there can be.

use std::collections::BTreeMap;

use glam::DVec3;
use subzero::{Features, TriangleMesh};
use voronoi::triangulate_between_lines;

use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::node_type::Meeting;
use crate::{BoundaryId, Level, Mesh, Network, NetworkError, Side};

/// The triangles between the lines of a level, each labelled with its grain; vertices are those of the lines, and what meets along a line is known.
pub(super) fn filled(network: &Network, lines: &Level, points: &[DVec3]) -> Result<Level, NetworkError> {
    let Mesh::Segments(segments) = &lines.mesh else { unreachable!("a network in the plane has lines") };
    let segments = segments.segments();
    let triangles = triangulate_between_lines(points, segments).ok_or(NetworkError::LinesCross)?;
    let sides = network.sides();
    let mut sides_of: BTreeMap<[u32; 2], Side> = BTreeMap::new();
    for ([from, to], boundary) in segments.iter().zip(&lines.boundary_of) {
        // The first side lies on the left.
        let [left, right] = sides[boundary.index()];
        sides_of.extend([([*from, *to], left), ([*to, *from], right)]);
    }
    let edges = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
    let mut across: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    let mut pieces = DisjointSets::new(triangles.len());
    for (triangle, corners) in (0u32..).zip(&triangles) {
        for [from, to] in edges(*corners).into_iter().filter(|edge| !sides_of.contains_key(edge)) {
            across.insert([from, to], triangle);
            if let Some(other) = across.get(&[to, from]) {
                pieces.join(triangle, *other);
            }
        }
    }
    let mut grain_of: Vec<Option<u32>> = vec![None; triangles.len()];
    for (triangle, corners) in (0u32..).zip(&triangles) {
        let side = edges(*corners).iter().find_map(|edge| sides_of.get(edge)?.grain());
        if let Some(grain) = side {
            grain_of[pieces.root(triangle) as usize] = Some(grain.0);
        }
    }
    // What is left lies outside, between the grains and their convex hull.
    let (mut inside, mut boundary_of) = (Vec::new(), Vec::new());
    for (triangle, corners) in (0u32..).zip(triangles) {
        if let Some(grain) = grain_of[pieces.root(triangle) as usize] {
            inside.push(corners);
            boundary_of.push(BoundaryId(grain));
        }
    }
    let mesh = TriangleMesh::new(points.len(), inside, &Features::default())?;
    let meetings: BTreeMap<[u32; 2], Meeting> = segments
        .iter()
        .zip(&lines.boundary_of)
        .map(|(ends, boundary)| (sorted(*ends), Meeting::inside(&network.boundaries()[boundary.index()])))
        .collect();
    let of_grain = Meeting::of_sides(&[Side::Grain(crate::GrainId(0))]);
    let at_edges =
        mesh.edges().map(|ends| meetings.get(&sorted(ends)).copied().unwrap_or(of_grain)).collect();
    Ok(Level { mesh: Mesh::Triangles(mesh), boundary_of, at_edges, ..lines.clone() })
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
