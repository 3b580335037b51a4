//! The stencils of Loop's scheme: smooth, crease and corner rules, and the semi-sharp ones between them.

use std::f64::consts::{PI, TAU};

use crate::ids::{next, prev};
use crate::stencil::merge;
use crate::vertex_stencils::vertex_stencil;
use crate::{EdgeId, StencilTable, TriangleMesh, VertexParent, VertexRule};

/// How strongly a smooth vertex is drawn to its neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LoopWeights {
    /// Loop 1987: (5/8 - (3/8 + cos(2 pi/n)/4)^2)/n for each of n neighbours.
    #[default]
    Loop,
    /// Warren 1995: 3/16 for each of 3 neighbours, else 3/(8 n).
    Warren,
    /// Loop's, and at creases those of Biermann, Levin and Zorin 2000: an edge that leaves a crease vertex is weighted by
    /// the number of triangles in its sector, which gives the surface a tangent plane there whatever that number is.
    BiermannLevinZorin,
}

impl LoopWeights {
    /// The weight of each of `valence` neighbours.
    pub fn neighbour(self, valence: usize) -> f64 {
        #[allow(clippy::cast_precision_loss)]
        let n = valence as f64;
        match self {
            // By far the most common, and the same for all.
            _ if valence == 6 => 0.0625,
            Self::Loop | Self::BiermannLevinZorin => (0.625 - (0.375 + 0.25 * (TAU / n).cos()).powi(2)) / n,
            Self::Warren if valence == 3 => 3.0 / 16.0,
            Self::Warren => 3.0 / (8.0 * n),
        }
    }
}

impl TriangleMesh {
    /// One stencil per vertex of the refined mesh: first those of the old vertices, then those of the edges.
    pub(crate) fn loop_stencils(&self, weights: LoopWeights) -> StencilTable {
        let vertices = self.counts().vertices;
        StencilTable::from_stencils(self.vertex_count() + self.edge_count(), |i, stencil| {
            self.add_loop_stencil(i, weights, &mut |point, weight| stencil.add(point, weight));
            if i < vertices && self.is_sharp(i as usize) {
                stencil.merge();
            }
        })
    }

    /// The stencil of one vertex of the refined mesh. That of a sharp one may name a point more than once.
    fn add_loop_stencil(&self, vertex: u32, weights: LoopWeights, add: &mut impl FnMut(u32, f64)) {
        match self.counts().vertex_parent(vertex) {
            VertexParent::Vertex(vertex) => self.loop_vertex_stencil(vertex, weights, add),
            VertexParent::Edge(edge) => self.loop_edge_stencil(edge, weights, add),
        }
    }

    /// One stencil of the table that [`loop_refine`](Self::loop_refine) makes, by itself: puts the old points that make up a vertex of the
    /// refined mesh in place of `entries`, each with its weight.
    ///
    /// # Panics
    /// If the refined mesh has no such vertex.
    pub fn loop_stencil(&self, vertex: u32, entries: &mut Vec<(u32, f64)>) {
        entries.clear();
        self.add_loop_stencil(vertex, LoopWeights::Loop, &mut |point, weight| entries.push((point, weight)));
        if vertex < self.counts().vertices && self.is_sharp(vertex as usize) {
            merge(entries);
        }
    }

    pub(crate) fn loop_edge_stencil(
        &self,
        edge: EdgeId,
        weights: LoopWeights,
        add: &mut impl FnMut(u32, f64),
    ) {
        let [along, against] = self.edges[edge.index()];
        let [a, b] = [self.start(along), self.start(next(along))];
        let crease = if self.sharp_edges[edge.index()] { self.sharpness.of_edge(edge).min(1.0) } else { 0.0 };
        if crease >= 1.0 {
            add(a, 0.5);
            add(b, 0.5);
        } else {
            let crease = f64::from(crease);
            let smooth = match weights {
                LoopWeights::Loop | LoopWeights::Warren => [0.375; 2],
                LoopWeights::BiermannLevinZorin => self.sector_weights(along, against),
            };
            let [end_a, end_b] = smooth.map(|end| end + (0.5 - end) * crease);
            let apex = 0.125 - 0.125 * crease;
            add(a, end_a);
            add(b, end_b);
            add(self.start(prev(along)), apex);
            add(self.start(prev(against)), apex);
        }
    }

    /// The weights of the two ends of an edge after Biermann, Levin and Zorin.
    fn sector_weights(&self, along: u32, against: u32) -> [f64; 2] {
        let far_end = |h: u32| {
            (self.vertex_rule(self.start(h)) == VertexRule::Crease)
                .then(|| 0.5 - 0.25 * (PI / f64::from(self.sector_triangles(h))).cos())
        };
        match (far_end(along), far_end(against)) {
            (Some(b), None) => [0.75 - b, b],
            (None, Some(a)) => [a, 0.75 - a],
            _ => [0.375; 2],
        }
    }

    /// Triangles in the sector of the start of `h` in which `h` lies, `h` being on no crease.
    fn sector_triangles(&self, h: u32) -> u32 {
        let is_crease = |h: &u32| self.sharp_edges[(self.directed_edge(*h) / 2) as usize];
        let left = std::iter::successors(Some(h), |&h| {
            Some(prev(h)).filter(|h| !is_crease(h)).map(|h| self.twin(h))
        });
        let right = std::iter::successors(Some(self.twin(h)), |&h| {
            Some(next(h)).filter(|h| !is_crease(h)).map(|h| self.twin(h))
        });
        left.chain(right).fold(0, |count, _| count + 1)
    }

    pub(crate) fn loop_vertex_stencil<Add: FnMut(u32, f64)>(
        &self,
        vertex: u32,
        weights: LoopWeights,
        add: &mut Add,
    ) {
        let smooth = |scale: f64, add: &mut Add| {
            let first = self.outgoing[vertex as usize];
            let valence = self.ring(first).count();
            let neighbour = weights.neighbour(valence);
            #[allow(clippy::cast_precision_loss)]
            add(vertex, scale * (1.0 - valence as f64 * neighbour));
            self.ring(first).for_each(|h| add(self.start(next(h)), scale * neighbour));
        };
        let rule = self.vertex_rule(vertex);
        vertex_stencil(&self.sharpness, (vertex, rule), add, |edge| self.other_end(edge, vertex), smooth);
    }
}
