//! `grainsmooth remesh`: from the network of a file to one for finite elements.

use std::process::ExitCode;

use grainsmooth::{Error, LabelledFile, Polycrystal, Progress, Stage, ToWrite};
use voronoi::Dimension;

use super::mesh::command_line;
use super::result_files::{ResultFiles, check_all_differ, thread_pool};
use crate::progress::ProgressLine;
use crate::say;
use grainsmooth::cli::{Arguments, RemeshArguments, usage};

/// Remeshes the network, writes what is asked for and reports.
pub fn run(arguments: &RemeshArguments) -> anyhow::Result<ExitCode> {
    let pool = thread_pool(&arguments.shared)?;
    let stages = vec![Stage::Network, Stage::Remeshing, Stage::Writing];
    let line = ProgressLine::new(arguments.shared.quiet, stages);
    let summary = pool.install(|| remesh(arguments, &|stage, done, count| line.show(stage, done, count)));
    line.clear();
    let summary = summary?;
    if !arguments.shared.quiet {
        say(&summary);
    }
    Ok(ExitCode::SUCCESS)
}

/// Returns the summary.
fn remesh(arguments: &RemeshArguments, progress: Progress<'_>) -> Result<String, Error> {
    let RemeshArguments { file: path, elements, outputs, pictures, shared } = arguments;
    if !elements.are_asked() {
        return Err(usage(
            "remesh needs a size of elements; give --elements-per-grain, such as --elements-per-grain 5, or --element-size",
        ));
    }
    progress(Stage::Network, 0, 1);
    let given = LabelledFile::read(path)?;
    let dimension = given.surface().elements.dimension();
    if dimension == Dimension::Two {
        let path = path.display();
        return Err(usage(&format!("{path} holds grains in 2D, and only boundaries in 3D are remeshed")));
    }
    pictures.check_known(path, given.orientations.is_some(), given.phases.is_some())?;
    let file = outputs.options(dimension)?;
    let to_write = ToWrite {
        dimension,
        has_voxels: file.voxels.is_some(),
        has_map: false,
        has_orientations: given.orientations.is_some(),
        has_cells: false,
        volume: file.volume,
    };
    let files = ResultFiles::check(outputs, pictures, shared, &to_write, true)?;
    check_all_differ(files.targets())?;
    let mut polycrystal = Polycrystal::of_file(path, &given, Arguments::domain_of(&given), command_line())?;
    *polycrystal.file_mut() = file;
    progress(Stage::Remeshing, 0, 1);
    files.fill_and_write(polycrystal.remeshed(elements)?, &to_write, progress)
}
