//! Where the points of a mesh end up on Loop's limit surface, and its normals there.

use glam::DVec3;
use rayon::prelude::*;

use crate::ids::{next, prev};
use crate::limit_masks::{
    RingMask, corner_tangents, crease_tangents, dart_position, dart_tangents, smooth_position,
    smooth_tangents,
};
use crate::stencil::StencilWriter;
use crate::{LoopWeights, MeshError, Point, Refinement, StencilTable, TriangleMesh, VertexRule};

/// A piece of the surface around a vertex that has one tangent plane: all of it at a smooth vertex or a dart, and what
/// lies between two neighbouring creases elsewhere, so one piece at a boundary and three at most triple lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sector {
    /// The vertex.
    pub vertex: u32,
    /// The first half-edge, counter-clockwise; it lies on a crease unless the sector goes all round.
    pub(crate) first: u32,
}

/// Limit positions and tangents of all vertices of a mesh, as averages of its points.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopLimits {
    /// One stencil per vertex: its limit position.
    pub positions: StencilTable,
    /// All sectors, sorted by vertex.
    pub sectors: Vec<Sector>,
    /// Per sector two stencils, that add up to 0: limit tangents t1 and t2 with the normal along t1 x t2. The stencils are empty where the
    /// surface has no tangent plane.
    pub tangents: StencilTable,
}

impl TriangleMesh {
    /// Limit positions and tangents of the scheme that [`loop_refine_with`](Self::loop_refine_with) iterates.
    ///
    /// Corners have a tangent plane only in sectors of at most three triangles; more make a cone. At boundaries and creases
    /// with sectors of six and more triangles the normals given are those of the dominant eigenvectors.
    ///
    /// # Errors
    /// [`MeshError::SemiSharp`] names a vertex with a sharpness that will run out: refine until it has. [`MeshError::TooLarge`] if the next level,
    /// which the weights of Biermann, Levin and Zorin need, outgrows 32-bit ids.
    pub fn loop_limits(&self, weights: LoopWeights) -> Result<LoopLimits, MeshError> {
        self.sharpness.check_settled()?;
        let sectors = self.sectors();
        let [positions, tangents] = if weights == LoopWeights::BiermannLevinZorin {
            // An edge's weights depend on both ends here. One level on, old vertices have regular neighbours only.
            let Refinement { mesh: finer, stencils } = self.loop_refine_with(weights)?;
            let children =
                sectors.iter().map(|&Sector { vertex, first }| Sector { vertex, first: 3 * first });
            let children: Vec<Sector> = children.collect();
            finer.limit_stencils(self.vertex_count(), &children, weights).map(|table| stencils.then(&table))
        } else {
            self.limit_stencils(self.vertex_count(), &sectors, weights)
        };
        Ok(LoopLimits { positions, sectors, tangents })
    }

    /// The limit positions of the first vertices, and the tangents of the sectors, where edges have regular rules.
    fn limit_stencils(
        &self,
        vertex_count: usize,
        sectors: &[Sector],
        weights: LoopWeights,
    ) -> [StencilTable; 2] {
        let positions =
            StencilTable::from_stencils(vertex_count, |vertex, stencil| match self.vertex_rule(vertex) {
                VertexRule::Smooth => {
                    let ring = self.closed_ring(self.outgoing[vertex as usize]);
                    add_stencil(stencil, vertex, &ring, &smooth_position(ring.len(), weights));
                }
                VertexRule::Dart => {
                    let ring = self.closed_ring(self.dart_start(vertex));
                    add_stencil(stencil, vertex, &ring, &dart_position(ring.len(), weights));
                }
                VertexRule::Crease => {
                    stencil.add(vertex, 4.0 / 6.0);
                    for outgoing_edge in self.sharpness.outgoing_edges(vertex) {
                        stencil.add(self.other_end(outgoing_edge.edge, vertex), 1.0 / 6.0);
                    }
                }
                VertexRule::Corner => stencil.add(vertex, 1.0),
            });
        let tangents = StencilTable::from_stencils(2 * sectors.len(), |i, stencil| {
            let sector = sectors[(i / 2) as usize];
            let ring = self.sector_ring(sector);
            let masks = match self.vertex_rule(sector.vertex) {
                VertexRule::Smooth => smooth_tangents(ring.len()),
                VertexRule::Dart => dart_tangents(ring.len(), weights),
                VertexRule::Crease => crease_tangents(ring.len(), weights),
                // The creases decide, unless the inner edges shrink more slowly than they do.
                VertexRule::Corner if ring.len() <= 4 => corner_tangents(ring.len()),
                VertexRule::Corner => return,
            };
            add_stencil(stencil, sector.vertex, &ring, &masks[(i % 2) as usize]);
        });
        [positions, tangents]
    }

