//! Limits of the Catmull-Clark scheme: positions, and tangents in every sector of every vertex.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use rayon::prelude::*;

use crate::catmull_clark::real;
use crate::ids::id;
use crate::loop_limit::normals_of_vertices;
use crate::stencil::StencilWriter;
use crate::{EdgeId, MeshError, PolygonMesh, Refinement, Sector, StencilTable, VertexRule};

/// Limit positions and tangents of a Catmull-Clark surface at the vertices of a mesh, as averages of its points.
#[derive(Clone, Debug, PartialEq)]
pub struct CatmullClarkLimits {
    /// One stencil per vertex: its limit position.
    pub positions: StencilTable,
    /// All sectors, sorted by vertex.
    pub sectors: Vec<Sector>,
    /// Per sector two stencils, that add up to 0: limit tangents t1 and t2 with the normal along t1 x t2. The stencils are empty
    /// where the surface has no tangent plane.
    pub tangents: StencilTable,
}

/// Weights around a vertex among four-sided faces, from an edge on counter-clockwise.
struct QuadMask {
    centre: f64,
    /// Of the other end of each edge.
    edges: Vec<f64>,
    /// Of the corner opposite in the face after each edge.
    faces: Vec<f64>,
}

impl PolygonMesh {
    /// Limit positions of all vertices, and limit tangents of all sectors.
    ///
    /// Corners have a tangent plane only in sectors of a single face; more make a cone.
    ///
    /// ```
    /// use glam::DVec3;
    /// use subzero::{Features, PolygonMesh};
    ///
    /// let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]].map(Vec::from);
    /// let points = [[-1., -1., -1.], [1., -1., -1.], [1., 1., -1.], [-1., 1., -1.], [-1., -1., 1.], [1., -1., 1.], [1., 1., 1.], [-1., 1., 1.]];
    /// let points = points.map(DVec3::from);
    /// let limits = PolygonMesh::new(8, &faces, &Features::default())?.catmull_clark_limits()?;
    /// let on_surface = limits.positions.apply(&points);
    /// assert!((on_surface[6] - DVec3::splat(0.5)).length() < 1e-12);
    /// assert!((limits.vertex_normals(&points)[6].expect("smooth") - DVec3::ONE.normalize()).length() < 1e-12);
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::SemiSharp`] names a vertex with a sharpness that will run out: refine until it has. [`MeshError::TooLarge`] if the next level
    /// outgrows 32-bit ids.
    pub fn catmull_clark_limits(&self) -> Result<CatmullClarkLimits, MeshError> {
        self.sharpness.check_settled()?;
        // The masks are known where all faces have four corners, as they do one level on.
        let Refinement { mesh: quads, stencils } = self.catmull_clark_refine()?;
        let positions =
            StencilTable::from_stencils(self.vertex_count(), |v, stencil| quads.limit_position(v, stencil));
        let sectors = self.sectors();
        let tangents = StencilTable::from_stencils(2 * sectors.len(), |i, stencil| {
            let Sector { vertex, first } = sectors[(i / 2) as usize];
            quads.limit_tangent(vertex, 4 * first, (i % 2) as usize, stencil);
        });
        Ok(CatmullClarkLimits {
            positions: stencils.then(&positions),
            sectors,
            tangents: stencils.then(&tangents),
        })
    }

    fn is_infinite_crease(&self, h: u32) -> bool {
        self.is_crease(EdgeId(self.directed_edges[h as usize] / 2))
    }

    fn sectors(&self) -> Vec<Sector> {
        let all_round = (0..id(self.vertex_count())).filter_map(|vertex| {
            let first = self.outgoing[vertex as usize];
            match self.vertex_rule(vertex) {
                VertexRule::Smooth => Some(Sector { vertex, first }),
                VertexRule::Dart => Some(Sector { vertex, first: self.dart_start(vertex) }),
                VertexRule::Crease | VertexRule::Corner => None,
            }
        });
        let at_creases = (0..id(self.corners.len())).filter_map(|h| {
            let vertex = self.start(h);
            let is_sharp = matches!(self.vertex_rule(vertex), VertexRule::Crease | VertexRule::Corner);
            (is_sharp && self.is_infinite_crease(h)).then_some(Sector { vertex, first: h })
        });
        let mut sectors: Vec<Sector> = all_round.chain(at_creases).collect();
        sectors.sort_unstable_by_key(|sector| (sector.vertex, sector.first));
        sectors
    }

    /// The half-edge of a dart's sharp edge that starts at the dart.
    fn dart_start(&self, vertex: u32) -> u32 {
        let first = self.outgoing[vertex as usize];
        self.ring(first).find(|&h| self.is_infinite_crease(h)).unwrap_or(first)
    }

    /// The vertices that bound or lie in a sector of [`catmull_clark_limits`](Self::catmull_clark_limits), counter-clockwise.
    ///
    /// # Panics
    /// If the sector is another mesh's.
    pub fn sector_ring(&self, sector: Sector) -> Vec<u32> {
        if matches!(self.vertex_rule(sector.vertex), VertexRule::Smooth | VertexRule::Dart) {
            return self.ring(sector.first).map(|h| self.end(h)).collect();
        }
        let half_edges = self.sector(sector.first);
        let last = half_edges.last().map(|&last| self.start(self.prev(last)));
        half_edges.iter().map(|&h| self.end(h)).chain(last).collect()
    }

    /// The half-edges that start where `first` starts, one per face up to the next crease.
    fn sector(&self, first: u32) -> Vec<u32> {
        let after = |&h: &u32| {
            let before = self.prev(h);
            if self.is_infinite_crease(before) {
                None
            } else {
                Some(self.twin(before)).filter(|&h| h != first)
            }
        };
        std::iter::successors(Some(first), after).collect()
    }

    /// The limit position of a vertex among four-sided faces.
    fn limit_position(&self, vertex: u32, stencil: &mut StencilWriter) {
        let first = self.outgoing[vertex as usize];
        match self.vertex_rule(vertex) {
            VertexRule::Corner => stencil.add(vertex, 1.0),
            VertexRule::Crease => {
                stencil.add(vertex, 4.0 / 6.0);
                for outgoing_edge in self.sharpness.outgoing_edges(vertex) {
                    stencil.add(self.other_end(outgoing_edge.edge, vertex), 1.0 / 6.0);
                }
            }
            VertexRule::Smooth => {
                let ring: Vec<u32> = self.ring(first).collect();
                let n = real(ring.len());
                let scale = 1.0 / (n * (n + 5.0));
                let [edges, faces] = [4.0, 1.0].map(|weight| vec![weight * scale; ring.len()]);
                self.add_mask(vertex, &ring, &QuadMask { centre: n / (n + 5.0), edges, faces }, stencil);
            }
            VertexRule::Dart => {
                let ring: Vec<u32> = self.ring(self.dart_start(vertex)).collect();
                self.add_mask(vertex, &ring, &dart_position(ring.len()), stencil);
            }
        }
    }

    /// A limit tangent of a sector among four-sided faces.
    fn limit_tangent(&self, vertex: u32, first: u32, which: usize, stencil: &mut StencilWriter) {
        let (ring, masks) = match self.vertex_rule(vertex) {
            VertexRule::Smooth => {
                let ring: Vec<u32> = self.ring(first).collect();
                let masks = smooth_tangents(ring.len());
                (ring, masks)
            }
            VertexRule::Dart => {
                let ring: Vec<u32> = self.ring(first).collect();
                let [_, across] = smooth_tangents(ring.len());
                let along = dart_along(ring.len());
                (ring, [along, across])
            }
            rule => {
                let sector = self.sector(first);
                let masks = match rule {
                    VertexRule::Crease => crease_tangents(sector.len()),
                    // Inner edges shrink no faster than the creases do.
                    _ if sector.len() == 1 => corner_tangents(),
                    _ => return,
                };
                (sector, masks)
            }
        };
        self.add_mask(vertex, &ring, &masks[which], stencil);
    }

    /// Adds a mask; one edge more than faces belongs to an open sector.
    fn add_mask(&self, vertex: u32, ring: &[u32], mask: &QuadMask, stencil: &mut StencilWriter) {
        let mut add = |point: u32, weight: f64| {
            if weight != 0.0 {
                stencil.add(point, weight);
            }
        };
        add(vertex, mask.centre);
        for ((&h, &edge), &face) in ring.iter().zip(&mask.edges).zip(&mask.faces) {
            add(self.end(h), edge);
            add(self.start(self.prev(self.prev(h))), face);
        }
        if let (Some(&last), Some(&weight)) = (ring.last(), mask.edges.get(ring.len())) {
            add(self.start(self.prev(last)), weight);
        }
    }
}

/// Tangents of a smooth vertex, a right angle apart; the first points along edge 0.
fn smooth_tangents(valence: usize) -> [QuadMask; 2] {
    let n = real(valence);
    let edge_weight = 1.0 + (TAU / n).cos() + (PI / n).cos() * (2.0 * (9.0 + (TAU / n).cos())).sqrt();
    [f64::cos, f64::sin].map(|wave| {
        let at = |i: usize| wave(TAU * real(i) / n);
        QuadMask {
            centre: 0.0,
            edges: (0..valence).map(|i| edge_weight * at(i)).collect(),
            faces: (0..valence).map(|i| at(i) + at(i + 1)).collect(),
        }
    })
}

/// Tangents in a sector of so many faces between two creases that are smooth at the vertex: along the crease at edge 0, and into
/// the sector. Both are exact left eigenvectors of the rules; the second has the eigenvalue (5 + c + sqrt((1 + c)(9 + c)))/16
/// with c the cosine of pi/faces.
fn crease_tangents(faces: usize) -> [QuadMask; 2] {
    let mut along = QuadMask { centre: 0.0, edges: vec![0.0; faces + 1], faces: vec![0.0; faces] };
    along.edges[0] = 1.0;
    along.edges[faces] = -1.0;
    if faces == 1 {
        let across = QuadMask { centre: -2.0, edges: vec![1.0, 1.0], faces: vec![0.0] };
        return [along, across];
    }
    let angle = PI / real(faces);
    let cosine = angle.cos();
    let root = ((1.0 + cosine) * (9.0 + cosine)).sqrt();
    let eigenvalue = (5.0 + cosine + root) / 16.0;
    let edge_weight = 1.0 + cosine + root;
    let at = |i: usize| (angle * real(i)).sin();
    // What the inner edges and the faces weigh together, and what they give to the crease's neighbour.
    let inside = (edge_weight + 2.0) / (angle / 2.0).tan();
    let given = (edge_weight / 16.0 + 0.25) * angle.sin();
    let end = (given - inside / 8.0) / (eigenvalue - 0.25);
    let mut edges: Vec<f64> = (0..=faces).map(|i| edge_weight * at(i)).collect();
    edges[0] = end;
    edges[faces] = end;
    let across = QuadMask {
        centre: -inside - 2.0 * end,
        edges,
        faces: (0..faces).map(|i| at(i) + at(i + 1)).collect(),
    };
    [along, across]
}

/// Tangents in a sector of a corner with a single face, along its two creases.
fn corner_tangents() -> [QuadMask; 2] {
    [vec![1.0, 0.0], vec![0.0, 1.0]].map(|edges| QuadMask { centre: -1.0, edges, faces: vec![0.0] })
}

/// Steps at most of the iterations at darts. Each shrinks the error by a third at least at valences up to 6, and by less
/// where there are more edges; rounding stops it earlier.
const DART_ITERATIONS: usize = 20_000;

/// Limit position of a dart, whose sharp edge is edge 0: the left eigenvector of its rules for the eigenvalue 1, found by iteration.
fn dart_position(valence: usize) -> QuadMask {
    let total = 2.0 * real(valence) + 1.0;
    let mut weights = vec![1.0 / total; 2 * valence + 1];
    iterate_dart(&mut weights, |_| ());
    quad_mask(&weights)
}

/// Limit tangent of a dart along its sharp edge, edge 0: the left eigenvector that is symmetric to this edge and has the second
/// largest eigenvalue, found by iteration.
fn dart_along(valence: usize) -> QuadMask {
    let QuadMask { centre, edges, faces } = dart_position(valence);
    let mut position = vec![centre];
    position.extend(edges.into_iter().zip(faces).flat_map(|(edge, face)| [edge, face]));
    let step = TAU / real(valence);
    let mut weights = vec![0.0];
    weights.extend((0..valence).flat_map(|i| [real(i), real(i) + 0.5].map(|i| (step * i).cos())));
    iterate_dart(&mut weights, |weights| {
        // What is left of the position does not shrink, and would win; so might what rounding adds that is not symmetric.
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().zip(&position).for_each(|(weight, position)| *weight -= sum * position);
        let ring = &weights[2..];
        let mirrored: Vec<f64> = ring.iter().zip(ring.iter().rev()).map(|(a, b)| 0.5 * (a + b)).collect();
        weights[2..].copy_from_slice(&mirrored);
        let largest = weights.iter().fold(0.0_f64, |largest, weight| largest.max(weight.abs()));
        weights.iter_mut().for_each(|weight| *weight /= largest);
    });
    quad_mask(&weights)
}

/// Weights of the centre, then of each edge's end and the face corner after it, as a mask.
fn quad_mask(weights: &[f64]) -> QuadMask {
    let (edges, faces) = weights[1..].chunks_exact(2).map(|pair| (pair[0], pair[1])).unzip();
    QuadMask { centre: weights[0], edges, faces }
}

/// Applies the transposed rules of a dart until the weights stay the same; `normalise` acts after each step.
fn iterate_dart(weights: &mut Vec<f64>, normalise: impl Fn(&mut [f64])) {
    for _ in 0..DART_ITERATIONS {
        let mut next = transposed_dart_rules(weights);
        normalise(&mut next);
        let change = next.iter().zip(&*weights).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        *weights = next;
        // Weights are 1 at most: less than this is rounding.
        if change <= 2.0 * f64::EPSILON {
            break;
        }
    }
}

/// The weights one level up that average the same as `weights` of what a dart's rules make: of the centre, then of each edge's end and
/// the face corner after it, from the sharp edge on.
fn transposed_dart_rules(weights: &[f64]) -> Vec<f64> {
    let valence = weights.len() / 2;
    let n = real(valence);
    let mut next = vec![0.0; weights.len()];
    // The new centre has a face point and an edge in each direction.
    next[0] += weights[0] * (1.0 - 7.0 / (4.0 * n));
    for i in 0..valence {
        let [edge, face] = [1 + 2 * i, 2 + 2 * i];
        let [edge_after, face_before] = [1 + 2 * ((i + 1) % valence), 2 + 2 * ((i + valence - 1) % valence)];
        next[edge] += weights[0] * 3.0 / (2.0 * n * n);
        next[face] += weights[0] / (4.0 * n * n);
        // The new face points.
        for corner in [0, edge, face, edge_after] {
            next[corner] += weights[face] / 4.0;
        }
        // The new edge points; edge 0 is sharp.
        if i == 0 {
            next[0] += weights[edge] / 2.0;
            next[edge] += weights[edge] / 2.0;
        } else {
            next[0] += weights[edge] * 3.0 / 8.0;
            next[edge] += weights[edge] * 3.0 / 8.0;
            let edge_before = 1 + 2 * (i - 1);
            for corner in [face, face_before, edge_before, edge_after] {
                next[corner] += weights[edge] / 16.0;
            }
        }
    }
    next
}

impl CatmullClarkLimits {
    /// The unit normals of all sectors; nothing where the surface has no tangent plane or the points are degenerate.
    ///
    /// # Panics
    /// If `points` has fewer points than the mesh has vertices.
    pub fn sector_normals(&self, points: &[DVec3]) -> Vec<Option<DVec3>> {
        let tangents = self.tangents.apply(points);
        tangents.par_chunks_exact(2).map(|t| t[0].cross(t[1]).try_normalize()).collect()
    }

    /// The unit normal at each vertex; nothing where there is no normal or more than one.
    ///
    /// # Panics
    /// If `points` has fewer points than the mesh has vertices.
    pub fn vertex_normals(&self, points: &[DVec3]) -> Vec<Option<DVec3>> {
        normals_of_vertices(self.positions.len(), &self.sectors, &self.sector_normals(points))
    }
}
