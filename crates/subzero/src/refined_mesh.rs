//! What a mesh becomes when it is refined, without making it.

use rayon::prelude::*;

use crate::ids::{NONE, next, prev};
use crate::{EdgeId, FaceId, HalfEdgeId, MeshCounts, MeshError, RefinedTriangle, TriangleMesh, large_vec};

/// Triangles that one task makes.
const PER_TASK: usize = 4096;

/// A mesh refined up to twice, numbered as [`MeshCounts`] says: all of it follows from the mesh by arithmetic, in a sixteenth of the memory.
#[derive(Clone, Copy, Debug)]
pub struct RefinedMesh<'a> {
    mesh: &'a TriangleMesh,
    levels: usize,
}

impl<'a> From<&'a TriangleMesh> for RefinedMesh<'a> {
    /// The mesh as it is.
    fn from(mesh: &'a TriangleMesh) -> Self {
        Self { mesh, levels: 0 }
    }
}

impl<'a> RefinedMesh<'a> {
    /// Most levels.
    pub const MOST_LEVELS: usize = 2;

    /// The mesh refined so many times, which may be none.
    ///
    /// ```
    /// use subzero::{FaceId, Features, RefinedMesh, TriangleMesh};
    ///
    /// let triangles = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    /// let mesh = TriangleMesh::new(4, triangles, &Features::default())?;
    /// let refined = RefinedMesh::new(&mesh, 2)?;
    /// let made = mesh.refine_connectivity()?.refine_connectivity()?;
    /// assert_eq!(refined.counts(), made.counts());
    /// assert_eq!(refined.triangle(FaceId(17)), made.triangles()[17]);
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if it outgrows 32-bit ids.
    ///
    /// # Panics
    /// If there are more levels than [`MOST_LEVELS`](Self::MOST_LEVELS).
    pub fn new(mesh: &'a TriangleMesh, levels: usize) -> Result<Self, MeshError> {
        assert!(levels <= Self::MOST_LEVELS, "ids are known of {} levels at most", Self::MOST_LEVELS);
        (0..levels).try_fold(mesh.counts(), |counts, _| counts.refined())?;
        Ok(Self { mesh, levels })
    }

