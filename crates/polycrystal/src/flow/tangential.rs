//! Motion within boundaries, which betters triangles and changes no shape.
//!
//! Tension leaves free where points lie within their surface. The triangles of a fan are thin where a triple line is short;
//! points that move toward the centre of the triangles around come closer to it.

use glam::DVec3;
use rayon::prelude::*;
use subzero::VertexRule;

use crate::energy::local_elements::ElementsPart;
use crate::energy::patch::Patch;
use crate::energy::patches::Patches;
use crate::{Mesh, Network};

/// A step of each point inside a boundary, within its tangent plane, by a share of its way to the centre of the triangles around; the others
/// stay, and in the plane all do. Patches are those of the level.
pub(crate) fn tangential_moves(
    network: &Network,
    level: usize,
    patches: &Patches,
    points: &[DVec3],
    rate: f64,
) -> Vec<DVec3> {
    let level = &network.levels()[level];
    let Mesh::Triangles(mesh) = &level.mesh else { return vec![DVec3::ZERO; points.len()] };
    let mut moves = vec![DVec3::ZERO; points.len()];
    let of_patch = |patch: Patch<'_>| {
        let ways = ways_to_middle(patch, points).into_iter().zip(patch.control_points);
        let inside = ways.filter(|(_, point)| mesh.vertex_rule(**point) == VertexRule::Smooth);
        let moves = inside
            .map(|(way, point)| (*point, network.freedom(level.walls[*point as usize]).project(way * rate)));
        moves.collect::<Vec<(u32, DVec3)>>()
    };
    let of_patches: Vec<Vec<(u32, DVec3)>> = patches.patches().map(of_patch).collect();
    of_patches.into_iter().flatten().for_each(|(point, by)| moves[point as usize] = by);
    moves
}

/// The way of each point of a patch to the centre of its triangles around, within the tangent plane; there are none in the plane.
fn ways_to_middle(patch: Patch<'_>, points: &[DVec3]) -> Vec<DVec3> {
    let ElementsPart::Triangles(triangles) = patch.elements else { return Vec::new() };
    let places: Vec<DVec3> = patch.control_points.iter().map(|point| points[*point as usize]).collect();
    let mut ways = vec![DVec3::ZERO; places.len()];
    let (mut normals, mut weights) = (ways.clone(), vec![0.0; places.len()]);
    for corners in triangles {
        let [a, b, c] = corners.map(|corner| places[corner as usize]);
        let normal = (b - a).cross(c - a);
        // Triangles count by area: no line that comes near catches up with the middle, however many points it has.
        let weight = normal.length();
        for (corner, others) in corners.iter().zip([b - a + (c - a), c - b + (a - b), a - c + (b - c)]) {
            normals[*corner as usize] += normal;
            ways[*corner as usize] += others * weight;
            weights[*corner as usize] += 2.0 * weight;
        }
    }
    for ((way, normal), weight) in ways.iter_mut().zip(normals).zip(weights) {
        let normal = normal.normalize_or_zero();
        *way = (*way - normal * normal.dot(*way)) / weight;
    }
    ways
}
