//! `grainsmooth remesh`: from the network of a file to one for finite elements.

use std::process::ExitCode;

use grainsmooth::{Error, LabelledFile, Progress, Stage};

use super::result_files::{ResultFiles, show_run};
use grainsmooth::cli::{RemeshArguments, usage};

/// Remeshes the network, writes what is asked for and reports.
pub fn run(arguments: &RemeshArguments) -> anyhow::Result<ExitCode> {
    let stages = vec![Stage::Network, Stage::Remeshing, Stage::Writing];
    show_run(&arguments.result.shared, stages, |progress| remesh(arguments, progress))
}

/// Returns the summary.
fn remesh(arguments: &RemeshArguments, progress: Progress<'_>) -> Result<String, Error> {
    let RemeshArguments { file: path, elements, result } = arguments;
    if !elements.are_asked() {
        return Err(usage(
            "remesh needs a size of elements; give --elements-per-grain, such as --elements-per-grain 5, or --element-size",
        ));
    }
    progress(Stage::Network, 0, 1);
    let given = LabelledFile::read(path)?;
    let (files, polycrystal) = ResultFiles::of_network(result, path, &given, true)?;
    progress(Stage::Remeshing, 0, 1);
    files.fill_and_write(polycrystal.remeshed(elements)?, progress)
}
