//! Edits of a mesh from a file: edges flipped, split and collapsed, winding made to agree, polygons cut.

use glam::DVec3;
use subzero::HalfEdgeMesh;

use super::file::{MeshFile, MeshFileProblem};

/// A change at an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EdgeEdit {
    /// Turns the edge within the quadrilateral of its two triangles.
    Flip,
    /// Puts a vertex on the middle of the edge.
    Split,
    /// Draws the edge's first vertex into its second.
    Collapse,
}

/// Edits edges, given by their ends, one after the other; returns the points and triangles then.
///
/// Points keep their ids: a split appends points, a collapse leaves a point that no triangle uses.
///
/// # Errors
/// [`MeshFileProblem::NotATriangle`]; [`MeshFileProblem::Mesh`] when the mesh is not manifold, or has no such edge
/// by the time of its edit, or the edit would leave no manifold mesh.
pub fn edit_edges(
    mesh: &MeshFile,
    edit: EdgeEdit,
    edges: &[[u32; 2]],
) -> Result<(Vec<DVec3>, Vec<[u32; 3]>), MeshFileProblem> {
    let mut points = mesh.points.clone();
    let mut half_edges = HalfEdgeMesh::new(points.len(), &mesh.triangles()?)?;
    for &[a, b] in edges {
        match edit {
            EdgeEdit::Flip => half_edges.flip(half_edges.half_edge_between(a, b)?)?,
            EdgeEdit::Split => half_edges.split_edges(&[[a, b]], &mut points).map(drop)?,
            EdgeEdit::Collapse => half_edges.collapse_into(a, b)?,
        }
    }
    Ok((points, half_edges.triangles().map(|(_, triangle)| triangle).collect()))
}

/// What [`MeshFile::orient`] did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OrientedFaces {
    /// How many faces it turned round.
    pub turned: usize,
    /// How many parts hang together by edges of two faces.
    pub components: usize,
}

impl MeshFile {
    /// Makes the winding of faces agree, component by component: most faces stay as they are. If `outward`, normals of closed
    /// components point out of them afterwards.
    ///
    /// # Errors
    /// [`MeshFileProblem::Mesh`] as of [`subzero::orient`].
    pub fn orient(&mut self, outward: bool) -> Result<OrientedFaces, MeshFileProblem> {
        let mut orientation = subzero::orient(self.points.len(), &self.faces)?;
        if outward {
            orientation.face_outward(&self.points, &self.faces);
        }
        orientation.apply(&mut self.faces);
        let turned = orientation.turned.iter().filter(|turned| **turned).count();
        Ok(OrientedFaces { turned, components: orientation.is_closed.len() })
    }

    /// Cuts polygons into triangles, and returns how many were cut.
    ///
    /// # Errors
    /// [`MeshFileProblem::Mesh`] as of [`subzero::triangulate`].
    pub fn triangulate(&mut self) -> Result<usize, MeshFileProblem> {
        let (triangles, _) = subzero::triangulate(&self.points, &self.faces)?;
        let polygons = self.faces.iter().filter(|face| face.len() > 3).count();
        self.faces = triangles.into_iter().map(Vec::from).collect();
        Ok(polygons)
    }
}
