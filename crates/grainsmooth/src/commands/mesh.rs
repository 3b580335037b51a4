//! `grainsmooth mesh`: reads a mesh, runs what the command line asks for, writes and reports.

mod bezier;
mod files;
mod shown;

use std::cell::RefCell;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use clap::CommandFactory;
use clap::error::ErrorKind;
use glam::DVec3;
use grainsmooth::mesh::MeshEdit;
use grainsmooth::mesh::file::{MeshFileProblem, MeshFormat};
use grainsmooth::vtk::VtkFormat;
use grainsmooth::{
    Connectivity, Error, Level, Output, Scheme, levels_json, limits, subdivide, write_collection,
};

use crate::say;
use files::scene_of_level;
use grainsmooth::cli::mesh::{Features, FileArguments, LimitArguments, MeshCommand, StepArguments, Task};
use grainsmooth::cli::{Arguments, usage};
use shown::{Scenes, Shown};

/// Runs a subcommand.
///
/// Ends the program with exit status 2 where the output's extension names no format.
pub fn run(command: &MeshCommand) -> Result<(), Error> {
    let (files, task) = command.task();
    let in_levels = matches!(&task, Task::Subdivide(_, steps, _) if steps.each_level);
    // A collection names files of levels.
    let of_collection = (in_levels && files.is_collection()).then_some(MeshFormat::Vtk(VtkFormat::Vtp));
    let Some(format) = files.format().or(of_collection) else {
        let message = format!(
            "{}: unknown extension; name the file *.vtp, *.vtu, *.vtk, *.obj, *.ply, *.stl or *.json",
            files.output.display()
        );
        Arguments::command().error(ErrorKind::ValueValidation, message).exit()
    };
    let shown = Shown::new(files)?;
    let job = Job { files, format, shown, command_line: command_line(), report: RefCell::default() };
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
    shown: Shown,
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
            Task::Construction { t, v } => self.construction(t, v),
        }
    }

    fn subdivide(&self, scheme: Scheme, steps: &StepArguments, features: Features<'_>) -> Result<(), Error> {
        if steps.each_level && self.format == MeshFormat::Json {
            return Err(usage(
                "--each-level writes one file per level, but JSON holds all levels in one; leave it out",
            ));
        }
        // Outputs that cannot be written are found before the work.
        let last = steps.levels;
        let outputs = if steps.each_level {
            (0..=last).map(|level| self.output(&of_level(&self.files.output, level))).collect()
        } else {
            self.output(&self.files.output).map(|output| vec![output])
        }?;
        let has_collection =
            steps.each_level && matches!(self.format, MeshFormat::Vtk(VtkFormat::Vtp | VtkFormat::Vtu));
        let collection = has_collection
            .then(|| Output::check_as(self.files.output.with_extension("pvd"), ()))
            .transpose()?;
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
        let first = if steps.each_level { 0 } else { levels.len() - 1 };
        let is_changed = |index: usize| index > 0 && scheme != Scheme::Midpoint;
        let scenes = || {
            let shown = (first..levels.len())
                .map(|index| self.scene_of_level(&mesh, &levels[index], is_changed(index)));
            Ok(Scenes { before: scene_of_level(&levels[0]), levels: shown.collect::<Result<_, Error>>()? })
        };
        let written = outputs.iter().map(Output::path).chain(collection.iter().map(Output::path));
        self.write(written.map(Path::to_owned).collect(), scenes, |files| {
            if self.format == MeshFormat::Json {
                return outputs[0].stage(files, |out| levels_json(&mesh, scheme, &levels, out));
            }
            for ((index, level), output) in (first..).zip(&levels[first..]).zip(&outputs) {
                self.stage_level(&mesh, level, None, is_changed(index), output, files)?;
            }
            match &collection {
                Some(collection) => {
                    let times = (0..=last).map(f64::from).zip(outputs.iter().map(Output::path));
                    collection.stage(files, |out| write_collection(times, out))
                }
                None => Ok(()),
            }
        })
    }

    fn limit(&self, scheme: Scheme, arguments: &LimitArguments) -> Result<(), Error> {
        let output = self.output(&self.files.output)?;
        let features = &arguments.features;
        let mesh = match scheme {
            Scheme::BSpline => {
                if !features.creases.is_empty() || features.boundary.is_some() {
                    return Err(usage(
                        "--crease and --boundary apply to surfaces only; for curves, give --corners",
                    ));
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
        let normals: Vec<DVec3> = found.normals.iter().map(|normal| normal.unwrap_or_default()).collect();
        // Curves have none.
        let normals = Some(&normals[..]).filter(|_| scheme != Scheme::BSpline);
        let at_limit = Level { points: found.positions, ..level.clone() };
        let scenes = || {
            let shown = self.scene_of_level(&mesh, &at_limit, true)?;
            Ok(Scenes { before: scene_of_level(&levels[0]), levels: vec![shown] })
        };
        self.write(vec![output.path().to_owned()], scenes, |files| match self.format {
            MeshFormat::Json => output.stage(files, |out| levels_json(&mesh, scheme, &levels, out)),
            _ => self.stage_level(&mesh, &at_limit, normals, true, &output, files),
        })
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

    fn output(&self, path: &Path) -> Result<Output<MeshFormat>, Error> {
        Output::check_as(path, self.format)
    }

    fn located(&self, problem: MeshFileProblem) -> Error {
        Error::MeshFile { path: self.files.input.clone(), problem }
    }

    fn report(&self, line: std::fmt::Arguments<'_>) {
        self.report.borrow_mut().push(line.to_string());
    }
}

/// `out.vtp` as `out_2.vtp`, and so `out.pvd`.
fn of_level(path: &Path, level: u32) -> PathBuf {
    let mut name = OsString::from(path.file_stem().unwrap_or_default());
    name.push(format!("_{level}"));
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(if extension.eq_ignore_ascii_case("pvd") { OsStr::new("vtp") } else { extension });
    }
    path.with_file_name(name)
}

/// The command line as it was typed, words with blanks in quotes.
pub fn command_line() -> String {
    let quoted = |word: OsString| {
        let word = word.to_string_lossy().into_owned();
        if word.contains(char::is_whitespace) || word.is_empty() { format!("'{word}'") } else { word }
    };
    let words = std::env::args_os().skip(1).map(quoted);
    std::iter::once("grainsmooth".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}
