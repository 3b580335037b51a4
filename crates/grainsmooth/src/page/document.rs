//! What a page shows.

use std::path::{Path, PathBuf};

use clap::ValueEnum;

use super::answer::Answer;
use super::edit::Editor;
use super::grains::Grains;
use crate::error::Error;
use crate::error::mesh_file::MeshFileProblem;
use crate::mesh::file::{read_mesh, read_polylines};

/// What a server shows: the grains of some files, or what is edited.
#[derive(Debug)]
pub struct PageDocument(Kind);

#[derive(Debug)]
enum Kind {
    Grains(Box<Grains>),
    Editor(Box<Editor>),
}

impl PageDocument {
    /// Networks of grains to look at: of one file, or one after the other of several, or of a collection (.pvd). The first is read.
    ///
    /// # Errors
    /// As of [`LabelledFile::read`](crate::LabelledFile::read); where a collection names no files that can be read.
    pub fn grains(paths: &[PathBuf]) -> Result<Self, Error> {
        Grains::open(paths).map(|grains| Self(Kind::Grains(Box::new(grains))))
    }

    /// A mesh, polylines or Bezier curves and patches to edit, as the file is read by `grainsmooth mesh`. Where nothing is said, .bpt files and
    /// JSON with control points are of Bezier's, and files without faces of polylines.
    ///
    /// # Errors
    /// [`Error::MeshFile`].
    pub fn edit(path: &Path, content: Option<EditContent>) -> Result<Self, Error> {
        let mesh = || Ok(Editor::of_mesh(path, read_mesh(path)?));
        let curves = || Ok(Editor::of_mesh(path, read_polylines(path)?));
        let editor = match content.or_else(|| bezier_of(path)) {
            Some(EditContent::Bezier) => Editor::of_bezier(path),
            Some(EditContent::Curves) => curves(),
            Some(EditContent::Mesh) => mesh(),
            None => match mesh() {
                Err(Error::MeshFile { problem: MeshFileProblem::OnlyPolylines, .. }) => curves(),
                other => other,
            },
        };
        Ok(Self(Kind::Editor(Box::new(editor?))))
    }

    /// The Utah teapot to edit.
    ///
    /// # Errors
    /// None that it is known to meet.
    pub fn teapot() -> Result<Self, Error> {
        Ok(Self(Kind::Editor(Box::new(Editor::of_teapot()?))))
    }

    /// A number that grows with each change.
    pub(super) fn revision(&self) -> u64 {
        match &self.0 {
            Kind::Grains(_) => 0,
            Kind::Editor(editor) => editor.revision(),
        }
    }

    /// What a command says.
    pub(super) fn answer(&mut self, path: &str, body: &[u8]) -> Answer {
        let said = match &mut self.0 {
            Kind::Grains(grains) => grains.answer(path, body),
            Kind::Editor(editor) => editor.answer(path, body),
        };
        said.unwrap_or_else(|refusal| refusal.0)
    }
}

/// What a file holds that is edited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EditContent {
    /// Faces.
    Mesh,
    /// Polylines.
    Curves,
    /// Control points of Bezier curves and patches.
    Bezier,
}

/// Bezier's, where the name or the keys of a file tell them.
fn bezier_of(path: &Path) -> Option<EditContent> {
    let extension = path.extension()?.to_ascii_lowercase();
    let is_bezier = match extension.to_str()? {
        "bpt" => true,
        "json" => {
            let keys: serde_json::Map<String, serde_json::Value> =
                serde_json::from_slice(&std::fs::read(path).ok()?).ok()?;
            ["curves", "surfaces", "surface", "patches", "control"].iter().any(|key| keys.contains_key(*key))
        }
        _ => false,
    };
    is_bezier.then_some(EditContent::Bezier)
}
