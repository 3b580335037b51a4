//! The `grainsmooth` program: reads the command line, runs the pipeline, reports.

mod cli;
mod commands;
#[cfg(unix)]
mod interruption;
mod progress;

use std::io::{self, Write};
use std::process::ExitCode;

use grainsmooth::mesh::file::READER_THREAD;

use cli::{Arguments, Command};

fn main() -> ExitCode {
    match run(&Arguments::read()) {
        Ok(code) => code,
        // Whoever reads what we print may stop when there is enough of it.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            say(&format!("error: {error}"));
            ExitCode::FAILURE
        }
    }
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

fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
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
        Command::View(view) => return commands::page::view(view),
        Command::Edit(edit) => return commands::page::edit(edit),
        Command::Completions { shell } => cli::print_completions(*shell)?,
        Command::Man => cli::print_manual()?,
    }
    Ok(ExitCode::SUCCESS)
}
