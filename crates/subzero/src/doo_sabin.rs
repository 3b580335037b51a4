//! Doo-Sabin subdivision (1978): every corner of a face gives a vertex; faces come from faces, inner edges and inner vertices.

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use crate::ids::{NONE, id};
use crate::mesh_checks::check_size;
use crate::{EdgeId, FaceId, MeshError, Point, PolygonMesh, Refinement, StencilTable, large_vec};

/// Half-edges that one task takes.
const PER_TASK: usize = 2048;

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
    /// One stencil per face: its centroid, which lies on the limit surface.
    pub positions: StencilTable,
    /// Two stencils per face, that add up to 0: limit tangents t1 and t2 with the normal along t1 x t2.
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
    /// The vertices that give a face.
    vertices: Vec<u32>,
    /// How many corners the faces around these have.
    valences: Vec<u32>,
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
    /// ```
    /// use subzero::{DooSabinWeights, Features, PolygonMesh};
    ///
    /// let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]].map(Vec::from);
    /// let cube = PolygonMesh::new(8, &faces, &Features::default())?;
    /// // A face for each face, each edge and each vertex.
    /// let finer = cube.doo_sabin_refine(DooSabinWeights::DooSabin)?.mesh;
    /// assert_eq!((finer.vertex_count(), finer.face_count()), (24, 6 + 12 + 8));
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::ValenceTwo`] names an inner vertex with two edges, whose face would have two corners;
    /// [`MeshError::TooLarge`] if the finer mesh outgrows 32-bit ids.
    pub fn doo_sabin_refine(&self, weights: DooSabinWeights) -> Result<Refinement<Self>, MeshError> {
        let masks = self.doo_sabin_masks(weights);
        let stencils = StencilTable::from_stencils(self.corners.len(), |h, stencil| {
            self.doo_sabin_stencil(h, &masks).for_each(|(corner, weight)| stencil.add(corner, weight));
        });
        Ok(Refinement { mesh: self.doo_sabin_connectivity()?, stencils })
    }

    /// The points one level on: bit for bit what the stencils of [`doo_sabin_refine`](Self::doo_sabin_refine) make of `points`, without the
    /// memory that these take.
    ///
    /// # Panics
    /// If `points` has fewer points than the mesh has vertices.
    pub fn doo_sabin_step<P: Point>(&self, points: &[P], weights: DooSabinWeights) -> Vec<P> {
        let masks = self.doo_sabin_masks(weights);
        let mut refined = large_vec::zeros(self.corners.len());
        refined.par_iter_mut().with_min_len(PER_TASK).enumerate().for_each(|(h, new)| {
            *new = self
                .doo_sabin_stencil(id(h), &masks)
                .fold(P::zero(), |sum, (corner, weight)| sum.add_scaled(points[corner as usize], weight));
        });
        refined
    }

    /// By number of corners of a face, as far as the mesh has such: the weights of a corner and of those after it.
    fn doo_sabin_masks(&self, weights: DooSabinWeights) -> Vec<Vec<f64>> {
        let mut masks: Vec<Vec<f64>> = Vec::new();
        for starts in self.face_starts.windows(2) {
            let corners = (starts[1] - starts[0]) as usize;
            if corners >= masks.len() {
                masks.resize(corners + 1, Vec::new());
            }
            if masks[corners].is_empty() {
                masks[corners] = (0..corners).map(|offset| weights.of_corner(offset, corners)).collect();
            }
        }
        masks
    }

    /// The corners of the face of a half-edge, and what each of them counts at the half-edge's new vertex.
    #[inline]
    fn doo_sabin_stencil(&self, h: u32, masks: &[Vec<f64>]) -> impl Iterator<Item = (u32, f64)> {
        let face = self.faces_of[h as usize];
        let own = (h - self.face_starts[face as usize]) as usize;
        let corners = self.face(FaceId(face));
        let (from_own, before_own) = masks[corners.len()].split_at(corners.len() - own);
        corners.iter().copied().zip(before_own.iter().chain(from_own).copied())
    }

    /// Limit points and tangents at the centres of all faces; the same for both kinds of weights.
    pub fn doo_sabin_limits(&self) -> DooSabinLimits {
        let positions = StencilTable::from_stencils(self.face_count(), |face, stencil| {
            let corners = self.face(FaceId(face));
            corners.iter().for_each(|&corner| stencil.add(corner, 1.0 / real(corners.len())));
        });
        let tangents = StencilTable::from_stencils(2 * self.face_count(), |tangent, stencil| {
            let corners = self.face(FaceId(tangent / 2));
            for (i, &corner) in corners.iter().enumerate() {
                let angle = TAU * real(i) / real(corners.len());
                stencil.add(corner, if tangent % 2 == 0 { angle.cos() } else { angle.sin() });
            }
        });
        DooSabinLimits { positions, tangents }
    }

    /// The mesh of [`doo_sabin_refine`](Self::doo_sabin_refine) alone; its points follow apart, by [`doo_sabin_step`](Self::doo_sabin_step).
    ///
    /// # Errors
    /// As of [`doo_sabin_refine`](Self::doo_sabin_refine).
    pub fn doo_sabin_connectivity(&self) -> Result<Self, MeshError> {
        check_size("half-edges", self.corners.len().saturating_mul(8))?;
        let new = self.doo_sabin_faces()?;
        let half_edges = id(self.corners.len());
        let first_around = half_edges + 4 * id(new.edges.len());
        let side = |h: u32| self.directed_edges[h as usize] % 2;
        let rank = |h: u32| new.edge_ranks[(self.directed_edges[h as usize] / 2) as usize];
        let is_around = |h: u32| new.around_vertex[self.start(h) as usize];
        // Across the start of half-edge h runs an edge from the vertex of the half-edge clockwise before h to that of h:
        // along the face around the start, against the face across the edge of h.
        let across = |h: u32| half_edges + 2 * rank(h) + side(h);
        // Where, in the face across the edge of h, the edge inside the face of h runs; the edge across the start of h follows.
        let in_quad = |h: u32| half_edges + 4 * rank(h) + 2 * side(h);

        let around: Vec<u32> =
            new.vertices.par_iter().flat_map_iter(|&v| self.ring(self.outgoing[v as usize])).collect();
        let places: Vec<AtomicU32> = self.corners.par_iter().map(|_| AtomicU32::new(NONE)).collect();
        // Each half-edge leaves one vertex, so that no two tasks write to one place.
        (0..id(around.len())).into_par_iter().for_each(|place| {
            places[around[place as usize] as usize].store(first_around + place, Ordering::Relaxed);
        });

        let inner = || new.edges.par_iter().flat_map_iter(|&edge| self.edges[edge as usize]);
        let quads = inner().flat_map_iter(|h| [self.next(h), h]);
        let quad_edges = inner().flat_map_iter(|h| [2 * h + 1, 2 * across(h) + u32::from(is_around(h))]);
        let around_edges = around.par_iter().map(|&h| 2 * across(self.twin(self.prev(h))));
        let inside_edges = (0..half_edges)
            .into_par_iter()
            .map(|h| [h, if self.twin(h) == NONE { NONE } else { in_quad(h) }]);
        let across_edges = inner().map(|h| {
            if is_around(h) {
                let clockwise = self.next(self.twin(h));
                [places[clockwise as usize].load(Ordering::Relaxed), in_quad(h) + 1]
            } else {
                [in_quad(h) + 1, NONE]
            }
        });

        let mut face_starts = self.face_starts.clone();
        face_starts.extend((1..=id(new.edges.len())).map(|rank| half_edges + 4 * rank));
        face_starts.extend(new.valences.iter().scan(first_around, |end, valence| {
            *end += valence;
            Some(*end)
        }));
        Ok(Self::with_open_boundary(
            face_starts,
            (0..half_edges).into_par_iter().chain(quads).chain(around.par_iter().copied()).collect(),
            (0..half_edges).into_par_iter().map(|h| 2 * h).chain(quad_edges).chain(around_edges).collect(),
            inside_edges.chain(across_edges).collect(),
            half_edges,
        ))
    }

    fn doo_sabin_faces(&self) -> Result<NewFaces, MeshError> {
        let mut around_vertex: Vec<bool> = self.outgoing.iter().map(|&h| h != NONE).collect();
        let mut edges = Vec::new();
        let mut edge_ranks = Vec::with_capacity(self.edge_count());
        for edge in 0..id(self.edge_count()) {
            edge_ranks.push(id(edges.len()));
            if self.is_boundary(EdgeId(edge)) {
                self.edge(EdgeId(edge)).into_iter().for_each(|end| around_vertex[end as usize] = false);
            } else {
                edges.push(edge);
            }
        }
        let vertices: Vec<u32> =
            (0..id(self.vertex_count())).filter(|&v| around_vertex[v as usize]).collect();
        let valences: Vec<u32> =
            vertices.par_iter().map(|&v| id(self.ring(self.outgoing[v as usize]).count())).collect();
        match valences.iter().position(|&valence| valence == 2) {
            Some(place) => Err(MeshError::ValenceTwo { vertex: vertices[place] }),
            None => Ok(NewFaces { edges, edge_ranks, around_vertex, vertices, valences }),
        }
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
