//! The `grainsmooth` program: reads the command line, runs the pipeline, reports.

mod cli;
mod mesh_cli;
mod mesh_run;
mod progress;

use std::io::Write;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::anyhow;
use clap::Parser;
use grainsmooth::mesh_file::READER_THREAD;
use grainsmooth::{Output, Stage, Summary, make_polycrystal};

use cli::{Arguments, Command};
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

/// A panic over a corrupt VTK file becomes an error, and needs no words of its own.
fn keep_reader_quiet() {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if std::thread::current().name() != Some(READER_THREAD) {
            hook(info);
        }
    }));
}

fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if let Some(Command::Mesh(mesh)) = &arguments.command {
        keep_reader_quiet();
        return Ok(mesh_run::run(&mesh.command)?);
    }
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
