//! Edges of a list of faces: found by sorting the half-edges, then numbered in the order of the faces.

use rayon::prelude::*;

use crate::ids::{NONE, id};
use crate::mesh_checks::{check_sharpness, check_vertex};
use crate::{Crease, MeshError};

/// The edges of a mesh. Edges count in the order in which the half-edges first name them.
pub(crate) struct EdgeTable {
    /// The edge between two vertices, the lower first; sorted.
    by_ends: Vec<([u32; 2], u32)>,
    /// Per half-edge: twice its edge, plus 1 if it runs against the edge.
    pub directed_edges: Vec<u32>,
    /// Per edge: its first half-edge, along which it runs, and, if there are exactly two and they run against each other,
    /// its other half-edge, else [`NONE`].
    pub edges: Vec<[u32; 2]>,
    /// Per edge: how many half-edges it has.
    pub half_edge_counts: Vec<u32>,
    /// Edges of exactly two half-edges that run the same way, and these.
    pub same_way: Vec<(u32, [u32; 2])>,
}

fn ordered([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

impl EdgeTable {
    /// The edges of half-edges with these starts and ends.
    pub(crate) fn new(half_edges: &[[u32; 2]]) -> Self {
        let mut sorted: Vec<([u32; 2], u32)> =
            half_edges.iter().enumerate().map(|(h, &ends)| (ordered(ends), id(h))).collect();
        sorted.par_sort_unstable();
        let mut first_of = vec![0; half_edges.len()];
        for group in sorted.chunk_by(|a, b| a.0 == b.0) {
            for &(_, h) in group {
                first_of[h as usize] = group[0].1;
            }
        }
        sorted.dedup_by_key(|&mut (ends, _)| ends);
        let mut table = Self {
            directed_edges: vec![0; half_edges.len()],
            edges: Vec::with_capacity(sorted.len()),
            half_edge_counts: Vec::with_capacity(sorted.len()),
            same_way: Vec::new(),
            by_ends: sorted,
        };
        for (h, &first) in first_of.iter().enumerate() {
            if first == id(h) {
                table.directed_edges[h] = 2 * id(table.edges.len());
                table.edges.push([first, NONE]);
                table.half_edge_counts.push(1);
            } else {
                let along = table.directed_edges[first as usize];
                let against = half_edges[h][0] != half_edges[first as usize][0];
                table.directed_edges[h] = along + u32::from(against);
                table.edges[(along / 2) as usize][1] = id(h);
                table.half_edge_counts[(along / 2) as usize] += 1;
            }
        }
        for (e, &count) in table.half_edge_counts.iter().enumerate() {
            let [along, other] = table.edges[e];
            let same_way = count == 2 && half_edges[along as usize] == half_edges[other as usize];
            if same_way {
                table.same_way.push((id(e), [along, other]));
            }
            if same_way || count != 2 {
                table.edges[e][1] = NONE;
            }
        }
        for (_, half_edge) in &mut table.by_ends {
            *half_edge = table.directed_edges[*half_edge as usize] / 2;
        }
        table
    }

    /// The edge between two vertices.
    fn find(&self, ends: [u32; 2]) -> Option<u32> {
        let ends = ordered(ends);
        self.by_ends.binary_search_by_key(&ends, |&(ends, _)| ends).ok().map(|found| self.by_ends[found].1)
    }

    /// The sharpness that the creases give to each edge.
    pub(crate) fn crease_sharpness(
        &self,
        vertex_count: usize,
        creases: &[Crease],
    ) -> Result<Vec<f32>, MeshError> {
        let edge = |(index, crease): (usize, &Crease)| {
            for vertex in crease.ends {
                check_vertex("crease", index, vertex, vertex_count)?;
            }
            check_sharpness("crease", index, crease.sharpness)?;
            self.find(crease.ends).ok_or(MeshError::CreaseWithoutEdge { index, ends: crease.ends })
        };
        let edges: Vec<Result<u32, MeshError>> = creases.par_iter().enumerate().map(edge).collect();
        let mut sharpness = vec![0.0_f32; self.edges.len()];
        for (edge, crease) in edges.into_iter().zip(creases) {
            let sharpness = &mut sharpness[edge? as usize];
            *sharpness = sharpness.max(crease.sharpness);
        }
        Ok(sharpness)
    }
}
