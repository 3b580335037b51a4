//! The files that a finished network goes to.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::anyhow;
use grainsmooth::{
    Config, DeckOutput, ElementOptions, Error, FileOptions, Html, LabelledFile, Output, OutputDirectory,
    OutputFormat, Picture, Png, Polycrystal, Progress, Stage, StagedFiles, StatisticsOutput, Summary,
    SummaryRecord, ToWrite, VolumeMeshOptions, check_gmsh, write_together,
};
use voronoi::Dimension;

use super::mesh::command_line;
use crate::progress::ProgressLine;
use crate::say;
use grainsmooth::cli::{
    Arguments, OutputArguments, PictureArguments, ResultArguments, SharedArguments, usage,
};

/// What is written, all found writable.
pub struct ResultFiles {
    to_write: ToWrite,
    /// The network and its voxels, by file.
    pub outputs: Vec<Output>,
    printed: Option<Printed>,
    grains: Option<OutputDirectory>,
    picture: Option<(Picture, Output<Png>)>,
    report: Option<Output<Html>>,
    summary: Option<Output<()>>,
    statistics: Option<StatisticsOutput>,
    deck: Option<DeckOutput>,
}

/// What goes to standard output.
#[derive(Clone, Copy)]
enum Printed {
    Network(OutputFormat),
    Summary,
}

/// What a file of input holds.
pub struct Given {
    pub dimension: Dimension,
    pub has_map: bool,
    pub has_orientations: bool,
    pub has_phases: bool,
    pub has_element_size: bool,
}

impl ResultFiles {
    /// Checks that all can be written and can hold what there will be; without a network if there will be none.
    ///
    /// # Errors
    /// [`Error::Usage`] where standard output is to take two things; what is wrong with a path.
    pub fn check(
        outputs: &OutputArguments,
        pictures: &PictureArguments,
        shared: &SharedArguments,
        to_write: &ToWrite,
        has_network: bool,
    ) -> Result<Self, Error> {
        let files = if has_network { outputs.outputs()? } else { Vec::new() };
        files.iter().try_for_each(|output| output.check_holds(to_write))?;
        let grains =
            outputs.grains_dir.as_ref().map(|path| OutputDirectory::check(path, outputs.grains_format));
        let grains = grains.transpose()?;
        if let Some(grains) = &grains {
            grains.check_dimension(to_write.dimension)?;
        }
        let network = if has_network { outputs.standard_output()? } else { None };
        let prints_summary = shared.json_summary.as_deref().is_some_and(|path| path.as_os_str() == "-");
        let printed = match (network, prints_summary) {
            (Some(_), true) => {
                return Err(usage(
                    "-o - and --json-summary - both go to standard output; give one of them a path",
                ));
            }
            (Some(format), false) => {
                format.check_holds(Path::new("standard output"), to_write)?;
                Some(Printed::Network(format))
            }
            (None, true) => Some(Printed::Summary),
            (None, false) => None,
        };
        let summary = shared.json_summary.as_deref().filter(|_| !prints_summary);
        let all = Self {
            to_write: *to_write,
            outputs: files,
            printed,
            grains,
            picture: pictures.picture()?,
            report: pictures.report()?,
            summary: summary.map(|path| Output::check_as(path, ())).transpose()?,
            statistics: outputs.statistics(to_write.dimension)?,
            deck: None,
        };
        all.check_elements()?;
        let deck = all.deck()?;
        let all = Self { deck, ..all };
        if all.need_gmsh() {
            check_gmsh()?;
        }
        Ok(all)
    }

    /// The same for what a file holds, and how files are written.
    ///
    /// # Errors
    /// [`Error::Usage`] where it does not hold what is asked for.
    pub fn of_given(
        arguments: &ResultArguments,
        path: &Path,
        given: Given,
    ) -> Result<(Self, FileOptions), Error> {
        let ResultArguments { outputs, pictures, shared } = arguments;
        let Given { dimension, has_map, has_orientations, has_phases, has_element_size } = given;
        pictures.check_known(path, has_orientations, has_phases)?;
        let file = outputs.options(dimension)?;
        let (voxels, volume) = (file.voxel_count(dimension), file.volume);
        let to_write = ToWrite {
            dimension,
            voxels,
            has_map,
            has_orientations,
            has_cells: false,
            has_element_size,
            volume,
        };
        let files = Self::check(outputs, pictures, shared, &to_write, true)?;
        check_all_differ(files.targets())?;
        files.check_voxels()?;
        Ok((files, file))
    }

