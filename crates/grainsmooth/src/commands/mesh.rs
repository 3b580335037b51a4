//! `grainsmooth mesh`: reads a mesh, runs what the command line asks for, writes and reports.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::CommandFactory;
use clap::error::ErrorKind;
use glam::DVec3;
use grainsmooth::mesh::file::{
    MeshFile, MeshFileProblem, MeshFormat, MeshToWrite, read_mesh, read_polylines, stage_mesh, write_mesh,
};
use grainsmooth::mesh::{CarriedData, MeshEdit, construction_json};
use grainsmooth::vtk::{Cells, DataArray};
use grainsmooth::{
    BezierFile, Connectivity, Error, Level, Output, Scheme, StagedFiles, bezier_json, levels_json, limits,
    mesh_json, read_bezier, subdivide, write_together,
};
use subzero::{INFINITE_SHARPNESS, MergedSurfaces, MeshError};

use crate::cli::mesh::{Features, FileArguments, LimitArguments, Merge, MeshCommand, StepArguments, Task};
use crate::cli::{Arguments, usage};
use crate::say;

/// Runs a subcommand.
///
/// Ends the program with exit status 2 where the output's extension names no format.
pub fn run(command: &MeshCommand) -> Result<(), Error> {
    let (files, task) = command.task();
    let Some(format) = files.format() else {
        let message = format!(
            "{}: unknown extension; name the file *.vtp, *.vtu, *.vtk, *.obj, *.ply, *.stl or *.json",
            files.output.display()
        );
        Arguments::command().error(ErrorKind::ValueValidation, message).exit()
    };
    let job = Job { files, format, command_line: command_line(), report: RefCell::default() };
    job.run(task)?;
    // A run that fails says one line, its error.
    if !files.quiet {
        say(&job.report.take().join("\n"));
    }
    Ok(())
}

/// The files of a run.
struct Job<'a> {
    files: &'a FileArguments,
    format: MeshFormat,
    command_line: String,
    /// What there is to say about it, line by line.
    report: RefCell<Vec<String>>,
}

