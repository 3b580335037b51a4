//! What is edited as a file: for the browser to download, or over the file that was opened.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde::Deserialize;
use subzero::BezierError;

use super::Model;
use super::drawing::Asked;
use super::surface::EditedMesh;
use crate::error::Error;
use crate::error::mesh_file::MeshFileProblem;
use crate::files::output::OutputPath;
use crate::mesh::file::{MeshFormat, MeshToWrite, write_mesh};
use crate::mesh::{
    BezierFile, CarriedData, Connectivity, Scheme, bezier_json, levels_json, mesh_json, subdivide,
};
use crate::vtk::Cells;

/// What is told of itself by files that hold how they were made.
const MADE_BY: &str = "grainsmooth edit";

/// What to save, and where.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Wanted {
    /// The extension of a format.
    pub(super) format: String,
    /// The steps of subdivision, or what follows from control points; else what is edited itself.
    pub(super) view: Option<Asked>,
    /// Over the file that was opened, though another program has changed it.
    pub(super) anyway: bool,
}

/// The file that was opened, as it was then.
#[derive(Debug)]
pub(super) struct Opened {
    pub(super) path: PathBuf,
    changed: Option<SystemTime>,
}

impl Opened {
    pub(super) fn new(path: &Path) -> Self {
        Self { path: path.to_owned(), changed: changed(path) }
    }

    /// Whether another program has written the file since.
    pub(super) fn is_stale(&self) -> bool {
        changed(&self.path) != self.changed
    }

    /// Notes that this program has.
    pub(super) fn note(&mut self) {
        self.changed = changed(&self.path);
    }
}

fn changed(path: &Path) -> Option<SystemTime> {
    fs::metadata(path).and_then(|file| file.modified()).ok()
}

/// The bytes of a file of a format.
pub(super) fn bytes(model: &Model, of: &Path, wanted: &Wanted) -> Result<Vec<u8>, Error> {
    let failed = |cause| Error::WriteOutput { path: of.to_owned(), cause };
    let directory = tempfile::tempdir().map_err(failed)?;
    let path = directory.path().join(format!("saved.{}", wanted.format));
    write(model, of, wanted, &path)?;
    fs::read(path).map_err(failed)
}

/// Writes a file of the format of its name.
pub(super) fn write(model: &Model, of: &Path, wanted: &Wanted, path: &Path) -> Result<(), Error> {
    let located = |problem| Error::MeshFile { path: of.to_owned(), problem };
    let format = MeshFormat::of_path(path).ok_or_else(|| located(MeshFileProblem::NotWritten))?;
    let output = OutputPath::check_as(path, format)?;
    match model {
        Model::Mesh(mesh) => write_edited(mesh, of, wanted.view.as_ref(), &output),
        Model::Bezier(bezier) => {
            let file = bezier.file().map_err(located)?;
            let samples = wanted.view.as_ref().map_or(2, |view| view.samples.clamp(2, 200));
            match format {
                MeshFormat::Json => output.write(|out| bezier_json(&file, samples, out)),
                _ => write_bezier(&file, samples, of, &output),
            }
        }
    }
}

fn write_edited(
    edited: &EditedMesh,
    of: &Path,
    view: Option<&Asked>,
    output: &OutputPath<MeshFormat>,
) -> Result<(), Error> {
    let mesh = edited.current();
    let steps = view.and_then(|view| Some((Scheme::named(&view.scheme)?, view.level)));
    if let Some((scheme, level)) = steps {
        let levels = subdivide(&mesh, of, scheme, level)?;
        if output.format() == MeshFormat::Json {
            return output.write(|out| levels_json(&mesh, scheme, &levels, out));
        }
        let Some(last) = levels.last() else { return Ok(()) };
        let faces = last.mesh.faces();
        let (cells, arrays) = match &last.mesh {
            Connectivity::Triangles(triangles) => (Cells::Triangles(triangles.triangles()), &mesh.face_data),
            Connectivity::Polygons(_) => (Cells::Polygons(&faces), &mesh.face_data),
            Connectivity::Curves(_) => (Cells::Polylines(&faces), &mesh.line_data),
        };
        let data = CarriedData::new(&mesh, last, arrays, level > 0);
        return write_mesh(
            &MeshToWrite {
                generations: last.generations.as_deref(),
                point_data: &data.of_points,
                cell_data: &data.of_cells,
                field: &data.field,
                ..content(&last.points, cells)
            },
            output,
        );
    }
    if output.format() == MeshFormat::Json && !edited.is_of_curves() {
        return output.write(|out| mesh_json(&mesh, None, out));
    }
    let triangles = mesh.triangles();
    let (cells, arrays) = match &triangles {
        _ if edited.is_of_curves() => (Cells::Polylines(&mesh.lines), &mesh.line_data),
        Ok(triangles) => (Cells::Triangles(triangles), &mesh.face_data),
        Err(_) => (Cells::Polygons(&mesh.faces), &mesh.face_data),
    };
    let content = MeshToWrite {
        point_data: &mesh.point_data,
        cell_data: arrays,
        field: &mesh.field,
        ..content(&mesh.points, cells)
    };
    write_mesh(&content, output)
}

/// Curves as polylines; patches as one closed mesh.
fn write_bezier(
    file: &BezierFile,
    samples: u32,
    of: &Path,
    output: &OutputPath<MeshFormat>,
) -> Result<(), Error> {
    let located = |problem| Error::MeshFile { path: of.to_owned(), problem };
    let failed = |error: BezierError| located(error.into());
    match (file.curves.is_empty(), file.surfaces.is_empty()) {
        (false, false) => Err(located(MeshFileProblem::CurvesAndSurfaces)),
        (_, true) => {
            let (points, lines) = file.polylines(samples).map_err(failed)?;
            write_mesh(&content(&points, Cells::Polylines(&lines)), output)
        }
        (true, false) => {
            let merged = file.merged(samples, true).map_err(failed)?;
            write_mesh(&content(&merged.points, Cells::Triangles(&merged.triangles)), output)
        }
    }
}

fn content<'a>(points: &'a [glam::DVec3], cells: Cells<'a>) -> MeshToWrite<'a> {
    MeshToWrite::new(points, cells, MADE_BY)
}
