//! Motion within boundaries, which betters triangles and changes no shape.
//!
//! Tension leaves free where points lie within their surface. The triangles of a fan are thin where a triple line is short;
//! points that move toward the centre of the triangles around come closer to it.

use glam::DVec3;
use rayon::prelude::*;
use subzero::VertexRule;

use crate::flow::pressure_response::CHUNK;
use crate::mesh::id::id;
use crate::{Mesh, Network};

/// A step of each point inside a boundary, within its tangent plane, by a share of its way to the centre of the triangles around; the others
/// stay, and in the plane all do.
pub(crate) fn tangential_moves(network: &Network, level: usize, points: &[DVec3], rate: f64) -> Vec<DVec3> {
    let level = &network.levels()[level];
    let mut moves = vec![DVec3::ZERO; points.len()];
    let Mesh::Triangles(mesh) = &level.mesh else { return moves };
    let mut normals = moves.clone();
    let mut weights = vec![0.0; points.len()];
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|corner| points[corner as usize]);
        let normal = (b - a).cross(c - a);
        // Triangles count by area: no line that comes near catches up with the middle, however many points it has.
        let weight = normal.length();
        for (corner, others) in corners.iter().zip([b - a + (c - a), c - b + (a - b), a - c + (b - c)]) {
            normals[*corner as usize] += normal;
            moves[*corner as usize] += others * weight;
            weights[*corner as usize] += 2.0 * weight;
        }
    }
    moves.par_iter_mut().enumerate().with_min_len(CHUNK).for_each(|(place, by)| {
        let is_inside = mesh.vertex_rule(id(place)) == VertexRule::Smooth;
        let normal = normals[place].normalize_or_zero();
        let within = *by - normal * normal.dot(*by);
        *by = if is_inside {
            network.freedom(level.walls[place]).project(within * (rate / weights[place]))
        } else {
            DVec3::ZERO
        };
    });
    moves
}
