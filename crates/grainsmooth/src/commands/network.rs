//! A run of the pipeline: from the command line to files and summary.

use std::io::{self, Write};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use grainsmooth::{
    CellTable, CellsSummary, Config, ElementOptions, Error, Estimate, ListedSummary, Output, Progress,
    Series, SeriesOutput, Stage, StagedFiles, Summary, Synthesis, TableFormat, check_expected_size,
    list_cells, smooth_watched, tessellate, write_together,
};

use super::result_files::{ResultFiles, check_all_differ, show_run, thread_pool, with_paths};
use crate::progress::ProgressLine;
use grainsmooth::cli::Arguments;

/// Runs what the command line asks for.
pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let config = arguments.config()?;
    // An output that cannot be written is found before hours of work, not after.
    let files = Files::check(arguments, &config)?;
    let shared = &arguments.run.shared;
    if arguments.run.dry_run {
        let line = ProgressLine::new(shared.quiet, files.stages(&config));
        let estimate = thread_pool(shared)?.install(|| estimate(&config, &files, &line));
        line.clear();
        let estimate = estimate?;
        writeln!(io::stdout(), "{estimate}")?;
        estimate.check()?;
        files.check_space(&config)?;
        return Ok(ExitCode::SUCCESS);
    }
    files.check_space(&config)?;
    show_run(shared, files.stages(&config), |progress| compute(&config, &files, progress))
}

/// What is written, all found writable.
struct Files {
    result: ResultFiles,
    tables: Vec<Output<TableFormat>>,
    series: Option<(SeriesOutput, NonZeroU32)>,
    /// Whether cells are all that is asked for.
    is_cells_only: bool,
}

impl Files {
    /// Checks that all can be written, each under a path of its own.
    fn check(arguments: &Arguments, config: &Config) -> Result<Self, Error> {
        let (files, run) = (&arguments.files, &arguments.run);
        let json = files.cells_json.iter().map(|path| Output::check_as(path, TableFormat::Json));
        let csv = files.cells_csv.iter().map(|path| Output::check_as(path, TableFormat::Csv));
        let tables = json.chain(csv).collect::<Result<_, _>>()?;
        let is_cells_only = run.no_mesh;
        let (pictures, to_write) = (&arguments.pictures, config.to_write());
        let result = ResultFiles::check(&files.outputs, pictures, &run.shared, &to_write, !is_cells_only)?;
        let series = files.series()?.map(|output| (output, files.every));
        let all = Self { result, tables, series, is_cells_only };
        let tables = all.tables.iter().map(Output::target);
        let others = tables.chain(all.series.as_ref().map(|(output, _)| output.target()));
        check_all_differ(others.map(Path::to_owned).chain(all.result.targets()).collect())?;
        Ok(all)
    }

    /// What a run goes through.
    fn stages(&self, config: &Config) -> Vec<Stage> {
        let mut stages = vec![Stage::Seeds, Stage::Cells];
        if !self.is_cells_only {
            stages.extend([Stage::Network, Stage::Relaxation, Stage::Subdivision, Stage::Validation]);
            if config.elements != ElementOptions::default() {
                stages.push(Stage::Remeshing);
            }
            if self.result.need_gmsh() {
                stages.push(Stage::Filling);
            }
        }
        stages.push(Stage::Writing);
        stages
    }

    /// Checks that there is space for what is known to be large.
    fn check_space(&self, config: &Config) -> Result<(), Error> {
        self.result.check_voxels()?;
        self.result.outputs.iter().try_for_each(|output| output.check_space(config))
    }

    /// What the summary lists, as the user called it.
    fn paths(&self) -> Vec<PathBuf> {
        let tables = self.tables.iter().map(|output| output.path().to_owned());
        let series = self.series.iter().map(|(output, _)| output.path().to_owned());
        tables.chain(self.result.paths()).chain(series).collect()
    }

    fn stage_tables<'a>(
        &self,
        table: impl FnOnce() -> CellTable<'a>,
        staged: &mut StagedFiles,
    ) -> Result<(), Error> {
        if self.tables.is_empty() {
            return Ok(());
        }
        let table = table();
        self.tables.iter().try_for_each(|output| table.stage(output, staged))
    }
}

/// Cuts the cells and tells what would become of them.
fn estimate(config: &Config, files: &Files, line: &ProgressLine) -> Result<Estimate, Error> {
    let cells = tessellate(config, &|stage, done, count| line.show(stage, done, count))?;
    Ok(Estimate::new(config, &cells, &files.result.formats()))
}

/// Computes and writes what is asked for, and returns the summary.
fn compute(config: &Config, files: &Files, progress: Progress<'_>) -> Result<String, Error> {
    let paths = files.paths();
    if files.is_cells_only {
        if config.lists_cells() {
            let cells = list_cells(config, progress)?;
            write_together(|staged| files.stage_tables(|| CellTable::of_list(config, &cells), staged))?;
            return Ok(with_paths(&ListedSummary(config, &cells).to_string().trim_end(), &paths));
        }
        let cells = tessellate(config, progress)?.stretched(config);
        write_together(|staged| files.stage_tables(|| CellTable::new(config, &cells), staged))?;
        return Ok(with_paths(&CellsSummary(config, &cells).to_string().trim_end(), &paths));
    }
    check_expected_size(config)?;
    let tessellated = tessellate(config, progress)?;
    Estimate::new(config, &tessellated, &files.result.formats()).check()?;
    let mut series = files.series.as_ref().map(|(output, every)| (output, Series::new(*every)));
    let mut added = Ok(());
    let mut polycrystal = smooth_watched(config, tessellated, &progress, |step| {
        if let (Some((_, series)), Ok(())) = (&mut series, &added) {
            added = series.add(&step);
        }
    })?;
    added?;
    polycrystal = polycrystal.completed(progress)?;
    if files.result.need_gmsh() {
        progress(Stage::Filling, 0, 1);
        polycrystal = polycrystal.filled()?;
    }
    progress(Stage::Writing, 0, 1);
    let start = Instant::now();
    write_together(|staged| {
        if let Some(Synthesis { cells, .. }) = polycrystal.synthesis() {
            files.stage_tables(|| CellTable::new(config, cells), staged)?;
        }
        files.result.stage(&polycrystal, staged)?;
        if let Some((output, series)) = &series {
            series.stage(&mut polycrystal, output, staged)?;
        }
        files.result.finish(&mut polycrystal, start, &paths, staged)
    })?;
    Ok(with_paths(&Summary(&polycrystal), &paths))
}
