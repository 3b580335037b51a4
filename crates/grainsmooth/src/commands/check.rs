//! `grainsmooth check`: certifies networks and volume meshes from files.

use std::fmt;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use grainsmooth::{CheckReport, Error, LabelledFile, MeasuredMap, VolumeFile, VolumeReport, read_map};
use serde::Serialize;

use crate::say;
use grainsmooth::cli::CheckArguments;

#[derive(Serialize)]
struct Reports {
    files: Vec<Report>,
}

/// What there is to say of a file.
#[derive(Serialize)]
#[serde(untagged)]
enum Report {
    Network(Box<CheckReport>),
    Volume(Box<VolumeReport>),
}

impl Report {
    fn is_good(&self) -> bool {
        match self {
            Self::Network(report) => report.good,
            Self::Volume(report) => report.good,
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Network(report) => report.fmt(out),
            Self::Volume(report) => report.fmt(out),
        }
    }
}

/// Checks all files and reports on standard output; what cannot be read is told on standard error.
pub fn run(arguments: &CheckArguments) -> anyhow::Result<ExitCode> {
    let map = arguments.labels.as_deref();
    let map = map.map(|path| read_map(path, &arguments.options).map(|map| (path, map))).transpose()?;
    let mut good = true;
    let mut reports = Reports { files: Vec::new() };
    for path in &arguments.files {
        match report(path, map.as_ref()) {
            Ok(report) => reports.files.push(report),
            Err(error) => {
                good = false;
                say(&format!("error: {error}"));
            }
        }
    }
    good &= reports.files.iter().all(Report::is_good);
    let mut out = std::io::stdout().lock();
    if arguments.json {
        serde_json::to_writer(&mut out, &reports)?;
        writeln!(out)?;
    } else {
        for report in &reports.files {
            writeln!(out, "{report}")?;
        }
    }
    Ok(if good { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// What there is to say of tetrahedra, or of a network, beside a map with its path.
fn report(path: &Path, map: Option<&(&Path, MeasuredMap)>) -> Result<Report, Error> {
    if let Some(file) = VolumeFile::read(path)? {
        return Ok(Report::Volume(Box::new(VolumeReport::new(path, &file))));
    }
    let file = LabelledFile::read(path)?;
    let Some((map_path, map)) = map else {
        return Ok(Report::Network(Box::new(CheckReport::new(path, &file))));
    };
    let report = CheckReport::beside_map(path, &file, map)
        .map_err(|problem| Error::MapFile { path: map_path.to_path_buf(), problem })?;
    Ok(Report::Network(Box::new(report)))
}
