//! The sharp edges and corners of one level, and what is left of them on the next.
//!
//! Features are sparse (curves on a surface), so they are sorted lists beside the dense connectivity. Refining keeps
//! them sorted: no search, no sort.

use rayon::prelude::*;

use crate::features::INFINITE_SHARPNESS;
use crate::ids::id;
use crate::{EdgeId, MeshError, VertexRule};

/// A sharp edge as seen from one of its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OutgoingEdge {
    pub vertex: u32,
    pub edge: EdgeId,
    pub sharpness: f32,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Sharpness {
    /// Edges with a sharpness above 0, sorted by edge.
    pub edges: Vec<(EdgeId, f32)>,
    /// Both ends of each of them, sorted by vertex, then edge.
    pub outgoing_edges: Vec<OutgoingEdge>,
    /// Vertices with a sharpness of their own, sorted.
    pub corners: Vec<(u32, f32)>,
}

impl Sharpness {
    /// The sharp edges among all; `ends` gives the two vertices of an edge.
    pub(crate) fn new(edge_sharpness: &[f32], ends: impl Fn(EdgeId) -> [u32; 2]) -> Self {
        let sharp = edge_sharpness.iter().enumerate().filter(|&(_, &s)| s > 0.0);
        let edges: Vec<(EdgeId, f32)> = sharp.map(|(e, &s)| (EdgeId(id(e)), s)).collect();
        let outgoing_edges_of = |&(edge, sharpness): &(EdgeId, f32)| {
            ends(edge).map(|vertex| OutgoingEdge { vertex, edge, sharpness })
        };
        let mut outgoing_edges: Vec<OutgoingEdge> = edges.iter().flat_map(outgoing_edges_of).collect();
        outgoing_edges.par_sort_unstable_by_key(|outgoing_edge| (outgoing_edge.vertex, outgoing_edge.edge));
        Self { edges, outgoing_edges, corners: Vec::new() }
    }

    /// Makes these the corners, in any order; of several entries for a vertex the sharpest holds.
    pub(crate) fn set_corners(&mut self, mut corners: Vec<(u32, f32)>) {
        corners.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
        corners.dedup_by_key(|&mut (vertex, _)| vertex);
        self.corners = corners;
    }

    /// The sharpness of an edge; 0 if it is smooth.
    pub(crate) fn of_edge(&self, edge: EdgeId) -> f32 {
        self.edges.binary_search_by_key(&edge, |&(e, _)| e).map_or(0.0, |found| self.edges[found].1)
    }

    /// The sharpness of a vertex itself; 0 if it has none.
    pub(crate) fn of_corner(&self, vertex: u32) -> f32 {
        self.corners.binary_search_by_key(&vertex, |&(v, _)| v).map_or(0.0, |found| self.corners[found].1)
    }

    /// The sharp edges at a vertex.
    pub(crate) fn outgoing_edges(&self, vertex: u32) -> &[OutgoingEdge] {
        let start = self.outgoing_edges.partition_point(|outgoing_edge| outgoing_edge.vertex < vertex);
        let end = start
            + self.outgoing_edges[start..].partition_point(|outgoing_edge| outgoing_edge.vertex == vertex);
        &self.outgoing_edges[start..end]
    }

    /// Checks that all sharpness is infinite.
    pub(crate) fn check_settled(&self) -> Result<(), MeshError> {
        let outgoing_edge = self
            .outgoing_edges
            .iter()
            .find(|outgoing_edge| !is_infinite(outgoing_edge.sharpness))
            .map(|outgoing_edge| outgoing_edge.vertex);
        let corner = self.corners.iter().find(|corner| !is_infinite(corner.1)).map(|corner| corner.0);
        outgoing_edge.or(corner).map_or(Ok(()), |vertex| Err(MeshError::SemiSharp { vertex }))
    }

    /// The features one level on, where edge e has the halves 2 e and 2 e + 1 and the vertex `vertex_count` + e;
    /// `is_start(vertex, edge)` tells which end of an edge a vertex is.
    pub(crate) fn refine(&self, vertex_count: usize, is_start: impl Fn(u32, EdgeId) -> bool) -> Self {
        let mut refined = Self::default();
        for &OutgoingEdge { vertex, edge, sharpness } in &self.outgoing_edges {
            let sharpness = decay(sharpness);
            if sharpness > 0.0 {
                let edge = EdgeId(2 * edge.0 + u32::from(!is_start(vertex, edge)));
                refined.outgoing_edges.push(OutgoingEdge { vertex, edge, sharpness });
            }
        }
        for &(edge, sharpness) in &self.edges {
            let sharpness = decay(sharpness);
            if sharpness > 0.0 {
                for half in [2 * edge.0, 2 * edge.0 + 1].map(EdgeId) {
                    refined.edges.push((half, sharpness));
                    refined.outgoing_edges.push(OutgoingEdge {
                        vertex: id(vertex_count) + edge.0,
                        edge: half,
                        sharpness,
                    });
                }
            }
        }
        refined.corners =
            self.corners.iter().map(|&(v, s)| (v, decay(s))).filter(|&(_, s)| s > 0.0).collect();
        refined
    }

    /// The rule of each vertex: its number of sharp edges decides, unless it is a corner by itself.
    pub(crate) fn vertex_rules(&self, vertex_count: usize) -> Vec<VertexRule> {
        let mut rules = vec![VertexRule::Smooth; vertex_count];
        for outgoing_edges in self.outgoing_edges.chunk_by(|a, b| a.vertex == b.vertex) {
            rules[outgoing_edges[0].vertex as usize] = rule_of_sharp_edges(outgoing_edges.len());
        }
        for &(vertex, _) in &self.corners {
            rules[vertex as usize] = VertexRule::Corner;
        }
        rules
    }

    /// Which edges are sharp at all.
    pub(crate) fn sharp_edges(&self, edge_count: usize) -> Vec<bool> {
        let mut sharp = vec![false; edge_count];
        for &(edge, _) in &self.edges {
            sharp[edge.index()] = true;
        }
        sharp
    }
}

/// Whether a sharpness never runs out.
pub(crate) fn is_infinite(sharpness: f32) -> bool {
    sharpness >= INFINITE_SHARPNESS
}

/// What is left of a sharpness one level on.
pub(crate) fn decay(sharpness: f32) -> f32 {
    if is_infinite(sharpness) { sharpness } else { (sharpness - 1.0).max(0.0) }
}

/// The rule of a vertex that is no corner by itself and has this many sharp edges.
pub(crate) fn rule_of_sharp_edges(count: usize) -> VertexRule {
    match count {
        0 => VertexRule::Smooth,
        1 => VertexRule::Dart,
        2 => VertexRule::Crease,
        _ => VertexRule::Corner,
    }
}
