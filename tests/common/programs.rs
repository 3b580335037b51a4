//! Programs that others wrote, which `.ci/run` installs.

use std::io::Write;
use std::process::{Command, Output};

/// Runs a program; nothing where it, or a module of Python, is not installed.
pub fn run(test: &str, command: &mut Command) -> Option<Output> {
    match command.output() {
        Ok(output) if String::from_utf8_lossy(&output.stderr).contains("ModuleNotFoundError") => {
            skip(test, String::from_utf8_lossy(&output.stderr).trim_end());
            None
        }
        Ok(output) => Some(output),
        Err(error) => {
            skip(test, &format!("cannot run {}: {error}", command.get_program().display()));
            None
        }
    }
}

/// Says that a test is not done here, which with `CI=true` fails it.
pub fn skip(test: &str, why: &str) {
    assert!(std::env::var("CI").as_deref() != Ok("true"), "{test} cannot be skipped in CI: {why}");
    // Not through `eprintln`, which the test harness keeps to itself.
    std::io::stderr().write_all(format!("SKIPPED {test}: {why}\n").as_bytes()).unwrap();
}
