//! A relaxation as a time series for ParaView.

use std::io::{self, Write};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

use glam::DVec3;
use polycrystal::{Junctions, Moving, Network, NetworkError, RelaxationStep, Relaxed};
use quick_xml::escape::escape;
use voronoi::Tessellation;

use crate::{Error, Output, OutputFormat, Polycrystal, StagedFiles, Synthesis};

/// The steps of a relaxation, every so many of them.
#[derive(Debug, Clone)]
pub struct Series {
    every: NonZeroU32,
    frames: Vec<Frame>,
}

/// The moved points after a step.
#[derive(Debug, Clone)]
struct Frame {
    time: f64,
    level: usize,
    points: Vec<DVec3>,
    of: FrameOf,
}

/// What the points of a frame are those of.
#[derive(Debug, Clone)]
enum FrameOf {
    /// A level of the finished network.
    Finished,
    /// The network of cells on their way.
    Cells(Box<Tessellation>),
    /// Grains on their way.
    Grains(Box<Network>),
}

/// Where a series goes, found writable.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SeriesOutput {
    collection: Output<()>,
}

impl SeriesOutput {
    /// Checks that a series can be written at `path`, which is to end in `.pvd`, with its steps beside.
    ///
    /// # Errors
    /// As of [`Output::check_as`].
    pub fn check(path: &Path) -> Result<Self, Error> {
        let output = Self { collection: Output::check_as(path, ())? };
        output.step(0)?;
        Ok(output)
    }

    /// The path as it was given.
    pub fn path(&self) -> &Path {
        self.collection.path()
    }

    /// The collection from the root on, or what it links to.
    pub fn target(&self) -> &Path {
        self.collection.target()
    }

    /// The file of a step: `a_0003.vtp` beside `a.pvd`.
    fn step(&self, number: usize) -> Result<Output, Error> {
        Output::check_as(step_path(self.path(), number), OutputFormat::VTP)
    }
}

/// Where the series at `path` has this step.
pub(crate) fn step_path(path: &Path, number: usize) -> PathBuf {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{name}_{number:04}.vtp"))
}

impl Series {
    /// A series of the start, of every so many steps, and of the end.
    pub fn new(every: NonZeroU32) -> Self {
        Self { every, frames: Vec::new() }
    }

    /// Takes a step up, if it is one of these.
    ///
    /// # Errors
    /// Where the network of a step cannot be made.
    pub fn add(&mut self, step: &RelaxationStep<'_>) -> Result<(), NetworkError> {
        // What folded is taken back and tried again.
        self.frames.retain(|frame| frame.time < step.time);
        if step.done.is_multiple_of(self.every.get() as usize) {
            let (level, points, of) = match step.now {
                Moving::Points { level, points } => (level, points.to_vec(), FrameOf::Finished),
                Moving::Cells(cells) => {
                    let (cells, points) = cells();
                    (0, points, FrameOf::Cells(Box::new(cells)))
                }
                Moving::Grains(network) => {
                    let (network, points) = network()?;
                    (0, points, FrameOf::Grains(Box::new(network)))
                }
            };
            self.frames.push(Frame { time: step.time, level, points, of });
        }
        Ok(())
    }

    /// Completes each step as a surface file, and the collection, which ParaView opens. The times in it are in the unit of
    /// the relaxation time: the mean grain size squared, at unit mobility and tension. The last step is the polycrystal itself.
    ///
    /// # Errors
    /// [`Error::WriteOutput`]; [`Error::OutputTwice`].
    pub fn stage(
        &self,
        polycrystal: &mut Polycrystal,
        output: &SeriesOutput,
        files: &mut StagedFiles,
    ) -> Result<(), Error> {
        let Some(Synthesis { relaxed, .. }) = polycrystal.synthesis() else { return Ok(()) };
        let Relaxed { level, time, .. } = *relaxed;
        let finest = polycrystal.network.level_count();
        let is_before = |frame: &&Frame| frame.level <= level && frame.time < time;
        let mut times = Vec::new();
        for frame in self.frames.iter().filter(is_before) {
            let network = match &frame.of {
                FrameOf::Finished => None,
                FrameOf::Cells(cells) => Some(network_of(cells, polycrystal)?),
                FrameOf::Grains(network) => Some((**network).clone()),
            };
            let of_frame = network.as_ref().unwrap_or(&polycrystal.network);
            let points = of_frame.subdivide_between(frame.level, finest, &frame.points);
            let finished = std::mem::replace(&mut polycrystal.points, points);
            let last = network.map(|network| std::mem::replace(&mut polycrystal.network, network));
            let written = output.step(times.len()).and_then(|step| polycrystal.stage(&step, files));
            polycrystal.points = finished;
            if let Some(last) = last {
                polycrystal.network = last;
            }
            written?;
            times.push(frame.time);
        }
        polycrystal.stage(&output.step(times.len())?, files)?;
        times.push(time);
        let steps = times.into_iter().enumerate();
        let steps = steps.map(|(number, time)| (time, step_path(output.path(), number)));
        output.collection.stage(files, |out| write_collection(steps, out))
    }
}

/// Writes a collection for ParaView (`.pvd`): times and the files, beside it, that hold what there is then.
///
/// # Errors
/// Whatever `out` reports.
pub fn write_collection(
    files: impl IntoIterator<Item = (f64, impl AsRef<Path>)>,
    out: &mut dyn Write,
) -> io::Result<()> {
    writeln!(out, "<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>")?;
    for (time, path) in files {
        let name = path.as_ref().file_name().unwrap_or_default().to_string_lossy();
        let file = escape(&name);
        writeln!(out, "<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{file}\"/>")?;
    }
    writeln!(out, "</Collection>\n</VTKFile>")
}

/// The network of cells on their way to those of a finished one.
fn network_of(cells: &Tessellation, polycrystal: &Polycrystal) -> Result<Network, NetworkError> {
    let finished = &polycrystal.network;
    let junctions = polycrystal.synthesis().map_or_else(Junctions::default, |made| made.config.junctions);
    let (mut network, _) = Network::new(cells, junctions, finished.level_count())?;
    if let Some(Synthesis { cells, .. }) = polycrystal.synthesis() {
        network = cells.law.apply(network)?;
    }
    Ok(network.with_cell_volumes(finished.cell_volumes().to_vec()))
}
