//! The files of a series: those named, and those that a collection of ParaView (.pvd) names.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::super::refusal::name;
use crate::Error;
use crate::vtk::attribute;

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
            let label = |tag: &str| format!("time {}", attribute(tag, "timestep").unwrap_or("?"));
            steps.extend(files_of(path)?.into_iter().map(|(tag, path)| Step { label: label(&tag), path }));
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
    let is_network = |(tag, _): &(String, PathBuf)| attribute(tag, "name") == Some("boundaries");
    let block = files_of(path)?.into_iter().find(is_network);
    block.map(|(_, path)| path).ok_or_else(|| Error::NoBoundariesBlock { path: path.to_owned() })
}

/// The files that a file of VTK's collections names, with their tags.
fn files_of(path: &Path) -> Result<Vec<(String, PathBuf)>, Error> {
    let text = std::fs::read_to_string(path)
        .map_err(|cause| Error::CollectionUnreadable { path: path.to_owned(), cause })?;
    let tags = text.split("<DataSet").skip(1).filter_map(|rest| rest.split_once('>'));
    let folder = path.parent().unwrap_or(Path::new(""));
    let files: Vec<(String, PathBuf)> = tags
        .filter_map(|(tag, _)| Some((tag.to_owned(), folder.join(unescaped(attribute(tag, "file")?)))))
        .collect();
    if files.is_empty() { Err(Error::EmptyCollection { path: path.to_owned() }) } else { Ok(files) }
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

fn unescaped(text: &str) -> String {
    text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&")
}
