//! Meshes, curves and Bezier patches to edit. Each command is kept; undoing one does those before it again.

mod bezier;
mod coloring;
mod command;
mod drawing;
mod pick;
mod saving;
mod surface;

use std::path::Path;

use glam::DVec3;
use hyper::StatusCode;
use serde::{Deserialize, Serialize};
use subzero::MeshError;

use super::answer::Answer;
use super::grains::Frame;
use super::refusal::{Refusal, name, words};
use crate::error::Error;
use crate::error::mesh_file::MeshFileProblem;
use crate::mesh::file::MeshFile;
use crate::mesh::{BezierFile, read_bezier};
use bezier::EditedBezier;
use command::Command;
use drawing::{Asked, Drawing};
use pick::{Ray, pick};
use saving::{Opened, Wanted};
use surface::EditedMesh;

/// How many states before global commands are kept: one of a mesh of 100 000 triangles takes some 4 MB.
const MOST_STATES: usize = 16;

/// What is edited, and how it came to be.
#[derive(Debug)]
pub(super) struct Editor {
    file: Opened,
    frame: Frame,
    model: Model,
    /// All commands; those behind the first `done` are undone.
    log: Vec<Command>,
    done: usize,
    /// States to go on from, each behind so many commands; the first is what was opened.
    states: Vec<(usize, Model)>,
    /// Grows with each change, be it undone or not.
    revision: u64,
    /// What was last told, for pages that ask what there is.
    said: String,
}

#[derive(Debug, Clone)]
enum Model {
    Mesh(Box<EditedMesh>),
    Bezier(EditedBezier),
}

/// A change, at the revision that the page knows.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Change {
    revision: u64,
    command: Asking,
    view: Asked,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Asking {
    Undo,
    Redo,
    #[serde(untagged)]
    Do(Command),
}

/// A point under the pointer, which is not let go yet.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Held {
    point: u32,
    to: [f64; 3],
    view: Asked,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Saving {
    #[serde(flatten)]
    wanted: Wanted,
    revision: u64,
}

#[derive(Serialize)]
struct Head<'a> {
    kind: &'static str,
    /// `mesh`, `curves` or `bezier`.
    model: &'static str,
    name: String,
    revision: u64,
    /// Commands that can be undone and done again.
    undo: usize,
    redo: usize,
    said: &'a str,
    /// Why edges cannot be edited.
    why_no_edges: Option<String>,
    /// Number of Bezier curves and patches.
    patches: usize,
    /// Whether the file that was opened can be written.
    can_overwrite: bool,
}

impl Editor {
    /// A mesh, or polylines where there are no faces.
    pub(super) fn of_mesh(path: &Path, mut mesh: MeshFile) -> Self {
        if !mesh.faces.is_empty() {
            mesh.lines.clear();
        }
        Self::new(path, Model::Mesh(Box::new(EditedMesh::new(mesh))))
    }

    /// Bezier curves and patches from a file.
    pub(super) fn of_bezier(path: &Path) -> Result<Self, Error> {
        let located = |error: MeshError| Error::MeshFile { path: path.to_owned(), problem: error.into() };
        Ok(Self::new(path, Model::Bezier(EditedBezier::new(&read_bezier(path)?).map_err(located)?)))
    }

    /// The Utah teapot.
    pub(super) fn of_teapot() -> Result<Self, Error> {
        let path = Path::new("teapot.json");
        let file = BezierFile::teapot();
        let located = |error: MeshError| Error::MeshFile { path: path.to_owned(), problem: error.into() };
        Ok(Self::new(path, Model::Bezier(EditedBezier::new(&file).map_err(located)?)))
    }

    fn new(path: &Path, model: Model) -> Self {
        Self {
            file: Opened::new(path),
            frame: Frame::around(model.points()),
            states: vec![(0, model.clone())],
            model,
            log: Vec::new(),
            done: 0,
            revision: 0,
            said: String::new(),
        }
    }