    /// The neighbours that bound or lie in a sector, counter-clockwise.
    ///
    /// # Panics
    /// If the sector is another mesh's.
    pub fn sector_ring(&self, sector: Sector) -> Vec<u32> {
        match self.vertex_rule(sector.vertex) {
            VertexRule::Smooth | VertexRule::Dart => self.closed_ring(sector.first),
            _ => self.open_ring(sector.first),
        }
    }

    fn sectors(&self) -> Vec<Sector> {
        let at_crease = |h: u32| {
            let vertex = self.start(h);
            let between_creases = matches!(self.vertex_rule(vertex), VertexRule::Crease | VertexRule::Corner);
            (between_creases && self.is_crease(self.edge_of(h))).then_some(Sector { vertex, first: h })
        };
        let all_round = |vertex: u32| match self.vertex_rule(vertex) {
            VertexRule::Smooth => Some(Sector { vertex, first: self.outgoing[vertex as usize] }),
            VertexRule::Dart => Some(Sector { vertex, first: self.dart_start(vertex) }),
            _ => None,
        };
        let counts = self.counts();
        let mut sectors: Vec<Sector> = (0..counts.vertices).into_par_iter().filter_map(all_round).collect();
        sectors.par_extend((0..3 * counts.triangles).into_par_iter().filter_map(at_crease));
        sectors.par_sort_unstable_by_key(|sector| (sector.vertex, sector.first));
        sectors
    }

    /// The half-edge of a dart's sharp edge that starts at the dart.
    fn dart_start(&self, vertex: u32) -> u32 {
        let on_crease = |&h: &u32| self.is_crease(self.edge_of(h));
        let first = self.outgoing[vertex as usize];
        self.ring(first).find(on_crease).unwrap_or(first)
    }

    /// The neighbours all round a vertex, from the end of the half-edge `first` on.
    fn closed_ring(&self, first: u32) -> Vec<u32> {
        self.ring(first).map(|h| self.start(next(h))).collect()
    }

    /// The neighbours from the end of the half-edge `first` to the next crease.
    fn open_ring(&self, first: u32) -> Vec<u32> {
        let mut ring = vec![self.start(next(first))];
        ring.extend(self.sector(first).map(|h| self.start(prev(h))));
        ring
    }
}

impl LoopLimits {
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

    /// The points moved to their limit positions.
    ///
    /// ```
    /// use glam::DVec3;
    /// use subzero::{Features, LoopWeights, TriangleMesh};
    ///
    /// let triangles = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    /// let points = [DVec3::ONE, DVec3::new(-1., 1., -1.), DVec3::new(1., -1., -1.), DVec3::new(-1., -1., 1.)];
    /// let mesh = TriangleMesh::new(4, triangles, &Features::default())?;
    /// let on_surface = mesh.loop_limits(LoopWeights::Loop)?.project(&points);
    /// assert!(on_surface.iter().zip(&points).all(|(limit, control)| limit.length() < control.length()));
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Panics
    /// If `points` has fewer points than the mesh has vertices.
    pub fn project<P: Point>(&self, points: &[P]) -> Vec<P> {
        self.positions.apply(points)
    }
}

/// Of the normals of all sectors, those of vertices with one sector.
pub(crate) fn normals_of_vertices(
    vertex_count: usize,
    sectors: &[Sector],
    normals: &[Option<DVec3>],
) -> Vec<Option<DVec3>> {
    let mut of_vertices = vec![None; vertex_count];
    let mut first = 0;
    for sectors in sectors.chunk_by(|a, b| a.vertex == b.vertex) {
        if sectors.len() == 1 {
            of_vertices[sectors[0].vertex as usize] = normals[first];
        }
        first += sectors.len();
    }
    of_vertices
}

fn add_stencil(stencil: &mut StencilWriter, vertex: u32, ring: &[u32], mask: &RingMask) {
    stencil.add(vertex, mask.centre);
    for (&neighbour, &weight) in ring.iter().zip(&mask.ring).filter(|&(_, &weight)| weight != 0.0) {
        stencil.add(neighbour, weight);
    }
}