    /// The mesh that is refined.
    pub fn mesh(self) -> &'a TriangleMesh {
        self.mesh
    }

    /// How often it is refined.
    pub fn levels(self) -> usize {
        self.levels
    }

    /// The same mesh refined so many times.
    ///
    /// # Panics
    /// If that is more often than this one.
    #[must_use]
    pub fn at(self, levels: usize) -> Self {
        assert!(levels <= self.levels, "it is refined {} times only", self.levels);
        Self { levels, ..self }
    }

    /// The numbers of vertices, edges and triangles.
    #[inline]
    pub fn counts(self) -> MeshCounts {
        self.counts_of(self.levels)
    }

    /// Those of the mesh refined so many times.
    #[inline]
    pub fn counts_of(self, levels: usize) -> MeshCounts {
        (0..levels).fold(self.mesh.counts(), |counts, _| grown(counts))
    }

    /// The corners of a triangle.
    ///
    /// # Panics
    /// If there is no such triangle.
    #[inline(always)]
    pub fn triangle(self, FaceId(triangle): FaceId) -> [u32; 3] {
        self.triangle_and_edges(triangle).0
    }

    /// The corners of all triangles.
    pub fn triangles(self) -> Vec<[u32; 3]> {
        let mut triangles = large_vec::with_capacity(self.counts().triangles as usize);
        let ids = (0..self.counts().triangles).into_par_iter().with_min_len(PER_TASK);
        ids.map(|triangle| self.triangle(FaceId(triangle))).collect_into_vec(&mut triangles);
        triangles
    }

    /// The triangle of the mesh in which a triangle lies.
    #[inline]
    pub fn ancestor(self, triangle: FaceId) -> FaceId {
        (0..self.levels)
            .rev()
            .fold(triangle, |triangle, level| self.counts_of(level).triangle_parent(triangle))
    }

    /// What each triangle of the mesh becomes.
    pub fn refined_triangle(self) -> &'static RefinedTriangle {
        &RefinedTriangle::OF_LEVELS[self.levels]
    }

    /// The triangle at a place in one of the mesh. Four in a row come from one triangle on the level before: those at its corners, and its centre.
    #[inline]
    pub fn triangle_in(self, triangle: FaceId, place: usize) -> FaceId {
        let counts = self.mesh.counts();
        let child = |place: usize| counts.triangle_children(triangle)[place];
        match self.levels {
            0 => triangle,
            1 => child(place),
            _ => grown(counts).triangle_children(child(place / 4))[place % 4],
        }
    }

    /// The vertices in a triangle of the mesh and on its edges: its corners, those on the middles of its edges, on the two halves of each edge, and on
    /// the edges that cut off the corners. Only the first [`vertices`](RefinedTriangle::vertices) of these are in this mesh; in place of others
    /// is the first corner.
    ///
    /// # Panics
    /// If there is no such triangle.
    #[inline(always)]
    pub fn vertices_in(self, FaceId(triangle): FaceId) -> [u32; 15] {
        let [corners, edges] =
            [&self.mesh.triangles, &self.mesh.directed_edges].map(|of| of[triangle as usize]);
        let mut vertices = [corners[0]; 15];
        vertices[..3].copy_from_slice(&corners);
        if self.levels > 0 {
            let counts = self.mesh.counts();
            vertices[3..6].copy_from_slice(&edges.map(|directed| counts.edge_vertex(EdgeId(directed / 2))));
            if self.levels > 1 {
                let finer = grown(counts);
                for k in 0..3 {
                    // The half of an edge where it starts, and the one where it ends, as the half-edge runs.
                    let halves = [edges[k], edges[k] ^ 1].map(|half| finer.edge_vertex(EdgeId(half)));
                    vertices[6 + 2 * k..8 + 2 * k].copy_from_slice(&halves);
                    vertices[12 + k] =
                        finer.edge_vertex(EdgeId(2 * counts.edges + 3 * triangle + [0, 1, 2][k]));
                }
            }
        }
        vertices
    }

    /// The edge of a half-edge.
    ///
    /// # Panics
    /// If there is no such half-edge.
    #[inline]
    pub fn edge_of(self, HalfEdgeId(h): HalfEdgeId) -> EdgeId {
        EdgeId(self.triangle_and_edges(h / 3).1[(h % 3) as usize] / 2)
    }

    /// The half-edge on the other side, which runs against this one; nothing on boundary and non-manifold edges.
    ///
    /// # Panics
    /// If there is no such half-edge.
    #[inline]
    pub fn half_edge_beyond(self, HalfEdgeId(h): HalfEdgeId) -> Option<HalfEdgeId> {
        let triangles = self.mesh.counts().triangles;
        let held = |h: u32| Some(self.mesh.twin(h)).filter(|twin| *twin != NONE);
        let once = |h: u32| child_twin(triangles, h, held);
        let twin = match self.levels {
            0 => held(h),
            1 => once(h),
            _ => child_twin(4 * triangles, h, once),
        };
        twin.map(HalfEdgeId)
    }

    /// The two ends of an edge.
    ///
    /// # Panics
    /// If there is no such edge.
    pub fn edge(self, edge: EdgeId) -> [u32; 2] {
        let Some(parents) = self.levels.checked_sub(1) else { return self.mesh.edge(edge) };
        let parents = self.at(parents);
        let counts = parents.counts();
        match edge.0.checked_sub(2 * counts.edges) {
            None => {
                let parent = EdgeId(edge.0 / 2);
                let [start, end] = parents.edge(parent);
                let middle = counts.edge_vertex(parent);
                if edge.0.is_multiple_of(2) { [start, middle] } else { [middle, end] }
            }
            Some(h) => [h, prev(h)].map(|h| counts.edge_vertex(parents.edge_of(HalfEdgeId(h)))),
        }
    }

    /// The corners of a triangle, and twice the edge of each half-edge, plus 1 if it runs against the edge.
    #[inline(always)]
    fn triangle_and_edges(self, triangle: u32) -> ([u32; 3], [u32; 3]) {
        let held = |t: u32| (self.mesh.triangles[t as usize], self.mesh.directed_edges[t as usize]);
        let counts = self.mesh.counts();
        let once = |t: u32| child(counts, t, held);
        match self.levels {
            0 => held(triangle),
            1 => once(triangle),
            _ => child(grown(counts), triangle, once),
        }
    }
}

