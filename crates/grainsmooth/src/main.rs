//! The `grainsmooth` program: reads the command line, runs the pipeline, reports.

mod commands;
#[cfg(unix)]
mod interruption;
mod progress;

use std::io::{self, Write};
use std::process::ExitCode;

use grainsmooth::Error;
use grainsmooth::cli::{self, Arguments, Command};
use grainsmooth::mesh::file::READER_THREAD;

fn main() -> ExitCode {
    match run() {
        Ok(code) => code,
        // Whoever reads what we print may stop when there is enough of it.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => match error.downcast() {
            Ok(Error::Usage(mistake)) => mistake.into_inner().exit(),
            Ok(error) => fail(&error),
            Err(error) => fail(&error),
        },
    }
}

fn fail(error: &dyn std::fmt::Display) -> ExitCode {
    say(&format!("error: {error}"));
    ExitCode::FAILURE
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let kind = match error.downcast_ref() {
        Some(error) => serde_json::Error::io_error_kind(error),
        None => error.downcast_ref().map(io::Error::kind),
    };
    kind == Some(io::ErrorKind::BrokenPipe)
}

/// Writes a line to standard error. Where nobody can read it the run is no worse for that.
fn say(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
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

fn run() -> anyhow::Result<ExitCode> {
    let arguments = &Arguments::read(std::env::args_os().collect())?;
    // Whoever interrupts a page has seen enough: that is how it ends.
    #[cfg(unix)]
    if !matches!(arguments.command, Some(Command::View(_) | Command::Edit(_))) {
        interruption::leave_nothing_when_interrupted()?;
    }
    let Some(command) = &arguments.command else { return commands::network::run(arguments) };
    keep_reader_quiet();
    match command {
        Command::Mesh(mesh) => commands::mesh::run(&mesh.command)?,
        Command::Check(check) => return commands::check::run(check),
        Command::Measure(measure) => commands::measure::run(measure)?,
        Command::Smooth(smooth) => return commands::smooth::run(smooth),
        Command::Remesh(remesh) => return commands::remesh::run(remesh),
        Command::View(view) => return commands::page::view(view),
        Command::Edit(edit) => return commands::page::edit(edit),
        Command::Completions { shell } => io::stdout().lock().write_all(&cli::completions(*shell))?,
        Command::Man => io::stdout().lock().write_all(&cli::manual()?)?,
    }
    Ok(ExitCode::SUCCESS)
}
