//! Doo-Sabin subdivision (1978): every corner of a face gives a vertex; faces come from faces, inner edges and inner vertices.

use std::f64::consts::TAU;

use glam::DVec3;
use rayon::prelude::*;

use crate::ids::{NONE, id};
use crate::mesh_checks::check_size;
use crate::{MeshError, PolygonMesh, Refinement, StencilTable};

/// How a new vertex averages the corners of its face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DooSabinWeights {
    /// Doo and Sabin: 1/4 + 5/(4 m) for the corner itself and (3 + 2 cos(2 pi j/m))/(4 m) for the j-th after it.
    #[default]
    DooSabin,
    /// The mean of the corner, the midpoints of its two edges and the centroid. The same for m = 4.
    Means,
}

/// Limit points and tangents of a Doo-Sabin surface at the centres of faces, as averages of the points.
#[derive(Clone, Debug, PartialEq)]
pub struct DooSabinLimits {
    /// One row per face: its centroid, which lies on the limit surface.
    pub positions: StencilTable,
    /// Two rows per face, that add up to 0: limit tangents t1 and t2 with the normal along t1 x t2.
    pub tangents: StencilTable,
}

/// Which faces the refined mesh has beside those inside the old ones.
struct NewFaces {
    /// Edges with two faces, each giving a four-sided face.
    edges: Vec<u32>,
    /// Per edge: how many of these come before it.
    edge_ranks: Vec<u32>,
    /// Per vertex: whether it lies off the boundary and gives a face.
    around_vertex: Vec<bool>,
}

/// A count as a number to compute with; no face has so many corners that this would round.
#[allow(clippy::cast_precision_loss)]
fn real(count: usize) -> f64 {
    count as f64
}

impl PolygonMesh {
    /// One step of Doo-Sabin subdivision. Creases and corners play no part, and open surfaces recede from their boundary.
    ///
    /// The refined mesh has no creases but its boundary. The half-edge h gives the vertex h. The refined faces are: face f inside face f, then one across each
    /// inner edge in the order of the edges, then one around each inner vertex in the order of the vertices.
    ///
    /// # Errors
    /// [`MeshError::ValenceTwo`] names an inner vertex with two edges, whose face would have two corners.
    ///
    /// # Panics
    /// If the finer mesh outgrows 32-bit ids.
    pub fn doo_sabin_refine(&self, weights: DooSabinWeights) -> Result<Refinement<Self>, MeshError> {
        if let Err(error) = check_size("half-edges", self.corners.len().saturating_mul(8)) {
            panic!("the finer mesh does not fit: {error}");
        }
        let stencils = StencilTable::from_rows(self.corners.len(), |h, rows| {
            let corners = self.face(self.faces_of[h as usize]);
            let own = (h - self.face_starts[self.faces_of[h as usize] as usize]) as usize;
            for (i, &corner) in corners.iter().enumerate() {
                rows.add(corner, weights.of_corner((i + corners.len() - own) % corners.len(), corners.len()));
            }
        });
        Ok(Refinement { mesh: self.doo_sabin_connectivity()?, stencils })
    }

    /// Limit points and tangents at the centres of all faces; the same for both kinds of weights.
    pub fn doo_sabin_limits(&self) -> DooSabinLimits {
        let positions = StencilTable::from_rows(self.face_count(), |face, rows| {
            let corners = self.face(face);
            corners.iter().for_each(|&corner| rows.add(corner, 1.0 / real(corners.len())));
        });
        let tangents = StencilTable::from_rows(2 * self.face_count(), |row, rows| {
            let corners = self.face(row / 2);
            for (i, &corner) in corners.iter().enumerate() {
                let angle = TAU * real(i) / real(corners.len());
                rows.add(corner, if row % 2 == 0 { angle.cos() } else { angle.sin() });
            }
        });
        DooSabinLimits { positions, tangents }
    }