    pub(super) fn revision(&self) -> u64 {
        self.revision
    }

    pub(super) fn answer(&mut self, path: &str, body: &[u8]) -> Result<Answer, Refusal> {
        match path {
            "/open" => self.draw(&Asked::default()),
            "/draw" => {
                let asked: Asked = words(body)?;
                self.draw(&asked)
            }
            "/edit" => self.change(words(body)?),
            "/hold" => self.hold(words(body)?),
            "/pick" => {
                let ray: Ray = words(body)?;
                let (points, edges, triangles) = self.targets();
                Ok(Answer::json(&pick(ray, &points, &edges, &triangles)))
            }
            "/file" => {
                let wanted: Wanted = words(body)?;
                let bytes = saving::bytes(&self.model, &self.file.path, &wanted);
                Ok(Answer::packed(bytes.map_err(|error| Refusal::impossible(&error))?))
            }
            "/save" => self.save(words(body)?),
            _ => Err(Refusal::no_such_command(path)),
        }
    }

    fn change(&mut self, Change { revision, command, view }: Change) -> Result<Answer, Refusal> {
        if revision != self.revision {
            let why = "another page changed this in the meantime: look, and do it again";
            return Err(Refusal::new(StatusCode::CONFLICT, why));
        }
        self.said = match command {
            Asking::Undo if self.done == 0 => return Err(Refusal::impossible(&"there is nothing to undo")),
            Asking::Undo => {
                self.done -= 1;
                self.replay();
                format!("undone; {} left", self.done)
            }
            Asking::Redo => {
                let command = self.log.get(self.done).cloned();
                let command = command.ok_or_else(|| Refusal::impossible(&"there is nothing to do again"))?;
                self.apply(&command)?
            }
            Asking::Do(command) => {
                let command = self.in_coordinates(command);
                let said = self.apply(&command)?;
                // What was undone and not done again is replaced.
                self.log.truncate(self.done - 1);
                self.states.retain(|(done, _)| *done < self.done);
                self.log.push(command);
                said
            }
        };
        self.revision += 1;
        self.draw(&view)
    }

    /// Places of the page as coordinates.
    fn in_coordinates(&self, command: Command) -> Command {
        match command {
            Command::Move { point, to } => {
                Command::Move { point, to: self.frame.point(DVec3::from_array(to)).to_array() }
            }
            other => other,
        }
    }

    /// Does a command behind those that are done.
    fn apply(&mut self, command: &Command) -> Result<String, Refusal> {
        let before = command.is_global().then(|| self.model.clone());
        let said = self.model.apply(command).map_err(|problem| Refusal::impossible(&problem))?;
        if let Some(before) = before.filter(|_| self.states.iter().all(|(done, _)| *done != self.done)) {
            self.states.push((self.done, before));
            if self.states.len() > MOST_STATES {
                self.states.remove(1);
            }
        }
        self.done += 1;
        Ok(said)
    }

    /// Does all commands that are not undone again, from the last state before them on.
    fn replay(&mut self) {
        let last = self.states.iter().rev().find(|(done, _)| *done <= self.done);
        let Some((start, model)) = last else { return };
        let mut model = model.clone();
        for command in &self.log[*start..self.done] {
            // It was possible before, on the same mesh.
            let again = model.apply(command);
            debug_assert!(again.is_ok(), "{command:?}");
        }
        self.model = model;
    }

    /// What is seen while a point is held at a place; nothing is changed.
    fn hold(&mut self, Held { point, to, view }: Held) -> Result<Answer, Refusal> {
        let command = self.in_coordinates(Command::Move { point, to });
        let mut model = self.model.clone();
        model.apply(&command).map_err(|problem| Refusal::impossible(&problem))?;
        self.packed(&model, &view)
    }

    fn draw(&self, asked: &Asked) -> Result<Answer, Refusal> {
        self.packed(&self.model, asked)
    }

