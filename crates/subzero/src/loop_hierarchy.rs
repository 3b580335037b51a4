//! A mesh refined several times by Loop's scheme.

use crate::base_rings::BaseRings;
use crate::large_vec;
use crate::{FaceId, LoopWeights, MeshError, Point, StencilTable, TriangleMesh};

/// A mesh and what Loop's scheme makes of it over several levels: topology once, points again and again.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopHierarchy {
    /// The meshes, coarsest first.
    levels: Vec<TriangleMesh>,
    /// Rings of the coarsest.
    rings: BaseRings,
    weights: LoopWeights,
}

impl TriangleMesh {
    /// The triangles and points of the mesh refined `levels` times by Loop's scheme. Takes half of the time and memory of a
    /// [`LoopHierarchy`], which also knows the edges of the finest mesh and keeps all levels for points that change.
    ///
    /// ```
    /// use glam::DVec3;
    /// use subzero::{Features, LoopWeights, TriangleMesh};
    ///
    /// let triangles = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    /// let points = [DVec3::ONE, DVec3::new(-1., 1., -1.), DVec3::new(1., -1., -1.), DVec3::new(-1., -1., 1.)];
    /// let mesh = TriangleMesh::new(4, triangles, &Features::default())?;
    /// let (triangles, points) = mesh.loop_subdivide(&points, 3, LoopWeights::Loop)?;
    /// assert_eq!(triangles.len(), 4 * 64);
    /// assert_eq!(points.len(), triangles.len() / 2 + 2);
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the finest mesh outgrows 32-bit ids; [`MeshCounts::refined`](crate::MeshCounts::refined) tells beforehand.
    ///
    /// # Panics
    /// If there is not one point per vertex.
    pub fn loop_subdivide<P: Point>(
        self,
        points: &[P],
        levels: usize,
        weights: LoopWeights,
    ) -> Result<(Vec<[u32; 3]>, Vec<P>), MeshError> {
        assert_eq!(points.len(), self.vertex_count(), "there must be one point per vertex");
        let Some(last) = levels.checked_sub(1) else { return Ok((self.triangles, points.to_vec())) };
        let rings = BaseRings::new(&self, weights);
        let mut ancestors = Vec::with_capacity(levels);
        let mut mesh = self;
        let mut points = points.to_vec();
        for level in 0..levels {
            mesh.counts().refined()?;
            let mut refined = large_vec::zeros(mesh.vertex_count() + mesh.edge_count());
            mesh.loop_points(&ancestors, &rings, &points, weights, &mut refined);
            points = refined;
            if level < last {
                let finer = mesh.refine_connectivity()?;
                ancestors.push(std::mem::replace(&mut mesh, finer));
            }
        }
        Ok((mesh.refined_triangles(), points))
    }
}

impl LoopHierarchy {
    /// Refines `mesh` so many times.
    ///
    /// ```
    /// use glam::DVec3;
    /// use subzero::{Features, LoopHierarchy, LoopWeights, TriangleMesh};
    ///
    /// let triangles = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    /// let points = [DVec3::ONE, DVec3::new(-1., 1., -1.), DVec3::new(1., -1., -1.), DVec3::new(-1., -1., 1.)];
    /// let mesh = TriangleMesh::new(4, triangles, &Features::default())?;
    /// let levels = LoopHierarchy::new(mesh, 3, LoopWeights::Loop)?;
    /// assert_eq!(levels.finest().triangles().len(), 4 * 64);
    /// // Connectivity is refined once; new control points cost one call.
    /// assert_eq!(levels.apply(&points).len(), levels.finest().vertex_count());
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the finest mesh outgrows 32-bit ids; [`MeshCounts::refined`](crate::MeshCounts::refined) tells beforehand.
    pub fn new(mesh: TriangleMesh, levels: usize, weights: LoopWeights) -> Result<Self, MeshError> {
        let rings = BaseRings::new(&mesh, weights);
        let mut meshes = vec![mesh];
        for level in 0..levels {
            meshes.push(meshes[level].refine_connectivity()?);
        }
        Ok(Self { levels: meshes, rings, weights })
    }

    /// The meshes, from the one given to the finest.
    pub fn meshes(&self) -> &[TriangleMesh] {
        &self.levels
    }