impl Job<'_> {
    fn run(&self, task: Task<'_>) -> Result<(), Error> {
        match task {
            Task::Subdivide(scheme, steps, features) => self.subdivide(scheme, steps, features),
            Task::Limit(scheme, arguments) => self.limit(scheme, arguments),
            Task::Normals => self.normals(),
            Task::Edit(edits) => self.edit(&edits),
            Task::Bezier { samples, merge: None } => self.bezier(samples),
            Task::Bezier { samples, merge: Some(merge) } => self.merged(samples, merge),
            Task::Construction { t } => self.construction(t),
        }
    }

    fn subdivide(&self, scheme: Scheme, steps: &StepArguments, features: Features<'_>) -> Result<(), Error> {
        if steps.each_level && self.format == MeshFormat::Json {
            usage("--each-level is a file a level, but JSON holds all levels in one; leave it out");
        }
        // Outputs that cannot be written are found before the work.
        let last = steps.levels;
        let outputs = if steps.each_level {
            (0..=last).map(|level| self.output(&of_level(&self.files.output, level))).collect()
        } else {
            self.output(&self.files.output).map(|output| vec![output])
        }?;
        let mesh = self.read_with(features)?;
        let levels = subdivide(&mesh, &self.files.input, scheme, last)?;
        if steps.closed {
            levels[0].mesh.check_closed().map_err(|error| self.located(error))?;
        }
        for (index, level) in levels.iter().enumerate() {
            let (points, faces) = (level.points.len(), level.mesh.face_count());
            let kind = if matches!(level.mesh, Connectivity::Curves(_)) { "segments" } else { "faces" };
            self.report(format_args!("level {index:<5} {points} points, {faces} {kind}"));
        }
        if self.format == MeshFormat::Json {
            outputs[0].write(|out| levels_json(&mesh, scheme, &levels, out))?;
        } else {
            let first = if steps.each_level { 0 } else { levels.len() - 1 };
            write_together(|files| {
                (first..).zip(&levels[first..]).zip(&outputs).try_for_each(|((index, level), output)| {
                    let is_changed = index > 0 && scheme != Scheme::Midpoint;
                    self.stage_level(&mesh, level, None, is_changed, output, files)
                })
            })?;
        }
        self.report_written(&outputs);
        Ok(())
    }

    fn limit(&self, scheme: Scheme, arguments: &LimitArguments) -> Result<(), Error> {
        let output = self.output(&self.files.output)?;
        let features = &arguments.features;
        let mesh = match scheme {
            Scheme::BSpline => {
                if !features.creases.is_empty() || features.boundary.is_some() {
                    usage("--crease and --boundary are of surfaces; give --corners to curves");
                }
                let mut mesh = self.read_lines()?;
                mesh.corners.extend(&features.corners);
                mesh
            }
            _ => self.read_with(Features::OfSurface(features))?,
        };
        let levels = subdivide(&mesh, &self.files.input, scheme, arguments.levels)?;
        let level = &levels[levels.len() - 1];
        // A level without limits is an error here, where JSON of all levels leaves it out.
        let found = limits(level, scheme).map_err(|error| self.located(error))?.unwrap_or_default();
        let with_normal = found.normals.iter().flatten().count();
        self.report(format_args!("limit       {} points, {with_normal} with a normal", level.points.len()));
        if self.format == MeshFormat::Json {
            output.write(|out| levels_json(&mesh, scheme, &levels, out))?;
        } else {
            let normals: Vec<DVec3> = found.normals.iter().map(|normal| normal.unwrap_or_default()).collect();
            // Curves have none.
            let normals = Some(&normals[..]).filter(|_| scheme != Scheme::BSpline);
            let at_limit = Level { points: found.positions, ..level.clone() };
            write_together(|files| self.stage_level(&mesh, &at_limit, normals, true, &output, files))?;
        }
        self.report_written(&[output]);
        Ok(())
    }

    fn normals(&self) -> Result<(), Error> {
        let output = self.output(&self.files.output)?;
        let before = self.read()?;
        let connectivity = before.polygon_mesh().map_err(|error| self.located(error))?;
        let normals = connectivity.vertex_normals(&before.points);
        self.report(format_args!("normals     {} points", normals.iter().flatten().count()));
        let mut mesh = before.clone();
        mesh.point_data.retain(|array| array.name != "Normals");
        self.write_single(&output, &before, &mesh, Some(&normals))
    }

    fn edit(&self, edits: &[MeshEdit]) -> Result<(), Error> {
        let output = self.output(&self.files.output)?;
        let before = self.read()?;
        let mut mesh = before.clone();
        for edit in edits {
            let edited = mesh.edit(edit).map_err(|error| self.located(error))?;
            self.report(format_args!("{edited}"));
        }
        let (points, faces) = (mesh.points.len(), mesh.faces.len());
        self.report(format_args!("edited      {points} points, {faces} faces"));
        self.write_single(&output, &before, &mesh, None)
    }

    fn bezier(&self, samples: u32) -> Result<(), Error> {
        let output = self.output(&self.files.output)?;
        let file = self.read_control_points()?;
        let (curves, surfaces) = (file.curves.len(), file.surfaces.len());
        let located = |error: MeshError| self.located(error.into());
        if self.format == MeshFormat::Json {
            output.write(|out| bezier_json(&file, samples, out))?;
        } else if surfaces == 0 {
            let (points, polylines) = file.polylines(samples).map_err(located)?;
            write_mesh(&self.content(&points, Cells::Polylines(&polylines)), &output)?;
        } else if curves == 0 {
            let (points, normals, triangles) = file.triangles(samples).map_err(located)?;
            let content = self.content(&points, Cells::Triangles(&triangles));
            write_mesh(&MeshToWrite { normals: Some(&normals), ..content }, &output)?;
        } else {
            return Err(self.located(MeshFileProblem::CurvesAndSurfaces));
        }
        self.report_written(&[output]);
        Ok(())
    }

    /// All surfaces of a file as one mesh.
    fn merged(&self, samples: u32, merge: Merge) -> Result<(), Error> {
        let output = self.output(&self.files.output)?;
        let file = self.read_control_points()?;
        if file.surfaces.is_empty() {
            return Err(self.located(MeshFileProblem::NoSurfaces));
        }
        let merged =
            file.merged(samples, merge == Merge::Closed).map_err(|error| self.located(error.into()))?;
        let MergedSurfaces { seams, poles, filled, holes, .. } = merged;
        self.report(format_args!(
            "merged      {seams} seams and {poles} poles; {filled} holes filled, {holes} left: {} points, {} triangles",
            merged.points.len(),
            merged.triangles.len()
        ));
        let number = |surface: &Option<u32>| surface.map_or(-1, u32::cast_signed);
        let surfaces: Vec<i32> = merged.surface_of.iter().map(number).collect();
        let faces = merged.triangles.iter().map(|triangle| triangle.to_vec()).collect();
        let mesh = MeshFile { points: merged.points, faces, ..MeshFile::default() };
        let connectivity = mesh.polygon_mesh().map_err(|error| self.located(error))?;
        let normals = connectivity.vertex_normals(&mesh.points);
        if self.format == MeshFormat::Json {
            output.write(|out| mesh_json(&mesh, Some(&normals), out))?;
        } else {
            let normals: Vec<DVec3> = normals.into_iter().map(Option::unwrap_or_default).collect();
            let content = self.content(&mesh.points, Cells::Triangles(&merged.triangles));
            let (normals, cell_data) = (Some(&normals[..]), &[DataArray::int32("Surface", surfaces)][..]);
            write_mesh(&MeshToWrite { normals, cell_data, ..content }, &output)?;
        }
        self.report_written(&[output]);
        Ok(())
    }

    /// De Casteljau's points on all curves of a file.
    fn construction(&self, t: f64) -> Result<(), Error> {
        let output = self.output(&self.files.output)?;
        let file = self.read_control_points()?;
        if file.curves.is_empty() {
            return Err(self.located(MeshFileProblem::NoCurves));
        }
        let all = file.construction(t).map_err(|error| self.located(error.into()))?;
        for curve in &file.curves {
            let DVec3 { x, y, z } = curve.point(t);
            self.report(format_args!("point       {x:?} {y:?} {z:?} after {} levels", curve.degree()));
        }
        if self.format == MeshFormat::Json {
            output.write(|out| construction_json(&file, t, out))?;
        } else {
            let content = self.content(&all.points, Cells::Polylines(&all.lines));
            let level = |levels: &Vec<i32>| [DataArray::int32("Level", levels.clone())];
            let (point_data, cell_data) = (&level(&all.levels)[..], &level(&all.line_levels)[..]);
            write_mesh(&MeshToWrite { point_data, cell_data, ..content }, &output)?;
        }
        self.report_written(&[output]);
        Ok(())
    }

    fn read_control_points(&self) -> Result<BezierFile, Error> {
        let file = read_bezier(&self.files.input)?;
        let (curves, surfaces) = (file.curves.len(), file.surfaces.len());
        self.report(format_args!("read        {curves} curves and {surfaces} surfaces"));
        Ok(file)
    }

    /// The surface, without polylines that the file may have.
    fn read(&self) -> Result<MeshFile, Error> {
        let mut mesh = read_mesh(&self.files.input)?;
        let (points, faces, lines) = (mesh.points.len(), mesh.faces.len(), mesh.lines.len());
        self.report(format_args!("read        {points} points, {faces} faces"));
        if lines > 0 {
            self.report(format_args!("dropped     {lines} polylines beside the faces"));
            mesh.lines.clear();
        }
        if let Some(corners) = mesh.welded_corners {
            self.report(format_args!(
                "welded      {corners} corners with exactly equal coordinates to {points} points"
            ));
        }
        Ok(mesh)
    }

    /// The polylines, without faces that the file may have.
    fn read_lines(&self) -> Result<MeshFile, Error> {
        let mut mesh = read_polylines(&self.files.input)?;
        let (points, faces, lines) = (mesh.points.len(), mesh.faces.len(), mesh.lines.len());
        self.report(format_args!("read        {points} points, {lines} polylines"));
        if faces > 0 {
            self.report(format_args!("dropped     {faces} faces beside the polylines"));
            mesh.faces.clear();
        }
        Ok(mesh)
    }

    /// The mesh or polylines, with the creases and corners of the command line beside those of the file.
    fn read_with(&self, features: Features<'_>) -> Result<MeshFile, Error> {
        match features {
            Features::OfSurface(features) => {
                let mut mesh = self.read()?;
                mesh.creases.extend(&features.creases);
                mesh.corners.extend(&features.corners);
                if let Some(boundary) = features.boundary {
                    mesh.boundary = boundary.into();
                }
                Ok(mesh)
            }
            Features::OfCurves { corners } => {
                let mut mesh = self.read_lines()?;
                mesh.corners.extend(corners.iter().map(|&corner| (corner, INFINITE_SHARPNESS)));
                Ok(mesh)
            }
        }
    }

    /// Completes a level as a file, with what keeps a meaning of the arrays of the mesh that it comes from.
    fn stage_level(
        &self,
        mesh: &MeshFile,
        level: &Level,
        normals: Option<&[DVec3]>,
        shape_changes: bool,
        output: &Output<MeshFormat>,
        files: &mut StagedFiles,
    ) -> Result<(), Error> {
        let polygons;
        let (cells, arrays) = match &level.mesh {
            Connectivity::Triangles(triangles) => (Cells::Triangles(triangles.triangles()), &mesh.face_data),
            Connectivity::Polygons(_) => {
                polygons = level.mesh.faces();
                (Cells::Polygons(&polygons[..]), &mesh.face_data)
            }
            Connectivity::Curves(curves) => (Cells::Polylines(&curves.lines[..]), &mesh.line_data),
        };
        let data = CarriedData::new(mesh, level, arrays, shape_changes);
        self.report_data(mesh, &data.names(normals.is_some()));
        let content = MeshToWrite {
            normals,
            generations: level.generations.as_deref(),
            point_data: &data.of_points,
            cell_data: &data.of_cells,
            field: &data.field,
            ..self.content(&level.points, cells)
        };
        stage_mesh(&content, output, files)
    }

    /// Writes a mesh in any format; `before` is that of the file it was made of.
    fn write_single(
        &self,
        output: &Output<MeshFormat>,
        before: &MeshFile,
        mesh: &MeshFile,
        normals: Option<&[Option<DVec3>]>,
    ) -> Result<(), Error> {
        let mut names = mesh.data_names();
        names.extend(normals.map(|_| "Normals".to_owned()));
        self.report_data(before, &names);
        if self.format == MeshFormat::Json {
            output.write(|out| mesh_json(mesh, normals, out))?;
        } else {
            let normals: Option<Vec<DVec3>> =
                normals.map(|normals| normals.iter().map(|normal| normal.unwrap_or_default()).collect());
            let triangles = mesh.triangles();
            let cells = match &triangles {
                Ok(triangles) => Cells::Triangles(triangles),
                Err(_) => Cells::Polygons(&mesh.faces),
            };
            let content = MeshToWrite {
                normals: normals.as_deref(),
                point_data: &mesh.point_data,
                cell_data: &mesh.face_data,
                field: &mesh.field,
                ..self.content(&mesh.points, cells)
            };
            write_mesh(&content, output)?;
        }
        self.report_written(std::slice::from_ref(output));
        Ok(())
    }

    /// Says once which arrays of a file are in what was made of it, and which are not, and why.
    fn report_data(&self, mesh: &MeshFile, written: &[String]) {
        let holds_arrays = matches!(self.format, MeshFormat::Vtk(_));
        let (kept, dropped): (Vec<String>, Vec<String>) =
            mesh.data_names().into_iter().partition(|name| holds_arrays && written.contains(name));
        let mut lines = Vec::new();
        if !kept.is_empty() {
            lines.push(format!("kept        {}", kept.join(", ")));
        }
        let mut by_reason: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for name in dropped {
            let why = if holds_arrays { mesh.why_dropped(&name) } else { "the format holds no arrays" };
            by_reason.entry(why).or_default().push(name);
        }
        lines.extend(
            by_reason.into_iter().map(|(why, names)| format!("dropped     {}: {why}", names.join(", "))),
        );
        for line in lines {
            if !self.report.borrow().contains(&line) {
                self.report(format_args!("{line}"));
            }
        }
    }

    fn content<'a>(&'a self, points: &'a [DVec3], cells: Cells<'a>) -> MeshToWrite<'a> {
        let command_line = &self.command_line;
        let encoding = self.files.vtk.vtk_encoding;
        MeshToWrite {
            points,
            cells,
            normals: None,
            generations: None,
            point_data: &[],
            cell_data: &[],
            field: &[],
            command_line,
            encoding,
        }
    }

    fn output(&self, path: &Path) -> Result<Output<MeshFormat>, Error> {
        Output::check_as(path, self.format)
    }

    fn located(&self, problem: MeshFileProblem) -> Error {
        Error::MeshFile { path: self.files.input.clone(), problem }
    }

    fn report_written(&self, outputs: &[Output<MeshFormat>]) {
        for output in outputs {
            self.report(format_args!("written     {}", output.path().display()));
        }
    }

    fn report(&self, line: std::fmt::Arguments<'_>) {
        self.report.borrow_mut().push(line.to_string());
    }
}

/// `out.vtp` as `out_2.vtp`.
fn of_level(path: &Path, level: u32) -> PathBuf {
    let mut name = OsString::from(path.file_stem().unwrap_or_default());
    name.push(format!("_{level}"));
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

/// The command line as it was typed, words with blanks in quotes.
fn command_line() -> String {
    let quoted = |word: OsString| {
        let word = word.to_string_lossy().into_owned();
        if word.contains(char::is_whitespace) || word.is_empty() { format!("'{word}'") } else { word }
    };
    let words = std::env::args_os().skip(1).map(quoted);
    std::iter::once("grainsmooth".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}
