//! A run of the pipeline: from the command line to files and summary.

use std::collections::BTreeSet;
use std::io::{self, BufWriter, Write};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::anyhow;
use grainsmooth::{
    CellTable, CellsSummary, Config, Error, Estimate, Html, Output, OutputDirectory, OutputFormat, Picture,
    Png, Polycrystal, Series, SeriesOutput, Stage, StagedFiles, StatisticsOutput, Summary, SummaryRecord,
    Synthesis, TableFormat, Tessellated, check_expected_size, check_gmsh, smooth_watched, tessellate,
    write_together,
};

use crate::cli::{Arguments, usage};
use crate::progress::ProgressLine;
use crate::say;

/// Runs what the command line asks for.
pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let config = arguments.config()?;
    // An output that cannot be written is found before hours of work, not after.
    let files = Files::check(arguments, &config)?;
    let threads = arguments.run.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|cause| anyhow!("cannot start {threads} threads: {cause}; give fewer with --threads"))?;
    let line = ProgressLine::new(arguments.run.quiet);
    if arguments.run.dry_run {
        let estimate = pool.install(|| estimate(&config, &files, &line));
        line.clear();
        let estimate = estimate?;
        writeln!(io::stdout(), "{estimate}")?;
        estimate.check()?;
        files.check_space(&config)?;
        return Ok(ExitCode::SUCCESS);
    }
    files.check_space(&config)?;
    let result = pool.install(|| compute(&config, &files, &line));
    line.clear();
    if let Err(Error::Failed(failure)) = &result
        && !arguments.run.quiet
    {
        failure.attempts.iter().for_each(|attempt| say(&format!("given up    {attempt}")));
    }
    let summary = result?;
    if !arguments.run.quiet {
        let names: Vec<String> = files.paths().iter().map(|path| path.display().to_string()).collect();
        say(&format!("{summary}\nwritten     {}", names.join(", ")));
    }
    Ok(ExitCode::SUCCESS)
}

/// What is written, all found writable.
struct Files {
    tables: Vec<Output<TableFormat>>,
    /// The network and its voxels, by file.
    outputs: Vec<Output>,
    printed: Option<Printed>,
    grains: Option<OutputDirectory>,
    picture: Option<(Picture, Output<Png>)>,
    report: Option<Output<Html>>,
    summary: Option<Output<()>>,
    statistics: Option<StatisticsOutput>,
    series: Option<(SeriesOutput, NonZeroU32)>,
    /// Whether cells are all that is asked for.
    is_cells_only: bool,
}

/// What goes to standard output.
#[derive(Clone, Copy)]
enum Printed {
    Network(OutputFormat),
    Summary,
}

impl Files {
    /// Checks that all can be written, each under a path of its own.
    fn check(arguments: &Arguments, config: &Config) -> Result<Self, Error> {
        let (files, run) = (&arguments.files, &arguments.run);
        let json = files.cells_json.iter().map(|path| Output::check_as(path, TableFormat::Json));
        let csv = files.cells_csv.iter().map(|path| Output::check_as(path, TableFormat::Csv));
        let tables = json.chain(csv).collect::<Result<_, _>>()?;
        let is_cells_only = run.no_mesh;
        let outputs = if is_cells_only { Vec::new() } else { files.outputs()? };
        outputs.iter().try_for_each(|output| output.check_fits(config))?;
        let grains = files
            .grains_dir
            .as_ref()
            .map(|path| OutputDirectory::check(path, files.grains_format))
            .transpose()?;
        if let Some(grains) = &grains {
            grains.check_fits(config)?;
        }
        let network = if is_cells_only { None } else { files.standard_output() };
        let prints_summary = run.json_summary.as_deref().is_some_and(|path| path.as_os_str() == "-");
        let printed = match (network, prints_summary) {
            (Some(_), true) => {
                usage("-o - and --json-summary - both go to standard output; give one of them a path")
            }
            (Some(format), false) => {
                format.check_fits(Path::new("standard output"), config)?;
                Some(Printed::Network(format))
            }
            (None, true) => Some(Printed::Summary),
            (None, false) => None,
        };
        let summary = run.json_summary.as_deref().filter(|_| !prints_summary);
        let summary = summary.map(|path| Output::check_as(path, ())).transpose()?;
        let (picture, report) = (arguments.pictures.picture()?, arguments.pictures.report()?);
        let statistics = files.statistics(config.dimension)?;
        let series = files.series()?.map(|output| (output, files.every));
        let all = Self {
            tables,
            outputs,
            printed,
            grains,
            picture,
            report,
            summary,
            statistics,
            series,
            is_cells_only,
        };
        // Before hours of work, not after.
        if all.formats().into_iter().any(|format| format.needs_tetrahedra(config)) {
            check_gmsh()?;
        }
        let mut targets = BTreeSet::new();
        if let Some(path) = all.targets().into_iter().find(|target| !targets.insert(target.clone())) {
            // As the user calls it, who gave no path from the root.
            let here = std::env::current_dir().and_then(|here| here.canonicalize()).unwrap_or_default();
            let path = path.strip_prefix(here).map_or(path.clone(), Path::to_owned);
            usage(&Error::OutputTwice { path }.to_string());
        }
        Ok(all)
    }

    /// Checks that there is room for what is known to be large.
    fn check_space(&self, config: &Config) -> Result<(), Error> {
        self.outputs.iter().try_for_each(|output| output.check_space(config))
    }

