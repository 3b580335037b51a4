//! Corners of faces, and how subdivision will turn out there.
//!
//! At a corner v with the crease edges e0 and e1 of a face and one edge s between them, a step of Loop subdivision maps
//! e to e / 2 and s to 3/8 s + 1/8 (e0 + e1). After n steps s is along `q s + (1 - q) (e0 + e1)` with q = (3/4)^n: where the
//! face's angle exceeds 180 degrees it moves to the wrong side of both creases (Biermann, Levin and Zorin 2000), and
//! the finer triangles fold although the control mesh does not.

use glam::DVec3;
use subzero::VertexRule;

use crate::{Mesh, Network};

/// Cosine of the largest angle that the limit of a corner's triangles may make with each other, and with the control
/// mesh's (75 degrees).
const LARGEST_BEND: f64 = 0.26;

/// Change of that cosine that counts as none.
const SLIGHT_BEND: f64 = 1e-9;

/// The corners of all faces in the control mesh.
pub(super) struct FaceCorners {
    /// Corner, outgoing crease neighbour, neighbour in between, incoming crease neighbour.
    corners: Vec<[u32; 4]>,
    /// (3/4)^n for n levels of subdivision.
    remaining: f64,
}

impl FaceCorners {
    /// None in the plane, and none where the control mesh is not subdivided.
    pub(super) fn new(network: &Network, level: usize) -> Self {
        let level_count = network.levels().len() - 1 - level;
        let remaining = 0.75f64.powi(i32::try_from(level_count).unwrap_or(i32::MAX));
        let control = &network.levels()[level];
        let (Mesh::Triangles(mesh), 1..) = (&control.mesh, level_count) else {
            return Self { corners: Vec::new(), remaining };
        };
        // Each corner of a face has one triangle beside the outgoing crease and one beside the incoming.
        let mut halves: Vec<(u32, u32, bool, [u32; 2])> = Vec::new();
        for (triangle, corners) in (0u32..).zip(mesh.triangles()) {
            let edges = mesh.triangle_edges(triangle);
            let boundary = control.boundary_of[triangle as usize].0;
            for k in 0..3 {
                let [v, next, previous] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
                if mesh.vertex_rule(v) != VertexRule::Corner {
                    continue;
                }
                let is_incoming = !mesh.is_crease(edges[k]);
                let crease_then_spoke = if is_incoming { [previous, next] } else { [next, previous] };
                halves.push((v, boundary, is_incoming, crease_then_spoke));
            }
        }
        halves.sort_unstable();
        let pairs = halves.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).filter(|pair| pair.len() == 2);
        let corners = pairs.map(|pair| [pair[0].0, pair[0].3[0], pair[0].3[1], pair[1].3[0]]).collect();
        Self { corners, remaining }
    }

    /// The corners that a step from `before` to `after` makes fold, or more so, on the finest level.
    pub(super) fn folding(&self, before: &[DVec3], after: &[DVec3]) -> Vec<[u32; 4]> {
        let folds = |corner: &&[u32; 4]| {
            let [first, second] = self.finest_normals(after, corner);
            let [old_first, old_second] = self.finest_normals(before, corner);
            let cosine = |a: DVec3, b: DVec3| a.normalize_or_zero().dot(b.normalize_or_zero());
            let bend = cosine(first, second);
            (bend < LARGEST_BEND && bend < cosine(old_first, old_second) - SLIGHT_BEND)
                || cosine(first, old_first) < LARGEST_BEND
                || cosine(second, old_second) < LARGEST_BEND
        };
        self.corners.iter().filter(folds).copied().collect()
    }

    /// Normals of the two triangles at the corner on the finest level.
    fn finest_normals(&self, points: &[DVec3], corner: &[u32; 4]) -> [DVec3; 2] {
        let [v, outgoing, spoke, incoming] = corner.map(|point| points[point as usize]);
        let [outgoing, spoke, incoming] = [outgoing - v, spoke - v, incoming - v];
        let spoke = spoke * self.remaining + (outgoing + incoming) * (1.0 - self.remaining);
        [outgoing.cross(spoke), spoke.cross(incoming)]
    }
}
