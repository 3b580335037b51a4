//! `grainsmooth smooth`: from a measured map to its network, or from a network to a relaxed one.

use std::process::ExitCode;
use std::time::Instant;

use grainsmooth::{Error, LabelledFile, MapRun, Progress, Stage, read_map, smooth_map};
use voronoi::Dimension;

use super::mesh::command_line;
use super::result_files::{Given, ResultFiles, show_run};
use grainsmooth::cli::{SmoothArguments, usage};

/// Smooths the map, writes what is asked for and reports.
pub fn run(arguments: &SmoothArguments) -> anyhow::Result<ExitCode> {
    let mut stages = vec![Stage::Map, Stage::Network, Stage::Writing];
    let network = &arguments.network;
    let is_relaxed = network.relaxation().is_some();
    let after = [
        (Stage::Relaxation, is_relaxed),
        (Stage::Validation, is_relaxed),
        (Stage::Subdivision, network.levels > 0),
    ];
    stages.splice(2..2, after.into_iter().filter(|(_, is_asked)| *is_asked).map(|(stage, _)| stage));
    show_run(&arguments.result.shared, stages, |progress| smooth(arguments, progress))
}

/// Returns the summary.
fn smooth(arguments: &SmoothArguments, progress: Progress<'_>) -> Result<String, Error> {
    let SmoothArguments { map: path, options, network, result } = arguments;
    let start = Instant::now();
    progress(Stage::Map, 0, 1);
    if LabelledFile::is_known(path) {
        return refine(arguments, progress);
    }
    let measured = read_map(path, options)?;
    let read_in = start.elapsed();
    let given = Given {
        dimension: if measured.map.is_plane() { Dimension::Two } else { Dimension::Three },
        has_map: true,
        has_orientations: measured.crystals.is_some(),
        has_phases: measured.crystals.is_some(),
        has_element_size: false,
    };
    let (files, file) = ResultFiles::of_given(result, path, given)?;
    let run = MapRun { command_line: command_line(), file, network: network.clone(), read_in };
    files.fill_and_write(smooth_map(path, measured, run, progress)?, progress)
}

/// Relaxes and subdivides a network.
fn refine(arguments: &SmoothArguments, progress: Progress<'_>) -> Result<String, Error> {
    let SmoothArguments { map: path, options, network, result } = arguments;
    if let Some(option) = options.first_given().or(network.first_of_maps()) {
        return Err(usage(&format!("{} is a network, not a map; leave {option} out", path.display())));
    }
    if network.relaxation().is_none() && network.levels == 0 {
        return Err(usage(&format!(
            "{} is a network already; give --relax, such as --relax equilibrium, or -n",
            path.display()
        )));
    }
    let given = LabelledFile::read(path)?;
    progress(Stage::Network, 0, 1);
    let (files, polycrystal) = ResultFiles::of_network(result, path, &given, false)?;
    files.fill_and_write(polycrystal.refined(path, network, progress)?, progress)
}
