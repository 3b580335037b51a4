//! A mesh or polylines that are edited.

use std::borrow::Cow;
use std::path::Path;

use glam::DVec3;
use subzero::{Crease, DooSabinWeights, HalfEdgeMesh, INFINITE_SHARPNESS, LoopWeights, MeshError};

use super::command::{Command, Sharpness};
use super::drawing::{Asked, Drawing};
use crate::error::Error;
use crate::error::mesh_file::MeshFileProblem;
use crate::mesh::file::{MeshFile, check_lengths};
use crate::mesh::{EditedEdges, Level, MeshEdit, Scheme, subdivide};

/// A mesh on which edits follow each other: half-edges, once made, stay until something else than edges is changed.
#[derive(Debug, Clone)]
pub(super) struct EditedMesh {
    /// Points, creases and arrays; its faces are those of the half-edges, where there are any.
    mesh: MeshFile,
    edges: Option<EditedEdges>,
}

impl EditedMesh {
    pub(super) fn new(mesh: MeshFile) -> Self {
        Self { mesh, edges: None }
    }

    pub(super) fn points(&self) -> &[DVec3] {
        &self.mesh.points
    }

    pub(super) fn is_of_curves(&self) -> bool {
        self.mesh.faces.is_empty()
    }

    /// The mesh as it is now.
    pub(super) fn current(&self) -> Cow<'_, MeshFile> {
        match &self.edges {
            None => Cow::Borrowed(&self.mesh),
            Some(edges) => {
                let mut mesh = self.mesh.clone();
                edges.clone().finish(&mut mesh);
                Cow::Owned(mesh)
            }
        }
    }

    /// The points of each face as they are now; of curves, of each polyline.
    pub(super) fn cells(&self) -> Vec<Vec<u32>> {
        match &self.edges {
            Some(edges) => edges.triangles().map(|triangle| triangle.to_vec()).collect(),
            None if self.is_of_curves() => self.mesh.lines.clone(),
            None => self.mesh.faces.clone(),
        }
    }

    /// Does what is asked, or nothing; tells what was done.
    pub(super) fn apply(&mut self, command: &Command) -> Result<String, MeshFileProblem> {
        match command {
            Command::Flip { edge } => {
                self.edit_edge(|edges, mesh| edges.flip(mesh, *edge)).map(|()| "flipped".to_owned())
            }
            Command::Split { edge } => {
                self.edit_edge(|edges, mesh| edges.split(mesh, *edge)).map(|()| "split".to_owned())
            }
            Command::Collapse { edge } => {
                self.edit_edge(|edges, mesh| edges.collapse(mesh, *edge)).map(|()| "collapsed".to_owned())
            }
            Command::Move { point, to } => self.move_point(*point, DVec3::from_array(*to)),
            Command::Crease { edge, sharpness } => self.crease(*edge, *sharpness),
            Command::Corner { point, sharpness } => self.corner(*point, *sharpness),
            Command::SplitMany(many) => self.edit(&MeshEdit::Split(vec![many.edges()])),
            Command::FlipMany(many) => self.edit(&MeshEdit::Flip(vec![many.edges()])),
            Command::Reverse => self.edit(&MeshEdit::Reverse),
            Command::Orient => self.edit(&MeshEdit::Orient { outward: true }),
            Command::Triangulate => self.edit(&MeshEdit::Triangulate),
        }
    }

    fn edit_edge(
        &mut self,
        edit: impl FnOnce(&mut EditedEdges, &mut MeshFile) -> Result<(), MeshError>,
    ) -> Result<(), MeshFileProblem> {
        self.refuse_curves()?;
        let mut edges = match self.edges.take() {
            Some(edges) => edges,
            None => EditedEdges::new(&self.mesh)?,
        };
        let edited = edit(&mut edges, &mut self.mesh);
        self.edges = Some(edges);
        edited?;
        self.mesh.drop_data_of_shape();
        Ok(())
    }

    fn edit(&mut self, edit: &MeshEdit) -> Result<String, MeshFileProblem> {
        self.refuse_curves()?;
        let mut mesh = self.current().into_owned();
        let edited = mesh.edit(edit)?;
        (self.mesh, self.edges) = (mesh, None);
        let words = edited.to_string();
        // The first column is the command's name.
        Ok(words.split_once("  ").map_or("", |(_, rest)| rest.trim()).to_owned())
    }

    fn refuse_curves(&self) -> Result<(), MeshFileProblem> {
        if self.is_of_curves() { Err(MeshFileProblem::OnlyPolylines) } else { Ok(()) }
    }

    fn move_point(&mut self, point: u32, to: DVec3) -> Result<String, MeshFileProblem> {
        self.check_point(point)?;
        check_lengths(&[to])?;
        self.mesh.points[point as usize] = to;
        self.mesh.drop_data_of_shape();
        Ok(format!("moved point {point}"))
    }

    fn crease(&mut self, edge: [u32; 2], sharpness: Option<Sharpness>) -> Result<String, MeshFileProblem> {
        self.refuse_curves()?;
        let cells = self.cells();
        let sides = |face: &Vec<u32>| {
            let next = face.iter().cycle().skip(1);
            face.iter().zip(next).any(|(&a, &b)| [a, b] == edge || [b, a] == edge)
        };
        if !cells.iter().any(sides) {
            return Err(MeshError::NoEdge { ends: edge }.into());
        }
        self.mesh.creases.retain(|crease| crease.ends != edge && crease.ends != [edge[1], edge[0]]);
        let Some(sharpness) = sharpness.map(Sharpness::steps) else {
            return Ok("no crease any more".to_owned());
        };
        check_sharpness("crease", self.mesh.creases.len(), sharpness)?;
        self.mesh.creases.push(Crease { sharpness, ..Crease::infinite(edge) });
        Ok("creased".to_owned())
    }

    fn corner(&mut self, point: u32, sharpness: Option<Sharpness>) -> Result<String, MeshFileProblem> {
        self.check_point(point)?;
        self.mesh.corners.retain(|(corner, _)| *corner != point);
        let Some(sharpness) = sharpness.map(Sharpness::steps) else {
            return Ok("no corner any more".to_owned());
        };
        check_sharpness("corner", self.mesh.corners.len(), sharpness)?;
        self.mesh.corners.push((point, if self.is_of_curves() { INFINITE_SHARPNESS } else { sharpness }));
        Ok("a corner now".to_owned())
    }

    fn check_point(&self, vertex: u32) -> Result<(), MeshFileProblem> {
        let vertex_count = self.mesh.points.len();
        if (vertex as usize) < vertex_count {
            return Ok(());
        }
        Err(MeshError::VertexOutOfRange { what: "command", index: 0, vertex, vertex_count }.into())
    }

    /// The mesh after some steps of a scheme, if one is named.
    pub(super) fn level(&self, path: &Path, asked: &Asked) -> Result<Option<Level>, Error> {
        let Some(scheme) = scheme(&asked.scheme).filter(|_| asked.level > 0) else { return Ok(None) };
        let mut levels = subdivide(&self.current(), path, scheme, asked.level)?;
        Ok(levels.pop())
    }

    /// What there is to draw.
    pub(super) fn draw(&self, path: &Path, asked: &Asked) -> Result<Drawing, Error> {
        let mut drawing = Drawing::of_points(self.mesh.points.clone());
        let cells = self.cells();
        drawing.creases =
            self.mesh.creases.iter().map(|crease| (crease.ends, shown_sharpness(crease.sharpness))).collect();
        drawing.corners =
            self.mesh.corners.iter().map(|&(point, sharpness)| (point, shown_sharpness(sharpness))).collect();
        let level = self.level(path, asked)?;
        if self.is_of_curves() {
            drawing.add_polylines(&cells);
            if let Some(level) = level {
                drawing.add_curves(&level.points, &level.mesh.faces());
            }
        } else {
            drawing.add_faces(&cells);
            match level {
                Some(level) => {
                    drawing.add_level(level.points, &level.mesh.faces(), level.generations, &asked.color)
                }
                None => drawing.color_cage(&asked.color),
            }
        }
        Ok(drawing)
    }

    /// What a pointer may be at.
    pub(super) fn targets(&self) -> Drawing {
        let mut drawing = Drawing::of_points(self.mesh.points.clone());
        match self.is_of_curves() {
            true => drawing.add_polylines(&self.cells()),
            false => drawing.add_faces(&self.cells()),
        }
        drawing
    }

    /// Checks what an edit of edges needs, so that a page knows what to offer.
    pub(super) fn why_no_edges(&self) -> Option<String> {
        if self.is_of_curves() || self.edges.is_some() {
            return None;
        }
        let triangles = match self.mesh.triangles() {
            Ok(triangles) => triangles,
            Err(problem) => return Some(problem.to_string()),
        };
        HalfEdgeMesh::new(self.mesh.points.len(), &triangles).err().map(|error| error.to_string())
    }
}

/// Infinite sharpness has no number in JSON.
fn shown_sharpness(sharpness: f32) -> Option<f32> {
    (sharpness < INFINITE_SHARPNESS).then_some(sharpness)
}

fn check_sharpness(what: &'static str, index: usize, sharpness: f32) -> Result<(), MeshError> {
    if sharpness >= 0.0 { Ok(()) } else { Err(MeshError::Sharpness { what, index, sharpness }) }
}

/// A scheme by its name on the command line.
pub(super) fn scheme(name: &str) -> Option<Scheme> {
    Some(match name {
        "loop" => Scheme::Loop(LoopWeights::default()),
        "butterfly" => Scheme::Butterfly,
        "modified-butterfly" => Scheme::ModifiedButterfly,
        "midpoint" => Scheme::Midpoint,
        "doo-sabin" => Scheme::DooSabin(DooSabinWeights::default()),
        "catmull-clark" => Scheme::CatmullClark,
        "b-spline" => Scheme::BSpline,
        "four-point" => Scheme::FourPoint,
        _ => return None,
    })
}
