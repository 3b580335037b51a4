//! From a list of triangles to connectivity: the one place that searches and sorts.

use crate::features::INFINITE_SHARPNESS;
use crate::ids::{NONE, id, next};
use crate::sharpness::{Sharpness, Spoke, is_infinite};
use crate::{BoundaryRule, Features, MeshError, TriangleMesh, VertexRule};

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
        check_triangles(vertex_count, &triangles)?;
        let sorted = SortedHalfEdges::new(&triangles)?;
        let creases = sorted.find_creases(vertex_count, features)?;
        let corners = check_corners(vertex_count, features)?;

        let mut outgoing = vec![NONE; vertex_count];
        for (h, &vertex) in triangles.as_flattened().iter().enumerate().rev() {
            outgoing[vertex as usize] = id(h);
        }
        let numbered = sorted.number_edges(&triangles, &creases)?;
        let mut mesh = Self {
            triangles,
            directed_edges: numbered.directed_edges,
            edges: numbered.edges,
            outgoing,
            vertex_rules: vec![VertexRule::Smooth; vertex_count],
            sharp_edges: Vec::new(),
            sharpness: Sharpness::default(),
        };
        mesh.set_sharpness(&numbered.triangle_counts, &numbered.sharpness, corners, features.boundary);
        Ok(mesh)
    }

    /// Collects sharp edges and corners, and from them the rules.
    fn set_sharpness(
        &mut self,
        triangle_counts: &[u32],
        edge_sharpness: &[f32],
        mut corners: Vec<(u32, f32)>,
        boundary: BoundaryRule,
    ) {
        let sharp = edge_sharpness.iter().enumerate().filter(|&(_, &s)| s > 0.0);
        self.sharpness.edges = sharp.map(|(e, &s)| (id(e), s)).collect();
        self.sharp_edges = self.sharpness.sharp_edges(self.edges.len());
        for &(edge, sharpness) in &self.sharpness.edges {
            let spokes = self.edge(edge).map(|vertex| Spoke { vertex, edge, sharpness });
            self.sharpness.spokes.extend(spokes);
        }
        self.sharpness.spokes.sort_by_key(|spoke| (spoke.vertex, spoke.edge));

        let fixed = self.fixed_vertices(triangle_counts, boundary);
        corners.extend(fixed.into_iter().map(|vertex| (vertex, INFINITE_SHARPNESS)));
        // Of several entries for a vertex, the sharpest comes first and stays.
        corners.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
        corners.dedup_by_key(|&mut (vertex, _)| vertex);
        self.sharpness.corners = corners;
        self.vertex_rules = self.sharpness.vertex_rules(self.vertex_count());
    }

    /// Vertices that connectivity alone makes corners: unused ones, those where sheets touch in the point only, those
    /// with a number of non-manifold edges other than 0 and 2, and boundary corners if the boundary rule fixes them.
    fn fixed_vertices(&self, triangle_counts: &[u32], boundary: BoundaryRule) -> Vec<u32> {
        let mut triangles = vec![0_usize; self.vertex_count()];
        for &vertex in self.triangles.as_flattened() {
            triangles[vertex as usize] += 1;
        }
        let mut non_manifold = vec![0_u32; self.vertex_count()];
        for spoke in &self.sharpness.spokes {
            let count = triangle_counts[spoke.edge as usize];
            non_manifold[spoke.vertex as usize] += u32::from(count > 2);
        }
        // Triangles that a turn around the vertex meets, starting at each crease, or anywhere if there is none.
        let mut met = vec![0; self.vertex_count()];
        for h in (0..id(3 * self.triangles.len())).filter(|&h| self.is_crease(self.directed_edge(h) / 2)) {
            met[self.start(h) as usize] += self.sector(h).count();
        }
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
        (0..id(self.vertex_count())).filter(is_fixed).collect()
    }
}

pub(crate) fn check_size(what: &'static str, count: usize) -> Result<(), MeshError> {
    // The last id is kept for "none".
    if count < u32::MAX as usize { Ok(()) } else { Err(MeshError::TooLarge { what, count }) }
}

fn check_triangles(vertex_count: usize, triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    for (index, &[a, b, c]) in triangles.iter().enumerate() {
        for vertex in [a, b, c] {
            check_vertex("triangle", index, vertex, vertex_count)?;
        }
        if a == b || b == c || c == a {
            let vertex = if b == c { b } else { a };
            return Err(MeshError::Degenerate { what: "triangle", index, vertex });
        }
    }
    Ok(())
}

pub(crate) fn check_vertex(
    what: &'static str,
    index: usize,
    vertex: u32,
    vertex_count: usize,
) -> Result<(), MeshError> {
    if (vertex as usize) < vertex_count {
        Ok(())
    } else {
        Err(MeshError::VertexOutOfRange { what, index, vertex, vertex_count })
    }
}

fn check_sharpness(what: &'static str, index: usize, sharpness: f32) -> Result<(), MeshError> {
    if sharpness >= 0.0 { Ok(()) } else { Err(MeshError::Sharpness { what, index, sharpness }) }
}

