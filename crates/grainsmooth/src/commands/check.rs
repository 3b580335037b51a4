//! `grainsmooth check`: certifies networks from files.

use std::io::Write;
use std::process::ExitCode;

use grainsmooth::{CheckReport, LabelledFile};
use serde::Serialize;

use crate::say;
use grainsmooth::cli::CheckArguments;

#[derive(Serialize)]
struct Reports {
    files: Vec<CheckReport>,
}

/// Checks all files and reports on standard output; what cannot be read is told on standard error.
pub fn run(arguments: &CheckArguments) -> anyhow::Result<ExitCode> {
    let mut good = true;
    let mut reports = Reports { files: Vec::new() };
    for path in &arguments.files {
        match LabelledFile::read(path) {
            Ok(file) => reports.files.push(CheckReport::new(path, &file)),
            Err(error) => {
                good = false;
                say(&format!("error: {error}"));
            }
        }
    }
    good &= reports.files.iter().all(|report| report.good);
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
