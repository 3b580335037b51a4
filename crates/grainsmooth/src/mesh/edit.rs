//! Edits of a mesh from a file: edges flipped, split and collapsed, winding made to agree, polygons cut.

use std::fmt;

use subzero::{HalfEdgeMesh, MeshError};

use super::edited_edges::EditedEdges;
use super::file::{MeshFile, MeshFileProblem};
use crate::figures::counted::Counted;
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
    /// So many faces were reversed.
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
            Self::Flipped { edges, left: 0 } => {
                write!(formatter, "flipped     {}", Counted(*edges, "edge"))
            }
            Self::Flipped { edges, left } => {
                write!(
                    formatter,
                    "flipped     {}; {left} stay, on the boundary or as the mesh would be no manifold",
                    Counted(*edges, "edge")
                )
            }
            Self::Split { edges } => write!(formatter, "split       {}", Counted(*edges, "edge")),
            Self::Collapsed { edges } => write!(formatter, "collapsed   {}", Counted(*edges, "edge")),
            Self::Turned { turned, faces, parts } => {
                write!(
                    formatter,
                    "oriented    {turned} of {faces} faces reversed; {}",
                    Counted(*parts, "part")
                )
            }
            Self::Cut { polygons, triangles } => {
                let (polygons, triangles) = (Counted(*polygons, "polygon"), Counted(*triangles, "triangle"));
                write!(formatter, "cut         {polygons}: {triangles}")
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
                let mut edges = EditedEdges::new(self)?;
                let (mut flipped, mut left) = (0, 0);
                for choice in choices {
                    for ends in choice.ends(self, edges.half_edges()) {
                        match (edges.flip(self, ends), choice) {
                            (Ok(()), _) => flipped += 1,
                            (Err(MeshError::Edit { .. }), choice) if !choice.is_single() => left += 1,
                            (Err(error), _) => return Err(error.into()),
                        }
                    }
                }
                edges.finish(self);
                self.drop_data_of_shape();
                Ok(Edited::Flipped { edges: flipped, left })
            }
            MeshEdit::Split(choices) => {
                let mut edges = EditedEdges::new(self)?;
                let mut count = 0;
                for choice in choices {
                    for ends in choice.ends(self, edges.half_edges()) {
                        edges.split(self, ends)?;
                        count += 1;
                    }
                }
                edges.finish(self);
                Ok(Edited::Split { edges: count })
            }
            MeshEdit::Collapse(pairs) => {
                let mut edges = EditedEdges::new(self)?;
                pairs.iter().try_for_each(|ends| edges.collapse(self, *ends))?;
                edges.finish(self);
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
        self.turn_round(orientation.reversed());
        let turned = orientation.reversed().iter().filter(|turned| **turned).count();
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
    /// The ends of the edges chosen, as the mesh is now.
    fn ends(self, mesh: &MeshFile, edges: &HalfEdgeMesh) -> Vec<[u32; 2]> {
        match self {
            Self::Between(ends) => vec![ends],
            Self::All => edges.edge_ends(),
            Self::Longest => edges.longest_edges(&mesh.points),
            Self::Flat => edges.flat_edges(&mesh.points),
        }
    }

    fn is_single(self) -> bool {
        matches!(self, Self::Between(_))
    }
}
