//! What is made of the command line's description: completions for shells, and the manual page.

use std::io;

use clap::CommandFactory;
use clap_complete::Shell;

use super::Arguments;

/// A shell's completions.
pub fn completions(shell: Shell) -> Vec<u8> {
    let mut command = Arguments::command();
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut command, env!("CARGO_PKG_NAME"), &mut script);
    script
}

/// The manual page, in roff.
///
/// # Errors
/// None that memory does not raise.
pub fn manual() -> io::Result<Vec<u8>> {
    let mut page = Vec::new();
    clap_mangen::Man::new(Arguments::command()).render(&mut page)?;
    Ok(page)
}
