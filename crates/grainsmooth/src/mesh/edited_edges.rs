//! Edges of a mesh that are edited one after the other.

use subzero::{Crease, HalfEdgeId, HalfEdgeMesh, MeshError};

use super::data::extend_by_means;
use super::file::{MeshFile, MeshFileProblem};

/// The half-edges of a mesh while its edges are edited. Points and creases of the mesh follow at once, faces and arrays in the end.
#[derive(Debug, Clone)]
pub(crate) struct EditedEdges {
    half_edges: HalfEdgeMesh,
    /// Of each triangle of the half-edges, that of the mesh in which it lies.
    face_of: Vec<usize>,
    /// The ends of the edges on whose middles new points lie.
    middles: Vec<[u32; 2]>,
}

impl EditedEdges {
    /// # Errors
    /// [`MeshFileProblem::NotATriangle`]; [`MeshFileProblem::Mesh`] when the mesh is not manifold.
    pub(crate) fn new(mesh: &MeshFile) -> Result<Self, MeshFileProblem> {
        let half_edges = HalfEdgeMesh::new(mesh.points.len(), &mesh.triangles()?)?;
        Ok(Self { half_edges, face_of: (0..mesh.faces.len()).collect(), middles: Vec::new() })
    }

    /// The triangles as they are now, by the places of their half-edges; nothing where one has gone.
    pub(crate) fn triangle_places(&self) -> impl Iterator<Item = Option<[u32; 3]>> {
        self.half_edge_numbers().step_by(3).map(|first| {
            let is_there = self.half_edges.exists(first);
            is_there.then(|| self.half_edges.face_half_edges(first).map(|half| self.half_edges.start(half)))
        })
    }

    /// The ends of each edge in the place of its first half-edge; nothing in those of others.
    pub(crate) fn edge_places(&self) -> impl Iterator<Item = Option<[u32; 2]>> {
        let mesh = &self.half_edges;
        self.half_edge_numbers().map(|half| {
            let is_first = mesh.exists(half) && mesh.twin(half).is_none_or(|twin| half < twin);
            is_first.then(|| [mesh.start(half), mesh.end(half)])
        })
    }

    fn half_edge_numbers(&self) -> impl Iterator<Item = HalfEdgeId> {
        (0..).map(HalfEdgeId).take(self.half_edges.half_edge_count())
    }

    /// The half-edges as they are now.
    pub(super) fn half_edges(&self) -> &HalfEdgeMesh {
        &self.half_edges
    }

    pub(crate) fn flip(&mut self, mesh: &mut MeshFile, ends: [u32; 2]) -> Result<(), MeshError> {
        self.half_edges.flip(self.half_edges.half_edge_between(ends[0], ends[1])?)?;
        mesh.creases.retain(|crease| !joins(crease, ends));
        Ok(())
    }

    pub(crate) fn split(&mut self, mesh: &mut MeshFile, ends: [u32; 2]) -> Result<(), MeshError> {
        let half_edge = self.half_edges.half_edge_between(ends[0], ends[1])?;
        let beside = [Some(half_edge), self.half_edges.twin(half_edge)];
        let middle = self.half_edges.split(half_edge)?;
        // Each of the two triangles leaves half of it to a new one, in this order.
        for half_edge in beside.into_iter().flatten() {
            self.face_of.push(self.face_of[half_edge.triangle().index()]);
        }
        self.middles.push(ends);
        let [a, b] = ends.map(|end| mesh.points[end as usize]);
        mesh.points.push(0.5 * a + 0.5 * b);
        let halves = |crease: Crease| match joins(&crease, ends) {
            true => vec![
                Crease { ends: [ends[0], middle], ..crease },
                Crease { ends: [middle, ends[1]], ..crease },
            ],
            false => vec![crease],
        };
        mesh.creases = mesh.creases.drain(..).flat_map(halves).collect();
        Ok(())
    }

    pub(crate) fn collapse(&mut self, mesh: &mut MeshFile, [from, into]: [u32; 2]) -> Result<(), MeshError> {
        self.half_edges.collapse_into(from, into)?;
        for end in mesh.creases.iter_mut().flat_map(|crease| &mut crease.ends).filter(|end| **end == from) {
            *end = into;
        }
        mesh.creases.retain(|crease| crease.ends[0] != crease.ends[1]);
        mesh.corners.retain(|(vertex, _)| *vertex != from);
        Ok(())
    }

    /// Gives the mesh its faces and arrays.
    pub(crate) fn finish(self, mesh: &mut MeshFile) {
        let (faces, triangles): (Vec<usize>, Vec<Vec<u32>>) = self
            .half_edges
            .triangles()
            .map(|(number, triangle)| (self.face_of[number.index()], triangle.to_vec()))
            .unzip();
        mesh.faces = triangles;
        for array in &mut mesh.face_data {
            *array = array.at(faces.iter().copied());
        }
        if !self.middles.is_empty() {
            mesh.drop_normals();
            mesh.point_data.retain_mut(|array| extend_by_means(array, &self.middles));
        }
    }
}

fn joins(crease: &Crease, [a, b]: [u32; 2]) -> bool {
    crease.ends == [a, b] || crease.ends == [b, a]
}
