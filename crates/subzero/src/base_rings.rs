//! The outgoing edges of the coarsest mesh's vertices, the only ones that need not have six.

use crate::{LoopWeights, TriangleMesh};

/// Per vertex of a mesh that will be refined: the edges that leave it, and the weight of the neighbours.
///
/// They are the same on every level: the first half of an edge leaves the vertex that the edge left.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BaseRings {
    /// Where the outgoing edges of each vertex start, and after the last vertex their number.
    starts: Vec<u32>,
    /// Twice the edge, plus 1 if it ends at the vertex; by vertex, then by triangle.
    outgoing_edges: Vec<u32>,
    /// Per vertex: the weight of each neighbour. Like the outgoing edges, it means nothing at boundaries.
    weights: Vec<f64>,
}

impl BaseRings {
    pub(crate) fn new(mesh: &TriangleMesh, weights: LoopWeights) -> Self {
        let half_edges = mesh.triangles.as_flattened().iter().zip(mesh.directed_edges.as_flattened());
        let mut starts = vec![0; mesh.vertex_count() + 1];
        for (&vertex, _) in half_edges.clone() {
            starts[vertex as usize + 1] += 1;
        }
        let weights = starts[1..].iter().map(|&valence| weights.neighbour(valence as usize)).collect();
        for vertex in 0..mesh.vertex_count() {
            starts[vertex + 1] += starts[vertex];
        }
        let mut free = starts.clone();
        let mut outgoing_edges = vec![0; starts[mesh.vertex_count()] as usize];
        for (&vertex, &directed) in half_edges {
            let next = &mut free[vertex as usize];
            outgoing_edges[*next as usize] = directed;
            *next += 1;
        }
        Self { starts, outgoing_edges, weights }
    }

    /// The outgoing edges of a vertex.
    pub(crate) fn outgoing_edges(&self, vertex: usize) -> &[u32] {
        &self.outgoing_edges[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// The weight of each neighbour of a vertex.
    pub(crate) fn weight(&self, vertex: usize) -> f64 {
        self.weights[vertex]
    }
}
