//! Meshes, curves and Bezier patches to edit. Each command is kept; undoing one does those before it again.

mod bezier;
mod cage;
mod coloring;
mod command;
mod drawing;
mod pick;
mod saving;
mod subdivided;
mod surface;

use std::path::Path;

use glam::DVec3;
use hyper::StatusCode;
use serde::{Deserialize, Serialize};
use subzero::MeshError;

use super::answer::Answer;
use super::grains::Frame;
use super::packed::Packed;
use super::refusal::{Refusal, name, words};
use crate::error::Error;
use crate::error::mesh_file::MeshFileProblem;
use crate::mesh::file::MeshFile;
use crate::mesh::{BezierFile, read_bezier};
use bezier::EditedBezier;
use cage::Cage;
use command::Command;
use drawing::{Asked, Drawing, DrawingHead};
use pick::{Ray, pick};
use saving::{Opened, Wanted};
use surface::EditedMesh;

/// How many states are kept: one of a mesh of 100 000 triangles takes some 4 MB.
const MOST_STATES: usize = 16;

/// After how many commands a state is kept, beside those before global commands: undoing does no more again. A thousand take some milliseconds.
const STATE_EVERY: usize = 1000;

/// What is edited, and how it came to be.
#[derive(Debug)]
pub(super) struct Editor {
    file: Opened,
    frame: Frame,
    model: Model,
    /// Of the model as it is.
    cage: Cage,
    /// What a page was told last.
    told: Option<Told>,
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

/// What a page was told, so that it hears of changes alone.
#[derive(Debug)]
struct Told {
    number: u64,
    revision: u64,
    view: Asked,
    drawing: Drawing,
    packed: Packed,
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
    look: Look,
}

/// What a page wants to see.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Look {
    view: Asked,
    /// The number of what it was told last, so that it hears of changes alone.
    known: Option<u64>,
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
    look: Look,
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
    /// Of what is told here.
    told: u64,
    revision: u64,
    /// Commands that can be undone and done again.
    undo: usize,
    redo: usize,
    said: &'a str,
    /// Why edges cannot be edited.
    why_no_edges: Option<&'a str>,
    /// Number of Bezier curves and patches.
    patches: usize,
    /// Whether the file that was opened can be written.
    can_overwrite: bool,
    middle: [f64; 3],
    unit: f64,
    #[serde(flatten)]
    drawing: DrawingHead,
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
        let frame = Frame::around(model.points());
        Self {
            file: Opened::new(path),
            frame,
            cage: model.cage(frame),
            told: None,
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
            "/open" => self.draw(Look::default()),
            "/draw" => self.draw(words(body)?),
            "/edit" => self.change(words(body)?),
            "/hold" => self.hold(words(body)?),
            "/pick" => {
                let ray: Ray = words(body)?;
                Ok(Answer::json(&pick(ray, &self.cage)))
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

    fn change(&mut self, Change { revision, command, look }: Change) -> Result<Answer, Refusal> {
        if revision != self.revision {
            let why = "another page changed this in the meantime: look, and do it again";
            return Err(Refusal::new(StatusCode::CONFLICT, why));
        }
        let mut moved = None;
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
                if let Command::Move { point, .. } = command {
                    moved = Some(point);
                }
                // What was undone and not done again is replaced.
                self.log.truncate(self.done - 1);
                self.states.retain(|(done, _)| *done < self.done);
                self.log.push(command);
                said
            }
        };
        self.revision += 1;
        let Some(point) = moved else {
            self.cage = self.model.cage(self.frame);
            return self.draw(look);
        };
        self.cage.points[point as usize] = self.frame.in_frame(self.model.points()[point as usize]);
        // Curvatures are of the whole surface.
        let is_local = look.view.color != "curvature" && self.follow(point, &look, revision);
        if is_local { self.answer_told() } else { self.draw(look) }
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
        let is_far = self.done >= self.states.last().map_or(0, |(done, _)| done + STATE_EVERY);
        let before = (is_far || command.is_global()).then(|| self.model.clone());
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
    fn hold(&mut self, Held { point, to, look }: Held) -> Result<Answer, Refusal> {
        let place = self.frame.point(DVec3::from_array(to));
        let from = self.model.hold(point, place).map_err(|problem| Refusal::impossible(&problem))?;
        let answer = match self.follow(point, &look, self.revision) {
            true => self.answer_told(),
            false => {
                let place = std::mem::replace(&mut self.cage.points[point as usize], DVec3::from_array(to));
                let answer = self.draw(look);
                self.cage.points[point as usize] = place;
                answer
            }
        };
        // It was there before.
        let back = self.model.hold(point, from);
        debug_assert!(back.is_ok(), "{from}");
        answer
    }

    /// Moves a point, and what follows from it, in what a page was told of a revision; whether that can be done.
    fn follow(&mut self, point: u32, Look { view, known }: &Look, revision: u64) -> bool {
        let (Model::Mesh(mesh), Some(told)) = (&self.model, &mut self.told) else { return false };
        if mesh.is_of_curves()
            || *known != Some(told.number)
            || (&told.view, told.revision) != (view, revision)
        {
            return false;
        }
        let place = self.frame.place(mesh.points()[point as usize]);
        if let Some(surface) = &mut told.drawing.surface {
            let Some(written) = surface.follow(point, mesh.points()) else { return false };
            let points = surface.points();
            let places = written.iter().map(|vertex| (*vertex, self.frame.place(points[*vertex as usize])));
            told.packed.place(&[("points", vec![(point, place)]), ("surface_points", places.collect())]);
        } else {
            told.packed.place(&[("points", vec![(point, place)])]);
        }
        told.number += 1;
        told.revision = self.revision;
        true
    }

    fn draw(&mut self, Look { view, known }: Look) -> Result<Answer, Refusal> {
        let drawing = self.model.draw(&self.file.path, &view, &self.cage);
        let drawing = drawing.map_err(|error| Refusal::impossible(&error))?;
        let mut packed = drawing.packed(self.frame, &self.cage);
        if let Some(told) = self.told.as_ref().filter(|told| Some(told.number) == known) {
            packed.leave_out(&told.packed);
        }
        let number = self.told.as_ref().map_or(0, |told| told.number) + 1;
        self.told = Some(Told { number, revision: self.revision, view, drawing, packed });
        self.answer_told()
    }

    fn answer_told(&self) -> Result<Answer, Refusal> {
        let Some(told) = &self.told else { return Err(Refusal::impossible(&"nothing is shown")) };
        let head = Head {
            kind: "edit",
            model: self.model.kind(),
            name: name(&self.file.path),
            told: told.number,
            revision: self.revision,
            undo: self.done,
            redo: self.log.len() - self.done,
            said: &self.said,
            why_no_edges: self.model.why_no_edges(),
            patches: self.model.patches(),
            can_overwrite: self.file.path.is_file() && self.model.can_write(&self.file.path),
            middle: self.frame.middle().to_array(),
            unit: self.frame.unit(),
            drawing: told.drawing.head(&self.cage),
        };
        Ok(Answer::packed(told.packed.bytes(&head)?))
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

    /// Puts a point elsewhere; returns where it was.
    fn hold(&mut self, point: u32, place: DVec3) -> Result<DVec3, MeshFileProblem> {
        match self {
            Self::Mesh(mesh) => mesh.hold(point, place),
            Self::Bezier(bezier) => bezier.hold(point, place),
        }
    }

    fn cage(&self, frame: Frame) -> Cage {
        match self {
            Self::Mesh(mesh) => mesh.cage(frame),
            Self::Bezier(bezier) => bezier.cage(frame),
        }
    }

    fn draw(&self, path: &Path, asked: &Asked, cage: &Cage) -> Result<Drawing, Error> {
        let located = |problem| Error::MeshFile { path: path.to_owned(), problem };
        match self {
            Self::Mesh(mesh) => mesh.draw(path, asked, cage),
            Self::Bezier(bezier) => bezier.draw(asked, cage).map_err(located),
        }
    }

    fn why_no_edges(&self) -> Option<&str> {
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
