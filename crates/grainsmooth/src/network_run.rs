//! A run of the pipeline: from the command line to files and summary.

use std::io::Write;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::anyhow;
use grainsmooth::{
    CellTable, Config, Error, Estimate, Html, Output, OutputDirectory, Picture, Png, Polycrystal, Series,
    SeriesOutput, Stage, StatisticsOutput, Summary, SummaryRecord, TableFormat, check_expected_size,
    smooth_watched, tessellate,
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
        writeln!(std::io::stdout(), "{estimate}")?;
        estimate.check()?;
        return Ok(ExitCode::SUCCESS);
    }
    let result = pool.install(|| compute(&config, &files, &line));
    line.clear();
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
    output: Option<Output>,
    grains: Option<OutputDirectory>,
    picture: Option<(Picture, Output<Png>)>,
    report: Option<Output<Html>>,
    summary: Option<Output<()>>,
    statistics: Option<StatisticsOutput>,
    series: Option<(SeriesOutput, NonZeroU32)>,
}

impl Files {
    fn check(arguments: &Arguments, config: &Config) -> Result<Self, Error> {
        let (files, run) = (&arguments.files, &arguments.run);
        let json = files.cells_json.iter().map(|path| Output::check_as(path, TableFormat::Json));
        let csv = files.cells_csv.iter().map(|path| Output::check_as(path, TableFormat::Csv));
        let tables = json.chain(csv).collect::<Result<_, _>>()?;
        let output = if run.no_mesh { None } else { Some(files.output()?) };
        if let Some(output) = &output {
            output.check_fits(config)?;
        }
        let grains = files.grains_dir.as_ref().map(|path| files.grains_format.check(path)).transpose()?;
        if let Some(grains) = &grains {
            grains.check_fits(config)?;
        }
        let summary = run.json_summary.as_deref().map(|path| match path.as_os_str() == "-" {
            true if files.is_standard_output() => {
                usage("-o - and --json-summary - both go to standard output; give one of them a path")
            }
            true => Ok(Output::to_standard_output(())),
            false => Output::check_as(path, ()),
        });
        let (picture, report) = (arguments.pictures.picture()?, arguments.pictures.report()?);
        let statistics = files.statistics(config.dimension)?;
        let series = files.series()?.map(|output| (output, files.every));
        Ok(Self {
            tables,
            output,
            grains,
            picture,
            report,
            summary: summary.transpose()?,
            statistics,
            series,
        })
    }

    fn paths(&self) -> Vec<PathBuf> {
        let tables = self.tables.iter().map(Output::path);
        let grains = self.grains.as_ref().map(OutputDirectory::path);
        let picture = self.picture.as_ref().map(|(_, output)| output.path());
        let report = self.report.as_ref().map(Output::path);
        let meshes = tables.chain(self.output.as_ref().map(Output::path)).chain(grains);
        let statistics = self.statistics.iter().flat_map(StatisticsOutput::paths);
        let series = self.series.iter().map(|(output, _)| output.path().to_owned());
        meshes.chain(picture).chain(report).map(Path::to_owned).chain(statistics).chain(series).collect()
    }
}

/// Cuts the cells and tells what would become of them.
fn estimate(config: &Config, files: &Files, line: &ProgressLine) -> Result<Estimate, Error> {
    let cells = tessellate(config, &|stage, done, count| line.show(stage, done, count))?;
    Ok(Estimate::new(config, &cells, files.output.as_ref().map(Output::format)))
}

/// Computes and writes what is asked for, and returns the summary.
fn compute(config: &Config, files: &Files, line: &ProgressLine) -> Result<String, Error> {
    let progress = |stage, done, count| line.show(stage, done, count);
    if files.output.is_some() {
        check_expected_size(config)?;
    }
    let tessellated = tessellate(config, &progress)?;
    if !files.tables.is_empty() {
        let table = CellTable::new(config, &tessellated);
        files.tables.iter().try_for_each(|output| table.write(output))?;
    }
    let Some(output) = &files.output else {
        let tessellation = &tessellated.tessellation;
        let lattice = config.lattice_report(tessellation.domain(), tessellation.cell_count());
        let lattice = lattice.map_or(String::new(), |lattice| format!("\nlattice     {lattice}"));
        return Ok(format!(
            "cells       {} in {}{lattice}",
            tessellation.cell_count(),
            tessellation.domain()
        ));
    };
    let mut series = files.series.as_ref().map(|(output, every)| (output, Series::new(*every)));
    let mut polycrystal = smooth_watched(config, tessellated, &progress, |step| {
        if let Some((_, series)) = &mut series {
            series.add(&step);
        }
    })?;
    polycrystal = polycrystal.cut_if_asked()?;
    line.show(Stage::Writing, 0, 1);
    let start = Instant::now();
    polycrystal.write(output)?;
    if let Some(grains) = &files.grains {
        polycrystal.write_grains(grains)?;
    }
    if let Some(statistics) = &files.statistics {
        polycrystal.statistics().write(statistics)?;
    }
    if let Some((output, series)) = &series {
        series.write(&mut polycrystal, output)?;
    }
    if let Some((picture, output)) = &files.picture {
        polycrystal.write_picture(picture, output)?;
    }
    polycrystal.add_time(Stage::Writing, start.elapsed());
    // After the time is taken, for the report tells it.
    if let Some(output) = &files.report {
        polycrystal.write_report(output)?;
    }
    if let Some(summary) = &files.summary {
        write_summary(&polycrystal, files.paths(), summary)?;
    }
    Ok(Summary(&polycrystal).to_string())
}

fn write_summary(polycrystal: &Polycrystal, written: Vec<PathBuf>, output: &Output<()>) -> Result<(), Error> {
    let record = SummaryRecord::new(polycrystal, written);
    output.write(|out| {
        serde_json::to_writer_pretty(&mut *out, &record)?;
        writeln!(out)
    })
}
