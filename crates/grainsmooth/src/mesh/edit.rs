//! Edits of a mesh from a file: edges flipped, split and collapsed, winding made to agree, polygons cut.

use std::fmt;

use subzero::{Crease, HalfEdgeMesh, MeshError};

use super::data::extend_by_means;
use super::file::{MeshFile, MeshFileProblem};
use crate::names::LABEL_ARRAYS;

/// A change of a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum MeshEdit {
    /// Turns edges within the quadrilaterals of their two triangles.
    Flip(Vec<EdgeChoice>),
    /// Puts vertices on the middles of edges.
    Split(Vec<EdgeChoice>),
    /// Draws the first vertices of edges into the second.
    Collapse(Vec<[u32; 2]>),
    /// Makes the winding of faces agree, component by component: most faces stay as they are.
    Orient {
        /// Whether normals of closed components are to point out of them.
        outward: bool,
    },
    /// Turns every face round.
    Reverse,
    /// Cuts polygons into triangles.
    Triangulate,
}

/// Edges to edit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EdgeChoice {
    /// That between two vertices.
    Between([u32; 2]),
    /// All that there are.
    All,
    /// The longest of each triangle, and those as long as it.
    Longest,
    /// The longest between triangles in one plane: diagonals of polygons that were cut.
    Flat,
}

/// What an edit did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edited {
    /// So many edges were flipped; so many of those chosen together could not be.
    Flipped {
        /// Number of edges flipped.
        edges: usize,
        /// Number of edges that stayed: on the boundary, or between vertices whose opposite ones share an edge already.
        left: usize,
    },
    /// So many edges were split.
    Split {
        /// Number of edges.
        edges: usize,
    },
    /// So many edges were collapsed.
    Collapsed {
        /// Number of edges.
        edges: usize,
    },
    /// So many faces were turned round.
    Turned {
        /// Number of faces turned.
        turned: usize,
        /// Number of all faces.
        faces: usize,
        /// Parts that hang together by edges of two faces; as one counts what is turned as a whole.
        parts: usize,
    },
    /// So many polygons were cut.
    Cut {
        /// Number of polygons.
        polygons: usize,
        /// Number of triangles then.
        triangles: usize,
    },
}

impl fmt::Display for Edited {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flipped { edges, left: 0 } => write!(formatter, "flipped     {edges} edges"),
            Self::Flipped { edges, left } => {
                write!(
                    formatter,
                    "flipped     {edges} edges; {left} stay, on the boundary or as the mesh would be no manifold"
                )
            }
            Self::Split { edges } => write!(formatter, "split       {edges} edges"),
            Self::Collapsed { edges } => write!(formatter, "collapsed   {edges} edges"),
            Self::Turned { turned, faces, parts } => {
                write!(formatter, "oriented    {turned} of {faces} faces turned round; {parts} parts")
            }
            Self::Cut { polygons, triangles } => {
                write!(formatter, "cut         {polygons} polygons: {triangles} triangles")
            }
        }
    }
}

impl MeshFile {
    /// Edits the mesh. Points keep their ids: a split appends points, a collapse leaves a point that no triangle uses. Creases follow
    /// their edges.
    ///
    /// # Errors
    /// [`MeshFileProblem::NotATriangle`] where edges of triangles are edited; [`MeshFileProblem::Mesh`] when the mesh is not manifold, or
    /// has no such edge by the time of its edit, or the edit would leave no manifold mesh; as of [`subzero::orient`] and
    /// [`subzero::triangulate`].
    pub fn edit(&mut self, edit: &MeshEdit) -> Result<Edited, MeshFileProblem> {
        match edit {
            MeshEdit::Flip(choices) => {
                let mut edges = EdgeEditor::new(self)?;
                let (mut flipped, mut left) = (0, 0);
                for choice in choices {
                    for ends in edges.chosen(*choice) {
                        match (edges.flip(ends), choice) {
                            (Ok(()), _) => flipped += 1,
                            (Err(MeshError::Edit { .. }), choice) if !choice.is_single() => left += 1,
                            (Err(error), _) => return Err(error.into()),
                        }
                    }
                }
                edges.finish();
                self.drop_data_of_shape();
                Ok(Edited::Flipped { edges: flipped, left })
            }
            MeshEdit::Split(choices) => {
                let mut edges = EdgeEditor::new(self)?;
                let mut count = 0;
                for choice in choices {
                    for ends in edges.chosen(*choice) {
                        edges.split(ends)?;
                        count += 1;
                    }
                }
                edges.finish();
                Ok(Edited::Split { edges: count })
            }
            MeshEdit::Collapse(pairs) => {
                let mut edges = EdgeEditor::new(self)?;
                pairs.iter().try_for_each(|ends| edges.collapse(*ends))?;
                edges.finish();
                self.drop_data_of_shape();
                Ok(Edited::Collapsed { edges: pairs.len() })
            }
            MeshEdit::Orient { outward } => self.orient(*outward),
            MeshEdit::Reverse => {
                let faces = self.faces.len();
                self.turn_round(&vec![true; faces]);
                Ok(Edited::Turned { turned: faces, faces, parts: 1 })
            }
            MeshEdit::Triangulate => self.triangulate(),
        }
    }

