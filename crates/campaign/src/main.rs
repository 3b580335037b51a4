//! The `campaign` program: runs a slice of a campaign, or sums up what slices have recorded.
#![allow(clippy::print_stdout, reason = "the summary is what the program is for")]

use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, ensure};
use campaign::{Limits, Record, Slice, Subject, Summary, run_slice};
use clap::Parser;

/// Run grainsmooth at random and certify each result
///
/// Each run is a command line with its input files, drawn from the seed and the run's index alone. Exit status 1 where a run
/// panicked, was invalid, or left files behind.
#[derive(Debug, Parser)]
struct Arguments {
    /// Number of runs
    #[arg(long, default_value_t = 100)]
    runs: u64,

    /// Seed of the campaign
    #[arg(long, required_unless_present = "summarize")]
    seed: Option<u64>,

    /// Draw measured maps for `grainsmooth smooth` instead of seeds
    ///
    /// Example: --maps --seed 7
    #[arg(long)]
    maps: bool,

    /// Index of the first run
    ///
    /// Example: --from 731 --runs 1 repeats run 731 alone
    #[arg(long, default_value_t = 0)]
    from: u64,

    /// Append a line of JSON for each run to this file
    #[arg(long, default_value = "campaign.jsonl")]
    results: PathBuf,

    /// The program to run [default: grainsmooth beside this program]
    #[arg(long)]
    program: Option<PathBuf>,

    /// Keep the input of runs that are neither good nor refused, or have thin triangles, in this directory
    #[arg(long)]
    keep: Option<PathBuf>,

    /// Most grains of a run
    #[arg(long, default_value_t = Limits::USUAL.grains)]
    grains: u32,

    /// Triangles of the finest level that are about the most
    #[arg(long, default_value_t = Limits::USUAL.triangles)]
    triangles: u32,

    /// Sum up these files of results instead
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["seed", "runs", "from"])]
    summarize: Option<Vec<PathBuf>>,
}

fn main() -> anyhow::Result<ExitCode> {
    let arguments = Arguments::parse();
    let records = match &arguments.summarize {
        Some(files) => {
            let records = files.iter().map(|file| read(file)).collect::<anyhow::Result<Vec<_>>>()?;
            records.concat()
        }
        None => run(&arguments)?,
    };
    println!("{}", Summary(&records));
    let is_bad = records.iter().any(Record::is_unacceptable);
    Ok(if is_bad { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

fn read(path: &Path) -> anyhow::Result<Vec<Record>> {
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    text.lines().map(|line| serde_json::from_str(line).with_context(|| path.display().to_string())).collect()
}

fn run(arguments: &Arguments) -> anyhow::Result<Vec<Record>> {
    let program = match &arguments.program {
        Some(program) => program.clone(),
        None => std::env::current_exe()?.with_file_name("grainsmooth"),
    };
    ensure!(program.is_file(), "no program {}; build it or name one with --program", program.display());
    // Runs go in directories of their own.
    let program = program.canonicalize()?;
    let mut results = OpenOptions::new()
        .create(true)
        .append(true)
        .open(&arguments.results)
        .with_context(|| arguments.results.display().to_string())?;
    let slice = Slice {
        program,
        subject: if arguments.maps { Subject::Maps } else { Subject::Seeds },
        seed: arguments.seed.unwrap_or_default(),
        from: arguments.from,
        runs: arguments.runs,
        limits: Limits { grains: arguments.grains, triangles: arguments.triangles },
        keep: arguments.keep.clone(),
    };
    run_slice(&slice, |record| {
        serde_json::to_writer(&mut results, record)?;
        Ok(writeln!(results)?)
    })
}
