//! `grainsmooth view` and `grainsmooth edit`: serve a page and open it, until Ctrl-C.

use std::io::{self, BufRead, IsTerminal, Write};
use std::process::{Command, ExitCode, Stdio};
use std::thread;

use grainsmooth::{PageDocument, PageServer};
use tempfile::NamedTempFile;

use crate::say;
use grainsmooth::cli::{EditArguments, ServerArguments, ViewArguments};

/// Shows grains.
pub fn view(arguments: &ViewArguments) -> anyhow::Result<ExitCode> {
    serve(PageDocument::grains(&arguments.files)?, &arguments.server)
}

/// Edits a mesh, curves or Bezier patches.
pub fn edit(arguments: &EditArguments) -> anyhow::Result<ExitCode> {
    let document = match &arguments.file {
        Some(file) => PageDocument::edit(file, arguments.content)?,
        None => PageDocument::teapot()?,
    };
    serve(document, &arguments.server)
}

fn serve(document: PageDocument, arguments: &ServerArguments) -> anyhow::Result<ExitCode> {
    let server = PageServer::new(document, arguments.port)?;
    let links = server.links();
    #[cfg(unix)]
    stop_when_interrupted(&server)?;
    let link = links.link()?;
    print(&link)?;
    // Where no browser opens there is the link.
    let _file = if arguments.no_open { None } else { open(&link).ok() };
    say("Press Ctrl-C to stop, or Enter for a new link; each works once.");
    if arguments.no_open {
        let port = links.port();
        say(&format!("From another machine: ssh -L {port}:127.0.0.1:{port} HOST there, then open the link."));
    }
    if io::stdin().is_terminal() {
        thread::spawn(move || {
            for _ in io::stdin().lock().lines().map_while(Result::ok) {
                if links.link().and_then(|link| print(&link)).is_err() {
                    break;
                }
            }
        });
    }
    server.run()?;
    Ok(ExitCode::SUCCESS)
}

/// On standard output, for programs that start this one.
fn print(link: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    writeln!(out, "{link}")?;
    out.flush()
}

#[cfg(unix)]
fn stop_when_interrupted(server: &PageServer) -> io::Result<()> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;

    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    let stop = server.stop();
    thread::spawn(move || {
        if signals.forever().next().is_some() {
            stop.stop();
        }
    });
    Ok(())
}

/// Opens a link in the user's browser. Arguments of programs are seen by all users of a machine; so the browser gets a file that leads on,
/// which this user alone can read, and which is gone when the program ends.
fn open(link: &str) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix("grainsmooth-").suffix(".html");
    #[cfg(unix)]
    builder.permissions({
        use std::os::unix::fs::PermissionsExt;
        std::fs::Permissions::from_mode(0o600)
    });
    let mut file = builder.tempfile()?;
    write!(file, "<!DOCTYPE html><meta charset=utf-8><meta http-equiv=refresh content=\"0;url={link}\">")?;
    file.flush()?;
    let mut command = opener();
    command.arg(file.path()).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
    Ok(file)
}

/// What opens files by the program that the user chose for them.
fn opener() -> Command {
    if cfg!(target_os = "macos") {
        Command::new("open")
    } else if cfg!(windows) {
        Command::new("explorer")
    } else {
        Command::new("xdg-open")
    }
}
