//! The `grainsmooth` program: reads the command line, runs the pipeline, reports.

mod check_run;
mod cli;
mod mesh_cli;
mod mesh_run;
mod progress;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::anyhow;
use grainsmooth::mesh_file::READER_THREAD;
use grainsmooth::{
    CellTable, Output, OutputDirectory, Series, SeriesOutput, Stage, StatisticsOutput, Summary, TableFormat,
    check_expected_size, smooth_watched, tessellate,
};

use cli::{Arguments, Command};
use progress::ProgressLine;

fn main() -> ExitCode {
    match run(&Arguments::read()) {
        Ok(code) => code,
        Err(error) => {
            say(&format!("error: {error}"));
            ExitCode::FAILURE
        }
    }
}

/// Writes a line to standard error. Where nobody can read it the run is no worse for that.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// A panic over a corrupt VTK file becomes an error, and needs no words of its own.
fn keep_reader_quiet() {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if std::thread::current().name() != Some(READER_THREAD) {
            hook(info);
        }
    }));
}

fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    if let Some(command) = &arguments.command {
        keep_reader_quiet();
        return match command {
            Command::Mesh(mesh) => Ok(mesh_run::run(&mesh.command).map(|()| ExitCode::SUCCESS)?),
            Command::Check(check) => check_run::run(check),
        };
    }
    // An output that cannot be written is found before hours of work, not after.
    let tables = tables(arguments)?;
    let output = if arguments.run.no_mesh { None } else { Some(Output::check(&arguments.files.output)?) };
    if let Some(output) = &output {
        output.check_fits(&arguments.config())?;
    }
    let grains = arguments
        .files
        .grains_dir
        .as_ref()
        .map(|path| arguments.files.grains_format.check(path))
        .transpose()?;
    if let Some(grains) = &grains {
        grains.check_fits(&arguments.config())?;
    }
    let statistics = arguments.files.statistics(arguments.config().dimension)?;
    let series = arguments.files.series()?;
    let threads = arguments.run.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|cause| anyhow!("cannot start {threads} threads: {cause}; give fewer with --threads"))?;
    let line = ProgressLine::new(arguments.run.quiet);
    let files = Files { tables, output, grains, statistics, series };
    let result = pool.install(|| compute(arguments, &files, &line));
    line.clear();
    let summary = result?;
    if !arguments.run.quiet {
        let names: Vec<String> = files.paths().iter().map(|path| path.display().to_string()).collect();
        say(&format!("{summary}\nwritten     {}", names.join(", ")));
    }
    Ok(ExitCode::SUCCESS)
}

/// The tables asked for, found writable.
fn tables(arguments: &Arguments) -> Result<Vec<Output<TableFormat>>, grainsmooth::Error> {
    let json = arguments.files.cells_json.iter().map(|path| Output::check_as(path, TableFormat::Json));
    let csv = arguments.files.cells_csv.iter().map(|path| Output::check_as(path, TableFormat::Csv));
    json.chain(csv).collect()
}

/// What is written, all found writable.
struct Files {
    tables: Vec<Output<TableFormat>>,
    output: Option<Output>,
    grains: Option<OutputDirectory>,
    statistics: Option<StatisticsOutput>,
    series: Option<SeriesOutput>,
}

impl Files {
    fn paths(&self) -> Vec<PathBuf> {
        let tables = self.tables.iter().map(Output::path);
        let grains = self.grains.as_ref().map(OutputDirectory::path);
        let meshes = tables.chain(self.output.as_ref().map(Output::path)).chain(grains);
        let statistics = self.statistics.iter().flat_map(StatisticsOutput::paths);
        let series = self.series.iter().map(|series| series.path().to_owned());
        meshes.map(Path::to_owned).chain(statistics).chain(series).collect()
    }
}

/// Computes and writes what is asked for, and returns the summary.
fn compute(arguments: &Arguments, files: &Files, line: &ProgressLine) -> Result<String, grainsmooth::Error> {
    let config = arguments.config();
    let progress = |stage, done, count| line.show(stage, done, count);
    if files.output.is_some() {
        check_expected_size(&config)?;
    }
    let tessellated = tessellate(&config, &progress)?;
    if !files.tables.is_empty() {
        let table = CellTable::new(&tessellated);
        files.tables.iter().try_for_each(|output| table.write(output))?;
    }
    let Some(output) = &files.output else {
        let tessellation = &tessellated.tessellation;
        let lattice = config.lattice_fit().map_or(String::new(), |fit| format!("\nlattice     {fit}"));
        return Ok(format!(
            "cells       {} in {}{lattice}",
            tessellation.cell_count(),
            tessellation.domain()
        ));
    };
    let mut series = Series::new(arguments.files.every);
    let mut polycrystal = smooth_watched(&config, tessellated, &progress, |step| {
        if files.series.is_some() {
            series.add(&step);
        }
    })?;
    line.show(Stage::Writing, 0, 1);
    let start = Instant::now();
    polycrystal.write(output)?;
    if let Some(grains) = &files.grains {
        polycrystal.write_grains(grains)?;
    }
    if let Some(statistics) = &files.statistics {
        polycrystal.statistics().write(statistics)?;
    }
    if let Some(output) = &files.series {
        series.write(&mut polycrystal, output)?;
    }
    polycrystal.add_time(Stage::Writing, start.elapsed());
    Ok(Summary(&polycrystal).to_string())
}
