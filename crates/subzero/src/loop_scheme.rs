//! The rows of Loop's scheme: smooth, crease and corner rules, and the semi-sharp ones between them.

use std::f64::consts::TAU;

use crate::ids::{next, prev};
use crate::sharpness::{Spoke, decay, is_infinite, rule_of_sharp_edges};
use crate::stencil::Rows;
use crate::{StencilTable, TriangleMesh, VertexRule};

/// How strongly a smooth vertex is drawn to its neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LoopWeights {
    /// Loop 1987: (5/8 - (3/8 + cos(2 pi/n)/4)^2)/n for each of n neighbours.
    #[default]
    Loop,
    /// Warren 1995: 3/16 for each of 3 neighbours, else 3/(8 n).
    Warren,
}

impl LoopWeights {
    /// The weight of each of `valence` neighbours.
    pub fn neighbour(self, valence: usize) -> f64 {
        #[allow(clippy::cast_precision_loss)]
        let n = valence as f64;
        match self {
            Self::Loop => (0.625 - (0.375 + 0.25 * (TAU / n).cos()).powi(2)) / n,
            Self::Warren if valence == 3 => 3.0 / 16.0,
            Self::Warren => 3.0 / (8.0 * n),
        }
    }
}

impl TriangleMesh {
    /// One row per vertex of the refined mesh: first those of the old vertices, then those of the edges.
    pub(crate) fn loop_stencils(&self, weights: LoopWeights) -> StencilTable {
        let vertices = self.counts().vertices;
        StencilTable::from_rows(self.vertex_count() + self.edge_count(), |i, rows| {
            if i < vertices {
                self.loop_vertex_row(i, weights, rows);
            } else {
                self.loop_edge_row(i - vertices, rows);
            }
        })
    }

    fn loop_edge_row(&self, edge: u32, rows: &mut Rows) {
        let [along, against] = self.edges[edge as usize];
        let [a, b] = [self.start(along), self.start(next(along))];
        let crease =
            if self.sharp_edges[edge as usize] { self.sharpness.of_edge(edge).min(1.0) } else { 0.0 };
        if crease >= 1.0 {
            rows.add(a, 0.5);
            rows.add(b, 0.5);
        } else {
            let crease = f64::from(crease);
            let end = 0.375 + 0.125 * crease;
            let apex = 0.125 - 0.125 * crease;
            rows.add(a, end);
            rows.add(b, end);
            rows.add(self.start(prev(along)), apex);
            rows.add(self.start(prev(against)), apex);
        }
    }

    fn loop_vertex_row(&self, vertex: u32, weights: LoopWeights, rows: &mut Rows) {
        let rule = self.vertex_rule(vertex);
        if matches!(rule, VertexRule::Smooth | VertexRule::Dart) {
            return self.smooth_vertex_row(vertex, weights, 1.0, rows);
        }
        // A sharp vertex keeps its rule, or blends it with the one that follows when some sharpness runs out.
        let spokes = self.sharpness.spokes(vertex);
        let corner = self.sharpness.of_corner(vertex);
        let next_rule = rule_after(spokes, corner);
        let sharp_share = if next_rule == rule { 1.0 } else { share_before_run_out(spokes, corner) };
        self.sharp_vertex_row(vertex, rule, spokes, sharp_share, rows);
        if sharp_share < 1.0 {
            let rest = 1.0 - sharp_share;
            match next_rule {
                VertexRule::Smooth | VertexRule::Dart => self.smooth_vertex_row(vertex, weights, rest, rows),
                _ => self.sharp_vertex_row(vertex, next_rule, &still_sharp(spokes), rest, rows),
            }
        }
    }

    fn smooth_vertex_row(&self, vertex: u32, weights: LoopWeights, share: f64, rows: &mut Rows) {
        let ring = self.ring(self.outgoing[vertex as usize]);
        let valence = ring.count();
        let neighbour = weights.neighbour(valence);
        #[allow(clippy::cast_precision_loss)]
        rows.add(vertex, share * (1.0 - valence as f64 * neighbour));
        for h in self.ring(self.outgoing[vertex as usize]) {
            rows.add(self.start(next(h)), share * neighbour);
        }
    }

    fn sharp_vertex_row(&self, vertex: u32, rule: VertexRule, spokes: &[Spoke], share: f64, rows: &mut Rows) {
        if rule == VertexRule::Crease {
            rows.add(vertex, 0.75 * share);
            for spoke in spokes {
                rows.add(self.other_end(spoke.edge, vertex), 0.125 * share);
            }
        } else {
            rows.add(vertex, share);
        }
    }
}

/// The spokes that are sharp one level on.
fn still_sharp(spokes: &[Spoke]) -> Vec<Spoke> {
    spokes.iter().filter(|spoke| decay(spoke.sharpness) > 0.0).copied().collect()
}

/// The rule of a vertex one level on.
fn rule_after(spokes: &[Spoke], corner: f32) -> VertexRule {
    if decay(corner) > 0.0 { VertexRule::Corner } else { rule_of_sharp_edges(still_sharp(spokes).len()) }
}

/// The mean of the sharpnesses that run out in this step, at most 1: the share of the rule that held until now.
fn share_before_run_out(spokes: &[Spoke], corner: f32) -> f64 {
    let ending = |&sharpness: &f32| sharpness > 0.0 && !is_infinite(sharpness) && decay(sharpness) == 0.0;
    let sharpnesses = spokes.iter().map(|spoke| spoke.sharpness).chain([corner]).filter(ending);
    let (sum, count) = sharpnesses.fold((0.0, 0.0), |(sum, count), s| (sum + f64::from(s), count + 1.0));
    if count > 0.0 { f64::min(sum / count, 1.0) } else { 1.0 }
}