    /// The same for the network of a file, which may get elements of a size, and this network.
    ///
    /// # Errors
    /// Also [`Error::NetworkOfMap`].
    pub fn of_network(
        arguments: &ResultArguments,
        path: &Path,
        network: &LabelledFile,
        has_element_size: bool,
    ) -> Result<(Self, Polycrystal), Error> {
        let given = Given {
            dimension: network.surface().elements.dimension(),
            has_map: false,
            has_orientations: network.orientations.is_some(),
            has_phases: network.phases.is_some(),
            has_element_size,
        };
        let (files, file) = Self::of_given(arguments, path, given)?;
        let domain = Arguments::domain_of(network);
        let mut polycrystal = Polycrystal::of_file(path, network, domain, command_line())?;
        *polycrystal.file_mut() = file;
        Ok((files, polycrystal))
    }

    /// Checks that what is asked of elements that fill grains goes into some file.
    fn check_elements(&self) -> Result<(), Error> {
        let (to_write, volume) = (&self.to_write, &self.to_write.volume);
        let elements = match to_write.dimension {
            Dimension::Two => "triangles that fill grains",
            Dimension::Three => "tetrahedra",
        };
        let has_voxels = self.formats().into_iter().any(|format| format.needs_voxel_elements(to_write));
        if volume.volume_mesh && !has_voxels && !self.need_elements() {
            return Err(usage(&format!(
                "--volume-mesh writes {elements}, but none of the files can hold them; give one of .vtu, .msh, .inp and .bdf, such as -o grains.vtu",
            )));
        }
        if volume.order.is_some() && !self.need_elements() {
            let without = if to_write.has_voxels() { ", without --voxels" } else { "" };
            return Err(usage(&format!(
                "--order needs {elements}; give --volume-mesh -o grains.vtu, or -o grains.inp{without}",
            )));
        }
        let has_properties = self.formats().into_iter().any(OutputFormat::has_plane_state);
        if volume.plane_state.is_some() && !has_properties {
            return Err(usage(
                "--plane-state is a property of elements in .inp and .bdf; give -o grains.inp, or leave it out",
            ));
        }
        let has_inp = self.formats().contains(&OutputFormat::INP);
        for (name, is_asked) in [
            ("periodic-equations", volume.periodic_equations),
            ("cohesive", volume.cohesive),
            ("solver-deck", volume.solver_deck.is_some()),
        ] {
            if is_asked && (!has_inp || self.to_write.has_voxels()) {
                return Err(usage(&format!(
                    "--{name} needs {elements} in .inp; give -o grains.inp without --voxels, or leave it out"
                )));
            }
        }
        Ok(())
    }

    /// The job for a solver, found writable; nothing where none is asked for.
    fn deck(&self) -> Result<Option<DeckOutput>, Error> {
        let Some(deck) = self.to_write.volume.solver_deck else { return Ok(None) };
        let Some(elements) = self.outputs.iter().find(|output| output.format() == OutputFormat::INP) else {
            return Err(usage("--solver-deck needs a file of elements; give -o grains.inp"));
        };
        DeckOutput::check(elements.path(), deck).map(Some)
    }

    /// Whether some format holds elements that fill grains.
    fn need_elements(&self) -> bool {
        self.formats().into_iter().any(|format| format.needs_elements(&self.to_write))
    }

    /// Whether Gmsh fills the grains.
    pub fn need_gmsh(&self) -> bool {
        self.to_write.dimension == Dimension::Three && self.need_elements()
    }

