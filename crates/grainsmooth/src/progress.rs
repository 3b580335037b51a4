//! One line on a terminal that says how far the run is.

use std::io::IsTerminal;
use std::time::Duration;

use grainsmooth::Stage;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A progress bar on standard error where that is a terminal, else nothing.
pub struct ProgressLine(ProgressBar);

impl ProgressLine {
    /// Shows nothing when `quiet`.
    pub fn new(quiet: bool) -> Self {
        let target = if quiet || !std::io::stderr().is_terminal() {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        let bar = ProgressBar::with_draw_target(Some(1), target);
        let style = ProgressStyle::with_template("{msg:12} {bar:40} {pos}/{len}  {elapsed}");
        bar.set_style(style.expect("the template is fixed"));
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(bar)
    }

    /// Shows the stage and how many of its steps are done.
    pub fn show(&self, stage: Stage, done: usize, count: usize) {
        self.0.set_message(stage.name());
        self.0.set_length(count as u64);
        self.0.set_position(done as u64);
    }

    /// Takes the line off the terminal.
    pub fn clear(&self) {
        self.0.finish_and_clear();
    }
}