    fn packed(&self, model: &Model, asked: &Asked) -> Result<Answer, Refusal> {
        let drawing = model.draw(&self.file.path, asked).map_err(|error| Refusal::impossible(&error))?;
        let head = Head {
            kind: "edit",
            model: model.kind(),
            name: name(&self.file.path),
            revision: self.revision,
            undo: self.done,
            redo: self.log.len() - self.done,
            said: &self.said,
            why_no_edges: model.why_no_edges(),
            patches: model.patches(),
            can_overwrite: self.file.path.is_file() && model.can_write(&self.file.path),
        };
        Ok(Answer::packed(drawing.packed(self.frame, &head)?))
    }

    /// Points, edges and triangles that a pointer may be at, in the page's frame.
    fn targets(&self) -> (Vec<DVec3>, Vec<[u32; 2]>, Vec<[u32; 3]>) {
        let drawing = self.model.targets();
        let points = drawing.points.iter().map(|point| self.frame.in_frame(*point)).collect();
        (points, drawing.edges, drawing.triangles)
    }

    fn save(&mut self, Saving { wanted, revision }: Saving) -> Result<Answer, Refusal> {
        if revision != self.revision {
            return Err(Refusal::new(
                StatusCode::CONFLICT,
                "another page changed this in the meantime: look, and save again",
            ));
        }
        if self.file.is_stale() && !wanted.anyway {
            let why = format!(
                "{}: another program wrote it since it was opened; save again to write over that",
                self.file.path.display()
            );
            return Err(Refusal::new(StatusCode::PRECONDITION_FAILED, &why));
        }
        let path = self.file.path.clone();
        saving::write(&self.model, &path, &wanted, &path).map_err(|error| Refusal::impossible(&error))?;
        self.file.note();
        Ok(Answer::json(&format!("written {}", path.display())))
    }
}

impl Model {
    fn points(&self) -> &[DVec3] {
        match self {
            Self::Mesh(mesh) => mesh.points(),
            Self::Bezier(bezier) => bezier.points(),
        }
    }

    fn kind(&self) -> &'static str {
        match self {
            Self::Mesh(mesh) if mesh.is_of_curves() => "curves",
            Self::Mesh(_) => "mesh",
            Self::Bezier(_) => "bezier",
        }
    }

    fn apply(&mut self, command: &Command) -> Result<String, MeshFileProblem> {
        match self {
            Self::Mesh(mesh) => mesh.apply(command),
            Self::Bezier(bezier) => bezier.apply(command),
        }
    }

    fn draw(&self, path: &Path, asked: &Asked) -> Result<Drawing, Error> {
        let located = |problem| Error::MeshFile { path: path.to_owned(), problem };
        match self {
            Self::Mesh(mesh) => mesh.draw(path, asked),
            Self::Bezier(bezier) => bezier.draw(asked).map_err(located),
        }
    }

    fn targets(&self) -> Drawing {
        match self {
            Self::Mesh(mesh) => mesh.targets(),
            // Nothing hides control points.
            Self::Bezier(bezier) => Drawing::of_points(bezier.points().to_vec()),
        }
    }

    fn why_no_edges(&self) -> Option<String> {
        match self {
            Self::Mesh(mesh) => mesh.why_no_edges(),
            Self::Bezier(_) => None,
        }
    }

    fn patches(&self) -> usize {
        match self {
            Self::Mesh(_) => 0,
            Self::Bezier(bezier) => bezier.count(),
        }
    }

    /// Whether a file of this name can hold what is edited: control points are kept by JSON alone.
    fn can_write(&self, path: &Path) -> bool {
        let format = crate::mesh::file::MeshFormat::of_path(path);
        match self {
            Self::Mesh(_) => format.is_some(),
            Self::Bezier(_) => format == Some(crate::mesh::file::MeshFormat::Json),
        }
    }
}
