//! `grainsmooth smooth`: from a measured map to its network, or from a network to a relaxed one.

use std::process::ExitCode;
use std::time::Instant;

use grainsmooth::{
    Error, LabelledFile, MapRun, MeasuredMap, Polycrystal, Progress, Stage, ToWrite, read_map, smooth_map,
};
use polycrystal::Relaxation;
use voronoi::Dimension;

use super::mesh::command_line;
use super::result_files::{ResultFiles, check_all_differ, thread_pool};
use crate::progress::ProgressLine;
use crate::say;
use grainsmooth::cli::{Arguments, SmoothArguments, usage};

/// Smooths the map, writes what is asked for and reports.
pub fn run(arguments: &SmoothArguments) -> anyhow::Result<ExitCode> {
    let pool = thread_pool(&arguments.shared)?;
    let mut stages = vec![Stage::Map, Stage::Network, Stage::Writing];
    if arguments.network.relaxation().is_some() {
        stages.splice(2..2, [Stage::Relaxation, Stage::Validation]);
    }
    let line = ProgressLine::new(arguments.shared.quiet, stages);
    let summary = pool.install(|| smooth(arguments, &line));
    line.clear();
    let summary = summary?;
    if !arguments.shared.quiet {
        say(&summary);
    }
    Ok(ExitCode::SUCCESS)
}

/// What is given.
enum Given {
    Map(Box<MeasuredMap>),
    /// To be relaxed.
    Network(Box<LabelledFile>, Relaxation),
}

impl Given {
    fn read(arguments: &SmoothArguments) -> Result<Self, Error> {
        let SmoothArguments { map: path, options, network, .. } = arguments;
        if !LabelledFile::is_known(path) {
            return Ok(Self::Map(Box::new(read_map(path, options)?)));
        }
        let of_maps = options.first_given().or(network.first_of_maps());
        if let Some(option) = of_maps {
            return Err(usage(&format!("{} is a network, not a map; leave {option} out", path.display())));
        }
        let Some(relaxation) = network.relaxation() else {
            return Err(usage(&format!(
                "{} is a network already; give --relax, such as --relax equilibrium",
                path.display()
            )));
        };
        Ok(Self::Network(Box::new(LabelledFile::read(path)?), relaxation))
    }

    fn dimension(&self) -> Dimension {
        match self {
            Self::Map(measured) if measured.map.is_plane() => Dimension::Two,
            Self::Map(_) => Dimension::Three,
            Self::Network(file, _) => file.surface().elements.dimension(),
        }
    }

    fn has_orientations(&self) -> bool {
        match self {
            Self::Map(measured) => measured.crystals.is_some(),
            Self::Network(file, _) => file.orientations.is_some(),
        }
    }

    fn has_phases(&self) -> bool {
        match self {
            Self::Map(measured) => measured.crystals.is_some(),
            Self::Network(file, _) => file.phases.is_some(),
        }
    }
}

/// Returns the summary.
fn smooth(arguments: &SmoothArguments, line: &ProgressLine) -> Result<String, Error> {
    let SmoothArguments { map: path, network, outputs, pictures, shared, .. } = arguments;
    let start = Instant::now();
    line.show(Stage::Map, 0, 1);
    let given = Given::read(arguments)?;
    let read_in = start.elapsed();
    let has_orientations = given.has_orientations();
    pictures.check_known(path, has_orientations, given.has_phases())?;
    let dimension = given.dimension();
    let file = outputs.options(dimension)?;
    let to_write = ToWrite {
        dimension,
        has_voxels: file.voxels.is_some(),
        has_map: matches!(given, Given::Map(_)),
        has_orientations,
        has_cells: false,
        volume: file.volume,
    };
    let files = ResultFiles::check(outputs, pictures, shared, &to_write, true)?;
    check_all_differ(files.targets())?;
    let progress: Progress<'_> = &|stage, done, count| line.show(stage, done, count);
    let polycrystal = match given {
        Given::Map(measured) => {
            let run = MapRun { command_line: command_line(), file, network: network.clone(), read_in };
            smooth_map(path, &measured, run, progress)?
        }
        Given::Network(given, relaxation) => {
            progress(Stage::Network, 0, 1);
            let mut polycrystal =
                Polycrystal::of_file(path, &given, Arguments::domain_of(&given), command_line())?;
            *polycrystal.file_mut() = file;
            polycrystal.relaxed(path, relaxation, progress)?
        }
    };
    files.fill_and_write(polycrystal, &to_write, progress)
}