    /// All files and directories in full.
    pub fn targets(&self) -> Vec<PathBuf> {
        let tables = self.statistics.iter().flat_map(StatisticsOutput::files).map(Output::target);
        let others = tables.chain(self.grains.as_ref().map(OutputDirectory::target));
        let others = others.chain(self.picture.as_ref().map(|(_, output)| output.target()));
        let others = others.chain(self.report.as_ref().map(Output::target));
        let others = others.chain(self.summary.as_ref().map(Output::target));
        let others = others.chain(self.deck.as_ref().map(|deck| deck.output().target()));
        self.outputs.iter().flat_map(Output::targets).chain(others.map(Path::to_owned)).collect()
    }

    /// What the summary lists, as the user called it.
    pub fn paths(&self) -> Vec<PathBuf> {
        let outputs = self.outputs.iter().map(Output::path);
        let printed = self.printed.filter(|printed| matches!(printed, Printed::Network(_)));
        let printed = printed.map(|_| Path::new("standard output"));
        let grains = self.grains.as_ref().map(OutputDirectory::path);
        let picture = self.picture.as_ref().map(|(_, output)| output.path());
        let report = self.report.as_ref().map(Output::path);
        let statistics = self.statistics.iter().flat_map(StatisticsOutput::files).map(Output::path);
        let deck = self.deck.as_ref().map(|deck| deck.output().path());
        let paths = outputs.chain(deck).chain(printed).chain(grains).chain(picture).chain(report);
        let paths = paths.chain(statistics);
        paths.map(Path::to_owned).collect()
    }

    /// Checks that there is memory for the voxels of each file.
    pub fn check_voxels(&self) -> Result<(), Error> {
        self.formats().into_iter().try_for_each(|format| format.check_voxels(&self.to_write))
    }

    /// The formats of the network.
    pub fn formats(&self) -> Vec<OutputFormat> {
        let printed = match self.printed {
            Some(Printed::Network(format)) => Some(format),
            _ => None,
        };
        self.outputs.iter().map(Output::format).chain(printed).collect()
    }

    /// Fills the grains of a network that was given, where some file is to hold that, writes everything and returns the summary.
    pub fn fill_and_write(
        &self,
        mut polycrystal: Polycrystal,
        progress: Progress<'_>,
    ) -> Result<String, Error> {
        if self.need_elements() {
            check_solver_options(&polycrystal, &self.to_write.volume)?;
        }
        if self.need_gmsh() {
            progress(Stage::Filling, 0, 1);
            polycrystal = polycrystal.filled()?;
        }
        progress(Stage::Writing, 0, 1);
        let start = Instant::now();
        write_together(|staged| {
            self.stage(&polycrystal, staged)?;
            self.finish(&mut polycrystal, start, &self.paths(), staged)
        })?;
        Ok(with_paths(&Summary(&polycrystal), &self.paths()))
    }

    /// Completes all files but the report and the summary, which tell how long that takes.
    pub fn stage(&self, polycrystal: &Polycrystal, staged: &mut StagedFiles) -> Result<(), Error> {
        self.outputs.iter().try_for_each(|output| polycrystal.stage(output, staged))?;
        if let Some(grains) = &self.grains {
            polycrystal.stage_grains(grains, staged)?;
        }
        if let Some(statistics) = &self.statistics {
            polycrystal.statistics().stage(statistics, staged)?;
        }
        if let Some((picture, output)) = &self.picture {
            polycrystal.stage_picture(picture, output, staged)?;
        }
        if let Some(deck) = &self.deck {
            polycrystal.stage_solver_deck(deck, staged)?;
        }
        Ok(())
    }

    /// Completes the report and the summary, and writes to standard output. `paths` are those of all files.
    pub fn finish(
        &self,
        polycrystal: &mut Polycrystal,
        started: Instant,
        paths: &[PathBuf],
        staged: &mut StagedFiles,
    ) -> Result<(), Error> {
        polycrystal.add_time(Stage::Writing, started.elapsed());
        if let Some(output) = &self.report {
            polycrystal.stage_report(output, staged)?;
        }
        if let Some(output) = &self.summary {
            output.stage(staged, |out| write_summary(polycrystal, paths, out))?;
        }
        // What is said cannot be taken back: all else is complete by then, and needs no more than its name.
        self.print(polycrystal, paths)
    }

