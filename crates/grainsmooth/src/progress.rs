//! One line on a terminal that says how far the run is.

use std::io::IsTerminal;
use std::time::Duration;

use grainsmooth::Stage;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Stages of a single step say nothing of what is left.
const UNCOUNTED: &str = "{prefix} {msg:12} {elapsed}";
const COUNTED: &str = "{prefix} {msg:12} {bar:40} {pos}/{len}  {elapsed}, about {eta} left in this stage";

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
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(bar)
    }

    /// Shows the stage and how many of its steps are done.
    pub fn show(&self, stage: Stage, done: usize, count: usize) {
        let number = 1 + Stage::ALL.iter().take_while(|other| **other != stage).count();
        if done == 0 {
            self.0.reset();
        }
        let template = if count > 1 { COUNTED } else { UNCOUNTED };
        self.0.set_style(ProgressStyle::with_template(template).expect("the template is fixed"));
        self.0.set_prefix(format!("[{number}/{}]", Stage::ALL.len()));
        self.0.set_message(stage.name());
        self.0.set_length(count as u64);
        self.0.set_position(done as u64);
    }

    /// Takes the line off the terminal.
    pub fn clear(&self) {
        self.0.finish_and_clear();
    }
}
