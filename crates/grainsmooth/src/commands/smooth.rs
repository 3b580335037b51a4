//! `grainsmooth smooth`: from a measured map to its network.

use std::process::ExitCode;
use std::time::Instant;

use grainsmooth::{Coloring, Error, MapRun, Stage, Summary, ToWrite, read_map, smooth_map, write_together};
use voronoi::Dimension;

use super::mesh::command_line;
use super::result_files::{ResultFiles, check_all_differ, thread_pool};
use crate::progress::ProgressLine;
use crate::say;
use grainsmooth::cli::{SmoothArguments, usage};

/// Smooths the map, writes what is asked for and reports.
pub fn run(arguments: &SmoothArguments) -> anyhow::Result<ExitCode> {
    let pool = thread_pool(&arguments.shared)?;
    let stages = vec![Stage::Map, Stage::Network, Stage::Writing];
    let line = ProgressLine::new(arguments.shared.quiet, stages);
    let summary = pool.install(|| smooth(arguments, &line));
    line.clear();
    let summary = summary?;
    if !arguments.shared.quiet {
        say(&summary);
    }
    Ok(ExitCode::SUCCESS)
}

/// Returns the summary.
fn smooth(arguments: &SmoothArguments, line: &ProgressLine) -> Result<String, Error> {
    let SmoothArguments { map: path, options, network, outputs, pictures, shared } = arguments;
    let start = Instant::now();
    line.show(Stage::Map, 0, 1);
    let measured = read_map(path, options)?;
    let read_in = start.elapsed();
    let coloring = pictures.coloring();
    let has_orientations = measured.crystals.is_some();
    if !has_orientations && (coloring == Coloring::Phase || coloring.needs_texture()) {
        let name = coloring.name();
        return Err(usage(&format!("--color-by {name} needs something that a map of labels does not hold")));
    }
    let dimension = if measured.map.is_plane() { Dimension::Two } else { Dimension::Three };
    let file = outputs.options(dimension)?;
    let to_write = ToWrite {
        dimension,
        has_voxels: file.voxels.is_some(),
        has_orientations,
        has_cells: false,
        volume: file.volume,
    };
    let files = ResultFiles::check(outputs, pictures, shared, &to_write, true)?;
    check_all_differ(files.targets())?;
    let shortest_edge = network.shortest_edge(measured.map.is_plane());
    let run = MapRun { command_line: command_line(), file, shortest_edge, read_in };
    let mut polycrystal =
        smooth_map(path, &measured, run, &|stage, done, count| line.show(stage, done, count))?;
    if files.need_tetrahedra(&to_write) {
        line.show(Stage::Filling, 0, 1);
        polycrystal = polycrystal.filled()?;
    }
    line.show(Stage::Writing, 0, 1);
    let start = Instant::now();
    write_together(|staged| {
        files.stage(&polycrystal, staged)?;
        files.finish(&mut polycrystal, start, &files.paths(), staged)
    })?;
    let names: Vec<String> = files.paths().iter().map(|path| path.display().to_string()).collect();
    Ok(format!("{}\nwritten     {}", Summary(&polycrystal), names.join(", ")))
}