    /// Writes to standard output. A reader that stops early has enough.
    fn print(&self, polycrystal: &Polycrystal, paths: &[PathBuf]) -> Result<(), Error> {
        let mut out = BufWriter::new(io::stdout().lock());
        let printed = match self.printed {
            None => Ok(()),
            Some(Printed::Network(format)) => polycrystal.write_to(format, &mut out),
            Some(Printed::Summary) => write_summary(polycrystal, paths, &mut out),
        };
        match printed.and_then(|()| out.flush()) {
            Err(cause) if cause.kind() != io::ErrorKind::BrokenPipe => {
                Err(Error::WriteOutput { path: "standard output".into(), cause })
            }
            _ => Ok(()),
        }
    }
}

/// A summary and the files that were written.
pub fn with_paths(summary: &dyn Display, paths: &[PathBuf]) -> String {
    let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    format!("{summary}\nwritten     {}", names.join(", "))
}

/// Refuses two files of one path.
///
/// # Errors
/// [`Error::Usage`].
pub fn check_all_differ(targets: Vec<PathBuf>) -> Result<(), Error> {
    let mut known = BTreeSet::new();
    if let Some(path) = targets.into_iter().find(|target| !known.insert(target.clone())) {
        // As the user calls it, who gave no path from the root.
        let here = std::env::current_dir().and_then(|here| here.canonicalize()).unwrap_or_default();
        let path = path.strip_prefix(here).map_or(path.clone(), Path::to_owned);
        return Err(usage(&Error::OutputTwice { path }.to_string()));
    }
    Ok(())
}

/// Checks that what solvers are to have goes with a network that was given.
///
/// # Errors
/// [`Error::Usage`].
fn check_solver_options(polycrystal: &Polycrystal, volume: &VolumeMeshOptions) -> Result<(), Error> {
    let network = &polycrystal.network;
    let mut repeats = network.domain().periodic() | polycrystal.axes_cut_at_box();
    if polycrystal.dimension() == Dimension::Two {
        // The third axis has no meaning in the plane.
        repeats.z = repeats.x;
    }
    if volume.periodic_equations && !repeats.any() {
        return Err(usage(
            "--periodic-equations ties nodes that are one period apart, and this network does not repeat; leave it out",
        ));
    }
    let fills_box = network.domain().is_box() && network.fills_domain();
    if volume.solver_deck.is_some() && (!fills_box || repeats.any() != repeats.all()) {
        return Err(usage(
            "--solver-deck loads a box that grains fill, periodic along all axes or none; leave it out",
        ));
    }
    let file = FileOptions { volume: *volume, ..FileOptions::default() };
    let elements = ElementOptions {
        element_size: polycrystal.elements.as_ref().map(|elements| elements.size),
        ..ElementOptions::default()
    };
    let dimension = polycrystal.dimension();
    let options = Config { dimension, periodic: repeats, elements, file, ..Config::default() };
    options.check().map_err(|error| usage(&error.to_string()))
}

/// Runs a command on its threads, with its progress through some stages shown, and says what it returns.
pub fn show_run(
    shared: &SharedArguments,
    stages: Vec<Stage>,
    make: impl FnOnce(Progress<'_>) -> Result<String, Error> + Send,
) -> anyhow::Result<ExitCode> {
    let pool = thread_pool(shared)?;
    let line = ProgressLine::new(shared.quiet, stages);
    let summary = pool.install(|| make(&|stage, done, count| line.show(stage, done, count)));
    line.clear();
    if let Err(Error::Failed(failure)) = &summary
        && !shared.quiet
    {
        failure.attempts.iter().for_each(|attempt| say(&format!("given up    {attempt}")));
    }
    let summary = summary?;
    if !shared.quiet {
        say(&summary);
    }
    Ok(ExitCode::SUCCESS)
}

/// Threads to compute with.
pub fn thread_pool(shared: &SharedArguments) -> anyhow::Result<rayon::ThreadPool> {
    let threads = shared.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|cause| anyhow!("cannot start {threads} threads: {cause}; give fewer with --threads"))
}

fn write_summary(polycrystal: &Polycrystal, paths: &[PathBuf], out: &mut dyn Write) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *out, &SummaryRecord::new(polycrystal, paths.to_vec()))?;
    writeln!(out)
}