    fn orient(&mut self, outward: bool) -> Result<Edited, MeshFileProblem> {
        let mut orientation = subzero::orient(self.points.len(), &self.faces)?;
        if outward {
            orientation.face_outward(&self.points, &self.faces);
        }
        self.turn_round(orientation.turned());
        let turned = orientation.turned().iter().filter(|turned| **turned).count();
        Ok(Edited::Turned { turned, faces: self.faces.len(), parts: orientation.is_closed().len() })
    }

    /// Turns faces round; each keeps its first corner, and its two sides change places.
    fn turn_round(&mut self, turned: &[bool]) {
        let faces = (0..).zip(&mut self.faces).zip(turned).filter(|(_, turned)| **turned);
        for ((number, face), _) in faces {
            face[1..].reverse();
            let is_pair = |name: &str, components| LABEL_ARRAYS.contains(&name) && components == 2;
            let labels = self.face_data.iter_mut().filter(|array| is_pair(&array.name, array.components));
            labels.for_each(|array| array.swap_pair(number));
        }
        self.drop_normals();
    }

    fn triangulate(&mut self) -> Result<Edited, MeshFileProblem> {
        let (triangles, face_of) = subzero::triangulate(&self.points, &self.faces)?;
        let polygons = self.faces.iter().filter(|face| face.len() > 3).count();
        self.faces = triangles.into_iter().map(Vec::from).collect();
        for array in &mut self.face_data {
            *array = array.at(face_of.iter().map(|face| face.index()));
        }
        Ok(Edited::Cut { polygons, triangles: self.faces.len() })
    }
}

impl EdgeChoice {
    fn is_single(self) -> bool {
        matches!(self, Self::Between(_))
    }
}

/// A mesh whose edges are being edited.
struct EdgeEditor<'a> {
    mesh: &'a mut MeshFile,
    half_edges: HalfEdgeMesh,
    /// Of each triangle of the half-edges, that of the mesh in which it lies.
    face_of: Vec<usize>,
    /// The ends of the edges on whose middles new points lie.
    middles: Vec<[u32; 2]>,
}

impl<'a> EdgeEditor<'a> {
    fn new(mesh: &'a mut MeshFile) -> Result<Self, MeshFileProblem> {
        let half_edges = HalfEdgeMesh::new(mesh.points.len(), &mesh.triangles()?)?;
        let face_of = (0..mesh.faces.len()).collect();
        Ok(Self { mesh, half_edges, face_of, middles: Vec::new() })
    }

    /// The ends of the edges chosen, as the mesh is now.
    fn chosen(&self, choice: EdgeChoice) -> Vec<[u32; 2]> {
        match choice {
            EdgeChoice::Between(ends) => vec![ends],
            EdgeChoice::All => self.half_edges.edge_ends(),
            EdgeChoice::Longest => self.half_edges.longest_edges(&self.mesh.points),
            EdgeChoice::Flat => self.half_edges.flat_edges(&self.mesh.points),
        }
    }

    fn flip(&mut self, ends: [u32; 2]) -> Result<(), MeshError> {
        self.half_edges.flip(self.half_edges.half_edge_between(ends[0], ends[1])?)?;
        self.mesh.creases.retain(|crease| !joins(crease, ends));
        Ok(())
    }

    fn split(&mut self, ends: [u32; 2]) -> Result<(), MeshError> {
        let half_edge = self.half_edges.half_edge_between(ends[0], ends[1])?;
        let beside = [Some(half_edge), self.half_edges.twin(half_edge)];
        let middle = self.half_edges.split(half_edge)?;
        // Each of the two triangles leaves half of it to a new one, in this order.
        for half_edge in beside.into_iter().flatten() {
            self.face_of.push(self.face_of[half_edge.triangle().index()]);
        }
        self.middles.push(ends);
        let [a, b] = ends.map(|end| self.mesh.points[end as usize]);
        self.mesh.points.push(0.5 * a + 0.5 * b);
        let halves = |crease: Crease| match joins(&crease, ends) {
            true => vec![
                Crease { ends: [ends[0], middle], ..crease },
                Crease { ends: [middle, ends[1]], ..crease },
            ],
            false => vec![crease],
        };
        self.mesh.creases = self.mesh.creases.drain(..).flat_map(halves).collect();
        Ok(())
    }

    fn collapse(&mut self, [from, into]: [u32; 2]) -> Result<(), MeshError> {
        self.half_edges.collapse_into(from, into)?;
        for end in
            self.mesh.creases.iter_mut().flat_map(|crease| &mut crease.ends).filter(|end| **end == from)
        {
            *end = into;
        }
        self.mesh.creases.retain(|crease| crease.ends[0] != crease.ends[1]);
        self.mesh.corners.retain(|(vertex, _)| *vertex != from);
        Ok(())
    }

    fn finish(self) {
        let (faces, triangles): (Vec<usize>, Vec<Vec<u32>>) = self
            .half_edges
            .triangles()
            .map(|(number, triangle)| (self.face_of[number.index()], triangle.to_vec()))
            .unzip();
        self.mesh.faces = triangles;
        for array in &mut self.mesh.face_data {
            *array = array.at(faces.iter().copied());
        }
        if !self.middles.is_empty() {
            self.mesh.drop_normals();
            self.mesh.point_data.retain_mut(|array| extend_by_means(array, &self.middles));
        }
    }
}

fn joins(crease: &Crease, [a, b]: [u32; 2]) -> bool {
    crease.ends == [a, b] || crease.ends == [b, a]
}
