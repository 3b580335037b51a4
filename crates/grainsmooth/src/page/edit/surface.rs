//! A mesh or polylines that are edited.

use std::borrow::Cow;
use std::path::Path;

use glam::DVec3;
use subzero::{Crease, INFINITE_SHARPNESS, MeshError};

use super::super::grains::Frame;
use super::cage::{Cage, edges};
use super::command::{Command, Sharpness};
use super::drawing::{Asked, Drawing};
use super::subdivided::Subdivided;
use crate::error::Error;
use crate::error::mesh_file::MeshFileProblem;
use crate::mesh::file::{MeshFile, check_lengths};
use crate::mesh::{EditedEdges, MeshEdit, Scheme, subdivide};

/// A mesh on which edits follow each other.
#[derive(Debug, Clone)]
pub(super) struct EditedMesh {
    /// Points, creases and arrays; its faces are those of the half-edges, where there are any.
    mesh: MeshFile,
    edges: Option<EditedEdges>,
    /// Why there are none.
    why_no_edges: Option<String>,
}

impl EditedMesh {
    pub(super) fn new(mesh: MeshFile) -> Self {
        let (edges, why_no_edges) = match (mesh.faces.is_empty(), EditedEdges::new(&mesh)) {
            (true, _) => (None, None),
            (false, Ok(edges)) => (Some(edges), None),
            (false, Err(problem)) => (None, Some(problem.to_string())),
        };
        Self { mesh, edges, why_no_edges }
    }

    pub(super) fn points(&self) -> &[DVec3] {
        &self.mesh.points
    }

    /// Puts a point elsewhere, for as long as something is looked at; returns where it was.
    pub(super) fn hold(&mut self, point: u32, place: DVec3) -> Result<DVec3, MeshFileProblem> {
        self.check_point(point)?;
        check_lengths(&[place])?;
        Ok(std::mem::replace(&mut self.mesh.points[point as usize], place))
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
        match &mut self.edges {
            Some(edges) => edit(edges, &mut self.mesh)?,
            None => edit(&mut EditedEdges::new(&self.mesh)?, &mut self.mesh)?,
        }
        self.mesh.drop_data_of_shape();
        Ok(())
    }

    fn edit(&mut self, edit: &MeshEdit) -> Result<String, MeshFileProblem> {
        self.refuse_curves()?;
        let mut mesh = self.current().into_owned();
        let edited = mesh.edit(edit)?;
        *self = Self::new(mesh);
        let words = edited.to_string();
        // The first column is the command's name.
        Ok(words.split_once("  ").map_or("", |(_, rest)| rest.trim()).to_owned())
    }

    fn refuse_curves(&self) -> Result<(), MeshFileProblem> {
        if self.is_of_curves() { Err(MeshFileProblem::OnlyPolylines) } else { Ok(()) }
    }

    fn move_point(&mut self, point: u32, to: DVec3) -> Result<String, MeshFileProblem> {
        self.hold(point, to)?;
        self.mesh.drop_data_of_shape();
        Ok(format!("moved point {point}"))
    }

    fn crease(&mut self, edge: [u32; 2], sharpness: Option<Sharpness>) -> Result<String, MeshFileProblem> {
        self.refuse_curves()?;
        let is_this = |ends: [u32; 2]| ends == edge || ends == [edge[1], edge[0]];
        let is_there = match &self.edges {
            Some(edges) => edges.edge_places().flatten().any(is_this),
            None => edges(&self.mesh.faces).into_iter().any(is_this),
        };
        if !is_there {
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

    /// What a pointer may be at.
    pub(super) fn cage(&self, frame: Frame) -> Cage {
        let mut cage = Cage::of_points(&self.mesh.points, frame);
        match &self.edges {
            Some(edges) => cage.add_half_edges(edges),
            None if self.is_of_curves() => cage.add_polylines(&self.mesh.lines),
            None => cage.add_faces(&self.mesh.faces),
        }
        cage
    }

    /// What there is to draw beside that.
    pub(super) fn draw(&self, path: &Path, asked: &Asked, cage: &Cage) -> Result<Drawing, Error> {
        let mut drawing = Drawing {
            creases: self.mesh.creases.iter().map(|crease| (crease.ends, shown(crease.sharpness))).collect(),
            corners: self.mesh.corners.iter().map(|&(point, sharpness)| (point, shown(sharpness))).collect(),
            ..Drawing::default()
        };
        if self.is_of_curves() {
            if let Some(scheme) = Scheme::named(&asked.scheme).filter(|_| asked.level > 0)
                && let Some(level) = subdivide(&self.mesh, path, scheme, asked.level)?.pop()
            {
                drawing.add_curves(&level.points, &level.mesh.faces());
            }
            return Ok(drawing);
        }
        drawing.surface = Subdivided::new(&self.current(), path, asked)?;
        let generations = self.mesh.generations();
        drawing.color(&asked.color, cage, &self.mesh.points, generations.as_deref());
        Ok(drawing)
    }

    /// Why edges cannot be edited, so that a page knows what to offer.
    pub(super) fn why_no_edges(&self) -> Option<&str> {
        self.why_no_edges.as_deref()
    }
}

/// Infinite sharpness has no number in JSON.
fn shown(sharpness: f32) -> Option<f32> {
    (sharpness < INFINITE_SHARPNESS).then_some(sharpness)
}

fn check_sharpness(what: &'static str, index: usize, sharpness: f32) -> Result<(), MeshError> {
    if sharpness >= 0.0 { Ok(()) } else { Err(MeshError::Sharpness { what, index, sharpness }) }
}
