//! The grains of a network in the plane, filled with triangles between their lines and the points of a lattice.
//!
//! What is made of them starts from these triangles, so they are about as large as elements: from those between lines alone, halving, collapsing and moving
//! took twice the time.

use std::collections::BTreeMap;

use glam::DVec3;
use subzero::{Features, TriangleMesh};
use voronoi::triangulate_between_lines;

use crate::check::box_tree::Bounds;
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::id::id;
use crate::mesh::node_type::{Meeting, NodeType};
use crate::mesh::wall_set::WallSet;
use crate::remesh::patch::edges;
use crate::{BoundaryId, Level, Mesh, Network, NetworkError, Side};

/// The triangles between the lines of a level, each labelled with its grain, and their points: first those of the lines, then those of a lattice of the given spacing that
/// are at least as far from lines as the shortest edges are long. What meets along a line is known.
pub(super) fn filled(
    network: &Network,
    lines: &Level,
    points: &[DVec3],
    [spacing, shortest]: [f64; 2],
) -> Result<(Level, Vec<DVec3>), NetworkError> {
    let Mesh::Segments(segments) = &lines.mesh else { unreachable!("a network in the plane has lines") };
    let segments = segments.segments();
    let mut points = points.to_vec();
    let lattice = lattice_between(&points, segments, [spacing, shortest]);
    points.extend(lattice);
    let triangles = triangulate_between_lines(&points, segments).ok_or(NetworkError::LinesCross)?;
    let sides = network.sides();
    let mut sides_of: BTreeMap<[u32; 2], Side> = BTreeMap::new();
    for ([from, to], boundary) in segments.iter().zip(&lines.boundary_of) {
        // The first side lies on the left.
        let [left, right] = sides[boundary.index()];
        sides_of.extend([([*from, *to], left), ([*to, *from], right)]);
    }
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
    let points = without_unused(points, lines.vertex_count(), &mut inside);
    let mesh = TriangleMesh::new(points.len(), inside, &Features::default())?;
    let meetings: BTreeMap<[u32; 2], Meeting> = segments
        .iter()
        .zip(&lines.boundary_of)
        .map(|(ends, boundary)| (sorted(*ends), Meeting::inside(&network.boundaries()[boundary.index()])))
        .collect();
    let of_grain = Meeting::of_sides(&[Side::Grain(crate::GrainId(0))]);
    let at_edges =
        mesh.edges().map(|ends| meetings.get(&sorted(ends)).copied().unwrap_or(of_grain)).collect();
    let mut level = Level { mesh: Mesh::Triangles(mesh), boundary_of, at_edges, ..lines.clone() };
    // As of points inside a flat boundary, which a grain is like here.
    level.node_types.resize(points.len(), NodeType::INTERIOR);
    level.grain_counts.resize(points.len(), 1);
    level.generations.resize(points.len(), 0);
    level.walls.resize(points.len(), WallSet::default());
    Ok((level, points))
}

/// Points of a triangular lattice that are not nearer to lines than `radius`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers of rows and columns, from 0 to what memory holds"
)]
fn lattice_between(points: &[DVec3], segments: &[[u32; 2]], [spacing, radius]: [f64; 2]) -> Vec<DVec3> {
    let around = Bounds::around(points.iter().copied());
    let height = 0.75f64.sqrt() * spacing;
    let size = around.size();
    let [columns, rows] = [size.x / spacing, size.y / height].map(|count| count as usize + 1);
    let place = |column: usize, row: usize| {
        let along = column as f64 + 0.5 * (row % 2) as f64;
        around.lower() + DVec3::new(along * spacing, row as f64 * height, 0.0)
    };
    let mut is_near = vec![false; columns * rows];
    for [from, to] in segments.iter().map(|ends| ends.map(|end| points[end as usize])) {
        let steps = (from.distance(to) / (0.5 * spacing)).ceil().max(1.0) as usize;
        for sample in (0..=steps).map(|step| from.lerp(to, step as f64 / steps as f64)) {
            let from_corner = sample - around.lower();
            let range = |middle: f64, unit: f64, count: usize| {
                let [first, last] = [middle - radius, middle + radius].map(|end| (end / unit).max(0.0));
                first as usize..=(last as usize + 1).min(count - 1)
            };
            for row in range(from_corner.y, height, rows) {
                for column in range(from_corner.x - 0.5 * spacing, spacing, columns) {
                    is_near[row * columns + column] |= place(column, row).distance(sample) < radius;
                }
            }
        }
    }
    let all = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    all.zip(is_near).filter(|(_, is_near)| !is_near).map(|((column, row), _)| place(column, row)).collect()
}

/// The points but those beyond the first few that no triangle has, whose corners are then as the points are numbered.
fn without_unused(points: Vec<DVec3>, first: usize, triangles: &mut [[u32; 3]]) -> Vec<DVec3> {
    let mut is_used = vec![false; points.len()];
    is_used[..first].fill(true);
    triangles.iter().flatten().for_each(|corner| is_used[*corner as usize] = true);
    let mut numbers = vec![0; points.len()];
    let mut used = Vec::new();
    for (old, point) in points.into_iter().enumerate().filter(|(old, _)| is_used[*old]) {
        numbers[old] = id(used.len());
        used.push(point);
    }
    triangles.iter_mut().flatten().for_each(|corner| *corner = numbers[*corner as usize]);
    used
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