    fn doo_sabin_connectivity(&self) -> Result<Self, MeshError> {
        let half_edges = id(self.corners.len());
        let new = self.doo_sabin_faces()?;
        // Across the start of half-edge h runs an edge from the vertex of the half-edge clockwise before h to that of h:
        // along the face around the start, against the face across the edge of h.
        let across = |h: u32| {
            let directed = self.directed_edges[h as usize];
            half_edges + 2 * new.edge_ranks[(directed / 2) as usize] + directed % 2
        };
        // Inside faces, edge h runs from vertex h to the next.
        let mut face_starts = self.face_starts.clone();
        let mut corners: Vec<u32> = (0..half_edges).collect();
        let mut directed_edges: Vec<u32> = corners.iter().map(|h| 2 * h).collect();
        let mut edges: Vec<[u32; 2]> = corners.iter().map(|&h| [h, NONE]).collect();
        edges.resize(edges.len() + 2 * new.edges.len(), [NONE; 2]);
        for (v, _) in new.around_vertex.iter().enumerate().filter(|&(_, &around)| around) {
            for h in self.ring(self.outgoing[v]) {
                let edge = across(self.twin(self.prev(h)));
                // Faces around vertices come after those across edges.
                let half_edge = id(corners.len() + 4 * new.edges.len());
                edges[edge as usize][0] = half_edge;
                corners.push(h);
                directed_edges.push(2 * edge);
            }
            face_starts.push(id(corners.len() + 4 * new.edges.len()));
        }
        let mut quads = Vec::with_capacity(4 * new.edges.len());
        let mut quad_edges = Vec::with_capacity(4 * new.edges.len());
        for (rank, &edge) in new.edges.iter().enumerate() {
            for (side, h) in self.edges[edge as usize].into_iter().enumerate() {
                let half_edge = half_edges + id(4 * rank + 2 * side);
                quads.extend([self.next(h), h]);
                edges[h as usize][1] = half_edge;
                let around = new.around_vertex[self.start(h) as usize];
                quad_edges.extend([2 * h + 1, 2 * across(h) + u32::from(around)]);
                edges[across(h) as usize][usize::from(around)] = half_edge + 1;
            }
        }
        let face_count = self.face_count();
        face_starts
            .splice(face_count..=face_count, (0..=id(new.edges.len())).map(|rank| half_edges + 4 * rank));
        corners.splice(self.corners.len()..self.corners.len(), quads);
        directed_edges.splice(self.corners.len()..self.corners.len(), quad_edges);
        Ok(Self::with_open_boundary(face_starts, corners, directed_edges, edges, half_edges))
    }

    fn doo_sabin_faces(&self) -> Result<NewFaces, MeshError> {
        let mut around_vertex: Vec<bool> = self.outgoing.iter().map(|&h| h != NONE).collect();
        let mut new = NewFaces { edges: Vec::new(), edge_ranks: Vec::new(), around_vertex: Vec::new() };
        for edge in 0..id(self.edge_count()) {
            new.edge_ranks.push(id(new.edges.len()));
            if self.is_boundary(edge) {
                self.edge(edge).into_iter().for_each(|end| around_vertex[end as usize] = false);
            } else {
                new.edges.push(edge);
            }
        }
        let has_two_edges = |&v: &usize| around_vertex[v] && self.ring(self.outgoing[v]).count() == 2;
        if let Some(vertex) = (0..self.vertex_count()).find(has_two_edges) {
            return Err(MeshError::ValenceTwo { vertex: id(vertex) });
        }
        new.around_vertex = around_vertex;
        Ok(new)
    }
}

impl DooSabinWeights {
    /// The weight of the corner `offset` places after the one that moves, in a face with `corners` corners.
    pub fn of_corner(self, offset: usize, corners: usize) -> f64 {
        let m = real(corners);
        let neighbour = if offset == 1 || offset + 1 == corners { 0.125 } else { 0.0 };
        match (self, offset) {
            (Self::DooSabin, 0) => 0.25 + 1.25 / m,
            (Self::DooSabin, _) => (3.0 + 2.0 * (TAU * real(offset) / m).cos()) / (4.0 * m),
            (Self::Means, 0) => 0.5 + 0.25 / m,
            (Self::Means, _) => neighbour + 0.25 / m,
        }
    }
}

impl DooSabinLimits {
    /// The unit normal at each face; nothing where the points are degenerate.
    ///
    /// # Panics
    /// If `points` has fewer points than the mesh has vertices.
    pub fn normals(&self, points: &[DVec3]) -> Vec<Option<DVec3>> {
        let tangents = self.tangents.apply(points);
        tangents.par_chunks_exact(2).map(|t| t[0].cross(t[1]).try_normalize()).collect()
    }
}
