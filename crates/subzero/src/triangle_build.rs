//! From a list of triangles to connectivity: the one place that searches and sorts.

use rayon::prelude::*;

use crate::edge_table::EdgeTable;
use crate::features::INFINITE_SHARPNESS;
use crate::ids::{NONE, id};
use crate::mesh_checks::{check_corners, check_duplicates, check_size, check_vertex};
use crate::sharpness::{Sharpness, is_infinite};
use crate::{BoundaryRule, FaceId, Features, MeshError, TriangleMesh, VertexRule};

impl TriangleMesh {
    /// Connectivity of `triangles` over `vertex_count` vertices, with its creases and corners.
    ///
    /// # Errors
    /// [`MeshError`] names the place: a vertex id out of range, a triangle that uses a vertex twice, two triangles with
    /// the same vertices, two triangles that run the same way along an edge that is no infinite crease, a crease
    /// that is no edge, a negative or NaN sharpness, or more elements than 32-bit ids can count.
    pub fn new(
        vertex_count: usize,
        triangles: Vec<[u32; 3]>,
        features: &Features,
    ) -> Result<Self, MeshError> {
        check_size("vertices", vertex_count)?;
        check_size("half-edges", triangles.len().saturating_mul(6))?;
        let half_edges: Vec<[u32; 2]> =
            triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        let (are_good, table) =
            rayon::join(|| check_triangles(vertex_count, &triangles), || EdgeTable::new(&half_edges));
        are_good?;
        let mut edge_sharpness = table.crease_sharpness(vertex_count, features.creases)?;
        let is_soft = |&&(edge, _): &&(u32, _)| !is_infinite(edge_sharpness[edge as usize]);
        if let Some(&(_, [first, second])) = table.same_way.iter().find(is_soft) {
            let ends = half_edges[first as usize];
            return Err(MeshError::Winding { first: FaceId(first / 3), second: FaceId(second / 3), ends });
        }
        for (sharpness, &[_, against]) in edge_sharpness.iter_mut().zip(&table.edges) {
            if against == NONE {
                *sharpness = INFINITE_SHARPNESS;
            }
        }

        let mut outgoing = vec![NONE; vertex_count];
        for (h, &vertex) in triangles.as_flattened().iter().enumerate().rev() {
            outgoing[vertex as usize] = id(h);
        }
        let mut mesh = Self {
            triangles,
            directed_edges: table.directed_edges.as_chunks().0.to_vec(),
            edges: table.edges,
            outgoing,
            vertex_rules: vec![VertexRule::Smooth; vertex_count],
            sharp_edges: Vec::new(),
            sharpness: Sharpness::default(),
        };
        mesh.sharpness = Sharpness::new(&edge_sharpness, |edge| mesh.edge(edge));
        mesh.sharp_edges = mesh.sharpness.sharp_edges(mesh.edge_count());
        let mut corners = check_corners(vertex_count, features)?;
        let fixed = mesh.fixed_vertices(&table.half_edge_counts, features.boundary);
        corners.extend(fixed.into_iter().map(|vertex| (vertex, INFINITE_SHARPNESS)));
        mesh.sharpness.set_corners(corners);
        mesh.vertex_rules = mesh.sharpness.vertex_rules(vertex_count);
        Ok(mesh)
    }

    /// Vertices that connectivity alone makes corners: unused ones, those where sheets touch in the point only, those
    /// with a number of non-manifold edges other than 0 and 2, and boundary corners if the boundary rule fixes them.
    fn fixed_vertices(&self, triangle_counts: &[u32], boundary: BoundaryRule) -> Vec<u32> {
        let mut triangles = vec![0_usize; self.vertex_count()];
        for &vertex in self.triangles.as_flattened() {
            triangles[vertex as usize] += 1;
        }
        let mut non_manifold = vec![0_u32; self.vertex_count()];
        for outgoing_edge in &self.sharpness.outgoing_edges {
            let count = triangle_counts[outgoing_edge.edge.index()];
            non_manifold[outgoing_edge.vertex as usize] += u32::from(count > 2);
        }
        // Triangles that a turn around the vertex meets, starting at each crease, or anywhere if there is none.
        let mut met = vec![0; self.vertex_count()];
        let creases = (0..id(3 * self.triangles.len())).into_par_iter();
        let creases = creases.filter(|&h| self.is_crease(self.edge_of(h)));
        let sectors: Vec<(u32, usize)> = creases.map(|h| (self.start(h), self.sector(h).count())).collect();
        sectors.iter().for_each(|&(vertex, count)| met[vertex as usize] += count);
        let is_fixed = |&vertex: &u32| {
            let [triangles, mut met] = [triangles[vertex as usize], met[vertex as usize]];
            if triangles > 0 && met == 0 {
                met = self.ring(self.outgoing[vertex as usize]).count();
            }
            triangles == 0
                || met != triangles
                || !matches!(non_manifold[vertex as usize], 0 | 2)
                || (boundary == BoundaryRule::EdgeCorner && triangles == 1)
        };
        (0..id(self.vertex_count())).into_par_iter().filter(is_fixed).collect()
    }
}

pub(crate) fn check_triangles(vertex_count: usize, triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    for (index, &[a, b, c]) in triangles.iter().enumerate() {
        for vertex in [a, b, c] {
            check_vertex("triangle", index, vertex, vertex_count)?;
        }
        if a == b || b == c || c == a {
            let vertex = if b == c { b } else { a };
            return Err(MeshError::Degenerate { what: "triangle", index, vertex });
        }
    }
    check_duplicates(triangles.iter().map(|&triangle| {
        let mut sorted = triangle;
        sorted.sort_unstable();
        sorted
    }))
}