/// The counts one level on, where it is known that they fit.
#[inline(always)]
fn grown(MeshCounts { vertices, edges, triangles }: MeshCounts) -> MeshCounts {
    MeshCounts { vertices: vertices + edges, edges: 2 * edges + 3 * triangles, triangles: 4 * triangles }
}

/// The corners and directed edges of a triangle one level on from a mesh of so much, given those of the triangle in which it lies.
///
/// Written out, so that what is known of a parent stays in registers: certificates ask for each triangle some ten times.
#[inline(always)]
fn child(
    counts: MeshCounts,
    triangle: u32,
    parent: impl Fn(u32) -> ([u32; 3], [u32; 3]),
) -> ([u32; 3], [u32; 3]) {
    let on_edge = |directed: u32| counts.vertices + directed / 2;
    let centres = 3 * counts.triangles;
    if triangle < centres {
        let ([a, b, c], [ab, bc, ca]) = parent(triangle / 3);
        let (corner, out, back) = match triangle % 3 {
            0 => (a, ab, ca),
            1 => (b, bc, ab),
            _ => (c, ca, bc),
        };
        // The half of an edge where a half-edge starts, and the one where it ends, in the half-edge's direction; between them the edge that cuts
        // off the corner.
        let edges = [2 * out + out % 2, 2 * (2 * counts.edges + triangle), 2 * (back ^ 1) + back % 2];
        ([corner, on_edge(out), on_edge(back)], edges)
    } else {
        let parent_triangle = triangle - centres;
        let (_, [ab, bc, ca]) = parent(parent_triangle);
        // It runs against the edges that cut off the corners.
        let first = 2 * (2 * counts.edges + 3 * parent_triangle) + 1;
        ([on_edge(ca), on_edge(ab), on_edge(bc)], [first, first + 2, first + 4])
    }
}