    /// All files and directories in full, but for the steps of a series.
    fn targets(&self) -> Vec<PathBuf> {
        let outputs = self.outputs.iter().flat_map(Output::targets);
        let tables = self.tables.iter().chain(self.statistics.iter().flat_map(StatisticsOutput::files));
        let others = tables.map(Output::target).chain(self.grains.as_ref().map(OutputDirectory::target));
        let others = others.chain(self.picture.as_ref().map(|(_, output)| output.target()));
        let others = others.chain(self.report.as_ref().map(Output::target));
        let others = others.chain(self.summary.as_ref().map(Output::target));
        let others = others.chain(self.series.as_ref().map(|(output, _)| output.target()));
        outputs.chain(others.map(Path::to_owned)).collect()
    }

    /// What the summary lists, as the user called it.
    fn paths(&self) -> Vec<PathBuf> {
        let tables = self.tables.iter().map(Output::path);
        let outputs = self.outputs.iter().map(Output::path);
        let printed = self.printed.filter(|printed| matches!(printed, Printed::Network(_)));
        let printed = printed.map(|_| Path::new("standard output"));
        let grains = self.grains.as_ref().map(OutputDirectory::path);
        let picture = self.picture.as_ref().map(|(_, output)| output.path());
        let report = self.report.as_ref().map(Output::path);
        let statistics = self.statistics.iter().flat_map(StatisticsOutput::files).map(Output::path);
        let series = self.series.iter().map(|(output, _)| output.path());
        let paths = tables.chain(outputs).chain(printed).chain(grains).chain(picture).chain(report);
        paths.chain(statistics).chain(series).map(Path::to_owned).collect()
    }

    /// The formats of the network.
    fn formats(&self) -> Vec<OutputFormat> {
        let printed = match self.printed {
            Some(Printed::Network(format)) => Some(format),
            _ => None,
        };
        self.outputs.iter().map(Output::format).chain(printed).collect()
    }
}

/// Cuts the cells and tells what would become of them.
fn estimate(config: &Config, files: &Files, line: &ProgressLine) -> Result<Estimate, Error> {
    let cells = tessellate(config, &|stage, done, count| line.show(stage, done, count))?;
    Ok(Estimate::new(config, &cells, &files.formats()))
}

/// Computes and writes what is asked for, and returns the summary.
fn compute(config: &Config, files: &Files, line: &ProgressLine) -> Result<String, Error> {
    let progress = |stage, done, count| line.show(stage, done, count);
    if files.is_cells_only {
        let cells = tessellate(config, &progress)?.stretched(config);
        write_together(|staged| files.stage_tables(config, &cells, staged))?;
        return Ok(CellsSummary(config, &cells).to_string().trim_end().to_owned());
    }
    check_expected_size(config)?;
    let tessellated = tessellate(config, &progress)?;
    let mut series = files.series.as_ref().map(|(output, every)| (output, Series::new(*every)));
    let mut added = Ok(());
    let mut polycrystal = smooth_watched(config, tessellated, &progress, |step| {
        if let (Some((_, series)), Ok(())) = (&mut series, &added) {
            added = series.add(&step);
        }
    })?;
    added?;
    polycrystal = polycrystal.cut_if_asked()?.stretched_if_asked();
    line.show(Stage::Remeshing, 0, 1);
    polycrystal = polycrystal.remeshed_if_asked()?;
    if files.formats().into_iter().any(|format| format.needs_tetrahedra(config)) {
        line.show(Stage::Filling, 0, 1);
        polycrystal = polycrystal.filled()?;
    }
    line.show(Stage::Writing, 0, 1);
    let start = Instant::now();
    write_together(|staged| {
        if let Some(Synthesis { cells, .. }) = polycrystal.synthesis() {
            files.stage_tables(config, cells, staged)?;
        }
        files.outputs.iter().try_for_each(|output| polycrystal.stage(output, staged))?;
        if let Some(grains) = &files.grains {
            polycrystal.stage_grains(grains, staged)?;
        }
        if let Some(statistics) = &files.statistics {
            polycrystal.statistics().stage(statistics, staged)?;
        }
        if let Some((output, series)) = &series {
            series.stage(&mut polycrystal, output, staged)?;
        }
        if let Some((picture, output)) = &files.picture {
            polycrystal.stage_picture(picture, output, staged)?;
        }
        polycrystal.add_time(Stage::Writing, start.elapsed());
        // After the time is taken, for the report tells it.
        if let Some(output) = &files.report {
            polycrystal.stage_report(output, staged)?;
        }
        if let Some(output) = &files.summary {
            output.stage(staged, |out| write_summary(&polycrystal, files, out))?;
        }
        // What is said cannot be taken back: all else is complete by then, and needs no more than its name.
        files.print(&polycrystal)
    })?;
    Ok(Summary(&polycrystal).to_string())
}

impl Files {
    fn stage_tables(
        &self,
        config: &Config,
        cells: &Tessellated,
        staged: &mut StagedFiles,
    ) -> Result<(), Error> {
        if self.tables.is_empty() {
            return Ok(());
        }
        let table = CellTable::new(config, cells);
        self.tables.iter().try_for_each(|output| table.stage(output, staged))
    }

    /// Writes to standard output. A reader that stops early has enough.
    fn print(&self, polycrystal: &Polycrystal) -> Result<(), Error> {
        let mut out = BufWriter::new(io::stdout().lock());
        let printed = match self.printed {
            None => Ok(()),
            Some(Printed::Network(format)) => polycrystal.write_to(format, &mut out),
            Some(Printed::Summary) => write_summary(polycrystal, self, &mut out),
        };
        match printed.and_then(|()| out.flush()) {
            Err(cause) if cause.kind() != io::ErrorKind::BrokenPipe => {
                Err(Error::WriteOutput { path: "standard output".into(), cause })
            }
            _ => Ok(()),
        }
    }
}

fn write_summary(polycrystal: &Polycrystal, files: &Files, out: &mut dyn Write) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *out, &SummaryRecord::new(polycrystal, files.paths()))?;
    writeln!(out)
}
