//! The spokes of the coarsest mesh's vertices, the only ones that need not have six.

use crate::{LoopWeights, TriangleMesh};

/// Per vertex of a mesh that will be refined: the edges that leave it, and the weight of the neighbours.
///
/// They are the same on every level: the first half of an edge leaves the vertex that the edge left.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BaseRings {
    /// Where the spokes of each vertex start, and after the last vertex their number.
    starts: Vec<u32>,
    /// Twice the edge, plus 1 if it ends at the vertex; by vertex, then by triangle.
    spokes: Vec<u32>,
    /// Per vertex: the weight of each neighbour. Like the spokes, it means nothing at boundaries.
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
        let mut spokes = vec![0; starts[mesh.vertex_count()] as usize];
        for (&vertex, &directed) in half_edges {
            let next = &mut free[vertex as usize];
            spokes[*next as usize] = directed;
            *next += 1;
        }
        Self { starts, spokes, weights }
    }

    /// The spokes of a vertex.
    pub(crate) fn spokes(&self, vertex: usize) -> &[u32] {
        &self.spokes[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// The weight of each neighbour of a vertex.
    pub(crate) fn weight(&self, vertex: usize) -> f64 {
        self.weights[vertex]
    }
}
