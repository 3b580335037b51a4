//! The files of a series: those named, and those that a collection of ParaView (.pvd) names.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::super::refusal::name;
use crate::Error;
use crate::files::read_input;
use crate::vtk::{Element, document};

/// A file of a series.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Step {
    /// What the page calls it.
    pub(super) label: String,
    #[serde(skip)]
    pub(super) path: PathBuf,
}

/// All steps of some files.
pub(super) fn steps(paths: &[PathBuf]) -> Result<Vec<Step>, Error> {
    let mut steps = Vec::new();
    for path in paths {
        if has_extension(path, "pvd") {
            let label = |time: Option<String>| format!("time {}", time.as_deref().unwrap_or("?"));
            let files = files_of(path, "timestep")?.into_iter();
            steps.extend(files.map(|(time, path)| Step { label: label(time), path }));
        } else {
            steps.push(Step { label: name(path), path: path.clone() });
        }
    }
    Ok(steps)
}

/// The file with the network itself: of blocks (.vtm), the boundaries.
pub(super) fn network_of(path: &Path) -> Result<PathBuf, Error> {
    if !has_extension(path, "vtm") {
        return Ok(path.to_owned());
    }
    let is_network = |(name, _): &(Option<String>, PathBuf)| name.as_deref() == Some("boundaries");
    let block = files_of(path, "name")?.into_iter().find(is_network);
    block.map(|(_, path)| path).ok_or_else(|| Error::NoBoundariesBlock { path: path.to_owned() })
}

/// The files that one of VTK's collections names, each with an attribute of its element.
fn files_of(path: &Path, attribute: &str) -> Result<Vec<(Option<String>, PathBuf)>, Error> {
    let text = read_input(path, "file")?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let document = document(&text);
    let file =
        |element: &Element<'_>| Some((element.attribute(attribute), folder.join(element.attribute("file")?)));
    let files: Vec<_> = document.all("DataSet").into_iter().filter_map(file).collect();
    if files.is_empty() { Err(Error::EmptyCollection { path: path.to_owned() }) } else { Ok(files) }
}

/// Whether a file is of a format.
pub(super) fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}
