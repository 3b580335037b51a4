//! The `grainsmooth` program: reads the command line, runs the pipeline, reports.

mod cli;
mod progress;

use std::io::Write;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::anyhow;
use clap::Parser;
use grainsmooth::{Output, Stage, Summary, make_polycrystal};

use cli::Arguments;
use progress::ProgressLine;

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            say(&format!("error: {error}"));
            ExitCode::FAILURE
        }
    }
}

/// Writes a line to standard error. Where nobody can read it the run is no worse for that.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

fn run(arguments: &Arguments) -> anyhow::Result<()> {
    // An output that cannot be written is found before hours of work, not after.
    let output = Output::check(&arguments.output)?;
    let threads = arguments.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|cause| anyhow!("cannot start {threads} threads: {cause}; give fewer with --threads"))?;
    let line = ProgressLine::new(arguments.quiet);
    let result = pool.install(|| {
        let mut polycrystal =
            make_polycrystal(&arguments.config(), &|stage, done, count| line.show(stage, done, count))?;
        line.show(Stage::Writing, 0, 1);
        let start = Instant::now();
        polycrystal.write(&output)?;
        polycrystal.add_time(Stage::Writing, start.elapsed());
        Ok::<_, grainsmooth::Error>(polycrystal)
    });
    line.clear();
    let polycrystal = result?;
    if !arguments.quiet {
        say(&format!("{}\nwritten     {}", Summary(&polycrystal), output.path().display()));
    }
    Ok(())
}