/// The half-edge on the other side one level on from a mesh of so many triangles, given that of the half-edges of this mesh.
#[inline(always)]
fn child_twin(triangles: u32, h: u32, beyond: impl Fn(u32) -> Option<u32>) -> Option<u32> {
    let half_edges = 3 * triangles;
    let (child, k) = (h / 3, h % 3);
    Some(match child.checked_sub(half_edges) {
        // Edge k of a centre cuts off corner k.
        Some(parent) => 3 * (3 * parent + k) + 1,
        None => match k {
            0 => 3 * next(beyond(child)?) + 2,
            1 => 3 * half_edges + child,
            _ => 3 * beyond(prev(child))?,
        },
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use crate::{EdgeId, FaceId, Features, HalfEdgeId, RefinedMesh, TriangleMesh};

    #[test]
    fn the_refined_mesh_is_known_without_it() {
        // A tetrahedron with a fin.
        let triangles = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2], [0, 1, 4]];
        let mesh = TriangleMesh::new(5, triangles, &Features::default()).unwrap();
        let once = mesh.refine_connectivity().unwrap();
        let twice = once.refine_connectivity().unwrap();
        for (levels, made) in [&mesh, &once, &twice].into_iter().enumerate() {
            let refined = RefinedMesh::new(&mesh, levels).unwrap();
            assert_eq!(refined.counts(), made.counts());
            assert_eq!(refined.triangles(), made.triangles());
            for triangle in (0..made.counts().triangles).map(FaceId) {
                for (h, edge) in (3 * triangle.0..).map(HalfEdgeId).zip(made.triangle_edges(triangle)) {
                    assert_eq!(refined.edge_of(h), edge);
                    assert_eq!(refined.half_edge_beyond(h), made.half_edge_beyond(h));
                }
                let parent = |triangle, mesh: &TriangleMesh| mesh.counts().triangle_parent(triangle);
                let ancestor =
                    [&mesh, &once][..levels].iter().rev().fold(triangle, |t, mesh| parent(t, mesh));
                assert_eq!(refined.ancestor(triangle), ancestor);
            }
            for edge in (0..made.counts().edges).map(EdgeId) {
                assert_eq!(refined.edge(edge), made.edge(edge));
            }
            check_what_is_in_triangles(refined, made);
        }
    }
    /// The ends of a half-edge.
    fn ends_of(mesh: &TriangleMesh, h: HalfEdgeId) -> [u32; 2] {
        let corners = mesh.triangles()[h.triangle().index()];
        [0, 1].map(|end| corners[((h.0 + end) % 3) as usize])
    }

    /// What is in each triangle of the mesh is there in the one that is made, and meets there as it should.
    fn check_what_is_in_triangles(refined: RefinedMesh<'_>, made: &TriangleMesh) {
        let pattern = refined.refined_triangle();
        let mut triangles = BTreeSet::new();
        for parent in (0..refined.mesh().counts().triangles).map(FaceId) {
            let vertices = refined.vertices_in(parent);
            let id = |place: usize| refined.triangle_in(parent, place);
            for (place, corners) in pattern.triangles.iter().enumerate() {
                assert_eq!(corners.map(|corner| vertices[corner]), made.triangles()[id(place).index()]);
                assert!(corners.iter().all(|corner| *corner < pattern.vertices));
                triangles.insert(id(place));
            }
            let beyond = |triangle: FaceId| {
                let half_edges = (3 * triangle.0..).take(3).map(HalfEdgeId);
                half_edges.filter_map(|h| made.half_edge_beyond(h)).map(HalfEdgeId::triangle).collect()
            };
            for [a, b] in pattern.neighbours.iter().map(|pair| pair.map(id)) {
                let beyond: Vec<FaceId> = beyond(a);
                assert!(beyond.contains(&b));
            }
            for (h, along) in (3 * parent.0..).map(HalfEdgeId).zip(pattern.along_edges) {
                let half_edge = |triangle: FaceId, (place, edge): &(usize, usize)| {
                    HalfEdgeId(3 * refined.triangle_in(triangle, *place).0 + u32::try_from(*edge).unwrap())
                };
                // They follow each other from corner to corner.
                let ends = along.iter().map(|at| ends_of(made, half_edge(parent, at)));
                let ends: Vec<[u32; 2]> = ends.collect();
                assert!(ends.windows(2).all(|pair| pair[0][1] == pair[1][0]));
                let corners = refined.mesh().triangles()[parent.index()];
                let first = (h.0 % 3) as usize;
                let along_parent = [corners[first], corners[(first + 1) % 3]];
                assert_eq!([ends[0][0], ends[ends.len() - 1][1]], along_parent);
                let Some(twin) = refined.mesh().half_edge_beyond(h) else { continue };
                let against = pattern.along_edges[(twin.0 % 3) as usize].iter().rev();
                for (here, there) in along.iter().zip(against) {
                    let beyond = made.half_edge_beyond(half_edge(parent, here));
                    assert_eq!(beyond, Some(half_edge(twin.triangle(), there)));
                }
            }
        }
        assert_eq!(triangles.len(), made.triangles().len());
    }
}
