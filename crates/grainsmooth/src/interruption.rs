//! Ctrl-C, and being asked to end: nothing half written stays.

use std::thread;

use grainsmooth::discard_unfinished;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

/// From here on, a signal that ends the program takes what is half written away first.
pub fn leave_nothing_when_interrupted() -> std::io::Result<()> {
    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    thread::spawn(move || {
        if let Some(signal) = signals.forever().next() {
            discard_unfinished();
            // Where the cursor stands after `^C`, or on the line of progress.
            crate::say("\ninterrupted; nothing half written is left");
            // As shells tell of a program that a signal ended.
            std::process::exit(128 + signal);
        }
    });
    Ok(())
}