    /// The finest mesh.
    pub fn finest(&self) -> &TriangleMesh {
        &self.levels[self.levels.len() - 1]
    }

    /// The level at which a vertex of the finest mesh was born, 0 for control points.
    pub fn generation(&self, vertex: u32) -> usize {
        self.levels.partition_point(|mesh| mesh.vertex_count() <= vertex as usize)
    }

    /// The triangle of the coarsest mesh in which a triangle of the finest lies.
    pub fn ancestor(&self, triangle: FaceId) -> FaceId {
        let coarser = self.levels[..self.levels.len() - 1].iter().rev();
        coarser.fold(triangle, |triangle, mesh| mesh.counts().triangle_parent(triangle))
    }

    /// Room for the points of each level but the coarsest, as [`apply_into`](Self::apply_into) needs it.
    pub fn buffers<P: Point>(&self) -> Vec<Vec<P>> {
        self.levels[1..].iter().map(|mesh| large_vec::zeros(mesh.vertex_count())).collect()
    }

    /// Room for the points of one level more: points of a level need the connectivity of the one before alone, which saves most of the
    /// memory and the time.
    pub fn buffers_beyond<P: Point>(&self) -> Vec<Vec<P>> {
        let mut buffers = self.buffers();
        let finest = self.finest();
        buffers.push(large_vec::zeros(finest.vertex_count() + finest.edge_count()));
        buffers
    }

    /// Writes the points of each level that there is room for, from those of the coarsest, in parallel and without allocation. The result
    /// does not depend on the number of threads.
    ///
    /// # Panics
    /// If there are more buffers than [`buffers_beyond`](Self::buffers_beyond) has, or if `points` or one of them does not have one point per
    /// vertex of its level.
    pub fn apply_into<P: Point>(&self, points: &[P], levels: &mut [Vec<P>]) {
        for (level, mesh) in self.levels_of(levels).iter().enumerate() {
            let (coarser, finer) = levels.split_at_mut(level);
            let points = coarser.last().map_or(points, Vec::as_slice);
            mesh.loop_points(&self.levels[..level], &self.rings, points, self.weights, &mut finer[0]);
        }
    }

    /// The meshes whose refinements have room in some buffers.
    fn levels_of<P>(&self, buffers: &[Vec<P>]) -> &[TriangleMesh] {
        assert!(buffers.len() <= self.levels.len(), "there must be one buffer per refinement at most");
        &self.levels[..buffers.len()]
    }

    /// Writes again what depends on one control point, in levels that [`apply_into`](Self::apply_into) wrote: the points within two rings of
    /// triangles around it, as is the support of its basis function. Returns the vertices of the last level that lie there, in order.
    ///
    /// # Panics
    /// As of [`apply_into`](Self::apply_into).
    pub fn apply_around<P: Point>(&self, vertex: u32, points: &[P], levels: &mut [Vec<P>]) -> Vec<u32> {
        let mut written = vec![vertex];
        let mut region = self.levels[0].triangles_at(&self.levels[0].neighbourhood(vertex));
        for (level, mesh) in self.levels_of(levels).iter().enumerate() {
            let (coarser, finer) = levels.split_at_mut(level);
            let points = coarser.last().map_or(points, Vec::as_slice);
            written = mesh.points_of_triangles(&region, vertex, points, self.weights, &mut finer[0]);
            region =
                region.into_iter().flat_map(|triangle| mesh.counts().triangle_children(triangle)).collect();
        }
        written
    }

    /// The points of the finest level.
    ///
    /// # Panics
    /// If there is not one point per vertex of the coarsest mesh.
    pub fn apply<P: Point>(&self, points: &[P]) -> Vec<P> {
        let mut levels = self.buffers();
        self.apply_into(points, &mut levels);
        levels.pop().unwrap_or_else(|| points.to_vec())
    }

    /// One table that takes points of the coarsest mesh to the finest: One stencil per vertex of the finest.
    pub fn stencils(&self) -> StencilTable {
        let identity = StencilTable::identity(self.levels[0].vertex_count());
        let coarser = &self.levels[..self.levels.len() - 1];
        coarser.iter().fold(identity, |table, mesh| table.then(&mesh.loop_stencils(self.weights)))
    }
}