/// Marked corners, as (vertex, sharpness) with sharpness above 0.
fn check_corners(vertex_count: usize, features: &Features) -> Result<Vec<(u32, f32)>, MeshError> {
    let mut corners = Vec::with_capacity(features.corners.len() + features.soft_corners.len());
    for (index, &vertex) in features.corners.iter().enumerate() {
        check_vertex("corner", index, vertex, vertex_count)?;
        corners.push((vertex, INFINITE_SHARPNESS));
    }
    for (index, &(vertex, sharpness)) in features.soft_corners.iter().enumerate() {
        check_vertex("corner", index, vertex, vertex_count)?;
        check_sharpness("corner", index, sharpness)?;
        if sharpness > 0.0 {
            corners.push((vertex, sharpness));
        }
    }
    Ok(corners)
}

/// A half-edge under its edge: the two ends, the lower first.
#[derive(Clone, Copy)]
struct HalfEdge {
    ends: [u32; 2],
    apex: u32,
    half_edge: u32,
}

/// All half-edges, those of one edge side by side.
struct SortedHalfEdges(Vec<HalfEdge>);

/// Edges with their numbers.
struct NumberedEdges {
    directed_edges: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    triangle_counts: Vec<u32>,
    sharpness: Vec<f32>,
}

impl SortedHalfEdges {
    fn new(triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        let mut half_edges = Vec::with_capacity(3 * triangles.len());
        for (t, &[a, b, c]) in triangles.iter().enumerate() {
            for (k, [start, end, apex]) in [[a, b, c], [b, c, a], [c, a, b]].into_iter().enumerate() {
                let ends = [start.min(end), start.max(end)];
                half_edges.push(HalfEdge { ends, apex, half_edge: id(3 * t + k) });
            }
        }
        half_edges.sort_unstable_by_key(|h| (h.ends, h.apex, h.half_edge));
        let duplicates =
            half_edges.windows(2).filter(|pair| (pair[0].ends, pair[0].apex) == (pair[1].ends, pair[1].apex));
        let faces = duplicates.map(|pair| (pair[0].half_edge / 3, pair[1].half_edge / 3));
        match faces.min() {
            Some((first, second)) => Err(MeshError::DuplicateFace { first, second }),
            None => Ok(Self(half_edges)),
        }
    }

    /// The half-edges of the edge between two vertices.
    fn find(&self, ends: [u32; 2]) -> &[HalfEdge] {
        let ends = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let start = self.0.partition_point(|h| h.ends < ends);
        let end = start + self.0[start..].partition_point(|h| h.ends == ends);
        &self.0[start..end]
    }

    /// The first half-edge of each creased edge, and its sharpness.
    fn find_creases(&self, vertex_count: usize, features: &Features) -> Result<Vec<(u32, f32)>, MeshError> {
        let mut creases = Vec::with_capacity(features.creases.len());
        for (index, crease) in features.creases.iter().enumerate() {
            for vertex in crease.ends {
                check_vertex("crease", index, vertex, vertex_count)?;
            }
            check_sharpness("crease", index, crease.sharpness)?;
            let first = self.find(crease.ends).iter().map(|h| h.half_edge).min();
            let first = first.ok_or(MeshError::CreaseWithoutEdge { index, ends: crease.ends })?;
            creases.push((first, crease.sharpness));
        }
        Ok(creases)
    }

    /// Numbers the edges in the order of their first half-edges, and sees to their sharpness.
    fn number_edges(
        &self,
        triangles: &[[u32; 3]],
        creases: &[(u32, f32)],
    ) -> Result<NumberedEdges, MeshError> {
        // The first half-edge of the edge of each half-edge.
        let mut first_of = vec![0; 3 * triangles.len()];
        for group in self.0.chunk_by(|a, b| a.ends == b.ends) {
            let first = group.iter().map(|h| h.half_edge).fold(u32::MAX, u32::min);
            for h in group {
                first_of[h.half_edge as usize] = first;
            }
        }
        let start = |h: u32| triangles[(h / 3) as usize][(h % 3) as usize];
        let mut numbered = NumberedEdges {
            directed_edges: vec![[0; 3]; triangles.len()],
            edges: Vec::new(),
            triangle_counts: Vec::new(),
            sharpness: Vec::new(),
        };
        let directed_edges = numbered.directed_edges.as_flattened_mut();
        for h in 0..id(first_of.len()) {
            let first = first_of[h as usize];
            if first == h {
                directed_edges[h as usize] = 2 * id(numbered.edges.len());
                numbered.edges.push([h, NONE]);
                numbered.triangle_counts.push(1);
                numbered.sharpness.push(0.0);
            } else {
                let along = directed_edges[first as usize];
                directed_edges[h as usize] = along + u32::from(start(h) != start(first));
                let edge = (along / 2) as usize;
                numbered.triangle_counts[edge] += 1;
                numbered.edges[edge][1] = h;
            }
        }
        for &(first, sharpness) in creases {
            let edge = (directed_edges[first as usize] / 2) as usize;
            numbered.sharpness[edge] = numbered.sharpness[edge].max(sharpness);
        }
        for (edge, &count) in numbered.triangle_counts.iter().enumerate() {
            let [along, other] = numbered.edges[edge];
            if count != 2 {
                numbered.edges[edge][1] = NONE;
                numbered.sharpness[edge] = INFINITE_SHARPNESS;
            } else if start(along) == start(other) {
                // Without a smooth passage the two sides need not know of each other.
                numbered.edges[edge][1] = NONE;
                if !is_infinite(numbered.sharpness[edge]) {
                    let ends = [start(along), start(next(along))];
                    return Err(MeshError::Winding { first: along / 3, second: other / 3, ends });
                }
            }
        }
        Ok(numbered)
    }
}
