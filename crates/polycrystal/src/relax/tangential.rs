//! Motion within boundaries, which betters triangles and changes no shape.
//!
//! Tension leaves free where points lie within their surface. The triangles of a fan are thin where a triple line is short;
//! points that move toward the mean of their neighbours come closer to it.

use glam::DVec3;
use subzero::VertexRule;

use crate::{Mesh, Network};

/// Share of the way to the centre of the triangles around that a point goes in a step where there are steps enough.
const CENTER_RATE: f64 = 0.2;

/// Where points inside boundaries go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Aim {
    /// The mean of their neighbours: where many of them are close together, toward these.
    Neighbors,
    /// The centre of the triangles around, however many: no line that comes near catches up with them.
    Center,
}

/// A step of each point inside a boundary, within its tangent plane; the others stay, and in the plane all do.
pub(super) fn tangential_moves(
    network: &Network,
    level: usize,
    points: &[DVec3],
    aim: Aim,
    rate: f64,
) -> Vec<DVec3> {
    let level = &network.levels()[level];
    let mut moves = vec![DVec3::ZERO; points.len()];
    let Mesh::Triangles(mesh) = &level.mesh else { return moves };
    let mut normals = moves.clone();
    let mut counts = vec![0.0; points.len()];
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|corner| points[corner as usize]);
        let normal = (b - a).cross(c - a);
        // Round a point inside a boundary each neighbour comes twice.
        let weight = match aim {
            Aim::Neighbors => 1.0,
            Aim::Center => normal.length(),
        };
        for (corner, others) in corners.iter().zip([b - a + (c - a), c - b + (a - b), a - c + (b - c)]) {
            normals[*corner as usize] += normal;
            moves[*corner as usize] += others * weight;
            counts[*corner as usize] += 2.0 * weight;
        }
    }
    let rate = match aim {
        Aim::Neighbors => rate,
        Aim::Center => CENTER_RATE,
    };
    for (point, by) in (0u32..).zip(&mut moves) {
        let place = point as usize;
        let is_inside = mesh.vertex_rule(point) == VertexRule::Smooth;
        let normal = normals[place].normalize_or_zero();
        let within = *by - normal * normal.dot(*by);
        *by = if is_inside {
            network.freedom(level.walls[place]).project(within * (rate / counts[place]))
        } else {
            DVec3::ZERO
        };
    }
    moves
}
