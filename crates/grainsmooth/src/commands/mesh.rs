//! `grainsmooth mesh`: reads a mesh, runs what the command line asks for, writes and reports.

use std::cell::RefCell;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::CommandFactory;
use clap::error::ErrorKind;
use glam::DVec3;
use grainsmooth::mesh::file::{
    MeshFile, MeshFileProblem, MeshFormat, MeshToWrite, read_mesh, read_polylines, stage_mesh, write_mesh,
};
use grainsmooth::mesh::{MeshEdit, construction_json};
use grainsmooth::vtk::Cells;
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
            let births = births(scheme, &levels);
            let first = if steps.each_level { 0 } else { levels.len() - 1 };
            write_together(|files| {
                levels[first..].iter().zip(&outputs).try_for_each(|(level, output)| {
                    let generations = births.as_ref().map(|births| &births[..level.points.len()]);
                    self.stage_level(level, &level.points, None, generations, output, files)
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
            let births = births(scheme, &levels);
            let normals: Vec<DVec3> = found.normals.iter().map(|normal| normal.unwrap_or_default()).collect();
            write_together(|files| {
                let births = births.as_deref();
                // Curves have none.
                let normals = Some(&normals[..]).filter(|_| scheme != Scheme::BSpline);
                self.stage_level(level, &found.positions, normals, births, &output, files)
            })?;
        }
        self.report_written(&[output]);
        Ok(())
    }

    fn normals(&self) -> Result<(), Error> {
        let output = self.output(&self.files.output)?;
        let mesh = self.read()?;
        let connectivity = mesh.polygon_mesh().map_err(|error| self.located(error))?;
        let normals = connectivity.vertex_normals(&mesh.points);
        self.report(format_args!("normals     {} points", normals.iter().flatten().count()));
        self.write_single(&output, &mesh, Some(&normals))
    }

    fn edit(&self, edits: &[MeshEdit]) -> Result<(), Error> {
        let output = self.output(&self.files.output)?;
        let mut mesh = self.read()?;
        for edit in edits {
            let edited = mesh.edit(edit).map_err(|error| self.located(error))?;
            self.report(format_args!("{edited}"));
        }
        let (points, faces) = (mesh.points.len(), mesh.faces.len());
        self.report(format_args!("edited      {points} points, {faces} faces"));
        self.write_single(&output, &mesh, None)
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
            let (normals, cell_numbers) = (Some(&normals[..]), Some(("Surface", &surfaces[..])));
            write_mesh(&MeshToWrite { normals, cell_numbers, ..content }, &output)?;
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
            let point_numbers = Some(("Level", &all.levels[..]));
            let cell_numbers = Some(("Level", &all.line_levels[..]));
            write_mesh(&MeshToWrite { point_numbers, cell_numbers, ..content }, &output)?;
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

    fn stage_level(
        &self,
        level: &Level,
        points: &[DVec3],
        normals: Option<&[DVec3]>,
        generations: Option<&[i8]>,
        output: &Output<MeshFormat>,
        files: &mut StagedFiles,
    ) -> Result<(), Error> {
        let polygons;
        let cells = match &level.mesh {
            Connectivity::Triangles(mesh) => Cells::Triangles(mesh.triangles()),
            Connectivity::Polygons(_) => {
                polygons = level.mesh.faces();
                Cells::Polygons(&polygons)
            }
            Connectivity::Curves(curves) => Cells::Polylines(&curves.lines),
        };
        stage_mesh(&MeshToWrite { normals, generations, ..self.content(points, cells) }, output, files)
    }

    /// Writes a mesh in any format.
    fn write_single(
        &self,
        output: &Output<MeshFormat>,
        mesh: &MeshFile,
        normals: Option<&[Option<DVec3>]>,
    ) -> Result<(), Error> {
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
            let content = self.content(&mesh.points, cells);
            write_mesh(&MeshToWrite { normals: normals.as_deref(), ..content }, output)?;
        }
        self.report_written(std::slice::from_ref(output));
        Ok(())
    }

    fn content<'a>(&'a self, points: &'a [DVec3], cells: Cells<'a>) -> MeshToWrite<'a> {
        let command_line = &self.command_line;
        let encoding = self.files.vtk.vtk_encoding;
        MeshToWrite {
            points,
            cells,
            normals: None,
            generations: None,
            point_numbers: None,
            cell_numbers: None,
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

/// For each point of the last level the level at which it was born; nothing for Doo and Sabin's scheme, whose points are
/// all new at each level.
fn births(scheme: Scheme, levels: &[Level]) -> Option<Vec<i8>> {
    if matches!(scheme, Scheme::DooSabin(_)) {
        return None;
    }
    let mut births = Vec::new();
    for (index, level) in levels.iter().enumerate() {
        births.resize(level.points.len(), i8::try_from(index).unwrap_or(i8::MAX));
    }
    Some(births)
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
