//! `grainsmooth check`: certifies networks from files.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use grainsmooth::{CheckReport, LabelledFile};
use serde::Serialize;

use crate::say;

/// Check networks of grains: closed, wound alike, nothing folded or crossed, no point twice
///
/// Reads triangles (in the plane: lines) with two labels each, from the cell array FaceLabels, boundary_labels or
/// BoundaryLabels of .vtp, .vtu and .vtk files, whichever program wrote them.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit status: 0 all good, 1 something is wrong or unreadable, 2 a mistake on the command line."
)]
pub struct CheckArguments {
    /// Files to check: .vtp, .vtu or .vtk
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,

    /// Report as JSON: {"files": [...]}
    #[arg(long)]
    json: bool,
}

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
